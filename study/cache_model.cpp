// SPDX-License-Identifier: Apache-2.0
#include "study/cache_model.hpp"

#include <algorithm>

namespace photonloom {

namespace {

constexpr uint64_t kNever = ~uint64_t{0};
constexpr uint32_t kNowhere = ~0u;

// The cache of rtl/common/cache.sv with several clients, in steps of a cycle; a lookup is decided
// when it is made.
class CacheInTime {
 public:
  CacheInTime(const CacheShape& shape, const LookupTimes& times, size_t clients)
      : shape_(shape),
        times_(times),
        used_(shape),
        tags_(size_t{shape.sets} * shape.ways, kNowhere),
        holders_(tags_.size(), 0),
        misses_(times.misses) {
    again_.reserve(clients);
  }

  // A client asks for a line now; it has no other request.
  void ask(uint32_t client, uint32_t line) { again_.push_back({client, line, now_}); }

  // One cycle. The client whose line has been read by the end of it, or kNowhere.
  uint32_t step() {
    look_up();
    start_reading();
    ++now_;
    if (reading_.until != now_) return kNowhere;
    --holders_[reading_.place];
    reading_.until = kNever;
    return reading_.client;
  }

  uint64_t now() const { return now_; }
  uint64_t fetched() const { return fetched_; }
  bool is_idle() const {
    return again_.empty() && reading_.until == kNever && hit_.place == kNowhere && busy_ == 0;
  }
  // Only where it is idle.
  void skip_to(uint64_t cycle) { now_ = cycle; }

 private:
  static constexpr uint64_t kRound = 4;  // from a lookup to the next one of the same request
  struct Request {
    uint32_t client, line;
    uint64_t from;
  };
  struct Reading {
    uint32_t client = 0, place = kNowhere;
    uint64_t until = kNever;
  };
  struct Miss {
    uint32_t client = 0, place = kNowhere;
    uint64_t filled = kNever;
  };

  void look_up() {
    const auto request = std::find_if(again_.begin(), again_.end(),
                                      [&](const Request& r) { return r.from <= now_; });
    if (request == again_.end()) return;
    const Request r = *request;
    again_.erase(request);
    if (!is_decided(r)) again_.push_back({r.client, r.line, now_ + kRound});
  }

  bool is_decided(const Request& r) {
    const uint32_t number = r.line % shape_.sets, set = number * shape_.ways;
    for (uint32_t place = set; place < set + shape_.ways; ++place) {
      if (tags_[place] != r.line) continue;
      const bool comes = std::any_of(misses_.begin(), misses_.end(),
                                     [&](const Miss& m) { return m.place == place; });
      if (comes || hit_.place != kNowhere) return false;
      hit_ = {r.client, place, kNever};
      ++holders_[place];
      used_.use(number, place - set);
      return true;
    }
    const auto entry = std::find_if(misses_.begin(), misses_.end(),
                                    [](const Miss& m) { return m.place == kNowhere; });
    if (entry == misses_.end()) return false;
    const uint32_t way = used_.take(number, [&](uint32_t w) { return holders_[set + w] != 0; });
    if (way == UsedWays::kNone) return false;
    const uint32_t place = set + way;
    tags_[place] = r.line;
    ++holders_[place];
    port_free_ = std::max(port_free_, now_) + times_.beats;
    *entry = {r.client, place, port_free_ + times_.memory};
    ++fetched_;
    ++busy_;
    return true;
  }

  // Lines that have come go before hits.
  void start_reading() {
    if (reading_.until != kNever) return;
    for (Miss& m : misses_) {
      if (m.place == kNowhere || m.filled > now_) continue;
      reading_ = {m.client, m.place, now_ + times_.read};
      m = {};
      --busy_;
      return;
    }
    if (hit_.place == kNowhere) return;
    reading_ = {hit_.client, hit_.place, now_ + times_.read};
    hit_ = {};
  }

