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

bool is_wide(const StudyRow& row) { return !row.line("gatherer.nodes_per_cycle").empty(); }

}  // namespace

Conclusion conclude_system(const StudyOutcome& outcome) {
  Conclusion conclusion;
  for (const std::string& scene : outcome.scenes) {
    conclusion.page += fmt::format(
        "### System on {}\n\n"
        "| k | ports | cycles a gather | bytes a gather | GB/s of photons | map, MB | at | "
        "gatherers | "
        "samplers | reorder buffers | LUT-eq of the gatherers |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|\n",
        scene);
    for (const StudyRow* row : outcome.rows_of("system", scene)) {
      if (row->line("gather.k").empty()) continue;
      const double rays_a_sample = std::stod(row->line("frame.gather_rays", "16"));
      // A sample's table gather comes on top of its rays' gathers.
      const double gathers = kRaysPerSecond * (1 + 1 / rays_a_sample);
      const double samples = kRaysPerSecond / rays_a_sample;
      const double cycles = row->value("gather.cycles"), bytes = row->value("gather.bytes");
      for (const double clock : kClocks) {
        const double gatherers = units(gathers * cycles, clock);
        conclusion.page += fmt::format(
            "| {} | {} | {:.1f} | {:.0f} | {:.1f} | {:.1f} | {:g} MHz | {:.0f} | {:.0f} | {:.0f} | "
            "{:.2f} M |\n",
            row->line("gather.k"), is_wide(*row) ? "wide" : "one a cycle", cycles, bytes,
            gathers * bytes / 1e9, row->value("resources.map_bytes") / 1e6, clock / 1e6, gatherers,
            units(samples * row->value("gather.table_cycles"), clock),
            units(kRaysPerSecond * kReorderCycles, clock),
            gatherers * row->value("resources.gatherer_lut") / 1e6);
      }
    }
    conclusion.page += "\n";
  }
  return conclusion;
}

}  // namespace photonloom
