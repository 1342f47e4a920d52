// SPDX-License-Identifier: Apache-2.0
// The search, written once over a level's vectors `V` (see gather_search_scalar.cpp for what one
// has to offer). Included by one file per level, which compiles it for its processor; everything is
// local to that file and nothing here calls an inline function of a library (see
// gather_search.hpp).
#pragma once
#include "golden/unit/gather_search.hpp"

namespace photonloom::search {
namespace {

__extension__ typedef unsigned __int128 Wide;

// Bitonic sort of n keys, n a power of two and at least V::kLanes.
template <class V>
inline void sort_keys(uint64_t* keys, uint32_t n) {
  for (uint32_t size = 2; size <= n; size *= 2)
    for (uint32_t stride = size / 2; stride > 0; stride /= 2) {
      if (stride >= V::kLanes) {
        for (uint32_t i = 0; i < n; i += V::kLanes) {
          if (i & stride) continue;
          const auto a = V::load(keys + i), b = V::load(keys + i + stride);
          const auto low = V::min(a, b), high = V::max(a, b);
          V::store(keys + i, i & size ? high : low);
          V::store(keys + i + stride, i & size ? low : high);
        }
      } else {
        for (uint32_t i = 0; i < n; i += V::kLanes)
          V::store(keys + i, V::exchange(V::load(keys + i), stride, size, (i & size) != 0));
      }
    }
}

// Sorted insertion: each place takes max(left neighbour, min(itself, x)), from the top down to x's.
template <class V>
inline void insert_key(uint64_t* keys, uint32_t vectors, uint64_t x) {
  const auto all_x = V::fill(x);
  auto at = V::load(keys + (vectors - 1) * V::kLanes);
  for (uint32_t i = vectors - 1; i > 0; --i) {
    const auto below = V::load(keys + (i - 1) * V::kLanes);
    V::store(keys + i * V::kLanes, V::max(V::shift_in(at, below), V::min(at, all_x)));
    at = below;
    if (vectors > V::kUnconditional && keys[i * V::kLanes - 1] <= x) return;
  }
  V::store(keys, V::max(V::shift_in(at, V::fill(0)), V::min(at, all_x)));
}

template <class V, class Coordinate, bool kFacing, bool kEpsilon>
Outcome run_search(const MapView& map, const Settings& settings, const QueryView& query,
                   uint64_t* keys) {
  struct Pending {
    uint64_t d2;
    uint32_t node;
    uint32_t offset[3];
  };
  Outcome out = {0, 0, 0, 0};
  if (map.lines == 0) return out;
  const uint32_t k = settings.k, lines = map.lines;
  const uint32_t vectors = (k + V::kLanes - 1) / V::kLanes;
  const int index_bits = map.index_bits;
  const typename V::Query q(query);
  uint64_t bound = map.r2_max;
  uint64_t last = kNoKey;  // the k-th, once there are k
  uint32_t n = 0;
  uint64_t passed[kBlock];

  const auto beyond = [&](uint64_t d2) {
    if constexpr (kEpsilon)
      return Wide{d2} * settings.epsilon_factor > Wide{bound} << settings.epsilon_shift;
    return d2 > bound;
  };
  const auto list_is_full = [&] {
    uint32_t size = V::kLanes;
    while (size < k) size *= 2;
    for (uint32_t i = k; i < size; ++i) keys[i] = kNoKey;
    sort_keys<V>(keys, size);
    last = keys[k - 1];
    bound = last >> index_bits;
  };

  Pending stack[40];  // a tree of 2^30 leaves is 30 deep
  uint32_t depth = 0;
  uint32_t node = 1;
  uint64_t node_d2 = 0;
  uint32_t offset[3] = {0, 0, 0};
  for (;;) {
    while (node < lines) {
      const uint32_t word = map.nodes[node];
      const uint32_t axis = word >> 30;
      const int32_t away =
          static_cast<int32_t>(query.position[axis]) - static_cast<int32_t>(word & 0x3fffffffu);
      const uint32_t right = away >= 0 ? 1u : 0u;
      const uint64_t distance = static_cast<uint64_t>(away < 0 ? -int64_t{away} : int64_t{away});
      Pending& far = stack[depth];
      const uint64_t before = offset[axis];
      far.d2 = node_d2 - before * before + distance * distance;
      far.node = 2 * node + 1 - right;
      far.offset[0] = offset[0];
      far.offset[1] = offset[1];
      far.offset[2] = offset[2];
      far.offset[axis] = static_cast<uint32_t>(distance);
      // The bound only shrinks: what is beyond it now need not wait on the stack.
      depth += beyond(far.d2) ? 0 : 1;
      node = 2 * node + right;
      ++out.nodes;
    }
    const uint32_t line = node - lines;
    for (uint32_t b = 0; b < map.blocks; ++b) {
      const uint32_t block = line * map.blocks + b;
      uint32_t exist = map.block_mask;
      const uint64_t first = uint64_t{line} * map.bucket + uint64_t{b} * kBlock;
      if (line + 1 == lines) {
        const uint64_t left = map.count > first ? map.count - first : 0;
        exist = left >= kBlock ? 0xff : (1u << left) - 1;
      }
      uint32_t m =
          V::template pass<Coordinate, kFacing>(map, block, first, q, bound, exist, passed);
      uint32_t i = 0;
      if (n < k) {
        const uint32_t take = m < k - n ? m : k - n;
        for (; i < take; ++i) keys[n + i] = passed[i];
        n += take;
        out.insertions += take;
        if (n == k) list_is_full();
      }
      for (; i < m; ++i) {
        if (passed[i] >= last) continue;
        insert_key<V>(keys, vectors, passed[i]);
        ++out.insertions;
        last = keys[k - 1];
        bound = last >> index_bits;
      }
    }
    ++out.leaves;
    if (out.leaves == settings.leaf_limit) break;
    do {
      if (depth == 0) goto finished;
      --depth;
    } while (beyond(stack[depth].d2));
    node = stack[depth].node;
    node_d2 = stack[depth].d2;
    offset[0] = stack[depth].offset[0];
    offset[1] = stack[depth].offset[1];
    offset[2] = stack[depth].offset[2];
  }
finished:
  out.count = n;
  if (n < k && n > 1) {
    uint32_t size = V::kLanes;
    while (size < n) size *= 2;
    for (uint32_t i = n; i < size; ++i) keys[i] = kNoKey;
    sort_keys<V>(keys, size);
  }
  return out;
}

template <class V>
constexpr Level make_level(const char* name) {
  return {name,
          {{{run_search<V, uint16_t, false, false>, run_search<V, uint16_t, false, true>},
            {run_search<V, uint16_t, true, false>, run_search<V, uint16_t, true, true>}},
           {{run_search<V, uint32_t, false, false>, run_search<V, uint32_t, false, true>},
            {run_search<V, uint32_t, true, false>, run_search<V, uint32_t, true, true>}}},
          V::flux};
}

}  // namespace
}  // namespace photonloom::search
