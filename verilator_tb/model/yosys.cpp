// SPDX-License-Identifier: Apache-2.0
// Finding Yosys, and handing it a unit.
#include <fmt/core.h>

#include <map>
#include <regex>
#include <stdexcept>

#include "verilator_tb/model/tools.hpp"

namespace photonloom::model_tools {

const Yosys& yosys(const std::string& command) {
  static std::map<std::string, Yosys> found;
  const auto at = found.find(command);
  if (at != found.end()) return at->second;
  Yosys y;
  y.version = output_of(quoted(command) + " -V");
  if (!y.version.starts_with("Yosys "))
    throw std::runtime_error(
        command == "yosys" ? "yosys is not installed: netlists and CXXRTL models are made with it"
                           : fmt::format("--yosys {}: does not start or is no Yosys", command));
  // Only Yosys knows where its own files are; it says so when it reads one.
  static const std::regex reading("Parsing Verilog input from `(.*)/ecp5/cells_sim\\.v' to AST");
  const std::string said =
      output_of(quoted(command) + " -p 'read_verilog -lib +/ecp5/cells_sim.v'");
  std::smatch m;
  if (!std::regex_search(said, m, reading))
    throw std::runtime_error(fmt::format(
        "{} ({}): does not tell where its models of the ECP5's cells are", command, y.version));
  y.share = m[1];
  return found[command] = y;
}

std::string yosys_read(const ModelInput& in, const std::string& flags) {
  std::string script = fmt::format("read_verilog -sv {}", flags);
  for (const std::string& file : in.files) script += " " + file;
  script += "\n";
  for (const std::string& p : in.parameters) {
    const size_t equals = p.find('=');
    script +=
        fmt::format("chparam -set {} {} {}\n", p.substr(0, equals), p.substr(equals + 1), in.unit);
  }
  return script;
}

}  // namespace photonloom::model_tools
