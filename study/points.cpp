// SPDX-License-Identifier: Apache-2.0
#include "study/points.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "golden/numeric/random.hpp"

namespace photonloom {
namespace {

std::vector<LineValues> grid(const std::vector<LineChoice>& choices) {
  std::vector<LineValues> points{{}};
  for (const LineChoice& c : choices) {
    std::vector<LineValues> longer;
    for (const LineValues& p : points)
      for (const std::string& value : c.values) {
        longer.push_back(p);
        longer.back().emplace_back(c.line, value);
      }
    points = std::move(longer);
  }
  return points;
}

}  // namespace

std::string value_at(const LineChoice& c, double u) {
  if (!c.values.empty()) {
    const auto n = static_cast<double>(c.values.size());
    return c.values[static_cast<size_t>(std::min(n - 1, std::floor(u * n)))];
  }
  // A whole number stands for the half open interval around it.
  const double from = c.whole ? c.from - 0.5 : c.from, to = c.whole ? c.to + 0.5 : c.to;
  const double x = c.logarithmic ? from * std::pow(to / from, u) : from + u * (to - from);
  if (c.whole)
    return fmt::format("{}", static_cast<int64_t>(std::clamp(std::round(x), c.from, c.to)));
  // Six digits are more than a study can tell apart, and read well.
  std::string text = fmt::format("{:.6g}", std::clamp(x, c.from, c.to));
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::vector<LineValues> latin_hypercube(const std::vector<LineChoice>& choices, int count,
                                        uint64_t seed) {
  std::vector<LineValues> points(static_cast<size_t>(count));
  for (size_t d = 0; d < choices.size(); ++d) {
    const auto random = [&](size_t i, uint64_t dimension) {
      return hash_bits(seed, i, d, dimension);
    };
    std::vector<size_t> part(points.size());
    std::iota(part.begin(), part.end(), size_t{0});
    std::sort(part.begin(), part.end(), [&](size_t a, size_t b) {
      return std::make_pair(random(a, 0), a) < std::make_pair(random(b, 0), b);
    });
    for (size_t i = 0; i < points.size(); ++i)
      points[i].emplace_back(choices[d].line, value_at(choices[d], (static_cast<double>(part[i]) +
                                                                    to_unit(random(i, 1))) /
                                                                       static_cast<double>(count)));
  }
  return points;
}

int baseline_seeds(const Study& study, size_t scene) {
  int most = 0;
  for (const PointSet& set : study.sets) {
    if (!set.has_scene(scene)) continue;
    if (set.seeds == 0) return 0;
    most = std::max(most, set.seeds);
  }
  return most;
}

std::vector<Point> fixed_points(const Study& study, size_t scene) {
  std::vector<Point> points{{.number = 0,
                             .scene = scene,
                             .lines = {},
                             .seeds = baseline_seeds(study, scene),
                             .origin = "baseline"}};
  for (const PointSet& set : study.sets) {
    if (!set.has_scene(scene)) continue;
    const auto add = [&](const std::vector<LineValues>& all, const std::string& origin) {
      for (const LineValues& lines : all)
        points.push_back({static_cast<uint32_t>(points.size()), scene, lines, set.seeds, origin});
    };
    if (set.strategy == Strategy::kList) add(set.list, "list");
    if (set.strategy == Strategy::kGrid) add(grid(set.choices), "grid");
    if (set.strategy == Strategy::kLatinHypercube)
      add(latin_hypercube(set.choices, set.count, set.seed),
          fmt::format("latin_hypercube seed {}", set.seed));
  }
  return points;
}

std::span<const uint64_t> seeds_of(const Point& point, const std::vector<uint64_t>& seeds) {
  const auto count = static_cast<size_t>(point.seeds);
  return std::span(seeds).first(count == 0 ? seeds.size() : std::min(count, seeds.size()));
}

uint32_t points_of_scene(const Study& study, size_t scene, bool with_searches) {
  uint64_t points = 1;  // the baseline
  for (const PointSet& set : study.sets)
    if (set.has_scene(scene) && (with_searches || set.strategy != Strategy::kSearch))
      points += set.points();
  return static_cast<uint32_t>(points);
}

}  // namespace photonloom
