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
  std::string text = row.line("cache.accuracy");
  for (const auto& [line, value] : row.lines)
    if (line != "cache.accuracy")
      text += fmt::format(", {} {}", line.starts_with("cache.") ? line.substr(6) : line, value);
  return text;
}

// "1024" as "1,024".
std::string grouped(std::string digits) {
  for (size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, ",");
  return digits;
}

// "256 × 256, 16 rays a sample": of a table's rows, whose names hold what they differ in.
std::string measured(const std::vector<const StudyRow*>& rows) {
  const auto same = [&](const char* line) {
    return std::all_of(rows.begin(), rows.end(), [&](const StudyRow* row) {
      return row->line(line) == rows.front()->line(line);
    });
  };
  std::string text = rows.front()->size();
  if (same("frame.gather_rays"))
    text += fmt::format(", {} rays a sample", grouped(rows.front()->line("frame.gather_rays")));
  if (same("frame.spp") && rows.front()->line("frame.spp") != "1")
    text += fmt::format(", {} samples a pixel", grouped(rows.front()->line("frame.spp")));
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
  const auto size = [](const std::vector<const StudyRow*>& rows) {
    return rows.empty() ? "" : rows.front()->size();
  };
  const std::vector<Block> blocks = {
      {"avoided", size(counted) + ": gathers avoided", counted,
       [](const StudyRow& r) { return caching(r, "avoided"); }},
      {"avoided64", size(converged) + ": gathers avoided", converged,
       [](const StudyRow& r) { return caching(r, "avoided"); }},
      {"difference",
       converged.empty() ? ""
                         : fmt::format("{}, {} rays: relMSE to the image without", size(converged),
                                       grouped(converged.front()->line("frame.gather_rays"))),
       converged, [](const StudyRow& r) { return caching(r, "relmse"); }}};
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
    const auto counted = rows_with({"caching.avoided", "caching.rays_saved"}, Figures::kFinite,
                                   outcome.rows_of("caching", scene), conclusion);
    // An image without a cache has an error alone.
    const auto images = outcome.rows_of("caching_converged", scene);
    const auto without = std::find_if(images.begin(), images.end(), [](const StudyRow* row) {
      return is_uncached(*row) && std::isfinite(row->value("visible.relmse"));
    });
    std::vector<const StudyRow*> cached;
    std::copy_if(images.begin(), images.end(), std::back_inserter(cached),
                 [](const StudyRow* row) { return !is_uncached(*row); });
    const auto converged = rows_with({"caching.avoided", "caching.relmse", "visible.relmse"},
                                     Figures::kFinite, cached, conclusion);
    if (!converged.empty() && without == images.end())
      conclusion.left_out.push_back(
          fmt::format("study caching_converged, scene {}: its table is left out, no point has the "
                      "error without a cache; expected one with cache.present = false",
                      scene));
    if (counted.empty() && converged.empty()) continue;
    conclusion.page += fmt::format("### Cache on {}\n\n", scene);
    if (!counted.empty()) {
      conclusion.page +=
          measured(counted) +
          ":\n\n| accuracy | gathers avoided | rays saved | most records of a tile | "
          "samples in full tiles |\n|---|---|---|---|---|\n";
      for (const StudyRow* row : counted)
        conclusion.page +=
            fmt::format("| {} | {:.1f} % | {:.1f} % | {:.0f} | {:.0f} |\n", setting(*row),
                        100 * caching(*row, "avoided"), 100 * caching(*row, "rays_saved"),
                        caching(*row, "most_records"), caching(*row, "full"));
      conclusion.page += "\n";
    }
    conclusion.rows += counted.size();
    if (!converged.empty() && without != images.end()) {
      conclusion.rows += converged.size();
      const double paths = (*without)->value("visible.relmse");
      conclusion.page += fmt::format(
          "{}; without a cache the error against path tracing is {:.2e}:\n\n"
          "| accuracy | gathers avoided | relMSE to the image without | largest difference over "
          "the mean | error against path tracing | over that without |\n"
          "|---|---|---|---|---|---|\n",
          measured(converged), paths);
      double most = 0;
      std::string most_at = "none";
      for (const StudyRow* row : converged) {
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
                 "{}, {}: part of the gathers avoided with relMSE at most {:g} to the image "
                 "without and error at most {:g} of its (accuracy {})",
                 scene, converged.front()->size(), kDifference, kAgainstPaths, most_at),
             kAvoided, most});
    }
    plot(scene, counted, converged, conclusion.plots);
  }
  return conclusion;
}

}  // namespace photonloom
