// SPDX-License-Identifier: Apache-2.0
#include "rtl/generate/unit_top.hpp"

#include <fmt/core.h>

#include "rtl/generate/fill.hpp"
#include "rtl/generate/sources.hpp"

namespace photonloom {
namespace {

void append(std::string& list, const std::string& between, const std::string& item) {
  list += (list.empty() ? "" : between) + item;
}

}  // namespace

std::string write_unit_top(const std::string& top, const std::string& unit,
                           const std::string& clock, const std::string& rtl_dir) {
  std::string inputs, outputs, registers, declarations, connections;
  for (const ModulePort& p : module_ports(rtl_dir, unit)) {
    if (is_shared(p)) {
      append(connections, ",\n", "      " + open_pin(p));
      continue;
    }
    append(connections, ",\n", fmt::format("      .{0}({0})", p.name));
    if (p.name == "clk_i") continue;
    const std::string type = package_type(p.type, unit);
    append(declarations, "\n", fmt::format("  {} {};", type, p.name));
    append(p.output ? outputs : inputs, ", ", p.name);
    if (!p.output) continue;
    append(declarations, "\n", fmt::format("  {} {}_q;", type, p.name));
    append(registers, ", ", p.name + "_q");
  }
  return fill_template("unit_top.sv", {{"TOP", top},
                                       {"UNIT", unit},
                                       {"CLOCK", clock},
                                       {"DECLARATIONS", declarations},
                                       {"INPUTS", inputs},
                                       {"OUTPUTS", outputs},
                                       {"REGISTERS", registers},
                                       {"CONNECTIONS", connections}});
}

}  // namespace photonloom
