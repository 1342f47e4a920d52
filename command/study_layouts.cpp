// SPDX-License-Identifier: Apache-2.0
// What `photonloom study layouts` says: bytes a gather in each layout of the photon map.
#include <fmt/core.h>

#include <algorithm>
#include <string>
#include <vector>

#include "command/study.hpp"

namespace photonloom {

Conclusion conclude_layouts(const StudyOutcome& outcome) {
  struct Layout {
    const char *column, *name;
  };
  constexpr Layout kLayouts[] = {{"textbook", "textbook tree, a photon a node"},
                                 {"grid", "hash grid"},
                                 {"padded", "lines of 8, 16 bytes a photon"},
                                 {"plain16", "lines of 16, no padding"},
                                 {"plain", "lines of 8, no padding"},
                                 {"compressed", "compressed lines of 8 in 80 bytes"}};
  const auto others = [](const StudyRow& row) { return row.others({"gather.k"}); };
  const auto name = [&](const StudyRow& row) {
    return fmt::format("k = {}{}", row.line("gather.k"), others(row));
  };
  Conclusion conclusion;
  for (const std::string& scene : outcome.scenes) {
    std::vector<const StudyRow*> rows;
    for (const StudyRow& row : outcome.rows)
      if (row.scene == scene) rows.push_back(&row);
    rows = rows_with(
        {"layouts.plain", "layouts.compressed", "layouts.to_plain", "layouts.to_textbook"},
        Figures::kAboveZero, rows, conclusion);
    if (rows.empty()) continue;
    std::string head = "| bytes a gather (of plain lines of 8) |", rule = "|---|";
    for (const StudyRow* row : rows) {
      head += fmt::format(" {} |", name(*row));
      rule += "---|";
    }
    conclusion.page += fmt::format("### {}\n\n{}\n{}\n", scene, head, rule);
    // Curves over k are of points that differ in nothing else.
    std::vector<std::string> families;
    for (const StudyRow* row : rows)
      if (std::find(families.begin(), families.end(), others(*row)) == families.end())
        families.push_back(others(*row));
    std::string blocks, plots;
    for (const Layout& layout : kLayouts) {
      conclusion.page += fmt::format("| {} |", layout.name);
      for (const StudyRow* row : rows) {
        const double bytes = row->value(std::string("layouts.") + layout.column);
        conclusion.page +=
            fmt::format(" {:.1f} ({:.3f}) |", bytes, bytes / row->value("layouts.plain"));
      }
      conclusion.page += "\n";
      ++conclusion.rows;
      for (size_t f = 0; f < families.size(); ++f) {
        const std::string block = f == 0 ? layout.column : fmt::format("{}_{}", layout.column, f);
        blocks += fmt::format("${} << EOD\n", block);
        for (const StudyRow* row : rows)
          if (others(*row) == families[f])
            blocks += fmt::format("{} {}\n", row->line("gather.k"),
                                  row->value(std::string("layouts.") + layout.column));
        blocks += "EOD\n";
        plots += fmt::format("{}${} using 1:2 with linespoints title {} noenhanced",
                             plots.empty() ? "plot " : ", ", block,
                             gnuplot_text(layout.name + families[f]));
      }
    }
    conclusion.page += "| further lines of compressed leaves, of the leaves |";
    for (const StudyRow* row : rows)
      conclusion.page += fmt::format(" {:.1f} % |", 100 * row->value("layouts.further"));
    conclusion.page += "\n\n";
    conclusion.plots.push_back(
        {"layouts_" + scene,
         fmt::format("set logscale xy 2\nset grid\nset key outside right top\n"
                     "set xlabel \"k\"\nset ylabel \"bytes a gather\"\n"
                     "set format y \"%g\"\nset format x \"%g\"\n"
                     "set title {} noenhanced\n{}{}\n",
                     gnuplot_text(scene + ": layouts of the photon map"), blocks, plots),
         900, 420});
    for (const StudyRow* row : rows) {
      const std::string what = fmt::format("{}, {}: ", scene, name(*row));
      conclusion.goals.push_back({what + "compressed over plain lines without padding", 0.85,
                                  row->value("layouts.to_plain"), false});
      conclusion.goals.push_back({what + "compressed over the textbook tree", 0.6,
                                  row->value("layouts.to_textbook"), false});
      conclusion.goals.push_back(
          {what + "gathers that found other photons", 0, row->value("layouts.different"), false});
    }
  }
  return conclusion;
}

}  // namespace photonloom
