// SPDX-License-Identifier: Apache-2.0
// The kernels' schedule as a model, on the plans that benches draw.
#include "tests/rtl/hls_schedule.hpp"
#include "verilator_tb/bench/bench.hpp"

using namespace photonloom;
using namespace photonloom::test;

TEST_CASE("the schedule model on random plans") {
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    INFO("random plan " << seed);
    const Plan plan = random_plan(seed);
    for_each_unit([&](auto unit) { check_schedule(unit, plan); });
  }
}