  CacheShape shape_;
  LookupTimes times_;
  UsedWays used_;
  std::vector<uint32_t> tags_;     // set by set
  std::vector<uint32_t> holders_;  // of each place: on its way, waiting to be read, being read
  std::vector<Miss> misses_;       // kNowhere: free
  std::vector<Request> again_;
  Reading hit_, reading_;
  uint64_t now_ = 0, port_free_ = 0, fetched_ = 0;
  uint32_t busy_ = 0;
};

}  // namespace

CacheShape leaf_cache_shape(const Plan& plan) { return cache_shape(plan, plan.line_bytes()); }

CacheShape cache_shape(const Plan& plan, int line_bytes) {
  if (plan.cache_bytes == 0) return {0, static_cast<uint32_t>(plan.cache_ways)};
  return {static_cast<uint32_t>(std::max(1, plan.cache_bytes / (line_bytes * plan.cache_ways))),
          static_cast<uint32_t>(plan.cache_ways)};
}

UsedWays::UsedWays(const CacheShape& shape)
    : ways_(shape.ways), used_(size_t{shape.sets} * shape.ways, 0) {}

void UsedWays::use(uint32_t set, uint32_t way) {
  const auto begin = used_.begin() + static_cast<std::ptrdiff_t>(size_t{set} * ways_);
  begin[way] = 1;
  if (std::find(begin, begin + ways_, 0) != begin + ways_) return;
  std::fill_n(begin, ways_, char{0});
  begin[way] = 1;
}

CacheModel::CacheModel(const CacheShape& shape)
    : sets_(shape.sets),
      ways_(shape.ways),
      used_(shape),
      tags_(size_t{shape.sets} * shape.ways, ~0u) {}

bool CacheModel::read(uint32_t line) {
  if (sets_ == 0) return false;
  const uint32_t number = line % sets_;
  uint32_t* const set = &tags_[size_t{number} * ways_];
  for (uint32_t way = 0; way < ways_; ++way)
    if (set[way] == line) {
      used_.use(number, way);
      return true;
    }
  set[used_.take(number, [](uint32_t) { return false; })] = line;
  return false;
}

LookupTimes lookup_times(const Plan& plan, int latency) {
  const uint32_t beats = static_cast<uint32_t>(plan.line_beats());
  LookupTimes t;
  t.read = static_cast<uint32_t>(plan.bucket / plan.lanes);
  t.beats = beats;
  t.memory = static_cast<uint32_t>(latency) + 2;
  t.between = kCyclesBetweenLines;
  t.misses = static_cast<uint32_t>(plan.cache_misses);
  return t;
}

uint64_t lines_fetched(const CacheShape& shape, const LineVisits& visits,
                       std::span<const uint32_t> order) {
  CacheModel cache(shape);
  uint64_t fetched = 0;
  for (const uint32_t query : order)
    for (const uint32_t line : visits.of(query)) fetched += !cache.read(line);
  return fetched;
}

uint64_t lines_fetched(const CacheShape& shape, const LineVisits& visits,
                       std::span<const uint32_t> order, int contexts, const LookupTimes& times) {
  if (contexts == 1 || shape.sets == 0) return lines_fetched(shape, visits, order);
  CacheInTime cache(shape, times, static_cast<size_t>(contexts));
  struct Flight {
    std::span<const uint32_t> lines;
    uint64_t asks = kNever;  // its next line, at this cycle
  };
  std::vector<Flight> flights(static_cast<size_t>(contexts));
  size_t next = 0;
  const auto enter = [&](Flight& flight) {
    while (flight.lines.empty() && next < order.size()) flight.lines = visits.of(order[next++]);
    flight.asks = flight.lines.empty() ? kNever : cache.now() + times.between;
  };
  for (Flight& flight : flights) enter(flight);
  for (;;) {
    uint64_t soonest = kNever;
    for (uint32_t i = 0; i < flights.size(); ++i) {
      Flight& flight = flights[i];
      if (flight.asks <= cache.now()) {
        cache.ask(i, flight.lines.front());
        flight.asks = kNever;
      }
      soonest = std::min(soonest, flight.asks);
    }
    if (cache.is_idle()) {
      if (soonest == kNever) return cache.fetched();
      cache.skip_to(soonest);
      continue;
    }
    const uint32_t served = cache.step();
    if (served == kNowhere) continue;
    Flight& flight = flights[served];
    flight.lines = flight.lines.subspan(1);
    enter(flight);
  }
}

}  // namespace photonloom
