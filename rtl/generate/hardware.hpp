// SPDX-License-Identifier: Apache-2.0
// A hardware package: a folder with everything that one plan's hardware needs and nothing else, to
// be taken to Verilator, Yosys, Vivado or FuseSoC as it is.
#pragma once
#include <map>
#include <string>
#include <vector>

#include "golden/plan/plan_file.hpp"
#include "golden/plan/units.hpp"

namespace photonloom {

struct HardwareRequest {
  Plan plan{};
  PlanReasons reasons{};
  std::string unit{};     // one unit alone; empty: the chip, or all of a board
  std::string rtl_dir{};  // empty: default_rtl_dir()
  std::string board{};    // files of this board too; with a unit, that unit alone on its part
  int clock_khz = 0;      // the board's clock, 0 for its default
  std::map<std::string, std::string> images{};  // further files, images/NAME -> text
  std::string boards_dir{};                     // empty: default_boards_dir()
};

// Path in the package -> text. Deterministic in the request and the RTL. A unit that the plan has
// not, an unknown one, and an unknown board are errors. package.json says what was asked for and
// the SHA-256 of each image, for check_hardware; photonloom.lock is that of rtl/generate/lock.hpp.
std::map<std::string, std::string> generate_hardware(const HardwareRequest& request);

// Throws std::runtime_error with the first thing in `dir` that is stale: a file that is not what
// its plan.toml, its package.json, the RTL in `rtl_dir` and the boards in `boards_dir` give, is
// missing, or is too much in rtl/, board/ or images/.
void check_hardware(const std::string& dir, const std::string& rtl_dir,
                    const std::string& boards_dir = "");

}  // namespace photonloom
