// SPDX-License-Identifier: Apache-2.0
// Plans of a study's points: what `packed` makes of a photon's bytes and of what goes with them.
#include "study/point_plan.hpp"

#include "tests/catch.hpp"
#include "tests/scene_files.hpp"

using namespace photonloom;

namespace {

Plan plan_with(const LineValues& lines) {
  const std::string scene = std::string(std::getenv("PHOTONLOOM_SOURCE")) + "/scenes/cornell.xml";
  Study study;
  study.scenes = {scene};
  study.seeds = {1};
  study.width = study.height = 4;
  study.base = {{"photons", "1000"}, {"frame.spp", "1"}, {"frame.gather_rays", "2"}};
  StudyScene of(scene, study);
  return plan_of_point(of, study, lines).plan;
}

}  // namespace

TEST_CASE("photons without padding have beats that fit them in either memory of a board") {
  const Plan block_ram = plan_with({{"packed", "true"}});
  CHECK(block_ram.photon_bytes == 12);
  CHECK(block_ram.photon_memory == PhotonMemory::kBlockRam);
  CHECK(block_ram.beat_bits == 128);
  // A map that would fit in block RAM.
  const Plan sdram = plan_with({{"packed", "true"}, {"board.photon_memory", "sdram"}});
  CHECK(sdram.photon_bytes == 12);
  CHECK(sdram.photon_memory == PhotonMemory::kSdram);
  CHECK(sdram.beat_bits == 192);
  const Plan uncached = plan_with({{"packed", "true"},
                                   {"board.photon_memory", "sdram"},
                                   {"gatherer.cache_bytes", "0"},
                                   {"gatherer.lanes", "1"}});
  CHECK(uncached.beat_bits == 96);
}

TEST_CASE("compressed photons have no padding to take away") {
  const LineValues lines{{"photon.lines", "compressed"}, {"photon.further_percent", "600"}};
  const Plan plan = plan_with(lines);
  LineValues without = lines;
  without.emplace_back("packed", "true");
  const Plan packed = plan_with(without);
  CHECK(plan_text(packed) == plan_text(plan));
  CHECK(smallest_stride(plan) > plan.photon_bytes);
}

TEST_CASE("compressed lines without room for the map are no plan") {
  CHECK_THROWS_WITH(
      plan_with(
          {{"photon.lines", "compressed"}, {"photon.further_percent", "0"}, {"photons", "300"}}),
      ContainsSubstring("expected photon.further_percent of at least"));
}
