// SPDX-License-Identifier: Apache-2.0
#include "golden/unit/photon_map.hpp"

#include <algorithm>
#include <tuple>

#include "tests/catch.hpp"
#include "tests/photon_sets.hpp"

using namespace photonloom;
using namespace photonloom::test;

namespace {

// The order that photon_map.hpp defines, for the photon with number a before that with number b.
bool before(const std::vector<PackedPhoton>& photons, uint32_t axis, uint32_t a, uint32_t b) {
  const auto key = [&](uint32_t i) {
    const PackedPhoton& p = photons[i];
    return std::make_tuple(p.position[axis], p.position[(axis + 1) % 3], p.position[(axis + 2) % 3],
                           p.direction.u, p.direction.v, p.power.mantissa, p.power.exponent, i);
  };
  return key(a) < key(b);
}

// Numbers of the photons below a node, from its lines.
std::vector<uint32_t> numbers_below(const PhotonMap& map, uint32_t node) {
  if (node >= map.lines) {
    std::vector<uint32_t> numbers;
    for (int slot = 0; slot < map.bucket; ++slot) {
      const uint64_t index = uint64_t{node - map.lines} * static_cast<uint64_t>(map.bucket) +
                             static_cast<uint64_t>(slot);
      if (map.valid(index)) numbers.push_back(map.source[index]);
    }
    return numbers;
  }
  std::vector<uint32_t> numbers = numbers_below(map, 2 * node);
  const std::vector<uint32_t> right = numbers_below(map, 2 * node + 1);
  numbers.insert(numbers.end(), right.begin(), right.end());
  return numbers;
}

void check_map(const Plan& plan, const std::vector<PackedPhoton>& photons) {
  const PhotonMap map = build_photon_map(photons, plan);
  const uint64_t bucket = static_cast<uint64_t>(plan.bucket);
  REQUIRE(map.count == photons.size());
  REQUIRE(map.lines == (photons.size() + bucket - 1) / bucket);
  REQUIRE(map.slots.size() == map.lines * bucket);
  // Every photon once, unused slots marked, numbers ascending in a line.
  std::vector<uint32_t> numbers(map.source.begin(),
                                map.source.begin() + static_cast<std::ptrdiff_t>(map.count));
  for (uint64_t i = 0; i < map.slots.size(); ++i) {
    if (map.valid(i)) {
      const PackedPhoton& p = photons[map.source[i]];
      REQUIRE(map.slots[i].position == p.position);
      REQUIRE(map.slots[i].power == p.power);
      REQUIRE(map.slots[i].direction == p.direction);
      if (i % bucket != 0) REQUIRE(map.source[i - 1] < map.source[i]);
    } else {
      REQUIRE(map.slots[i].power == invalid_power(plan.exponent_bits));
      REQUIRE(map.source[i] == ~0u);
    }
  }
  std::sort(numbers.begin(), numbers.end());
  for (uint32_t i = 0; i < numbers.size(); ++i) REQUIRE(numbers[i] == i);
  // Every inner node splits as defined.
  for (uint32_t node = 1; node < map.lines; ++node) {
    const std::vector<uint32_t> left = numbers_below(map, 2 * node);
    const std::vector<uint32_t> right = numbers_below(map, 2 * node + 1);
    UVec3 low = photons[left[0]].position, high = low;
    for (const auto* side : {&left, &right})
      for (uint32_t i : *side)
        for (size_t c = 0; c < 3; ++c) {
          low[c] = std::min(low[c], photons[i].position[c]);
          high[c] = std::max(high[c], photons[i].position[c]);
        }
    uint32_t axis = 0;
    for (uint32_t c = 1; c < 3; ++c)
      if (high[c] - low[c] > high[axis] - low[axis]) axis = c;
    const auto order = [&](uint32_t a, uint32_t b) { return before(photons, axis, a, b); };
    const uint32_t last_left = *std::max_element(left.begin(), left.end(), order);
    const uint32_t first_right = *std::min_element(right.begin(), right.end(), order);
    REQUIRE(map.nodes[node].axis == axis);
    REQUIRE(map.nodes[node].split == photons[first_right].position[axis]);
    REQUIRE(order(last_left, first_right));
  }
}

}  // namespace

TEST_CASE("leaves below a node of a complete tree add up") {
  for (uint32_t lines = 1; lines <= 70; ++lines) {
    REQUIRE(leaves_below(1, lines) == lines);
    for (uint32_t node = 1; node < 2 * lines; ++node)
      REQUIRE(
          leaves_below(node, lines) ==
          (node >= lines ? 1 : leaves_below(2 * node, lines) + leaves_below(2 * node + 1, lines)));
  }
}

TEST_CASE("a photon map is the tree that its header defines, for every number of photons") {
  Plan plan;
  for (int bucket : {2, 8, 16}) {
    plan.bucket = bucket;
    for (size_t n = 1; n <= 200; ++n) {
      const PointSet set = kPointSets[n % std::size(kPointSets)];
      INFO("bucket " << bucket << ", " << n << " photons, " << to_string(set) << ", seed " << n);
      check_map(plan, make_photons(plan, set, n, n));
    }
  }
}

TEST_CASE("a photon map of every point set and position width is as defined") {
  for (PointSet set : kPointSets)
    for (int bits : {4, 10, 16, 24}) {
      Plan plan;
      plan.position_bits = bits;
      INFO(to_string(set) << ", " << bits << " bits, seed 3");
      check_map(plan, make_photons(plan, set, 1234, 3));
    }
}

TEST_CASE("a map that is built by many tasks is the same every time") {
  const Plan plan;
  const auto photons = make_photons(plan, PointSet::kClustered, 60000, 11);
  const PhotonMap first = build_photon_map(photons, plan);
  for (int i = 0; i < 3; ++i) REQUIRE(build_photon_map(photons, plan).source == first.source);
}

TEST_CASE("the map of no photons is empty") {
  const PhotonMap map = build_photon_map({}, Plan{});
  REQUIRE(map.count == 0);
  REQUIRE(map.lines == 0);
  REQUIRE(map.slots.empty());
}
