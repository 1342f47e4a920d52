// SPDX-License-Identifier: Apache-2.0
#include "rtl/generate/chip.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <stdexcept>

#include "golden/plan/plan_file.hpp"
#include "golden/plan/units.hpp"
#include "rtl/generate/fill.hpp"
#include "rtl/generate/hardware.hpp"
#include "rtl/generate/sources.hpp"

namespace photonloom {

bool has_unit(const std::vector<std::string>& units, const std::string& unit) {
  return std::find(units.begin(), units.end(), unit) != units.end();
}

namespace {

// The chip wires the one before the other.
const std::string kReorder = unit_name<ReorderBuffer>, kGatherer = unit_name<PhotonGatherer>;

bool of_stream(const std::string& port, const std::string& stream, bool unit_gives) {
  const char* forward = unit_gives ? "_o" : "_i";
  const char* back = unit_gives ? "_i" : "_o";
  return port == stream + "_valid" + forward || port == stream + forward ||
         port == stream + "_ready" + back;
}

// Streams that the chip wires inside, by unit.
bool is_inner(const std::string& unit, const std::string& port, bool reordered) {
  if (unit == kReorder) return of_stream(port, "in", false) || of_stream(port, "out", true);
  return unit == kGatherer && of_stream(port, "in", false) && reordered;
}

// How a unit's port is called on the chip.
std::string chip_port(const std::string& unit, const std::string& port) {
  if (port == "clk_i" || port == "rst_i") return port;
  const std::string prefix = find_unit(unit).chip_prefix;
  if (!prefix.empty()) return prefix + port;
  if (unit == kGatherer && port.starts_with("in_")) return "query_" + port.substr(3);
  if (port.starts_with("count_")) return unit + "_" + port;
  return port;
}

// What the chip's instance of a unit has at a port.
std::string chip_wire(const std::string& unit, const std::string& port, bool reordered) {
  if (!is_inner(unit, port, reordered)) return chip_port(unit, port);
  if (unit == kReorder && port == "in_i") return "query_i";
  return (unit == kGatherer ? "gather_" : "reorder_") + port.substr(0, port.size() - 2);
}

}  // namespace

std::vector<DescribedPort> described_ports(const std::string& rtl_dir, const std::string& module) {
  std::vector<DescribedPort> ports;
  for (const ModulePort& p : module_ports(rtl_dir, module)) {
    if (is_shared(p)) continue;
    if (p.meaning.empty())
      throw std::runtime_error(
          fmt::format("{}/{}: nothing says what the port {} means, expected a comment behind it",
                      rtl_dir, module_files(rtl_dir, module).back(), p.name));
    ports.push_back({p.output, package_type(p.type, module), p.name, p.meaning});
  }
  return ports;
}

std::vector<DescribedPort> chip_ports(const Plan& plan, const std::string& rtl_dir) {
  const std::vector<std::string> units = units_present(plan);
  const bool reordered = has_unit(units, kReorder);
  std::vector<DescribedPort> ports;
  const auto add = [&](const std::string& unit, DescribedPort p) {
    p.name = chip_port(unit, p.name);
    if (std::none_of(ports.begin(), ports.end(), [&](const auto& q) { return q.name == p.name; }))
      ports.push_back(p);  // clock and reset once
  };
  for (const std::string& unit : units)
    for (const DescribedPort& p : described_ports(rtl_dir, unit)) {
      if (!is_inner(unit, p.name, reordered)) add(unit, p);
      // Behind clock and reset of the first unit: the queries, which are the gatherer's or go
      // through what chip_reordered.sv.in wires.
      if (reordered && ports.size() == 2)
        for (const DescribedPort& query : described_ports(rtl_dir, kGatherer))
          if (of_stream(query.name, "in", false)) add(kGatherer, query);
    }
  ports.push_back({true, "logic [63:0]", "plan_hash_o", "hash of the plan"});
  return ports;
}

std::string write_chip(const Plan& plan, const std::string& rtl_dir) {
  const std::vector<std::string> units = units_present(plan);
  const bool reordered = has_unit(units, kReorder);
  std::string port_list, instances;
  const std::vector<DescribedPort> ports = chip_ports(plan, rtl_dir);
  for (size_t i = 0; i < ports.size(); ++i)
    port_list +=
        fmt::format("    {} {} {}{}  // {}\n", ports[i].output ? "output" : "input ", ports[i].type,
                    ports[i].name, i + 1 < ports.size() ? "," : "", ports[i].meaning);
  for (const std::string& unit : units) {
    instances += fmt::format("{0}  {1} {1} (\n", instances.empty() ? "" : "\n", unit);
    const std::vector<ModulePort> list = module_ports(rtl_dir, unit);
    for (size_t i = 0; i < list.size(); ++i)
      instances += fmt::format(
          "      {}{}\n",
          is_shared(list[i])
              ? open_pin(list[i])
              : fmt::format(".{}({})", list[i].name, chip_wire(unit, list[i].name, reordered)),
          i + 1 < list.size() ? "," : "");
    instances += "  );\n";
  }
  Places places = {
      {"PLAN", plan_hash_text(plan)}, {"TOP", kChip}, {"PORTS", port_list}, {"UNITS", instances}};
  if (reordered) places["CAMERA_TAG"] = fmt::format("{}'d{}", plan.tag_bits(), plan.gather_rays);
  return fill_template(reordered ? "chip_reordered.sv" : "chip.sv", places);
}

}  // namespace photonloom
