// SPDX-License-Identifier: Apache-2.0
#include "golden/unit/photon_map.hpp"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_invoke.h>

#include <algorithm>
#include <stdexcept>
#include <tuple>

#include "golden/numeric/bits.hpp"

namespace photonloom {
namespace {

constexpr uint64_t kMaxPhotons = uint64_t{1} << 30;
constexpr uint64_t kParallelPhotons = 8192;  // subtrees below this are built by one task

// What the partition moves: the position beside the photon's number, so that comparisons rarely
// leave the array.
struct Element {
  UVec3 position;
  uint32_t number;
};

class Builder {
 public:
  Builder(std::span<const PackedPhoton> photons, PhotonMap& map, std::vector<Element>& elements)
      : photons_(photons), map_(map), elements_(elements) {}

  // Builds the subtree of `node` over elements [begin, begin + count) and writes its lines.
  void build(uint32_t node, uint64_t begin, uint64_t count) {
    if (node >= map_.lines) {
      write_line(node - map_.lines, begin, count);
      return;
    }
    const uint32_t axis = longest_axis(begin, count);
    const uint64_t left = photons_below(2 * node);
    const auto first = elements_.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto middle = first + static_cast<std::ptrdiff_t>(left);
    std::nth_element(
        first, middle, first + static_cast<std::ptrdiff_t>(count),
        [this, axis](const Element& a, const Element& b) { return before(a, b, axis); });
    map_.nodes[node] = {axis, middle->position[axis]};
    const auto go_left = [&] { build(2 * node, begin, left); };
    const auto go_right = [&] { build(2 * node + 1, begin + left, count - left); };
    if (count >= kParallelPhotons) {
      tbb::parallel_invoke(go_left, go_right);
    } else {
      go_left();
      go_right();
    }
  }

 private:
  // The total order in which a node splits along `axis`.
  bool before(const Element& a, const Element& b, uint32_t axis) const {
    for (uint32_t i = 0; i < 3; ++i) {
      const uint32_t c = (axis + i) % 3;
      if (a.position[c] != b.position[c]) return a.position[c] < b.position[c];
    }
    const PackedPhoton& p = photons_[a.number];
    const PackedPhoton& q = photons_[b.number];
    return std::tie(p.direction.u, p.direction.v, p.power.mantissa, p.power.exponent, a.number) <
           std::tie(q.direction.u, q.direction.v, q.power.mantissa, q.power.exponent, b.number);
  }

  uint32_t longest_axis(uint64_t begin, uint64_t count) const {
    UVec3 low = elements_[begin].position, high = low;
    for (uint64_t i = begin + 1; i < begin + count; ++i)
      for (size_t c = 0; c < 3; ++c) {
        low[c] = std::min(low[c], elements_[i].position[c]);
        high[c] = std::max(high[c], elements_[i].position[c]);
      }
    uint32_t axis = 0;
    for (uint32_t c = 1; c < 3; ++c)
      if (high[c] - low[c] > high[axis] - low[axis]) axis = c;
    return axis;
  }

  // Photons in the lines below a node: all lines are full but that of the last leaf, 2L-1.
  uint64_t photons_below(uint32_t node) const {
    const uint64_t full = uint64_t{leaves_below(node, map_.lines)} * bucket();
    const uint64_t last = 2 * uint64_t{map_.lines} - 1;
    const int depth = msb(last) - msb(node);
    const bool holds_last = depth >= 0 && (last >> depth) == node;
    return holds_last ? full - (map_.lines * bucket() - map_.count) : full;
  }

  void write_line(uint32_t line, uint64_t begin, uint64_t count) {
    const auto first = elements_.begin() + static_cast<std::ptrdiff_t>(begin);
    std::sort(first, first + static_cast<std::ptrdiff_t>(count),
              [](const Element& a, const Element& b) { return a.number < b.number; });
    for (uint64_t slot = 0; slot < count; ++slot) {
      const uint64_t index = line * bucket() + slot;
      map_.slots[index] = photons_[elements_[begin + slot].number];
      map_.source[index] = elements_[begin + slot].number;
    }
  }

  uint64_t bucket() const { return static_cast<uint64_t>(map_.bucket); }

  std::span<const PackedPhoton> photons_;
  PhotonMap& map_;
  std::vector<Element>& elements_;
};

}  // namespace

uint32_t leaves_below(uint32_t node, uint32_t lines) {
  // Level by level: the nodes of the subtree that lie among the leaves L .. 2L-1.
  uint64_t first = node, last = node, leaves = 0;
  const uint64_t begin = lines, end = 2 * uint64_t{lines};
  while (first < end) {
    const uint64_t low = std::max(first, begin), high = std::min(last + 1, end);
    if (low < high) leaves += high - low;
    first = 2 * first;
    last = 2 * last + 1;
  }
  return static_cast<uint32_t>(leaves);
}

PhotonMap build_photon_map(std::span<const PackedPhoton> photons, const Plan& plan) {
  if (photons.size() > kMaxPhotons)
    throw std::runtime_error("a photon map holds at most 2^30 photons, asked for " +
                             std::to_string(photons.size()));
  const uint64_t bucket = static_cast<uint64_t>(plan.bucket);
  PhotonMap map;
  map.bucket = plan.bucket;
  map.count = photons.size();
  map.lines = static_cast<uint32_t>((map.count + bucket - 1) / bucket);
  if (map.count == 0) return map;
  map.nodes.resize(map.lines);
  map.slots.assign(map.lines * bucket, {{}, invalid_power(plan.exponent_bits), {}});
  map.source.assign(map.lines * bucket, ~0u);
  std::vector<Element> elements(photons.size());
  tbb::parallel_for(size_t{0}, photons.size(), [&](size_t i) {
    elements[i] = {photons[i].position, static_cast<uint32_t>(i)};
  });
  Builder(photons, map, elements).build(1, 0, map.count);
  return map;
}

}  // namespace photonloom
