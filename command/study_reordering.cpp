// SPDX-License-Identifier: Apache-2.0
// What `photonloom study reordering` says: bytes of an image, gain over naive order, share of the
// gain of Hilbert order, for every order, buffer and cache. docs/studies.md has the figures.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "command/study.hpp"

namespace photonloom {
namespace {

constexpr double kSetCache = 131072;  // of the published setting
constexpr double kWholeImage = 1e18;  // as a buffer

// A figure of an order with a buffer and a cache.
struct Cell {
  std::string scene, order;
  int tile = 0;                  // its edge in pixels
  double buffer = 0, cache = 0;  // bytes
  double bytes = 0, gathers = 0;
  double gain = 0, share = 0;
  double image_mb() const { return bytes * gathers / 1e6; }
};

// Lines that the order's name, the buffer and the cache hold.
const std::vector<std::string> kTold = {"frame.order",   "frame.tile",      "reorder.key",
                                        "reorder.drain", "reorder.packets", "gatherer.cache_bytes"};
constexpr int kTile = 16;  // unless a name says otherwise

std::string order_name(const StudyRow& row) {
  const std::string &order = row.line("frame.order"), &key = row.line("reorder.key");
  std::string name = order == "direction_bins" ? "direction bins" : order;
  if (const std::string& tile = row.line("frame.tile"); tile != std::to_string(kTile))
    name += fmt::format(" of {0} × {0}", tile);
  if (key == "none") return (name == "pixel" ? "pixel (naive)" : name) + row.others(kTold);
  return fmt::format("{}, {} {}{}", name, key == "hash" ? "hashed," : "Hilbert bins,",
                     row.line("reorder.drain"), row.others(kTold));
}

// The order of the measure's windows, which are of tiles of 16 x 16 and have no bins.
std::string windows_name(const StudyRow& row) {
  std::vector<std::string> told = kTold;
  told.insert(told.end(), {"reorder.bins", "reorder.cell_bits", "frame.direction_bin_bits"});
  return "tile, sorted Hilbert windows" + row.others(told);
}

std::vector<Cell> cells_of(const StudyOutcome& outcome, const std::string& scene,
                           Conclusion& conclusion) {
  std::vector<Cell> cells;
  const auto known = [&](const Cell& c) {
    return std::any_of(cells.begin(), cells.end(), [&](const Cell& other) {
      return other.order == c.order && other.buffer == c.buffer && other.cache == c.cache;
    });
  };
  std::vector<const StudyRow*> rows;
  for (const StudyRow& row : outcome.rows)
    if (row.scene == scene) rows.push_back(&row);
  for (const StudyRow* row :
       rows_with({"traffic.bytes", "traffic.naive"}, Figures::kAboveZero, rows, conclusion)) {
    const auto value = [&](const char* name) { return row->value(std::string("traffic.") + name); };
    const Cell c{scene,
                 "",
                 0,
                 value("buffer_bytes"),
                 row->number("gatherer.cache_bytes"),
                 0,
                 value("gathers"),
                 0,
                 0};
    const auto add = [&](const std::string& order, int tile, double buffer, double bytes) {
      Cell more = c;
      more.order = order;
      more.tile = tile;
      more.buffer = buffer;
      more.bytes = bytes;
      more.gain = value("naive") / bytes;
      more.share = value("hilbert") / bytes;
      if (std::isfinite(bytes) && !known(more)) cells.push_back(more);
    };
    const int tile = static_cast<int>(row->number("frame.tile"));
    add(order_name(*row), tile, c.buffer, value("bytes"));
    add(order_name(*row), tile, kWholeImage, value("unlimited"));
    add(windows_name(*row), kTile, c.buffer, value("window"));
    add(windows_name(*row), kTile, kWholeImage, value("hilbert"));
  }
  return cells;
}

std::string size_text(double bytes) {
  if (bytes == 0) return "none";
  if (bytes == kWholeImage) return "whole image";
  return bytes >= 1048576 ? fmt::format("{:g} MB", bytes / 1048576)
                          : fmt::format("{:g} KB", bytes / 1024);
}

template <class Get>
auto sorted(const std::vector<Cell>& cells, const Get& get) {
  std::set<std::decay_t<decltype(get(cells.front()))>> all;
  for (const Cell& c : cells) all.insert(get(c));
  return all;
}

std::vector<std::string> orders_of(const std::vector<Cell>& cells) {
  std::vector<std::string> names;
  for (const Cell& c : cells)
    if (std::find(names.begin(), names.end(), c.order) == names.end()) names.push_back(c.order);
  return names;
}

std::string table(const std::vector<Cell>& cells, const std::string& title,
                  const std::string& rows_are, const std::function<double(const Cell&)>& column,
                  const std::function<std::string(const Cell&)>& text) {
  const std::set<double> columns = sorted(cells, column);
  std::string page = title + "\n\n| " + rows_are + " |", rule = "|---|";
  for (const double x : columns) {
    page += " " + size_text(x) + " |";
    rule += "---|";
  }
  page += "\n" + rule + "\n";
  for (const std::string& order : orders_of(cells)) {
    page += "| " + order + " |";
    for (const double x : columns) {
      const auto at = std::find_if(cells.begin(), cells.end(), [&](const Cell& c) {
        return c.order == order && column(c) == x;
      });
      page += at == cells.end() ? " |" : " " + text(*at) + " |";
    }
    page += "\n";
  }
  return page + "\n";
}

template <class Keep>
std::vector<Cell> where(const std::vector<Cell>& cells, const Keep& keep) {
  std::vector<Cell> kept;
  std::copy_if(cells.begin(), cells.end(), std::back_inserter(kept), keep);
  return kept;
}

Plot plot(const std::string& scene, const std::vector<Cell>& cells) {
  std::string commands =
      "set logscale xy 2\nset grid\nset key outside right top noenhanced\n"
      "set xlabel \"cache, KB\"\nset ylabel \"MB from the photon map an image\"\n"
      "set format y \"%g\"\nset format x \"%g\"\n";
  const std::set<double> buffers = sorted(cells, [](const Cell& c) { return c.buffer; });
  commands += fmt::format("set multiplot layout {},1 title {} noenhanced\n", buffers.size(),
                          gnuplot_text(scene + ": bytes from the photon map"));
  for (const double buffer : buffers) {
    const std::vector<Cell> here = where(cells, [&](const Cell& c) { return c.buffer == buffer; });
    std::string plots;
    int block = 0;
    for (const std::string& order : orders_of(here)) {
      const std::string name =
          fmt::format("$b{}_{}", static_cast<int>(std::log2(buffer + 1)), block++);
      commands += name + " << EOD\n";
      for (const Cell& c : here)
        if (c.order == order) commands += fmt::format("{} {}\n", c.cache / 1024, c.image_mb());
      commands += "EOD\n";
      plots += fmt::format("{}{} using 1:2 with linespoints title {} noenhanced",
                           plots.empty() ? "plot " : ", ", name, gnuplot_text(order));
    }
    commands += fmt::format("set title \"buffer: {}\"\n{}\n", size_text(buffer), plots);
  }
  return {"reordering_" + scene, commands + "unset multiplot\n", 900,
          static_cast<int>(320 * buffers.size())};
}

}  // namespace

Conclusion conclude_reordering(const StudyOutcome& outcome) {
  Conclusion conclusion;
  for (const std::string& scene : outcome.scenes) {
    const std::vector<Cell> cells = cells_of(outcome, scene, conclusion);
    if (cells.empty()) continue;
    const std::vector<Cell> set = where(cells, [](const Cell& c) { return c.cache == kSetCache; });
    conclusion.rows += orders_of(cells).size();
    conclusion.page += fmt::format("### {}\n\n", scene);
    if (!set.empty())
      conclusion.page += table(
          set,
          "Gain over naive order (share of the gain of Hilbert order over the image), "
          "cache 128 KB:",
          "order, by buffer", [](const Cell& c) { return c.buffer; },
          [](const Cell& c) { return fmt::format("{:.2f}× ({:.1f} %)", c.gain, 100 * c.share); });
    for (const double buffer : sorted(cells, [](const Cell& c) { return c.buffer; }))
      conclusion.page += table(
          where(cells, [&](const Cell& c) { return c.buffer == buffer; }),
          fmt::format("MB an image, buffer {}:", size_text(buffer)), "order, by cache",
          [](const Cell& c) { return c.cache; },
          [](const Cell& c) { return fmt::format("{:.1f}", c.image_mb()); });
    conclusion.plots.push_back(plot(scene, cells));
    if (scene == "atrium")
      for (const auto& [limit, wanted] : {std::pair{1048576.0, 30.0}, std::pair{262144.0, 11.5}}) {
        for (const bool any_tile : {false, true}) {
          const Cell* best = nullptr;
          for (const Cell& c : set)
            if (c.buffer <= limit && (any_tile || c.tile == kTile) &&
                (!best || c.gain > best->gain))
              best = &c;
          if (best)
            conclusion.goals.push_back(
                {fmt::format(
                     "{}, at most {} of packets, tiles {}: gain over naive order ({}; {:.1f} "
                     "% of the gain of Hilbert order)",
                     scene, size_text(limit), any_tile ? "of any size" : "of 16 × 16", best->order,
                     100 * best->share),
                 wanted, best->gain});
        }
      }
  }
  return conclusion;
}

}  // namespace photonloom
