// SPDX-License-Identifier: Apache-2.0
// The gather in double: what golden is measured against. Positions, directions and powers are those
// of the photons as they were traced.
#pragma once
#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "golden/numeric/vec.hpp"
#include "golden/transport/world.hpp"
#include "golden/unit/photon_map.hpp"

namespace photonloom {

// A photon found: `index` is its place in the photons given; smaller is nearer, ties by index.
struct ReferenceNeighbour {
  double d2 = 0;  // scene units squared
  uint32_t index = 0;
  auto operator<=>(const ReferenceNeighbour&) const = default;
};

// How the photons are kept: the classic balanced tree with one photon at every node (Jensen 2001,
// "Realistic Image Synthesis Using Photon Mapping"), or the same with leaves of up to eight. They
// find the same photons.
enum class ReferenceTree { kNodes, kBuckets };

// kFlat: every photon counts the same, times c = (k-1)/k when there are k, else 1.
// kEpanechnikov: 2 (1 - d^2/r^2), no c.
enum class Kernel { kFlat, kEpanechnikov };

class ReferenceGather {
 public:
  explicit ReferenceGather(std::vector<Photon> photons,
                           ReferenceTree tree = ReferenceTree::kBuckets);

  const std::vector<Photon>& photons() const { return photons_; }

  // The at most k nearest photons with d^2 <= r2_max and direction . normal > 0, smallest
  // (d2, index) first. d^2 is x^2 + y^2 + z^2, added in that order. r2_max may be infinite.
  void find(const Vec3& position, const Vec3& normal, int k, double r2_max,
            std::vector<ReferenceNeighbour>& found) const;

  // r^2 of a gather: d^2 of the k-th, or r2_max when there are fewer.
  static double radius2(std::span<const ReferenceNeighbour> found, int k, double r2_max) {
    return found.size() == static_cast<size_t>(k) ? found.back().d2 : r2_max;
  }

  // Sum of the photons' powers, in their order, W.
  Rgb flux(std::span<const ReferenceNeighbour> found) const;

  // Irradiance, W/m^2: the kernel-weighted sum of powers over pi max(r^2, r2_floor). 0 when r^2 is
  // infinite.
  Rgb irradiance(std::span<const ReferenceNeighbour> found, int k, double r2_max, double r2_floor,
                 Kernel kernel) const;

 private:
  struct Item {
    Vec3 position;
    uint32_t index;
    uint32_t axis;  // along which the item splits its range
  };
  class Finder;

  void build(size_t begin, size_t end);

  std::vector<Photon> photons_;
  size_t leaf_;              // ranges of at most this many items are not split
  std::vector<Item> items_;  // the middle item of a range is its node; the rest are the children
};

// The photons in the order of a map's indices, so that reference and golden break ties alike.
std::vector<Photon> in_map_order(std::span<const Photon> photons, const PhotonMap& map);

}  // namespace photonloom
