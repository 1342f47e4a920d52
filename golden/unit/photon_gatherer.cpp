// SPDX-License-Identifier: Apache-2.0
#include "golden/unit/photon_gatherer.hpp"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>

#include "golden/numeric/bits.hpp"
#include "golden/numeric/octahedral.hpp"
#include "golden/numeric/reciprocal.hpp"

namespace photonloom {
namespace {

uint64_t square_distance(const UVec3& a, const UVec3& b) {
  uint64_t d2 = 0;
  for (size_t c = 0; c < 3; ++c) {
    const int64_t d = int64_t{a[c]} - int64_t{b[c]};
    d2 += static_cast<uint64_t>(d * d);
  }
  return d2;
}

// One query's search.
class Search {
 public:
  Search(const Plan& plan, const PhotonMap& map, const GatherQuery& query,
         std::vector<Neighbour>& found)
      : plan_(plan),
        map_(map),
        query_(query),
        normal_(oct_decode({query.normal[0], query.normal[1]}, plan.normal_bits)),
        k_(static_cast<size_t>(plan.k)),
        bound_(plan.map(query.map != 0).r2_max),
        found_(found) {}

  SearchCounts run() {
    found_.clear();
    if (map_.lines == 0) return counts_;
    std::vector<Pending> stack;
    stack.push_back({1, {0, 0, 0}});
    while (!stack.empty()) {
      Pending at = stack.back();
      stack.pop_back();
      if (skipped(at.offset)) continue;
      while (at.node < map_.lines) {
        const MapNode& node = map_.nodes[at.node];
        ++counts_.nodes;
        const int64_t away = int64_t{query_.position[node.axis]} - int64_t{node.split};
        const uint32_t right = away >= 0 ? 1 : 0;
        Pending far{2 * at.node + 1 - right, at.offset};
        far.offset[node.axis] = static_cast<uint32_t>(away < 0 ? -away : away);
        stack.push_back(far);
        at.node = 2 * at.node + right;
      }
      visit_leaf(at.node - map_.lines);
      if (plan_.leaf_limit != 0 && counts_.leaves == plan_.leaf_limit) break;
    }
    return counts_;
  }

 private:
  struct Pending {
    uint32_t node;
    UVec3 offset;  // from the query to the node's region, an axis each
  };

  bool skipped(const UVec3& offset) const {
    uint64_t d2 = 0;
    for (const uint32_t o : offset) d2 += uint64_t{o} * o;
    return UInt128{d2} * plan_.epsilon_factor > UInt128{bound_} << plan_.epsilon_shift;
  }

  void visit_leaf(uint32_t line) {
    ++counts_.leaves;
    const uint64_t begin = uint64_t{line} * static_cast<uint64_t>(map_.bucket);
    const uint64_t end = std::min(begin + static_cast<uint64_t>(map_.bucket), map_.count);
    for (uint64_t index = begin; index < end; ++index) {
      const PackedPhoton& photon = map_.slots[index];
      const Neighbour candidate{square_distance(photon.position, query_.position),
                                static_cast<uint32_t>(index)};
      if (candidate.d2 > plan_.map(query_.map != 0).r2_max) continue;
      if (found_.size() == k_ && !(candidate < found_.back())) continue;
      if (oct_dot(oct_decode(photon.direction, plan_.direction_bits), normal_) <= 0) continue;
      insert(candidate);
    }
  }

  void insert(const Neighbour& candidate) {
    ++counts_.insertions;
    if (found_.size() == k_) found_.pop_back();
    found_.insert(std::upper_bound(found_.begin(), found_.end(), candidate), candidate);
    if (found_.size() == k_) bound_ = found_.back().d2;
  }

  const Plan& plan_;
  const PhotonMap& map_;
  const GatherQuery& query_;
  IVec3 normal_;
  size_t k_;
  uint64_t bound_;
  std::vector<Neighbour>& found_;
  SearchCounts counts_;
};

GatherResult flush_result(const GatherQuery& query) {
  GatherResult result{};
  result.pixel = query.pixel;
  result.sample = query.sample;
  result.tag = query.tag;
  result.flush = 1;
  return result;
}

constexpr size_t kBlock = 4096;  // queries whose photons are held at a time

// Answers queries in parallel; `find` is (map, query, found) -> counts.
template <class Find>
class ParallelGatherer final : public PhotonGatherer {
 public:
  ParallelGatherer(const Plan& plan, Find find) : plan_(plan), find_(std::move(find)) {}

  void load(const PhotonMap& global, const PhotonMap& caustic) override {
    maps_[0] = &global;
    maps_[1] = &caustic;
  }

  void process(std::span<const GatherQuery> in, std::vector<GatherResult>& results,
               std::vector<GatherPhoton>& photons) override {
    for (; !in.empty(); in = in.subspan(std::min(kBlock, in.size())))
      process_block(in.first(std::min(kBlock, in.size())), results, photons);
  }

  Counters counters() const override { return counters_; }

