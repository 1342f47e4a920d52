// SPDX-License-Identifier: Apache-2.0
// Photons and queries for tests of everything that reads photon maps: point sets in which searches
// go wrong.
#pragma once
#include <string>
#include <vector>

#include "golden/numeric/random.hpp"
#include "golden/packet/packet.hpp"
#include "golden/unit/photon_map.hpp"

namespace photonloom::test {

enum class PointSet {
  kRandom,      // uniform in the cube
  kSurfaces,    // on the cube's walls, as photons are
  kClustered,   // dense clumps in a sparse cube
  kCollinear,   // on a diagonal
  kCoincident,  // all in one point
  kCorners,     // in the cube's corners: the largest distances there are
  kGrid         // few coordinates: equal distances everywhere, equal coordinates at splits
};
inline constexpr PointSet kPointSets[] = {
    PointSet::kRandom,     PointSet::kSurfaces, PointSet::kClustered, PointSet::kCollinear,
    PointSet::kCoincident, PointSet::kCorners,  PointSet::kGrid};

inline std::string to_string(PointSet set) {
  static const char* const names[] = {"random",     "surfaces", "clustered", "collinear",
                                      "coincident", "corners",  "grid"};
  return names[static_cast<int>(set)];
}

inline UVec3 make_point(PointSet set, int bits, uint64_t seed, uint64_t i) {
  const uint32_t top = static_cast<uint32_t>(ones(bits));
  const auto coordinate = [&](uint64_t dimension) {
    return static_cast<uint32_t>(hash_bits(seed, i, 0, dimension) >> (64 - bits));
  };
  const UVec3 uniform{coordinate(0), coordinate(1), coordinate(2)};
  const uint64_t choice = hash_bits(seed, i, 0, 3);
  switch (set) {
    case PointSet::kRandom:
      return uniform;
    case PointSet::kSurfaces: {
      UVec3 p = uniform;
      p[choice % 3] = (choice >> 8) % 2 ? top : 0;
      return p;
    }
    case PointSet::kClustered: {
      const uint64_t clump = choice % 7;
      UVec3 p;
      for (size_t c = 0; c < 3; ++c) {
        const uint32_t centre = static_cast<uint32_t>(hash_bits(seed, clump, 1, c) >> (64 - bits));
        p[c] = (centre + (uniform[c] >> 5)) & top;
      }
      return p;
    }
    case PointSet::kCollinear:
      return {uniform[0], uniform[0], uniform[0]};
    case PointSet::kCoincident:
      return {top / 3, top / 2, top};
    case PointSet::kCorners:
      return {choice & 1 ? top : 0, choice & 2 ? top : 0, choice & 4 ? top : 0};
    case PointSet::kGrid:
      return {top / 3 * (uniform[0] % 4), top / 3 * (uniform[1] % 4), top / 3 * (uniform[2] % 4)};
  }
  return uniform;
}

// `n` photons in the plan's formats, with directions all around and powers over the whole range.
inline std::vector<PackedPhoton> make_photons(const Plan& plan, PointSet set, size_t n,
                                              uint64_t seed) {
  std::vector<PackedPhoton> photons(n);
  for (size_t i = 0; i < n; ++i) {
    const auto bits = [&](uint64_t dimension, int width) {
      return width == 0 ? 0u
                        : static_cast<uint32_t>(hash_bits(seed, i, 2, dimension) >> (64 - width));
    };
    photons[i].position = make_point(set, plan.position_bits, seed, i);
    photons[i].direction = {bits(0, plan.direction_bits), bits(1, plan.direction_bits)};
    for (int c = 0; c < plan.channels; ++c)
      photons[i].power.mantissa[static_cast<size_t>(c)] =
          bits(2 + static_cast<uint64_t>(c), plan.mantissa_bits);
    photons[i].power.mantissa[0] |= 1u << (plan.mantissa_bits - 1);  // as encode_power normalises
    photons[i].power.exponent = bits(5, plan.exponent_bits);
  }
  return photons;
}

// A query near the set (even i) or anywhere (odd i).
inline GatherQuery make_query(const Plan& plan, PointSet set, uint64_t seed, uint64_t i) {
  GatherQuery query{};
  query.pixel = static_cast<uint32_t>(i & ones(plan.pixel_bits()));
  query.position = i % 2 == 0 ? make_point(set, plan.position_bits, seed, 1000000 + i)
                              : make_point(PointSet::kRandom, plan.position_bits, seed, i);
  for (size_t c = 0; c < 2; ++c)
    query.normal[c] = static_cast<uint32_t>(hash_bits(seed, i, 3, c) >> (64 - plan.normal_bits));
  return query;
}

}  // namespace photonloom::test
