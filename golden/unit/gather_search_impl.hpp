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

// Sorts n keys, where there is room for the next power of two.
template <class V>
inline void sort_padded(uint64_t* keys, uint32_t n) {
  uint32_t size = V::kLanes;
  while (size < n) size *= 2;
  for (uint32_t i = n; i < size; ++i) keys[i] = kNoKey;
  sort_keys<V>(keys, size);
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
    if (keys[i * V::kLanes - 1] <= x) return;
  }
  V::store(keys, V::max(V::shift_in(at, V::fill(0)), V::min(at, all_x)));
}

// Inserts m candidates one after the other into a list of N vectors, which stays in registers;
// returns how many were smaller than the k-th at their time. What is not leaves the first k alone.
template <class V, uint32_t N>
inline uint32_t insert_in_registers(uint64_t* keys, uint32_t k, const uint64_t* candidates,
                                    uint32_t m) {
  typename V::Vector list[N];
  for (uint32_t v = 0; v < N; ++v) list[v] = V::load(keys + v * V::kLanes);
  uint32_t insertions = 0;
  for (uint32_t i = 0; i < m; ++i) {
    const auto x = V::fill(candidates[i]);
    insertions += V::below(x, list[N - 1], (k - 1) % V::kLanes);
    for (uint32_t v = N - 1; v > 0; --v)
      list[v] = V::max(V::shift_in(list[v], list[v - 1]), V::min(list[v], x));
    list[0] = V::max(V::shift_in(list[0], V::fill(0)), V::min(list[0], x));
  }
  for (uint32_t v = 0; v < N; ++v) V::store(keys + v * V::kLanes, list[v]);
  return insertions;
}

template <class V>
inline uint32_t insert_keys(uint64_t* keys, uint32_t k, uint32_t vectors,
                            const uint64_t* candidates, uint32_t m) {
  if constexpr (V::kInRegisters) {
    switch (vectors) {
      case 1:
        return insert_in_registers<V, 1>(keys, k, candidates, m);
      case 2:
        return insert_in_registers<V, 2>(keys, k, candidates, m);
      case 3:
        return insert_in_registers<V, 3>(keys, k, candidates, m);
      case 4:
        return insert_in_registers<V, 4>(keys, k, candidates, m);
      case 5:
        return insert_in_registers<V, 5>(keys, k, candidates, m);
      case 6:
        return insert_in_registers<V, 6>(keys, k, candidates, m);
      case 7:
        return insert_in_registers<V, 7>(keys, k, candidates, m);
      case 8:
        return insert_in_registers<V, 8>(keys, k, candidates, m);
      default:
        break;
    }
  }
  uint32_t insertions = 0;
  for (uint32_t i = 0; i < m; ++i) {
    if (candidates[i] >= keys[k - 1]) continue;
    ++insertions;
    insert_key<V>(keys, vectors, candidates[i]);
  }
  return insertions;
}

// The subtrees that a query has yet to visit. Squared distances stand apart: many are dropped
// without a look at the rest.
struct Stack {
  struct Entry {
    uint32_t node;
    uint32_t offset[3];
  };
  static constexpr uint32_t kDepth = 40;  // a tree of 2^30 leaves is 30 deep
  uint64_t d2[kDepth];
  Entry entry[kDepth];
  uint32_t depth;
};

template <class V, class Coordinate, bool kFacing, bool kEpsilon>
class Walk {
 public:
  void start(const MapView& map, const Settings& settings, const QueryView& query) {
    map_ = &map;
    settings_ = &settings;
    query_ = &query;
    stack_.depth = 0;
    node_ = 1;
  }

  // One inner node on the way from the root to the first leaf, where all offsets are 0.
  void first_descent() {
    const uint32_t word = map_->nodes[node_];
    const uint32_t axis = word >> 30;
    const int64_t away = int64_t{query_->position[axis]} - int64_t{word & 0x3fffffffu};
    const uint32_t right = away >= 0 ? 1u : 0u;
    const uint32_t distance = static_cast<uint32_t>(away < 0 ? -away : away);
    Stack::Entry& far = stack_.entry[stack_.depth];
    far.node = 2 * node_ + 1 - right;
    far.offset[0] = far.offset[1] = far.offset[2] = 0;
    far.offset[axis] = distance;
    const uint64_t far_d2 = uint64_t{distance} * distance;
    stack_.d2[stack_.depth] = far_d2;
    stack_.depth += beyond(far_d2, map_->r2_max) ? 0 : 1;
    node_ = 2 * node_ + right;
  }

  // Asks for the coordinates of the first leaf, or of the two below this node.
  void prefetch() const {
    const uint32_t line = node_ < map_->lines ? 2 * node_ - map_->lines : node_ - map_->lines;
    const char* const at = static_cast<const char*>(map_->coordinates) +
                           size_t{line} * map_->blocks * (3 * kBlock * sizeof(Coordinate));
    __builtin_prefetch(at);
    __builtin_prefetch(at + 64);
  }

