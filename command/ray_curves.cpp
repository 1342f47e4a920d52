// SPDX-License-Identifier: Apache-2.0
#include "command/ray_curves.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace photonloom {
namespace {

// How far a curve is continued with its last points' power, times the most rays of them.
constexpr double kFurther = 1.25;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

}  // namespace

std::string asked_rays(const StudyRow& row, const RayKind& kind) {
  return row.line(row.line(kind.first) == "0" ? kind.fixed : kind.mean);
}

RayCurve::RayCurve(std::string name, const std::vector<const StudyRow*>& rows, const RayKind& kind)
    : name_(std::move(name)) {
  const std::string measure = kind.measure;
  for (const StudyRow* row : rows) {
    const Point p{std::stod(asked_rays(*row, kind)), row->value(measure + "." + kind.rays),
                  row->value(measure + ".relmse"), row->error(measure + ".relmse")};
    if (p.rays > 0 && p.noise > 0) points_.push_back(p);
  }
  std::sort(points_.begin(), points_.end(),
            [](const Point& a, const Point& b) { return a.rays < b.rays; });
}

std::string text_of(const RayPart& part) {
  if (std::isnan(part.value)) return "–";  // no such plan in this scene
  if (part.beyond != 0) return fmt::format("{} {:.2g}", part.beyond > 0 ? ">" : "<", part.value);
  return fmt::format("{:.2f} ± {:.2f}", part.value, part.error);
}

RayPart RayCurve::part_of(const RayCurve& base, double rays) const {
  const auto at = std::find_if(base.points_.begin(), base.points_.end(),
                               [&](const Point& p) { return p.asked == rays; });
  if (at == base.points_.end() || points_.size() < 2) return {kNone, kNone, 0};
  const auto relative = [](const Point& p) { return p.error / p.noise; };
  if (this == &base) return {1, 0, 0};
  if (at->noise > points_.front().noise) return {points_.front().rays / at->rays, 0, -1};
  size_t i = 1;
  while (i + 1 < points_.size() && points_[i].noise > at->noise) ++i;
  const Point &a = points_[i - 1], &b = points_[i];
  const double power = std::log(b.noise / a.noise) / std::log(b.rays / a.rays);
  const double part = a.rays * std::pow(at->noise / a.noise, 1 / power) / at->rays;
  const double most = points_.back().rays / at->rays;
  if (at->noise < points_.back().noise && !(power < 0 && part <= kFurther * most))
    return {most, 0, 1};
  const Point& near =
      std::fabs(std::log(a.noise / at->noise)) < std::fabs(std::log(b.noise / at->noise)) ? a : b;
  return {part, part * std::hypot(relative(near), relative(*at)) / std::fabs(power), 0};
}

std::string RayCurve::data() const {
  std::string lines;
  for (const Point& p : points_) lines += fmt::format("{} {} {}\n", p.rays, p.noise, p.error);
  return lines;
}

Plot plot_curves(const std::string& name, const std::string& title, const RayKind& kind,
                 const std::vector<RayCurve>& curves) {
  std::string blocks, plots;
  for (size_t i = 0; i < curves.size(); ++i) {
    blocks += fmt::format("$c{} << EOD\n{}EOD\n", i, curves[i].data());
    plots += fmt::format("{}$c{} using 1:2:3 with yerrorlines title {} noenhanced",
                         i == 0 ? "plot " : ", ", i, gnuplot_text(curves[i].name()));
  }
  return {name,
          fmt::format("set logscale xy 2\nset grid\nset key outside right top\n"
                      "set xlabel \"{} a sample\"\n"
                      "set ylabel \"noise (relMSE)\"\nset format y \"%.2g\"\n"
                      "set title {} noenhanced\n{}{}\n",
                      kind.name, gnuplot_text(title), blocks, plots),
          900, 420};
}

}  // namespace photonloom
