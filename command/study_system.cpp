// SPDX-License-Identifier: Apache-2.0
// What `photonloom study system` says: units, memory and area that the dissertation's load of 30
// frames a second would take, from measured cycles and bytes.
#include <fmt/core.h>

#include <cmath>
#include <string>

#include "command/study.hpp"

namespace photonloom {
namespace {

// Rays a second at 30 frames a second: J. Steinhurst, Practical Photon Mapping in Hardware (2007).
constexpr double kRaysPerSecond = 385e6;
constexpr double kClocks[] = {100e6, 1e9};
// The reorder buffer takes a packet a cycle (docs/reorder_buffer.md).
constexpr double kReorderCycles = 1;

// Whole units that so many cycles a second keep busy.
double units(double cycles_per_second, double clock) {
  return std::ceil(cycles_per_second / clock);
}

// How wide a gatherer is, and what else the point sets.
std::string ports(const StudyRow& row) {
  std::vector<std::string> told = {"gather.k", "gatherer.nodes_per_cycle",
                                   "gatherer.candidates_per_cycle", "gatherer.powers_per_cycle"};
  const auto is = [&](const char* nodes, const char* candidates, const char* powers) {
    return row.line("gatherer.nodes_per_cycle") == nodes &&
           row.line("gatherer.candidates_per_cycle") == candidates &&
           row.line("gatherer.powers_per_cycle") == powers;
  };
  std::string text;
  if (is("1", "1", "1")) {
    text = "one a cycle";
  } else if (is("2", "4", "4")) {
    text = "wide";
    // That of studies/system.toml, as wide as the RTL goes.
    if (row.line("gatherer.lanes") == "8" && row.line("gatherer.contexts") == "32") {
      told.emplace_back("gatherer.lanes");
      told.emplace_back("gatherer.contexts");
    }
  } else {
    text = fmt::format(
        "{} nodes, {} candidates, {} powers a cycle", row.line("gatherer.nodes_per_cycle"),
        row.line("gatherer.candidates_per_cycle"), row.line("gatherer.powers_per_cycle"));
  }
  return text + row.others(told);
}

}  // namespace

Conclusion conclude_system(const StudyOutcome& outcome) {
  Conclusion conclusion;
  for (const std::string& scene : outcome.scenes) {
    // Without final gather rays there are no gathers a ray.
    const auto rows = rows_with({"gather.cycles", "gather.bytes", "gather.table_cycles"},
                                Figures::kFinite, outcome.rows_of("system", scene), conclusion);
    if (rows.empty()) continue;
    conclusion.page += fmt::format(
        "### System on {}\n\n"
        "| k | ports | cycles a gather | bytes a gather | GB/s of photons | map, MB | at | "
        "gatherers | "
        "samplers | reorder buffers | LUT-eq of the gatherers |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|\n",
        scene);
    for (const StudyRow* row : rows) {
      const double rays_a_sample = row->number("frame.gather_rays");
      // A sample's table gather comes on top of its rays' gathers.
      const double gathers = kRaysPerSecond * (1 + 1 / rays_a_sample);
      const double samples = kRaysPerSecond / rays_a_sample;
      const double cycles = row->value("gather.cycles"), bytes = row->value("gather.bytes");
      for (const double clock : kClocks) {
        const double gatherers = units(gathers * cycles, clock);
        conclusion.page += fmt::format(
            "| {} | {} | {:.1f} | {:.0f} | {:.1f} | {:.1f} | {:g} MHz | {:.0f} | {:.0f} | {:.0f} | "
            "{:.2f} M |\n",
            row->line("gather.k"), ports(*row), cycles, bytes, gathers * bytes / 1e9,
            row->value("resources.map_bytes") / 1e6, clock / 1e6, gatherers,
            units(samples * row->value("gather.table_cycles"), clock),
            units(kRaysPerSecond * kReorderCycles, clock),
            gatherers * row->value("resources.gatherer_lut") / 1e6);
        ++conclusion.rows;
      }
    }
    conclusion.page += "\n";
  }
  return conclusion;
}

}  // namespace photonloom
