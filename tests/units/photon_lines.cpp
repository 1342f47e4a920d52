// SPDX-License-Identifier: Apache-2.0
// Lines of photon memory: what is written is read, to the bit, by every layout.
#include "golden/unit/photon_lines.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>

#include "golden/plan/plan_file.hpp"
#include "tests/catch.hpp"
#include "tests/photon_sets.hpp"

using namespace photonloom;
using namespace photonloom::test;

namespace {

Plan line_plan(int position_bits, int bucket, int photon_bytes) {
  Plan plan;
  plan.position_bits = position_bits;
  plan.bucket = bucket;
  plan.lanes = 2;
  plan.photon_bytes = photon_bytes;
  plan.photon_lines = PhotonLines::kCompressed;
  plan.further_percent = 100 * (bucket - 1);
  plan.global = {.present = true, .photons = 1195};
  plan.cache_bytes = plan.line_bytes() * plan.cache_ways;
  plan.beat_bits = 8 * plan.line_bytes();
  derive_plan(plan);
  return plan;
}

// Photons of a set with powers whose exponents differ by up to `exponents`, some without power.
PhotonMap random_map(const Plan& plan, PointSet set, uint32_t exponents) {
  std::vector<PackedPhoton> photons(1195);
  for (uint64_t i = 0; i < photons.size(); ++i) {
    const auto draw = [&](uint64_t dimension, int bits) {
      return static_cast<uint32_t>(hash_bits(5, i, 9, dimension) >> (64 - bits));
    };
    photons[i].position = make_point(set, plan.position_bits, 5, i);
    photons[i].direction = {draw(0, plan.direction_bits), draw(1, plan.direction_bits)};
    photons[i].power = {{draw(2, 9), draw(3, 9), draw(4, 9)}, draw(5, 32) % (exponents + 1)};
    if (draw(6, 4) == 0) photons[i].power = {};
  }
  return build_photon_map(photons, plan);
}

}  // namespace

TEST_CASE("compressed lines give back every photon, and each line belongs to one leaf") {
  size_t further = 0, alone = 0;
  for (const Plan& plan : {line_plan(16, 8, 10), line_plan(14, 16, 9), line_plan(24, 8, 14),
                           line_plan(4, 16, 8), line_plan(12, 2, 16)}) {
    REQUIRE_NOTHROW(check_plan(plan));
    for (const PointSet set : kPointSets)
      for (const uint32_t exponents : {0u, 3u, 31u}) {
        INFO(to_string(set) << ", exponents to " << exponents << ", position_bits "
                            << plan.position_bits << ", bucket " << plan.bucket);
        const PhotonMap map = random_map(plan, set, exponents);
        const std::vector<uint8_t> bytes = photon_lines(plan, map, false);
        std::set<uint32_t> seen;
        for (uint32_t leaf = 0; leaf < map.lines; ++leaf) {
          const StoredLeaf stored = read_leaf(plan, bytes, leaf);
          (stored.lines.size() > 1 ? further : alone) += 1;
          seen.insert(stored.lines.begin(), stored.lines.end());
          const PackedPhoton* slots = &map.slots[leaf * static_cast<size_t>(plan.bucket)];
          REQUIRE(std::equal(stored.slots.begin(), stored.slots.end(), slots,
                             [](const PackedPhoton& a, const PackedPhoton& b) {
                               return a.position == b.position && a.power == b.power &&
                                      a.direction == b.direction;
                             }));
        }
        REQUIRE(seen.size() * static_cast<size_t>(plan.line_bytes()) == bytes.size());
      }
  }
  CHECK(further > 1000);
  CHECK(alone > 1000);
}

TEST_CASE("each layout of compressed lines holds what it says and no more") {
  const Plan plan = line_plan(16, 8, 10);
  for (uint32_t split = 0; split < kSplits; ++split)
    for (uint32_t axis = 0; axis < kAxes; ++axis) {
      const OffsetBits bits = offset_bits_of(plan, split, axis);
      CHECK(bits.own + bits.first + bits.second + bits.exponent == plan.offset_bits());
      const size_t own = std::min(axis, 2u), first = own == 0 ? 1 : 0, second = own == 2 ? 1 : 2;
      // Two photons that differ by as much as the layout holds, from a corner on.
      std::vector<PackedPhoton> photons(2);
      photons[0].position = {4096, 4096, 4096};
      photons[1].position[own] = 4096 + static_cast<uint32_t>(ones(bits.own));
      photons[1].position[first] = 4096 + static_cast<uint32_t>(ones(bits.first));
      photons[1].position[second] = 4096 + static_cast<uint32_t>(ones(bits.second));
      photons[0].power = {{1, 2, 3}, 5};
      photons[1].power = {{4, 5, 6}, 5 + static_cast<uint32_t>(ones(bits.exponent))};
      INFO("split " << split << ", axis " << axis);
      CHECK(photon_lines(plan, build_photon_map(photons, plan), false).size() == 80);
      // The widest of all layouts along an axis has 12 bits.
      photons[1].position[own] = 4096 + (1 << 12);
      CHECK(photon_lines(plan, build_photon_map(photons, plan), false).size() == 160);
    }
}

TEST_CASE("a map whose further lines have no room is refused, and told what would do") {
  Plan plan = line_plan(16, 8, 10);
  const PhotonMap map = random_map(plan, PointSet::kRandom, 0);
  const size_t needed = photon_lines(plan, map, false).size() / 80 - map.lines;
  const int percent = static_cast<int>((100 * needed + map.lines - 1) / map.lines);
  REQUIRE(percent > 0);
  plan.further_percent = percent;
  CHECK_NOTHROW(photon_lines(plan, map, false));
  plan.further_percent = 0;
  CHECK_THROWS_WITH(
      photon_lines(plan, map, false),
      ContainsSubstring("global map: its 150 leaves take") &&
          ContainsSubstring("photon.further_percent of at least " + std::to_string(percent)));
}

TEST_CASE("a map of more leaves than the plan has lines is refused, and told what would do") {
  Plan plan = line_plan(16, 8, 10);
  const PhotonMap map = random_map(plan, PointSet::kRandom, 0);
  plan.global.photons = 1192;
  CHECK_THROWS_WITH(photon_lines(plan, map, false),
                    "global map: has 150 lines, the plan has room for 149; expected global.photons "
                    "of at least 1195");
}
