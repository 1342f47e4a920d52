// SPDX-License-Identifier: Apache-2.0
// The kernels' schedule as a model beside the cycles that instrumented kernels count.
#pragma once
#include "tests/catch.hpp"
#include "verilator_tb/unit/drawn_run.hpp"

namespace photonloom::test {

inline Plan base_plan() {
  Plan plan;
  plan.global.present = true;
  plan.global.photons = 2000;
  plan.global.r2_max = uint64_t{1} << 24;
  plan.gather_rays = 4;
  plan.k = 16;
  plan.cell_bits = 3;
  plan.reorder_packets = 100;
  plan.reorder_bins = 64;
  return plan;
}

inline RunOptions kernel_options() {
  RunOptions o;
  o.kind = ModelKind::kHls;
  o.work_dir = "cosim";  // benches compile the kernels of the same plans
  return o;
}

// Cycles and, of each loop, turns are within 15 % of the model's; initiation intervals are its.
template <class Unit>
void check_schedule(std::type_identity<Unit> unit, const Plan& plan) {
  const auto within = [](double model, double counted) {
    INFO(counted << " counted, model " << model);
    CHECK(model > 0.85 * counted);
    CHECK(model < 1.15 * counted);
  };
  const DrawnRun run = run_drawn(unit, plan, kernel_options());
  const std::vector<KernelLoop> loops = kernel_loops(unit, plan);
  INFO(unit_name<Unit> << ", contexts " << plan.contexts << ", lanes " << plan.lanes << ", bucket "
                       << plan.bucket << ", k " << plan.k);
  within(modelled_cycles(loops, run.trips), static_cast<double>(run.cycles));
  double terms = 0;
  for (const TurnTerm& term : run.trips.terms) terms += term.turns;
  CHECK(terms == Approx(run.trips.turns[0]));
  for (size_t i = 0; i < loops.size(); ++i) {
    INFO("process " << loops[i].process);
    CHECK(run.counters.at("interval of " + loops[i].process) ==
          static_cast<uint64_t>(loops[i].interval()));
    within(run.trips.turns[i],
           static_cast<double>(run.counters.at("turns of " + loops[i].process)));
  }
}

}  // namespace photonloom::test
