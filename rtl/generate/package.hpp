// SPDX-License-Identifier: Apache-2.0
// The generated SystemVerilog package photonloom_pkg: the plan's constants and the packets.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "golden/plan/plan.hpp"

namespace photonloom {

// A constant of the package.
struct PackageConstant {
  std::string name;  // UpperCamel of the plan line or width
  std::string type;  // "int unsigned" or "logic [N-1:0]"
  std::string value;
  std::string meaning;
  uint64_t number;  // the value
};

std::vector<PackageConstant> package_constants(const Plan& plan);

// Text of photonloom_pkg.sv, deterministic in the plan. `plan_hash` becomes PlanHash. Throws
// PlanError of a plan that hardware_problem() tells of.
std::string write_package(const Plan& plan, uint64_t plan_hash);

// reorder_cell_bits -> ReorderCellBits.
std::string upper_camel(const std::string& snake);

}  // namespace photonloom
