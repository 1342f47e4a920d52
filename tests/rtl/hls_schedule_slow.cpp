// SPDX-License-Identifier: Apache-2.0
// The kernels' schedule as a model, on more plans and on those that benches draw.
#include "tests/rtl/hls_schedule.hpp"
#include "verilator_tb/bench/bench.hpp"

using namespace photonloom;
using namespace photonloom::test;

namespace {

std::vector<Plan> other_plans() {
  std::vector<Plan> list(2, base_plan());
  list[0].contexts = 4;
  list[0].lanes = 8;
  list[0].cell_bits = 2;
  list[0].reorder_key = ReorderKey::kNone;
  list[1].contexts = 8;
  list[1].lanes = 2;
  list[1].k = 50;
  list[1].cell_bits = 4;
  list[1].reorder_drain = ReorderDrain::kFullest;
  return list;
}

}  // namespace

TEST_CASE("the schedule model with other contexts, lanes and orders") {
  for (const Plan& plan : other_plans())
    for_each_unit([&](auto unit) { check_schedule(unit, plan); });
}

TEST_CASE("the schedule model on random plans") {
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    INFO("random plan " << seed);
    const Plan plan = random_plan(seed);
    for_each_unit([&](auto unit) { check_schedule(unit, plan); });
  }
}
