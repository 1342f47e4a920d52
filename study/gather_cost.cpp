// SPDX-License-Identifier: Apache-2.0
#include "study/gather_cost.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "golden/numeric/sha256.hpp"
#include "golden/plan/plan_file.hpp"
#include "golden/unit/photon_gatherer.hpp"
#include "golden/unit/photon_lines.hpp"
#include "study/cache_model.hpp"
#include "study/cycle_fit.hpp"
#include "verilator_tb/unit/backends.hpp"

namespace photonloom {
namespace {

constexpr size_t kRuns = 4;  // of neighbouring queries

size_t samples_of(const Plan& plan) {
  return static_cast<size_t>(plan.width) * static_cast<size_t>(plan.height) *
         static_cast<size_t>(plan.spp);
}

}  // namespace

WatchedGatherer::Runs::Runs(size_t queries, size_t most)
    // Some rays leave the scene, so the places are within the first half of what may come.
    : length(std::max<size_t>(1, queries / kRuns)), stride(std::max(length, most / 2 / kRuns)) {}

void WatchedGatherer::Runs::see(const GatherQuery& query) {
  const size_t place = seen++;
  if (place / stride < kRuns && place % stride < length) kept.push_back(query);
}

WatchedGatherer::WatchedGatherer(const Plan& plan, size_t queries)
    : golden_(make_golden_photon_gatherer(plan)),
      finals_(queries, samples_of(plan) * static_cast<size_t>(std::max(1, plan.gather_rays))),
      caustics_(queries, samples_of(plan)) {}

void WatchedGatherer::load(const PhotonMap& global, const PhotonMap& caustic) {
  golden_->load(global, caustic);
}

void WatchedGatherer::process(std::span<const GatherQuery> in, std::vector<GatherResult>& results,
                              std::vector<GatherPhoton>& photons) {
  for (const GatherQuery& query : in)
    if (!query.flush && !query.want_photons) (query.map != 0 ? caustics_ : finals_).see(query);
  golden_->process(in, results, photons);
}

GatherCost gather_cost_rtl(const Plan& plan, const PhotonMap& global, const PhotonMap& caustic,
                           std::span<const GatherQuery> queries, int latency,
                           const std::string& work_dir) {
  GatherCost cost = gather_cost_model(plan, global, caustic, queries, latency);
  RunOptions options;
  options.latency = latency;
  options.work_dir = work_dir;
  const auto rtl = make_rtl_photon_gatherer(plan, options);
  const auto golden = make_golden_photon_gatherer(plan);
  std::vector<GatherResult> results, expected;
  std::vector<GatherPhoton> photons;
  golden->load(global, caustic);
  golden->process(queries, expected, photons);
  rtl->load(global, caustic);
  const Counters before = rtl->counters();
  const uint64_t first = rtl->cycles();
  rtl->process(queries, results, photons);
  if (results != expected)
    throw std::runtime_error(
        fmt::format("plan {}: the RTL's gathers are not golden's", plan_hash_text(plan)));
  const auto per_query = [&](double n) { return n / static_cast<double>(queries.size()); };
  const Counters after = rtl->counters();
  cost.from_rtl = true;
  cost.cycles = per_query(static_cast<double>(rtl->cycles() - first));
  cost.bytes = per_query(static_cast<double>(after.at("bytes read") - before.at("bytes read")));
  cost.load.misses = cost.bytes / plan.line_bytes();
  return cost;
}

GatherSearches searched(const Plan& plan, const PhotonMap& global, const PhotonMap& caustic,
                        std::span<const GatherQuery> queries) {
  GatherSearches s;
  std::vector<Neighbour> found;
  std::vector<uint32_t> leaves;
  const FurtherLines further[] = {further_lines(plan, global, false),
                                  further_lines(plan, caustic, true)};
  for (const GatherQuery& query : queries) {
    leaves.clear();
    const SearchCounts counts =
        search_gather(plan, query.map ? caustic : global, query, found, &leaves);
    std::vector<uint32_t> lines = lines_of(further[query.map ? 1 : 0], leaves);
    if (query.map)
      for (uint32_t& line : lines) line += 1u << plan.line_address_bits();
    s.visits.add_query(lines);
    s.load.nodes += counts.nodes;
    s.load.leaves += counts.leaves;
    s.load.insertions += counts.insertions;
  }
  for (double* sum : {&s.load.nodes, &s.load.leaves, &s.load.insertions})
    *sum /= static_cast<double>(std::max<size_t>(1, queries.size()));
  return s;
}

GatherCost gather_cost(const Plan& plan, const GatherSearches& searches, int latency) {
  GatherCost cost;
  const size_t queries = searches.visits.queries();
  if (queries == 0) return cost;
  cost.load = searches.load;
  std::vector<uint32_t> order(queries);
  std::iota(order.begin(), order.end(), 0u);
  const uint64_t lines = lines_fetched(leaf_cache_shape(plan), searches.visits, order,
                                       plan.contexts, lookup_times(plan, latency));
  cost.load.misses = static_cast<double>(lines) / static_cast<double>(queries);
  cost.bytes = cost.load.misses * plan.line_bytes();
  cost.cycles = modelled_cycles(plan, cost.load, latency);
  return cost;
}

GatherCost gather_cost_model(const Plan& plan, const PhotonMap& global, const PhotonMap& caustic,
                             std::span<const GatherQuery> queries, int latency) {
  return gather_cost(plan, searched(plan, global, caustic, queries), latency);
}

double modelled_cycles(const Plan& plan, const GatherLoad& load, int latency,
                       LineBeats line_beats) {
  const CycleFit& f = kCycleFit;
  const double parts = static_cast<double>(plan.bucket) / plan.lanes;
  const double beats = plan.line_beats();
  // A step of two levels has one of them where a descent enters at a lower one, and where it ends
  // at the upper one: 1.4 to 1.6 nodes a step are measured (docs/photon_gatherer.md).
  const double steps = load.nodes / (plan.node_levels() > 1 ? 1.5 : 1);
  // What one query waits for when it is alone. Without a leaf cache a leaf is not looked up, nor is
  // its line written and read there: 10 cycles less, as two contexts show in three scenes.
  const bool cached = plan.cache_bytes != 0;
  const double leaf = cached ? 27 : 17;
  const double alone = 3 * steps + 1.5 * (load.nodes + 1) + leaf * load.leaves + load.insertions +
                       load.misses * (latency + beats) + plan.k;
  const double in_lanes = f.lanes * parts * load.leaves, in_memory = f.memory * beats * load.misses;
  // Without a cache between, beats pass the lanes as they come: one bound, the larger.
  const double bounds[] = {
      f.nodes * steps / plan.trees(), cached ? in_lanes : std::max(in_lanes, in_memory),
      f.insertions * load.insertions / plan.candidates_per_cycle,
      cached && line_beats == LineBeats::kBound ? in_memory : 0, f.latency * alone / plan.contexts};
  const double power = cached ? f.power : kUncachedPower;
  double sum = 0;
  for (const double b : bounds) sum += std::pow(b, power);
  // Each miss has an entry of the cache until its line is there. Where one node and one candidate a
  // cycle are taken they are seldom all in use, so no fit can have it.
  if (cached && plan.nodes_per_cycle * plan.candidates_per_cycle > 1)
    sum += std::pow(load.misses * (latency + beats) / plan.cache_misses, power);
  // Where one candidate a cycle enters a list this never binds, so no fit can have it: the sum
  // reads its photons one after the other, beside everything else.
  const double powers = (std::min<double>(plan.k, load.insertions) + 1) / plan.powers_per_cycle;
  return std::max(f.fixed + std::pow(sum, 1 / power), powers);
}

std::string cycle_fit_signature() {
  const CycleFit& f = kCycleFit;
  Sha256 sum;
  sum.add(fmt::format("{} {} {} {} {} {} {} {} powers entries straight {}", f.power, f.fixed,
                      f.nodes, f.lanes, f.insertions, f.memory, f.latency, kCyclesBetweenLines,
                      kUncachedPower));
  return sum.hex().substr(0, 16);
}

double sampler_cycles(const Plan& plan, double photons, double rays) {
  const double cells = static_cast<double>(1 << (2 * plan.cell_bits));
  const int edge = 1 << plan.cell_bits;
  const double steps = (edge / 2 + 1 + 1) / 2;
  const int levels = clog2(static_cast<uint64_t>(plan.levels));
  const int delay = plan.combine == TableCombine::kWeighted ? std::max(levels, 3) : levels;
  const double build = std::max(photons, steps - 1) + cells + 12 + delay;
  return std::max(build, 1 + photons + rays);
}

}  // namespace photonloom
