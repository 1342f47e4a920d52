// SPDX-License-Identifier: Apache-2.0
// Longer runs of the board's side of docs/host-link.md: more seeds, and photons in SDRAM with its
// clock at several ratios.
#include "tests/rtl/link_bench.hpp"

using namespace photonloom;
using namespace photonloom::test;

TEST_CASE("host link: many damaged frames, other registers at the start") {
  for (uint64_t seed = 50; seed < 56; ++seed)
    soak({.initial_seed = seed, .work_dir = "cosim"}, small_plan(), seed, 600);
}

TEST_CASE("host link: photons in SDRAM") {
  Plan plan = small_plan();
  plan.photon_memory = PhotonMemory::kSdram;
  plan.board_cache_bytes = 1024;
  uint64_t seed = 60;
  for (const double period : {0.5, 0.37, 1.0, 1.21}) {
    INFO("period " << period);
    soak({.sdram_period = period, .work_dir = "cosim"}, plan, ++seed, 200);
  }
}
