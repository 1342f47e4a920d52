// SPDX-License-Identifier: Apache-2.0
#include "rtl/generate/readme.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <set>

#include "golden/packet/layout.hpp"
#include "golden/plan/plan_file.hpp"
#include "golden/plan/units.hpp"
#include "golden/planner/resources.hpp"
#include "rtl/generate/chip.hpp"
#include "rtl/generate/fill.hpp"
#include "rtl/generate/package.hpp"
#include "rtl/generate/tables.hpp"

namespace photonloom {
namespace {

std::string port_table(const std::vector<DescribedPort>& ports) {
  std::string text = "| port | direction | type | meaning |\n|---|---|---|---|\n";
  for (const DescribedPort& p : ports)
    text += fmt::format("| `{}` | {} | `{}` | {} |\n", p.name, p.output ? "out" : "in", p.type,
                        p.meaning);
  return text;
}

// Bits of memory and multipliers that follow from the plan, a row each.
std::string budget_table(const Plan& plan, const std::vector<std::string>& units) {
  std::string text = "| what | size |\n|---|---|\n";
  const auto row = [&](const std::string& what, const std::string& size) {
    text += fmt::format("| {} | {} |\n", what, size);
  };
  if (has_unit(units, unit_name<PhotonGatherer>)) {
    const uint64_t nodes = plan.lines(plan.global) + plan.lines(plan.caustic);
    const int line = plan.bucket * plan.photon_bytes;
    const uint64_t lines = plan.memory_lines(plan.global) + plan.memory_lines(plan.caustic);
    row("external line memory", fmt::format("{} lines of {} bytes = {} bytes", lines, line,
                                            lines * static_cast<uint64_t>(line)));
    row("node memory", fmt::format("{} x {} bits", nodes, plan.position_bits + 2));
    row("leaf cache", plan.cache_bytes == 0
                          ? std::string("none")
                          : fmt::format("{} bytes, {} ways", plan.cache_bytes, plan.cache_ways));
    row("candidate lists", fmt::format("{} contexts x {} entries x {} bits of (d2, index)",
                                       plan.contexts, plan.k, plan.r2_bits() + plan.index_bits()));
    row("distance lanes",
        fmt::format("{} x 3 squares of {} bits", plan.lanes, plan.position_bits + 1));
    row("flux accumulators", fmt::format("{} channels x {} bits", plan.channels, plan.flux_bits()));
  }
  if (has_unit(units, unit_name<ReorderBuffer>)) {
    row("reorder pool", fmt::format("{} packets x {} bits", plan.reorder_packets,
                                    PacketLayout::of<GatherQuery>(plan).bits()));
    row("reorder links and bins",
        fmt::format("{} links, {} heads and tails of {} bits", plan.reorder_packets,
                    plan.reorder_bins,
                    std::max(1, clog2(static_cast<uint64_t>(plan.reorder_packets)))));
  }
  if (has_unit(units, unit_name<CdfSampler>))
    row("sampler tables",
        fmt::format("2 x {} cells x {} bits", 1 << plan.cell_index_bits(), plan.total_bits()));
  return text;
}

// What the units will take of an LFE5U, a row each.
std::string resource_table(const Plan& plan, const std::vector<std::string>& units, bool board) {
  std::string text =
      "| unit, on an LFE5U | LUT-equivalents | flip-flops | MULT18X18D | DP16KD |\n"
      "|---|---|---|---|---|\n";
  for (const std::string& unit : units) {
    if (!is_predicted(unit)) continue;
    const UnitResources r = estimate_resources(plan, unit);
    const bool several = board && unit == unit_name<PhotonGatherer> && plan.gatherers > 1;
    text += fmt::format("| `{}`{} | {:.0f} | {:.0f} | {:.0f} | {:.0f} |\n", unit,
                        several ? fmt::format(", each of {}", plan.gatherers) : std::string(),
                        r.lut, r.ff, r.dsp, r.ebr);
  }
  if (board) {
    const BoardMemories b = board_memories(plan);
    const auto row = [&](const std::string& what, int blocks) {
      text += fmt::format("| {} | | | | {} |\n", what, blocks);
    };
    row(plan.photon_memory == PhotonMemory::kSdram ? "cache before the SDRAM" : "photon memory",
        b.photons);
    row("replayer, link", b.replayer + b.link);
    if (plan.shared_nodes) row("node memories shared, not one each", b.shared_nodes);
    row("all of the top", b.total());
  }
  return text;
}

}  // namespace

std::string write_readme(const PackageReadme& r) {
  std::string packet_tables, units, constants = "| constant | value | meaning |\n|---|---|---|\n";
  for (const std::string& name : packet_names())
    if (r.whole_board || std::any_of(r.ports.begin(), r.ports.end(), [&](const DescribedPort& p) {
          return p.type == "photonloom_pkg::" + name + "_t";
        }))
      packet_tables += packet_table(r.plan, name) + "\n";
  for (const PackageConstant& c : package_constants(r.plan))
    constants += fmt::format("| `{}` | {} | {} |\n", c.name, c.value, c.meaning);
  for (const std::string& unit : r.units) units += fmt::format(" `{}`", unit);
  return fill_template(
      "README.md",
      {{"TOP", r.top},
       {"PLAN", plan_hash_text(r.plan)},
       {"UNITS", units},
       {"LINT", fmt::format("verilator --lint-only -Wall --top-module {}{} -f files.f", r.top,
                            r.lint_options)},
       {"SYNTHESIS", r.board.empty() ? fill_template("synthesis.md", {{"TOP", r.top}}) : ""},
       {"BOARD", r.board},
       {"PORTS_OF", r.ports_of.empty() ? "" : fmt::format(" of `{}`", r.ports_of)},
       {"PORTS", port_table(r.ports)},
       {"PACKETS", packet_tables},
       {"BUDGET", budget_table(r.plan, r.units)},
       {"RESOURCES", resource_table(r.plan, r.units, r.whole_board)},
       {"CONSTANTS", constants}});
}

}  // namespace photonloom
