// SPDX-License-Identifier: Apache-2.0
#include "study/traffic.hpp"

#include <fmt/core.h>

#include <functional>

#include "study/frame_gathers.hpp"

namespace photonloom {
namespace {

// Lines that an order fetches are asked for by many points.
uint64_t shared_lines(PointRun& run, const std::string& name, const Plan& order_plan,
                      const std::function<std::vector<uint32_t>(const FrameGathers&)>& make) {
  const Plan& plan = run.plan();
  const CacheShape shape = leaf_cache_shape(plan);
  const std::shared_ptr<const FrameGathers> gathers = frame_gathers(run);
  const std::string key = fmt::format(
      "lines fetched {} order {} {} tile {} {} of {} queries {} sets {} ways {} contexts {} lanes "
      "{} misses latency {} seed {}",
      name, static_cast<int>(order_plan.order), order_plan.direction_bin_bits, order_plan.tile,
      order_plan.batch_tiles, static_cast<const void*>(gathers.get()), shape.sets, shape.ways,
      plan.contexts, plan.lanes, plan.cache_misses, run.study().latency, run.seed());
  return *run.scene().shared<uint64_t>(key, [&] {
    return lines_fetched(shape, gathers->visits, make(*gathers), plan.contexts,
                         lookup_times(plan, run.study().latency));
  });
}

}  // namespace

std::vector<Column> traffic_columns() {
  return {{"bytes", "bytes", "fetched from the map a final gather, in the plan's order"},
          {"image_bytes", "bytes", "the same, an image"},
          {"gathers", "", "final gathers of an image"},
          {"lines", "lines", "read a gather, from cache or memory"},
          {"buffer_bytes", "bytes", "of packets that the reorder buffer holds"},
          {"naive", "bytes", "a gather, pixel order and no buffer"},
          {"window", "bytes", "a gather, tile order in sorted Hilbert windows of as many packets"},
          {"unlimited", "bytes", "a gather, the plan's key and drain over the whole image"},
          {"hilbert", "bytes", "a gather, Hilbert order over the whole image"},
          {"gain", "", "naive over bytes"},
          {"window_gain", "", "naive over window"},
          {"share", "", "hilbert over bytes: part of the gain of Hilbert order that is reached"}};
}

Measurement measure_traffic(PointRun& run) {
  Measurement m;
  const Plan& plan = run.plan();
  if (!plan.global.present || plan.gather_rays == 0 || plan.first_rays > 0) {
    m.values.assign(traffic_columns().size(), kNoValue);
    return m;
  }
  const std::shared_ptr<const FrameGathers> gathers = frame_gathers(run);
  const std::shared_ptr<const std::vector<uint32_t>> own = frame_order(run);
  const auto n = static_cast<double>(own->size());
  const bool is_buffered = plan.reorder_key != ReorderKey::kNone;
  Plan pixel = plan, tile = plan;
  pixel.order = FrameOrder::kPixel;
  tile.order = FrameOrder::kTile;
  tile.tile = Plan{}.tile;
  const auto made_as = [&](const Plan& p) {
    PointRun other(run.scene(), run.study(), p, run.seed(), run.work_dir());
    return frame_order(other);
  };
  const auto bytes = [&](uint64_t lines) {
    return static_cast<double>(lines) * plan.line_bytes() / n;
  };

  const double fetched =
      bytes(lines_fetched(leaf_cache_shape(plan), gathers->visits,
                          is_buffered ? buffered_order(plan, gathers->queries, *own) : *own,
                          plan.contexts, lookup_times(plan, run.study().latency)));
  const double naive = bytes(
      shared_lines(run, "as made", pixel, [&](const FrameGathers&) { return *made_as(pixel); }));
  const double hilbert = bytes(shared_lines(run, "Hilbert", tile, [&](const FrameGathers& g) {
    return sorted_windows(plan, g, *made_as(tile), own->size());
  }));
  double window = kNoValue, unlimited = kNoValue;
  if (is_buffered) {
    window = bytes(shared_lines(
        run, fmt::format("window {}", plan.reorder_packets), tile, [&](const FrameGathers& g) {
          return sorted_windows(plan, g, *made_as(tile), static_cast<size_t>(plan.reorder_packets));
        }));
    Plan whole = plan;
    whole.reorder_packets = static_cast<int>(own->size()) + 1;
    unlimited = bytes(shared_lines(
        run,
        fmt::format("unlimited {} {} {} {}", static_cast<int>(plan.reorder_key),
                    static_cast<int>(plan.reorder_drain), plan.reorder_bins,
                    plan.reorder_cell_bits),
        plan, [&](const FrameGathers& g) { return buffered_order(whole, g.queries, *own); }));
  }
  const double held = is_buffered ? static_cast<double>(plan.reorder_packets) : 0;
  m.values = {fetched,
              fetched * n,
              n,
              static_cast<double>(gathers->visits.total()) / n,
              held * kPacketBytes,
              naive,
              window,
              unlimited,
              hilbert,
              naive / fetched,
              naive / window,
              hilbert / fetched};
  return m;
}

std::string traffic_settings(const Study&, const StudyScene&) {
  return fmt::format("1 packet of {} bytes", kPacketBytes);
}

}  // namespace photonloom
