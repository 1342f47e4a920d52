// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/model/model.hpp"
#include "verilator_tb/model/tools.hpp"

namespace photonloom {

std::map<std::string, std::string> tool_versions(ModelKind kind, const std::string& yosys) {
  using namespace model_tools;
  std::map<std::string, std::string> versions = {{"compiler", compiler().version}};
  if (kind == ModelKind::kHls) return versions;
  if (kind != ModelKind::kCxxrtl) versions["verilator"] = verilator_version();
  if (kind != ModelKind::kRtl) versions["yosys"] = model_tools::yosys(yosys).version;
  return versions;
}

}  // namespace photonloom
