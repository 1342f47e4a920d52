// SPDX-License-Identifier: Apache-2.0
#include "study/layout_traffic.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>

#include "study/frame_gathers.hpp"
#include "study/photon_layouts.hpp"

namespace photonloom {
namespace {

constexpr int kCompressedLine = 80;  // bytes, of 8 photons
constexpr size_t kCompared = 64;     // every so many-th query's photons are compared

struct Traffic {
  double bytes = 0;        // a gather
  uint64_t different = 0;  // gathers that found other photons, of those compared
};

// `by_index`: photons have the map's numbers; else their distances alone are compared.
Traffic traffic_of(const Plan& plan, const PhotonMap& map, const PhotonLayout& layout,
                   const FrameGathers& gathers, std::span<const uint32_t> order, bool by_index) {
  CacheModel cache(cache_shape(plan, layout.line_bytes()));
  std::vector<uint32_t> lines;
  std::vector<Neighbour> found, expected;
  uint64_t fetched = 0, number = 0;
  Traffic traffic;
  for (const uint32_t query : order) {
    lines.clear();
    layout.gather(gathers.queries[query], found, lines);
    for (const uint32_t line : lines) fetched += !cache.read(line);
    if (number++ % kCompared != 0) continue;
    search_gather(plan, map, gathers.queries[query], expected);
    bool same = found.size() == expected.size();
    for (size_t i = 0; same && i < found.size(); ++i)
      same = found[i].d2 == expected[i].d2 && (!by_index || found[i].index == expected[i].index);
    traffic.different += !same;
  }
  traffic.bytes = static_cast<double>(fetched) * layout.line_bytes() /
                  static_cast<double>(std::max<size_t>(1, order.size()));
  return traffic;
}

}  // namespace

std::vector<Column> layout_columns() {
  return {{"padded", "bytes", "a gather, lines of 8 photons of 16 bytes"},
          {"plain", "bytes", "a gather, lines of 8 photons without padding"},
          {"plain16", "bytes", "a gather, lines of 16 photons without padding"},
          {"textbook", "bytes", "a gather, a kd-tree of a photon a node"},
          {"grid", "bytes", "a gather, a hash grid"},
          {"compressed", "bytes", "a gather, compressed lines of 8 photons in 80 bytes"},
          {"further", "", "further lines of compressed leaves over leaves"},
          {"to_plain", "", "compressed over plain"},
          {"to_textbook", "", "compressed over textbook"},
          {"different", "", "gathers whose photons differ between layouts, of one in 64"}};
}

Measurement measure_layouts(PointRun& run) {
  Measurement m;
  const Plan& plan = run.plan();
  if (!plan.global.present || plan.gather_rays == 0 || plan.first_rays > 0 || plan.bucket != 8) {
    m.values.assign(layout_columns().size(), kNoValue);
    return m;
  }
  const PhotonMap& map = run.map(false);
  const std::shared_ptr<const FrameGathers> gathers = frame_gathers(run);
  const std::shared_ptr<const std::vector<uint32_t>> made = frame_order(run);
  const std::vector<uint32_t> order = buffered_order(plan, gathers->queries, *made);
  const int bytes = (plan.photon_bits() + 7) / 8;
  Plan wide = plan;
  wide.bucket = 16;
  const PhotonMap wide_map =
      build_photon_map(std::span(map.slots).first(static_cast<size_t>(map.count)), wide);
  const bool has_radius = plan.global.r2_max < plan.r2_limit();

  const auto compressed = make_compressed_lines(plan, map, kCompressedLine);
  uint64_t different = 0;
  const auto bytes_of = [&](const PhotonLayout& layout, bool by_index) {
    const Traffic t = traffic_of(plan, map, layout, *gathers, order, by_index);
    different += t.different;
    return t.bytes;
  };
  const double padded = bytes_of(*make_plain_lines(plan, map, 16), true);
  const double plain = bytes_of(*make_plain_lines(plan, map, bytes), true);
  const double plain16 = bytes_of(*make_plain_lines(wide, wide_map, bytes), false);
  const double textbook = bytes_of(*make_textbook_tree(plan, map), true);
  const double grid = has_radius ? bytes_of(*make_hash_grid(plan, map), true) : kNoValue;
  const double small = bytes_of(*compressed, true);
  const double lines = static_cast<double>(map.lines);
  m.values = {padded,
              plain,
              plain16,
              textbook,
              grid,
              small,
              static_cast<double>(compressed->map_bytes()) / (kCompressedLine * lines) - 1,
              small / plain,
              small / textbook,
              static_cast<double>(different)};
  return m;
}

std::string layout_settings(const Study&, const StudyScene&) {
  return fmt::format("1 lines of {} bytes", kCompressedLine);
}

}  // namespace photonloom
