// SPDX-License-Identifier: Apache-2.0
// The README of a hardware package.
#pragma once
#include <string>
#include <vector>

#include "golden/plan/plan.hpp"
#include "rtl/generate/chip.hpp"

namespace photonloom {

struct PackageReadme {
  Plan plan{};
  std::string top{};
  std::vector<std::string> units{};
  std::vector<DescribedPort> ports{};
  bool whole_board = false;    // the package is board_core's: all packets and its memories
  std::string ports_of{};      // the module whose ports they are, if not `top`
  std::string lint_options{};  // for Verilator
  std::string board{};         // section of the board; empty: none
};

std::string write_readme(const PackageReadme& readme);

}  // namespace photonloom
