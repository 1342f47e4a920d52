// SPDX-License-Identifier: Apache-2.0
#include "golden/unit/gather_search_impl.hpp"

namespace photonloom::search {
namespace {

// A vector of one key. What a level offers: keys loaded, stored, compared; exchange(v, stride,
// size, down): a stage of the bitonic sort inside a vector; shift_in(at, below): every lane takes
// its left neighbour, lane 0 the last of `below`; below(x, at, lane): whether x is smaller there;
// kInRegisters: short lists are kept in registers; pass(): the keys of a block's photons within
// `bound` that face the query, in the order of their slots.
struct Scalar {
  static constexpr uint32_t kLanes = 1;
  static constexpr bool kInRegisters = false;
  using Vector = uint64_t;
  static Vector load(const uint64_t* p) { return *p; }
  static void store(uint64_t* p, Vector v) { *p = v; }
  static Vector fill(uint64_t x) { return x; }
  static Vector min(Vector a, Vector b) { return a < b ? a : b; }
  static Vector max(Vector a, Vector b) { return a < b ? b : a; }
  static Vector exchange(Vector v, uint32_t, uint32_t, bool) { return v; }
  static Vector shift_in(Vector, Vector below) { return below; }

  struct Query {
    explicit Query(const QueryView& q) : view(q) {}
    const QueryView& view;
  };

  template <class Coordinate, bool kFacing>
  static uint32_t pass(const MapView& map, uint32_t block, uint64_t first, const Query& q,
                       uint64_t bound, uint32_t exist, uint64_t* passed) {
    const Coordinate* at =
        static_cast<const Coordinate*>(map.coordinates) + size_t{block} * (3 * kBlock);
    const int16_t* direction = map.directions + size_t{block} * (4 * kBlock);
    uint32_t m = 0;
    for (uint32_t slot = 0; slot < kBlock; ++slot) {
      if (!(exist >> slot & 1)) continue;
      uint64_t d2 = 0;
      for (uint32_t c = 0; c < 3; ++c) {
        const int64_t d = int64_t{at[c * kBlock + slot]} - int64_t{q.view.position[c]};
        d2 += static_cast<uint64_t>(d * d);
      }
      if (d2 > bound) continue;
      if (kFacing) {
        const int32_t dot = int32_t{direction[2 * slot]} * q.view.normal[0] +
                            int32_t{direction[2 * slot + 1]} * q.view.normal[1] +
                            int32_t{direction[2 * kBlock + 2 * slot]} * q.view.normal[2];
        if (dot <= 0) continue;
      }
      passed[m++] = d2 << map.index_bits | (first + slot);
    }
    return m;
  }

  static void flux(const MapView& map, const uint64_t* keys, uint32_t n, uint64_t* flux) {
    const uint64_t mask = (uint64_t{1} << map.index_bits) - 1;
    flux[0] = flux[1] = flux[2] = 0;
    for (uint32_t i = 0; i < n; ++i) {
      const uint64_t power = map.powers[keys[i] & mask];
      const int exponent = static_cast<int>(power >> 48);
      for (uint32_t c = 0; c < 3; ++c) flux[c] += (power >> (16 * c) & 0xffff) << exponent;
    }
  }
};

}  // namespace

const Level kScalar = make_level<Scalar>("scalar");

}  // namespace photonloom::search
