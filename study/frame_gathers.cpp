// SPDX-License-Identifier: Apache-2.0
#include "study/frame_gathers.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <unordered_map>
#include <utility>

#include "golden/numeric/hilbert.hpp"
#include "golden/plan/plan_file.hpp"
#include "golden/unit/photon_gatherer.hpp"
#include "golden/unit/photon_lines.hpp"
#include "golden/unit/reorder_buffer.hpp"

namespace photonloom {
namespace {

// Passes everything and keeps the queries.
class KeepingBuffer final : public ReorderBuffer {
 public:
  explicit KeepingBuffer(std::vector<GatherQuery>& kept) : kept_(kept) {}
  void process(std::span<const GatherQuery> in, std::vector<GatherQuery>& out) override {
    for (const GatherQuery& query : in)
      if (!query.flush) kept_.push_back(query);
    out.insert(out.end(), in.begin(), in.end());
  }
  Counters counters() const override { return {}; }

 private:
  std::vector<GatherQuery>& kept_;
};

// The plan as far as queries and their visits depend on it; only when packets come, and in which
// order, is as in every plan.
Plan asked_by(const Plan& plan) {
  Plan p = plan;
  const Plan usual;
  p.reorder_key = usual.reorder_key;
  p.reorder_drain = usual.reorder_drain;
  p.reorder_packets = usual.reorder_packets;
  p.reorder_bins = 1;
  p.reorder_cell_bits = 1;
  p.contexts = usual.contexts;
  p.lanes = 1;
  p.cache_misses = usual.cache_misses;
  p.cache_ways = 1;
  p.cache_bytes = p.line_bytes();
  p.order = FrameOrder::kTile;
  // Tiles decide what the irradiance cache shares.
  if (!p.cache_present) {
    p.tile = usual.tile;
    p.batch_tiles = usual.batch_tiles;
  }
  p.direction_bin_bits = usual.direction_bin_bits;
  return p;
}

std::vector<GatherQuery> made_by(PointRun& run, const Plan& plan) {
  std::vector<GatherQuery> queries;
  FrameUnits units = make_golden_units(plan);
  units.reorder_buffer = std::make_unique<KeepingBuffer>(queries);
  FrameCounts counts;
  run.render(plan, Arithmetic::kGolden, units, counts, run.seed());
  return queries;
}

std::string key_of(PointRun& run, const char* what, const Plan& plan) {
  return fmt::format("{} {} seed {}", what, plan_hash_text(plan), run.seed());
}

// Pixel, sample and ray as one number.
uint64_t name_of(const Plan& plan, const GatherQuery& q) {
  return (uint64_t{q.pixel} * static_cast<uint64_t>(plan.spp) + q.sample) *
             static_cast<uint64_t>(plan.gather_rays) +
         q.tag;
}

}  // namespace

std::shared_ptr<const FrameGathers> frame_gathers(PointRun& run) {
  const Plan plan = asked_by(run.plan());
  const std::string key = key_of(run, "frame gathers", plan);
  return run.scene().shared<FrameGathers>(key, [&] {
    FrameGathers made;
    made.queries = made_by(run, plan);
    std::vector<Neighbour> found;
    std::vector<uint32_t> leaves;
    const FurtherLines further = further_lines(plan, run.map(false), false);
    for (const GatherQuery& query : made.queries) {
      leaves.clear();
      search_gather(plan, run.map(false), query, found, &leaves);
      made.visits.add_query(lines_of(further, leaves));
    }
    return made;
  });
}

std::shared_ptr<const std::vector<uint32_t>> frame_order(PointRun& run) {
  const std::shared_ptr<const FrameGathers> gathers = frame_gathers(run);
  const Plan usual = asked_by(run.plan());
  Plan plan = usual;
  plan.order = run.plan().order;
  plan.batch_tiles = run.plan().batch_tiles;
  // Whole frames in pixel order have no tiles, orders without bins no bins.
  if (plan.order != FrameOrder::kPixel || plan.batch_tiles != 0 || plan.cache_present)
    plan.tile = run.plan().tile;
  if (plan.order == FrameOrder::kDirectionBins)
    plan.direction_bin_bits = run.plan().direction_bin_bits;
  return run.scene().shared<std::vector<uint32_t>>(key_of(run, "frame order", plan), [&] {
    std::vector<uint32_t> order(gathers->queries.size());
    std::iota(order.begin(), order.end(), 0u);
    if (plan_hash(plan) == plan_hash(usual)) return order;
    std::unordered_map<uint64_t, uint32_t> numbers;
    for (const uint32_t i : order) numbers.emplace(name_of(plan, gathers->queries[i]), i);
    const std::vector<GatherQuery> made = made_by(run, plan);
    if (made.size() != order.size())
      throw std::logic_error("frames of two orders ask different numbers of final gathers");
    for (size_t i = 0; i < made.size(); ++i) order[i] = numbers.at(name_of(plan, made[i]));
    return order;
  });
}

std::vector<uint32_t> buffered_order(const Plan& plan, std::span<const GatherQuery> queries,
                                     std::span<const uint32_t> order) {
  const std::unique_ptr<ReorderBuffer> buffer = make_golden_reorder_pool(plan);
  std::vector<GatherQuery> in(order.size() + 1), out;
  for (size_t i = 0; i < order.size(); ++i) {
    in[i] = queries[order[i]];
    in[i].pixel = order[i];
  }
  in.back() = {};
  in.back().flush = 1;
  buffer->process(in, out);
  std::vector<uint32_t> served;
  served.reserve(order.size());
  for (const GatherQuery& query : out)
    if (!query.flush) served.push_back(query.pixel);
  return served;
}

std::vector<uint32_t> sorted_windows(const Plan& plan, const FrameGathers& gathers,
                                     std::span<const uint32_t> order, size_t packets) {
  std::vector<std::pair<uint64_t, uint32_t>> places(order.size());
  for (size_t i = 0; i < order.size(); ++i)
    places[i] = {hilbert_index(gathers.queries[order[i]].position, plan.position_bits), order[i]};
  for (size_t begin = 0; begin < places.size(); begin += packets) {
    const size_t end = std::min(places.size(), begin + packets);
    std::stable_sort(places.begin() + static_cast<std::ptrdiff_t>(begin),
                     places.begin() + static_cast<std::ptrdiff_t>(end),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
  }
  std::vector<uint32_t> served(places.size());
  for (size_t i = 0; i < places.size(); ++i) served[i] = places[i].second;
  return served;
}

}  // namespace photonloom
