// SPDX-License-Identifier: Apache-2.0
// What `photonloom study caching` says: final gathers that an irradiance cache avoids, and the
// error it adds, over its accuracy. docs/irradiance_cache.md defines the words, docs/studies.md has
// the figures.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "command/study.hpp"

namespace photonloom {
namespace {

// Where the goals are judged, and what they allow.
const std::vector<std::string> kJudged = {"cornell", "atrium"};
constexpr double kAvoided = 0.6, kDifference = 1e-3, kAgainstPaths = 1.1;

double caching(const StudyRow& row, const char* column) {
  return row.value(std::string("caching.") + column);
}

bool is_uncached(const StudyRow& row) { return row.line("cache.present") == "false"; }

// What a row sets, the accuracy first.
std::string setting(const StudyRow& row) {
  std::string text = row.line("cache.accuracy", "0.1");
  for (const auto& [line, value] : row.lines)
    if (line != "cache.accuracy" && line.starts_with("cache."))
      text += fmt::format(", {} {}", line.substr(6), value);
  return text;
}

// Whether a point differs in its accuracy alone.
bool on_curve(const StudyRow& row) {
  return std::all_of(row.lines.begin(), row.lines.end(),
                     [](const auto& line) { return line.first == "cache.accuracy"; }) &&
         !row.lines.empty();
}

struct Block {
  std::string name, title;
  std::vector<const StudyRow*> rows;  // by accuracy
  std::function<double(const StudyRow&)> value;
};

// Adds avoided gathers, and error beside them, over the accuracy.
void plot(const std::string& scene, const std::vector<const StudyRow*>& counted,
          const std::vector<const StudyRow*>& converged, std::vector<Plot>& to) {
  const std::vector<Block> blocks = {
      {"avoided", "256 × 256: gathers avoided", counted,
       [](const StudyRow& r) { return caching(r, "avoided"); }},
      {"avoided64", "64 × 64: gathers avoided", converged,
       [](const StudyRow& r) { return caching(r, "avoided"); }},
      {"difference", "64 × 64, 1,024 rays: relMSE to the image without", converged,
       [](const StudyRow& r) { return caching(r, "relmse"); }}};
  std::string data, plots;
  for (const Block& b : blocks) {
    std::string lines;
    for (const StudyRow* row : b.rows)
      if (on_curve(*row))
        lines += fmt::format("{} {}\n", row->line("cache.accuracy"), b.value(*row));
    if (lines.empty()) continue;
    data += fmt::format("${} << EOD\n{}EOD\n", b.name, lines);
    plots += fmt::format("{}${} using 1:2 axes x1y{} with linespoints title \"{}\" noenhanced",
                         plots.empty() ? "plot " : ", ", b.name, b.name == "difference" ? 2 : 1,
                         b.title);
  }
  if (plots.empty()) return;
  to.push_back({"caching_" + scene,
                fmt::format("set logscale x 2\nset logscale y2 10\nset grid\nset ytics nomirror\n"
                            "set y2tics\nset yrange [0:1]\nset key outside bottom center\n"
                            "set xlabel \"accuracy\"\nset ylabel \"part of the gathers avoided\"\n"
                            "set y2label \"relMSE\"\nset format y2 \"%g\"\n"
                            "set title {} noenhanced\n{}{}\n",
                            gnuplot_text(scene + ": irradiance cache"), data, plots),
                900, 480});
}

}  // namespace

Conclusion conclude_caching(const StudyOutcome& outcome) {
  Conclusion conclusion;
  for (const std::string& scene : outcome.scenes) {
    const auto counted = outcome.rows_of("caching", scene),
               converged = outcome.rows_of("caching_converged", scene);
    if (counted.empty() && converged.empty()) continue;
    conclusion.page += fmt::format("### Cache on {}\n\n", scene);
    if (!counted.empty()) {
      conclusion.page +=
          "256 × 256, 16 rays a sample:\n\n| accuracy | gathers avoided | rays saved | most "
          "records of a tile | "
          "samples in full tiles |\n|---|---|---|---|---|\n";
      for (const StudyRow* row : counted)
        if (!row->lines.empty())
          conclusion.page +=
              fmt::format("| {} | {:.1f} % | {:.1f} % | {:.0f} | {:.0f} |\n", setting(*row),
                          100 * caching(*row, "avoided"), 100 * caching(*row, "rays_saved"),
                          caching(*row, "most_records"), caching(*row, "full"));
      conclusion.page += "\n";
    }
    const auto without = std::find_if(converged.begin(), converged.end(),
                                      [](const StudyRow* row) { return is_uncached(*row); });
    if (without != converged.end()) {
      const double paths = (*without)->value("visible.relmse");
      conclusion.page += fmt::format(
          "64 × 64, 1,024 rays a sample; without a cache the error against path tracing is "
          "{:.2e}:\n\n"
          "| accuracy | gathers avoided | relMSE to the image without | largest difference over "
          "the "
          "mean | error against path tracing | over that without |\n|---|---|---|---|---|---|\n",
          paths);
      double most = 0;
      std::string most_at = "none";
      for (const StudyRow* row : converged) {
        if (row->lines.empty() || is_uncached(*row)) continue;
        const double avoided = caching(*row, "avoided"), difference = caching(*row, "relmse"),
                     error = row->value("visible.relmse");
        conclusion.page +=
            fmt::format("| {} | {:.1f} % | {:.1e} | {:.2f} | {:.2e} | {:.3f} |\n", setting(*row),
                        100 * avoided, difference, caching(*row, "worst"), error, error / paths);
        if (difference <= kDifference && error <= kAgainstPaths * paths && avoided > most) {
          most = avoided;
          most_at = setting(*row);
        }
      }
      conclusion.page += "\n";
      if (std::find(kJudged.begin(), kJudged.end(), scene) != kJudged.end())
        conclusion.goals.push_back(
            {fmt::format(
                 "{}, 64 × 64: part of the gathers avoided with relMSE at most {:g} to the image "
                 "without and error at most {:g} of its (accuracy {})",
                 scene, kDifference, kAgainstPaths, most_at),
             kAvoided, most});
    }
    plot(scene, counted, converged, conclusion.plots);
  }
  return conclusion;
}

}  // namespace photonloom
