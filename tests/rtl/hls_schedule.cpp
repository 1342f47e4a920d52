// SPDX-License-Identifier: Apache-2.0
// The kernels' schedule as a model beside the cycles that instrumented kernels count.
#include "tests/rtl/hls_schedule.hpp"

using namespace photonloom;
using namespace photonloom::test;

TEST_CASE("the schedule model is within 15 % of what instrumented kernels count") {
  for_each_unit([&](auto unit) { check_schedule(unit, base_plan()); });
}

TEST_CASE("a dependency from turn to turn raises the model's count") {
  const Plan plan = base_plan();
  for_each_unit([&](auto unit) {
    const DrawnRun run = run_drawn(unit, plan, kernel_options());
    std::vector<KernelLoop> loops = kernel_loops(unit, plan);
    const double before = modelled_cycles(loops, run.trips);
    loops[0].dependencies.push_back({"planted", 9, 1, "a divider in the loop"});
    CHECK(loops[0].interval() == 9);
    CHECK(modelled_cycles(loops, run.trips) > 1.5 * before);
    loops[0].dependencies.back().distance = 9;  // the same, carried over nine turns
    CHECK(modelled_cycles(loops, run.trips) == before);
  });
}

TEST_CASE("the gatherer's kernel keeps at least four queries in flight") {
  Plan plan = base_plan();
  for (const int contexts : {1, 2, 4, 5, 16, 32}) {
    plan.contexts = contexts;
    CHECK(kernel_contexts(plan) >= std::max(4, contexts));
    CHECK(kernel_loops(std::type_identity<PhotonGatherer>{}, plan)[0].interval() <= 3);
  }
}