 private:
  void process_block(std::span<const GatherQuery> in, std::vector<GatherResult>& results,
                     std::vector<GatherPhoton>& photons) {
    const size_t base = results.size();
    results.resize(base + in.size());
    std::vector<std::vector<GatherPhoton>> wanted(in.size());
    tbb::parallel_for(tbb::blocked_range<size_t>(0, in.size(), 16), [&](const auto& range) {
      std::vector<Neighbour> found;
      for (size_t i = range.begin(); i < range.end(); ++i) {
        const GatherQuery& query = in[i];
        if (query.flush) {
          results[base + i] = flush_result(query);
          continue;
        }
        const PhotonMap& map = *maps_[query.map];
        const SearchCounts counts = find_(map, query, found);
        results[base + i] = make_gather_result(plan_, map, query, found, counts);
        if (query.want_photons) append_gather_photons(map, found, wanted[i]);
      }
    });
    for (size_t i = 0; i < in.size(); ++i) {
      photons.insert(photons.end(), wanted[i].begin(), wanted[i].end());
      const GatherResult& result = results[base + i];
      counters_[in[i].flush ? "flushes" : "queries"] += 1;
      counters_["photons out"] += wanted[i].size();
      counters_["nodes"] += result.nodes;
      counters_["leaves"] += result.leaves;
      counters_["insertions"] += result.insertions;
      counters_["clamped"] += result.clamped;
    }
  }

  Plan plan_;
  Find find_;
  const PhotonMap* maps_[2] = {nullptr, nullptr};
  Counters counters_;
};

template <class Find>
std::unique_ptr<PhotonGatherer> make_parallel_gatherer(const Plan& plan, Find find) {
  return std::make_unique<ParallelGatherer<Find>>(plan, std::move(find));
}

}  // namespace

bool faces(const Plan& plan, OctCode direction, const Pair32& normal) {
  return oct_dot(oct_decode(direction, plan.direction_bits),
                 oct_decode({normal[0], normal[1]}, plan.normal_bits)) > 0;
}

std::vector<Neighbour> brute_force_gather(const Plan& plan, const PhotonMap& map,
                                          const GatherQuery& query) {
  std::vector<Neighbour> found;
  for (uint64_t index = 0; index < map.count; ++index) {
    const uint64_t d2 = square_distance(map.slots[index].position, query.position);
    if (d2 <= plan.map(query.map != 0).r2_max &&
        faces(plan, map.slots[index].direction, query.normal))
      found.push_back({d2, static_cast<uint32_t>(index)});
  }
  std::sort(found.begin(), found.end());
  if (found.size() > static_cast<size_t>(plan.k)) found.resize(static_cast<size_t>(plan.k));
  return found;
}

SearchCounts search_gather(const Plan& plan, const PhotonMap& map, const GatherQuery& query,
                           std::vector<Neighbour>& found) {
  return Search(plan, map, query, found).run();
}

GatherResult make_gather_result(const Plan& plan, const PhotonMap& map, const GatherQuery& query,
                                std::span<const Neighbour> found, const SearchCounts& counts) {
  GatherResult result{};
  result.pixel = query.pixel;
  result.sample = query.sample;
  result.tag = query.tag;
  result.map = query.map;
  result.count = static_cast<uint32_t>(found.size());
  result.full = found.size() == static_cast<size_t>(plan.k) ? 1 : 0;
  result.r2 = result.full ? found.back().d2 : plan.map(query.map != 0).r2_max;
  for (const Neighbour& n : found)
    for (int c = 0; c < plan.channels; ++c)
      result.flux[static_cast<size_t>(c)] += power_value(map.slots[n.index].power, c);
  result.clamped = result.r2 < plan.r2_floor ? 1 : 0;
  if (plan.reciprocal_bits != 0) {
    const Reciprocal inverse = reciprocal(std::max(result.r2, plan.r2_floor), plan.reciprocal_bits);
    result.reciprocal = inverse.mantissa;
    result.reciprocal_exponent = inverse.exponent;
  }
  result.nodes = counts.nodes;
  result.leaves = counts.leaves;
  result.insertions = counts.insertions;
  return result;
}

void append_gather_photons(const PhotonMap& map, std::span<const Neighbour> found,
                           std::vector<GatherPhoton>& photons) {
  for (size_t i = 0; i < found.size(); ++i) {
    const PackedPhoton& photon = map.slots[found[i].index];
    photons.push_back({.index = found[i].index,
                       .d2 = found[i].d2,
                       .mantissa = photon.power.mantissa,
                       .exponent = photon.power.exponent,
                       .direction = {photon.direction.u, photon.direction.v},
                       .last = i + 1 == found.size() ? 1u : 0u});
  }
}

std::unique_ptr<PhotonGatherer> make_golden_photon_gatherer(const Plan& plan) {
  return make_parallel_gatherer(
      plan, [plan](const PhotonMap& map, const GatherQuery& query, std::vector<Neighbour>& found) {
        return search_gather(plan, map, query, found);
      });
}

std::unique_ptr<PhotonGatherer> make_brute_photon_gatherer(const Plan& plan) {
  return make_parallel_gatherer(
      plan, [plan](const PhotonMap& map, const GatherQuery& query, std::vector<Neighbour>& found) {
        found = brute_force_gather(plan, map, query);
        return SearchCounts{};
      });
}

}  // namespace photonloom
