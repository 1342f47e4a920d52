// SPDX-License-Identifier: Apache-2.0
#include "study/cache_model.hpp"

#include <algorithm>

namespace photonloom {

CacheShape leaf_cache_shape(const Plan& plan) { return cache_shape(plan, plan.line_bytes()); }

CacheShape cache_shape(const Plan& plan, int line_bytes) {
  return {static_cast<uint32_t>(std::max(1, plan.cache_bytes / (line_bytes * plan.cache_ways))),
          static_cast<uint32_t>(plan.cache_ways)};
}

CacheModel::CacheModel(const CacheShape& shape)
    : sets_(shape.sets), ways_(shape.ways), tags_(size_t{shape.sets} * shape.ways, ~0u) {}

bool CacheModel::read(uint32_t line) {
  uint32_t* const set = &tags_[size_t{line % sets_} * ways_];
  for (uint32_t way = 0; way < ways_; ++way)
    if (set[way] == line) return true;
  set[turn_] = line;
  turn_ = turn_ + 1 == ways_ ? 0 : turn_ + 1;
  return false;
}

uint64_t lines_fetched(const CacheShape& shape, const LineVisits& visits,
                       std::span<const uint32_t> order, int contexts) {
  CacheModel cache(shape);
  uint64_t fetched = 0;
  if (contexts == 1) {
    for (const uint32_t query : order)
      for (const uint32_t line : visits.of(query)) fetched += !cache.read(line);
    return fetched;
  }
  std::vector<std::span<const uint32_t>> flights;
  for (size_t next = 0;;) {
    while (flights.size() < static_cast<size_t>(contexts) && next < order.size())
      flights.push_back(visits.of(order[next++]));
    if (flights.empty()) return fetched;
    for (auto& lines : flights) {
      if (lines.empty()) continue;
      fetched += !cache.read(lines.front());
      lines = lines.subspan(1);
    }
    std::erase_if(flights, [](const auto& lines) { return lines.empty(); });
  }
}

}  // namespace photonloom
