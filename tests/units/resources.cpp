// SPDX-License-Identifier: Apache-2.0
// What a plan is predicted to take of an FPGA.
#include "golden/planner/resources.hpp"

#include "golden/packet/layout.hpp"
#include "golden/planner/resource_fit.hpp"
#include "tests/catch.hpp"

using namespace photonloom;

TEST_CASE("block RAMs of a memory, in the best shape") {
  CHECK(block_rams(36, 512) == 1);
  CHECK(block_rams(18, 1024) == 1);
  CHECK(block_rams(9, 2048) == 1);
  CHECK(block_rams(4, 4096) == 1);
  CHECK(block_rams(1, 16384) == 1);
  CHECK(block_rams(1, 1) == 1);
  CHECK(block_rams(37, 512) == 2);
  CHECK(block_rams(36, 513) == 2);
  CHECK(block_rams(18, 8192) == 8);    // 9 bits x 2048 would take as many, 36 x 512 twice
  CHECK(block_rams(96, 16384) == 88);  // 11 x 8 of 9 bits x 2048
}

TEST_CASE("words of a memory that is no power of two deep share block RAMs, as synthesized") {
  CHECK(block_rams(73, 2816) == 14);
  CHECK(block_rams(73, 2100) == 12);
  CHECK(block_rams(73, 5120) == 23);
  CHECK(block_rams(19, 1300) == 3);
  CHECK(block_rams(19, 3072) == 5);
  CHECK(block_rams(29, 5000) == 10);
  CHECK(block_rams(37, 1025) == 4);
  CHECK(block_rams(37, 3000) == 8);
  CHECK(block_rams(40, 600) == 3);
  CHECK(block_rams(46, 7168) == 21);
  CHECK(block_rams(5, 7000) == 3);
  CHECK(block_rams(5, 9000) == 5);
}

TEST_CASE("every term has a coefficient, every prediction an error below 15 %") {
  Plan plan;
  plan.global = {.present = true, .photons = 65536};
  for (const char* unit : {"photon_gatherer", "reorder_buffer", "cdf_sampler"})
    for (const char* resource : {"lut", "ff", "dsp", "ebr"}) {
      INFO(unit << " " << resource);
      CHECK(resource_error(unit, resource) < 0.15);
      for (const auto& [term, value] : resource_terms(plan, unit, resource)) {
        INFO(term);
        int found = 0;
        for (const ResourceCoefficient& c : kResourceCoefficients)
          found +=
              std::string(unit) == c.unit && std::string(resource) == c.resource && term == c.term;
        CHECK(found == 1);
      }
    }
  CHECK_THROWS_WITH(resource_terms(plan, "shader", "lut"), ContainsSubstring("no unit shader"));
  CHECK_THROWS_WITH(resource_terms(plan, "cdf_sampler", "watts"),
                    ContainsSubstring("no resource watts"));
}

TEST_CASE("more is predicted to take more") {
  Plan plan;
  plan.global = {.present = true, .photons = 65536};
  plan.k = 16;
  const UnitResources before = estimate_resources(plan, "photon_gatherer");
  CHECK(before.lut > 1000);
  plan.k = 50;
  CHECK(estimate_resources(plan, "photon_gatherer").lut > before.lut);
  plan.k = 16;
  plan.lanes = 8;
  CHECK(estimate_resources(plan, "photon_gatherer").dsp > before.dsp);
  plan.lanes = 4;
  plan.cache_bytes = 65536;
  CHECK(estimate_resources(plan, "photon_gatherer").ebr > before.ebr);
}

TEST_CASE("memories of LUTs are no block RAM") {
  Plan plan;
  plan.global = {.present = true, .photons = 65536};
  for (const char* unit : {"photon_gatherer", "reorder_buffer", "cdf_sampler"}) {
    INFO(unit);
    plan.lut_ram_words = 0;
    const UnitResources before = estimate_resources(plan, unit);
    plan.lut_ram_words = 1024;
    const UnitResources after = estimate_resources(plan, unit);
    CHECK(after.ebr < before.ebr);
    CHECK(after.lut > before.lut);
    CHECK(after.ff > before.ff);
    CHECK(after.dsp == before.dsp);
  }
}

TEST_CASE("results have their places in LUTs where these hold four for each context") {
  Plan plan;
  plan.global = {.present = true, .photons = 65536};
  plan.lut_ram_words = 64;
  const auto gatherer = [&](int contexts) {
    plan.contexts = contexts;
    return estimate_resources(plan, "photon_gatherer");
  };
  // What else grows from 16 contexts to 32 has 512 words at most, and so as many blocks.
  plan.k = 16;
  const int few = gatherer(16).ebr;
  // 256 places in block RAM: what is known of a result at its start, at its end, its reciprocal.
  const int start = plan.pixel_bits() + plan.sample_bits() + plan.tag_bits() + 1;
  CHECK(gatherer(17).ebr >= few + block_rams(start, 256));
}