  // The rest of the search, after `nodes` steps of the first descent.
  Outcome finish(uint32_t nodes, uint64_t* keys) {
    const MapView& map = *map_;
    const QueryView& query = *query_;
    const uint32_t k = settings_->k, lines = map.lines;
    const uint32_t vectors = (k + V::kLanes - 1) / V::kLanes;
    const int index_bits = map.index_bits;
    const typename V::Query q(query);
    uint64_t last = kNoKey;  // the k-th, once there are k
    uint32_t n = 0, insertions = 0, leaves = 0;
    alignas(64) uint64_t passed[kBlock];
    uint64_t node_d2 = 0, bound = map.r2_max;
    uint32_t node = node_, depth = stack_.depth;
    uint32_t offset[3] = {0, 0, 0};
    for (;;) {
      while (node < lines) {
        const uint32_t word = map.nodes[node];
        const uint32_t axis = word >> 30;
        const int64_t away = int64_t{query.position[axis]} - int64_t{word & 0x3fffffffu};
        const uint32_t right = away >= 0 ? 1u : 0u;
        const uint64_t distance = static_cast<uint64_t>(away < 0 ? -away : away);
        const uint64_t before = offset[axis];
        Stack::Entry& far = stack_.entry[depth];
        far.node = 2 * node + 1 - right;
        far.offset[0] = offset[0];
        far.offset[1] = offset[1];
        far.offset[2] = offset[2];
        far.offset[axis] = static_cast<uint32_t>(distance);
        const uint64_t far_d2 = node_d2 - before * before + distance * distance;
        stack_.d2[depth] = far_d2;
        // The bound only shrinks: what is beyond it now need not wait on the stack.
        depth += beyond(far_d2, bound) ? 0 : 1;
        node = 2 * node + right;
        ++nodes;
      }
      const uint32_t line = node - lines;
      for (uint32_t b = 0; b < map.blocks; ++b) {
        const uint64_t first = uint64_t{line} * map.bucket + uint64_t{b} * kBlock;
        uint32_t exist = map.block_mask;
        if (line + 1 == lines) {
          const uint64_t left = map.count > first ? map.count - first : 0;
          exist = left >= kBlock ? 0xff : (1u << left) - 1;
        }
        const uint32_t m = V::template pass<Coordinate, kFacing>(map, line * map.blocks + b, first,
                                                                 q, bound, exist, passed);
        uint32_t i = 0;
        if (n < k) {
          const uint32_t take = m < k - n ? m : k - n;
          for (; i < take; ++i) keys[n + i] = passed[i];
          n += take;
          insertions += take;
          if (n == k) {
            sort_padded<V>(keys, k);
            last = keys[k - 1];
          }
        }
        if (i < m) {
          insertions += insert_keys<V>(keys, k, vectors, passed + i, m - i);
          last = keys[k - 1];
        }
        if (n == k) bound = last >> index_bits;
      }
      ++leaves;
      if (leaves == settings_->leaf_limit || !pop(depth, bound)) break;
      const Stack::Entry& next = stack_.entry[depth];
      node = next.node;
      node_d2 = stack_.d2[depth];
      offset[0] = next.offset[0];
      offset[1] = next.offset[1];
      offset[2] = next.offset[2];
    }
    if (n < k && n > 1) sort_padded<V>(keys, n);
    return {n, nodes, leaves, insertions};
  }

 private:
  bool beyond(uint64_t d2, uint64_t bound) const {
    if constexpr (kEpsilon)
      return Wide{d2} * settings_->epsilon_factor > Wide{bound} << settings_->epsilon_shift;
    return d2 > bound;
  }

  // Drops what is beyond the bound; leaves `depth` at the entry to visit. False: nothing is left.
  bool pop(uint32_t& depth, uint64_t bound) const {
    while (depth > 0)
      if (!beyond(stack_.d2[--depth], bound)) return true;
    return false;
  }

  const MapView* map_;
  const Settings* settings_;
  const QueryView* query_;
  uint32_t node_;
  Stack stack_;
};

// Queries go down to their first leaf side by side: their loads overlap, and all inner levels that
// are full take the same number of steps. After that they have nothing in common.
template <class V, class Coordinate, bool kFacing, bool kEpsilon>
void run_search(const MapView& map, const Settings& settings, const QueryView* queries, uint32_t n,
                uint64_t* keys, Outcome* outcomes) {
  if (map.lines == 0) {
    for (uint32_t i = 0; i < n; ++i) outcomes[i] = {0, 0, 0, 0};
    return;
  }
  uint32_t levels = 0;
  while (uint64_t{2} << levels <= map.lines) ++levels;
  Walk<V, Coordinate, kFacing, kEpsilon> walks[kGroup];
  for (uint32_t begin = 0; begin < n; begin += kGroup) {
    const uint32_t some = n - begin < kGroup ? n - begin : kGroup;
    for (uint32_t i = 0; i < some; ++i) walks[i].start(map, settings, queries[begin + i]);
    for (uint32_t level = 0; level < levels; ++level)
      for (uint32_t i = 0; i < some; ++i) walks[i].first_descent();
    for (uint32_t i = 0; i < some; ++i) walks[i].prefetch();
    for (uint32_t i = 0; i < some; ++i)
      outcomes[begin + i] = walks[i].finish(levels, keys + size_t{begin + i} * kKeys);
  }
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
