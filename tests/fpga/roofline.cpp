// SPDX-License-Identifier: Apache-2.0
// The bound that binds a gather from SDRAM is chosen by cycles, then judged.
#include "verilator_tb/throughput/roofline.hpp"

#include "tests/catch.hpp"

using namespace photonloom;

namespace {

// Both bounds of a gather of so many cycles.
bool reaches(double gatherers, double sdram, double cycles) {
  return reaches_its_bound({gatherers, gatherers / cycles}, {sdram, sdram / cycles});
}

}  // namespace

TEST_CASE("What needs more cycles binds") {
  CHECK(binds({10, 0.5}, {9, 0.45}));
  CHECK_FALSE(binds({9, 0.45}, {10, 0.5}));
  CHECK_FALSE(binds({10, 0.5}, {10, 0.5}));
  CHECK(binds({10, 0.95}, {9, 0.86}));  // although the SDRAM reaches what it is asked for
}

TEST_CASE("The SDRAM's roofline is asked for 85 % where it binds, whatever the gatherers reach") {
  CHECK(reaches(5, 10, 11.7));
  CHECK_FALSE(reaches(9.9, 10, 11.8));  // the gatherers at 84 %
}

TEST_CASE("The gatherers are asked for 80 % where they bind, whatever the SDRAM reaches") {
  CHECK(reaches(10, 5, 12.4));
  CHECK_FALSE(reaches(10, 9.9, 12.6));
}
