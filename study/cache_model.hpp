// SPDX-License-Identifier: Apache-2.0
// What the gatherer's leaf cache fetches for a stream of gathers: the cache of rtl/common/cache.sv,
// without time. docs/reordering.md defines it.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "golden/plan/plan.hpp"

namespace photonloom {

// Lines that queries read, query by query, in the order in which each reads them.
class LineVisits {
 public:
  size_t queries() const { return begin_.size() - 1; }
  size_t total() const { return lines_.size(); }
  std::span<const uint32_t> of(size_t query) const {
    return std::span(lines_).subspan(begin_[query], begin_[query + 1] - begin_[query]);
  }
  void add_query(std::span<const uint32_t> lines) {
    lines_.insert(lines_.end(), lines.begin(), lines.end());
    begin_.push_back(lines_.size());
  }

 private:
  std::vector<size_t> begin_{0};
  std::vector<uint32_t> lines_;
};

struct CacheShape {
  uint32_t sets = 1;  // in the RTL a power of two; 0: no cache, every line is fetched
  uint32_t ways = 1;
};
CacheShape leaf_cache_shape(const Plan& plan);
// As many bytes in lines of another size: sets need no power of two.
CacheShape cache_shape(const Plan& plan, int line_bytes);

// Which ways of a cache were used of late: a bit each, all but the last of a set's cleared when all
// would be. What a miss may take is the next way in turn, of those not used where it can; one turn
// serves all sets.
class UsedWays {
 public:
  explicit UsedWays(const CacheShape& shape);
  void use(uint32_t set, uint32_t way);
  // The way that a miss takes, of those for which held(way) is false; kNone: all are held. Advances
  // the turn.
  static constexpr uint32_t kNone = ~0u;
  template <class Held>
  uint32_t take(uint32_t set, Held&& held) {
    for (const bool spare : {true, false})
      for (uint32_t i = 0; i < ways_; ++i) {
        const uint32_t way = turn_ + i < ways_ ? turn_ + i : turn_ + i - ways_;
        if (held(way) || (spare && used_[size_t{set} * ways_ + way])) continue;
        turn_ = turn_ + 1 == ways_ ? 0 : turn_ + 1;
        use(set, way);
        return way;
      }
    return kNone;
  }

 private:
  uint32_t ways_, turn_ = 0;
  std::vector<char> used_;  // set by set
};

// A set-associative cache of lines. A line's set is its number modulo the sets.
class CacheModel {
 public:
  explicit CacheModel(const CacheShape& shape);
  // Whether the line was there; it is afterwards.
  bool read(uint32_t line);

 private:
  uint32_t sets_, ways_;
  UsedWays used_;
  std::vector<uint32_t> tags_;  // set by set; ~0: nothing
};

// Cycles that pass between and during lookups where several queries are in flight.
struct LookupTimes {
  uint32_t read = 1;     // of the reader, a line
  uint32_t beats = 1;    // of the memory port, a line
  uint32_t memory = 0;   // from a request to its first beat
  uint32_t between = 1;  // from a line read, or the query's start, to the query's next lookup
  uint32_t misses = 1;   // that may be on their way
};
// Lanes, list and count of a leaf take 27 cycles, an inner node 4; about three lie before a leaf.
inline constexpr uint32_t kCyclesBetweenLines = 40;
// With a memory of `latency` cycles.
LookupTimes lookup_times(const Plan& plan, int latency);

// Lines fetched, from an empty cache, when the queries of `order` (numbers of queries in `visits`)
// are served one after another. Exactly those of the RTL with one context.
uint64_t lines_fetched(const CacheShape& shape, const LineVisits& visits,
                       std::span<const uint32_t> order);
// With `contexts` of them in flight: the RTL's cache and its misses, held ways and repeated
// lookups in time, while the descent between two lines takes always as long.
uint64_t lines_fetched(const CacheShape& shape, const LineVisits& visits,
                       std::span<const uint32_t> order, int contexts, const LookupTimes& times);

}  // namespace photonloom
