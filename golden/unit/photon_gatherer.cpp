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
         std::vector<Neighbour>& found, std::vector<uint32_t>* lines)
      : plan_(plan),
        map_(map),
        query_(query),
        normal_(oct_decode({query.normal[0], query.normal[1]}, plan.normal_bits)),
        k_(static_cast<size_t>(plan.k)),
        bound_(plan.map(query.map != 0).r2_max),
        found_(found),
        lines_(lines) {}

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
    if (lines_) lines_->push_back(line);
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
  std::vector<uint32_t>* lines_;
  SearchCounts counts_;
};

// `kth` is the d^2 of the last of `count` photons; looked at only if there are
// k.
GatherResult finish_result(const Plan& plan, const GatherQuery& query, uint32_t count, uint64_t kth,
                           const Channels64& flux, const SearchCounts& counts) {
  GatherResult result{};
  result.pixel = query.pixel;
  result.sample = query.sample;
  result.tag = query.tag;
  result.map = query.map;
  result.count = count;
  result.full = count == static_cast<uint32_t>(plan.k) ? 1 : 0;
  result.r2 = result.full ? kth : plan.map(query.map != 0).r2_max;
  result.flux = flux;
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

GatherResult flush_result(const GatherQuery& query) {
  GatherResult result{};
  result.pixel = query.pixel;
  result.sample = query.sample;
  result.tag = query.tag;
  result.flush = 1;
  return result;
}

constexpr size_t kQueries = 4096;  // whose photons are held at a time

// What both units do around the search: blocks of queries, answered in
// parallel, leave in order.
class ParallelGatherer : public PhotonGatherer {
 public:
  explicit ParallelGatherer(const Plan& plan) : plan_(plan) {}

  void load(const PhotonMap& global, const PhotonMap& caustic) override {
    maps_[0] = &global;
    maps_[1] = &caustic;
  }

  void process(std::span<const GatherQuery> in, std::vector<GatherResult>& results,
               std::vector<GatherPhoton>& photons) override {
    for (; !in.empty(); in = in.subspan(std::min(kQueries, in.size())))
      process_block(in.first(std::min(kQueries, in.size())), results, photons);
  }

  Counters counters() const override {
    return {{"queries", queries_}, {"flushes", flushes_},      {"photons out", photons_out_},
            {"nodes", nodes_},     {"leaves", leaves_},        {"clamped", clamped_},
            {"full", full_},       {"insertions", insertions_}};
  }

 protected:
  // Answers queries of one map, none of which is a flush: the result of
  // in[of[i]] goes to results[of[i]], its photons, if wanted, to
  // photons[of[i]].
  virtual void answer(std::span<const GatherQuery> in, std::span<const size_t> of,
                      GatherResult* results, std::vector<GatherPhoton>* photons) const = 0;

  const Plan& plan() const { return plan_; }
  const PhotonMap& map(const GatherQuery& query) const { return *maps_[query.map]; }

 private:
  void process_block(std::span<const GatherQuery> in, std::vector<GatherResult>& results,
                     std::vector<GatherPhoton>& photons) {
    const size_t base = results.size();
    results.resize(base + in.size());
    std::vector<std::vector<GatherPhoton>> wanted(in.size());
    tbb::parallel_for(tbb::blocked_range<size_t>(0, in.size(), 2 * search::kGroup),
                      [&](const auto& range) {
                        std::vector<size_t> of[2];
                        for (size_t i = range.begin(); i < range.end(); ++i) {
                          if (in[i].flush) {
                            results[base + i] = flush_result(in[i]);
                          } else {
                            of[in[i].map].push_back(i);
                          }
                        }
                        for (const auto& queries : of)
                          if (!queries.empty()) answer(in, queries, &results[base], wanted.data());
                      });
    for (size_t i = 0; i < in.size(); ++i) {
      photons.insert(photons.end(), wanted[i].begin(), wanted[i].end());
      const GatherResult& result = results[base + i];
      (in[i].flush ? flushes_ : queries_) += 1;
      photons_out_ += wanted[i].size();
      nodes_ += result.nodes;
      leaves_ += result.leaves;
      insertions_ += result.insertions;
      clamped_ += result.clamped;
      full_ += result.full;
    }
  }

  Plan plan_;
  const PhotonMap* maps_[2] = {nullptr, nullptr};
  uint64_t queries_ = 0, flushes_ = 0, photons_out_ = 0, nodes_ = 0, leaves_ = 0, insertions_ = 0,
           clamped_ = 0, full_ = 0;
};

class BruteGatherer final : public ParallelGatherer {
 public:
  using ParallelGatherer::ParallelGatherer;

 private:
  void answer(std::span<const GatherQuery> in, std::span<const size_t> of, GatherResult* results,
              std::vector<GatherPhoton>* photons) const override {
    for (const size_t i : of) {
      const std::vector<Neighbour> found = brute_force_gather(plan(), map(in[i]), in[i]);
      if (in[i].want_photons) append_gather_photons(map(in[i]), found, photons[i]);
      results[i] = make_gather_result(plan(), map(in[i]), in[i], found, {});
    }
  }
};

// The search with vectors where its keys hold the map's candidates, else
// search_gather; they give the same packets.
class GoldenGatherer final : public ParallelGatherer {
 public:
  GoldenGatherer(const Plan& plan, const search::Level& level)
      : ParallelGatherer(plan),
        level_(level),
        epsilon_(plan.epsilon_factor != uint32_t{1} << plan.epsilon_shift) {
    settings_.k = static_cast<uint32_t>(plan.k);
    settings_.leaf_limit = plan.leaf_limit == 0 ? ~0u : plan.leaf_limit;
    settings_.epsilon_factor = plan.epsilon_factor;
    settings_.epsilon_shift = plan.epsilon_shift;
  }

  void load(const PhotonMap& global, const PhotonMap& caustic) override {
    ParallelGatherer::load(global, caustic);
    const PhotonMap* const maps[2] = {&global, &caustic};
    for (size_t m = 0; m < 2; ++m) {
      const MapPlan& map_plan = plan().map(m != 0);
      fast_[m].reset();
      if (search::Map::fits(*maps[m], map_plan) && settings_.k <= search::kMaxK)
        fast_[m] = std::make_unique<search::Map>(*maps[m], plan(), map_plan);
    }
  }

 private:
  void answer(std::span<const GatherQuery> in, std::span<const size_t> of, GatherResult* results,
              std::vector<GatherPhoton>* photons) const override {
    const search::Map* const fast = fast_[in[of[0]].map].get();
    if (!fast) return answer_step_by_step(in, of, results, photons);
    const int index_bits = fast->view().index_bits;
    search::QueryView views[search::kGroup];
    search::Outcome outcomes[search::kGroup];
    alignas(64) uint64_t all_keys[search::kGroup * search::kKeys];
    for (; !of.empty(); of = of.subspan(std::min<size_t>(of.size(), search::kGroup))) {
      const uint32_t n = static_cast<uint32_t>(std::min<size_t>(of.size(), search::kGroup));
      for (uint32_t i = 0; i < n; ++i) {
        const GatherQuery& query = in[of[i]];
        const IVec3 normal = oct_decode({query.normal[0], query.normal[1]}, plan().normal_bits);
        for (size_t c = 0; c < 3; ++c) {
          views[i].position[c] = query.position[c];
          views[i].normal[c] = static_cast<int16_t>(normal[c]);
        }
      }
      level_.search[fast->wide()][1][epsilon_](fast->view(), settings_, views, n, all_keys,
                                               outcomes);
      for (uint32_t i = 0; i < n; ++i) {
        const GatherQuery& query = in[of[i]];
        const uint64_t* const keys = all_keys + size_t{i} * search::kKeys;
        const search::Outcome& outcome = outcomes[i];
        Channels64 flux;
        level_.flux(fast->view(), keys, outcome.count, flux.data());
        if (query.want_photons) {
          std::vector<Neighbour> found(outcome.count);
          for (uint32_t j = 0; j < outcome.count; ++j)
            found[j] = {keys[j] >> index_bits, static_cast<uint32_t>(keys[j] & ones(index_bits))};
          append_gather_photons(map(query), found, photons[of[i]]);
        }
        const uint64_t kth = outcome.count == settings_.k ? keys[settings_.k - 1] >> index_bits : 0;
        results[of[i]] = finish_result(plan(), query, outcome.count, kth, flux,
                                       {outcome.nodes, outcome.leaves, outcome.insertions});
      }
    }
  }

  void answer_step_by_step(std::span<const GatherQuery> in, std::span<const size_t> of,
                           GatherResult* results, std::vector<GatherPhoton>* photons) const {
    std::vector<Neighbour> found;
    for (const size_t i : of) {
      const SearchCounts counts = search_gather(plan(), map(in[i]), in[i], found);
      if (in[i].want_photons) append_gather_photons(map(in[i]), found, photons[i]);
      results[i] = make_gather_result(plan(), map(in[i]), in[i], found, counts);
    }
  }

  const search::Level& level_;
  bool epsilon_;
  search::Settings settings_;
  std::unique_ptr<search::Map> fast_[2];
};

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
                           std::vector<Neighbour>& found, std::vector<uint32_t>* lines) {
  return Search(plan, map, query, found, lines).run();
}

GatherResult make_gather_result(const Plan& plan, const PhotonMap& map, const GatherQuery& query,
                                std::span<const Neighbour> found, const SearchCounts& counts) {
  Channels64 flux{};
  for (const Neighbour& n : found)
    for (int c = 0; c < plan.channels; ++c)
      flux[static_cast<size_t>(c)] += power_value(map.slots[n.index].power, c);
  return finish_result(plan, query, static_cast<uint32_t>(found.size()),
                       found.empty() ? 0 : found.back().d2, flux, counts);
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
  return make_golden_photon_gatherer(plan, search::chosen_level());
}

std::unique_ptr<PhotonGatherer> make_golden_photon_gatherer(const Plan& plan,
                                                            const search::Level& level) {
  return std::make_unique<GoldenGatherer>(plan, level);
}

std::unique_ptr<PhotonGatherer> make_brute_photon_gatherer(const Plan& plan) {
  return std::make_unique<BruteGatherer>(plan);
}

}  // namespace photonloom