TEST_CASE("block RAMs of a prefetcher") {
  // Lines of 96 bytes: 512 of them in the cache before the SDRAM, or 256, or one byte too few.
  Plan plan;
  plan.global = {.present = true, .photons = 65536};
  plan.bucket = 8;
  plan.photon_bytes = 12;
  plan.beat_bits = 384;
  plan.gatherers = 3;
  plan.photon_memory = PhotonMemory::kSdram;
  plan.board_cache_bytes = 512 * 96;
  REQUIRE(plan.line_bytes() == 96);
  CHECK(plan.prefetch_queries() == 128);
  // 9 of 2 bits x 8,192 for the nodes, and those of the queries.
  const int queries = block_rams(PacketLayout::of<GatherQuery>(plan).bits(), 128);
  const int with = board_memories(plan).photons;
  plan.gatherers = 1;
  CHECK(plan.prefetch_queries() == 0);
  CHECK(board_memories(plan).photons == with - 9 - queries);
  plan.gatherers = 3;
  plan.board_cache_bytes = 512 * 96 - 1;
  CHECK(plan.prefetch_queries() == 64);
  plan.board_cache_bytes = 256 * 96 - 1;
  CHECK(plan.prefetch_queries() == 0);
  plan.board_cache_bytes = 512 * 96;
  plan.photon_memory = PhotonMemory::kBlockRam;
  CHECK(plan.prefetch_queries() == 0);
}

TEST_CASE("a node memory serves two gatherers, or one and the prefetcher") {
  Plan plan;
  plan.global = {.present = true, .photons = 65536};
  plan.bucket = 8;
  plan.photon_bytes = 12;
  plan.beat_bits = 384;
  plan.photon_memory = PhotonMemory::kSdram;
  plan.board_cache_bytes = 512 * 96;
  // 9 of 2 bits x 8,192 of each, in twos; the prefetcher is one more but beside a single gatherer.
  for (const auto& [gatherers, fewer] :
       {std::pair{1, 0}, std::pair{2, 1}, std::pair{3, 2}, std::pair{4, 2}}) {
    plan.gatherers = gatherers;
    plan.shared_nodes = false;
    const int own = board_memories(plan).total();
    plan.shared_nodes = true;
    CHECK(own - board_memories(plan).total() == 9 * fewer);
    // A gatherer by itself has a memory; the prefetcher's is of the photons' blocks.
    CHECK(board_memories(plan).shared_nodes ==
          9 * ((gatherers + (gatherers > 1) + 1) / 2 - gatherers));
  }
  plan.cache_bytes = 32 * plan.line_bytes();
  plan.global.r2_max = plan.r2_limit();
  REQUIRE(find_problem(plan) == std::nullopt);
  plan.nodes_per_cycle = 2;
  CHECK(find_problem(plan)->line == "board.shared_nodes");
}

TEST_CASE("the self-test's script is block RAM whatever fits in LUTs") {
  Plan plan;
  plan.global = {.present = true, .photons = 1000};
  plan.board_cache_bytes = 65536;
  plan.lut_ram_words = 1024;
  const int without = board_memories(plan).link;
  plan.self_test = true;
  CHECK(board_memories(plan).link - without >= 1);
}

TEST_CASE("block RAMs of a board's top") {
  Plan plan;
  plan.global = {.present = true, .photons = 16384};
  plan.bucket = 8;
  plan.photon_bytes = 16;
  plan.beat_bits = 512;
  plan.gatherers = 1;
  // Four photons of 96 bits a beat, two beats a row: twice 43 blocks of 9 bits x 2,048.
  REQUIRE(plan.photon_bits() == 96);
  const BoardMemories one = board_memories(plan);
  CHECK(one.photons == 86);
  const double gatherer = estimate_resources(plan, "photon_gatherer").ebr;
  const double buffer = estimate_resources(plan, "reorder_buffer").ebr;
  // 5 of the link, one of 36 bits x 512 for each word of a query in the replayer.
  plan.replay_queries = 512;
  const int words = (PacketLayout::of<GatherQuery>(plan).bits() + 31) / 32;
  CHECK(board_memories(plan).total() == 86 + 5 + words + gatherer + buffer);
  plan.gatherers = 2;
  CHECK(board_memories(plan).units - one.units == gatherer);
  CHECK(board_memories(plan).photons == one.photons);
  plan.reorder_key = ReorderKey::kNone;
  CHECK(board_memories(plan).units == 2 * gatherer);
  // A beat a line, 2,048 beats: 86 blocks of 9 bits x 2,048.
  plan.beat_bits = 1024;
  CHECK(board_memories(plan).photons == 86);
  plan.beat_bits = 512;
  // 4,096 lines of a beat: four banks of 22 blocks of 18 bits x 1,024.
  plan.bucket = 4;
  CHECK(board_memories(plan).photons == 88);
  plan.bucket = 8;
  // A gatherer without a leaf cache has neither its lines nor its tags.
  const int cached = board_memories(plan).units;
  plan.cache_bytes = 0;
  CHECK(board_memories(plan).units < cached);
  plan.photon_memory = PhotonMemory::kSdram;
  plan.board_cache_bytes = 65536;
  const int cache = board_memories(plan).photons;
  plan.board_cache_bytes = 131072;
  CHECK(board_memories(plan).photons > cache);
  plan.lut_ram_words = 1024;
  CHECK(board_memories(plan).replayer == 0);
}
