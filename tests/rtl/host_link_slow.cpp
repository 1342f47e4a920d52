// SPDX-License-Identifier: Apache-2.0
// Longer runs of the board's side of docs/host-link.md: more seeds, and photons in SDRAM with its
// clock at several ratios.
#include <bit>

#include "tests/rtl/link_bench.hpp"
#include "verilator_tb/bench/bench.hpp"

using namespace photonloom;
using namespace photonloom::test;

TEST_CASE("host link: many damaged frames, other registers at the start") {
  for (uint64_t seed = 50; seed < 56; ++seed)
    soak({.initial_seed = seed, .work_dir = "cosim"}, small_plan(), seed, 600);
}

TEST_CASE("host link: compressed lines, most leaves of several") {
  Plan plan = compressed(small_plan());
  plan.board_cache_bytes = 8 * plan.line_bytes();
  plan.self_test = true;
  uint64_t seed = 80;
  for (const PhotonMemory memory : {PhotonMemory::kBlockRam, PhotonMemory::kSdram})
    for (const bool both : {true, false}) {
      plan.photon_memory = memory;
      plan.caustic = both ? small_plan().caustic : MapPlan{};
      INFO((memory == PhotonMemory::kSdram ? "SDRAM" : "block RAM")
           << (both ? ", both maps" : ", one map"));
      test::Bench bench(plan, {.work_dir = "cosim"});
      bench.run(300000);  // the self-test, which hears nothing
      CHECK(bench.reg(26) == 2);
      const uint32_t words =
          static_cast<uint32_t>((plan.memory_lines(plan.global) + plan.memory_lines(plan.caustic)) *
                                static_cast<uint64_t>(plan.line_bytes()) / 4);
      CHECK(bench.write(kLines + words - 1, {0}) == 0);
      CHECK(bench.write(kLines + words, {0}) == 1);
      CHECK(soak_on(bench, ++seed, 100, damaged) > 0);
    }
}

TEST_CASE("host link: a cold replay is as the first one, in lines and in cycles") {
  Plan plan = small_plan();
  plan.gatherers = 1;
  plan.cache_bytes = 65536;  // all lines, in 512 sets, which take as many cycles to be forgotten
  test::Bench bench(plan, {.work_dir = "cosim"});
  bench.load(90);
  const size_t words = PacketLayout::of<GatherQuery>(plan).words();
  Words memory;
  for (const GatherQuery& q : queries(plan, 64, 90, false)) {
    Words one = packed(plan, q);
    one.resize(std::bit_ceil(words));
    memory.insert(memory.end(), one.begin(), one.end());
  }
  REQUIRE(bench.write(kQueries, memory) == 0);
  Words lines, cycles;
  uint32_t control = 0;
  for (const uint32_t mode : {0u, 0u, 2u, 2u}) {
    const uint32_t before = bench.reg(42);
    REQUIRE(bench.write(17, {64, 1, mode}) == 0);
    REQUIRE(bench.write(kControl, {++control}) == 0);
    for (int i = 0; bench.reg(kFlags) != 2; ++i) REQUIRE(i < 2000);
    lines.push_back(bench.reg(42) - before);
    cycles.push_back(bench.reg(20));
  }
  CHECK(lines[0] > 64);
  CHECK(lines == Words{lines[0], 0, lines[0], lines[0]});
  CHECK(cycles[1] < cycles[0]);
  CHECK(cycles[2] == cycles[0]);
  CHECK(cycles[3] == cycles[0]);
}

TEST_CASE("host link: boards of random plans") {
  for (const RandomPlans which : {RandomPlans::kUsual, RandomPlans::kEnds})
    for (uint64_t seed = 1; seed <= 3; ++seed) {
      INFO((which == RandomPlans::kEnds ? "ends:" : "random:") << seed);
      Plan plan = random_plan(seed, which, true);
      // Fewer photons, for each comes over the link.
      plan.global.photons = std::min<uint64_t>(plan.global.photons, 300);
      plan.caustic.photons = std::min<uint64_t>(plan.caustic.photons, 100);
      plan.replay_queries = 64;
      plan.self_test = true;
      REQUIRE_FALSE(board_problem(plan));
      test::Bench bench(plan, {.work_dir = "cosim"});
      for (int i = 0; i < 40; ++i) bench.run(50000);  // the self-test, which hears nothing
      CHECK(bench.reg(26) == 2);
      CHECK(soak_on(bench, seed, 60, damaged) > 0);
    }
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
