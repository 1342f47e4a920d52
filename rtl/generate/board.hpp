// SPDX-License-Identifier: Apache-2.0
// What a hardware package has for one FPGA board beside the RTL: the top with clock, reset and
// pins, the constraints, and a Makefile that goes from there to a bitstream. All of it is files of
// fpga/boards/NAME and fpga/flows, copied and filled. docs/fpga.md, docs/porting.md.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "golden/plan/plan.hpp"
#include "golden/plan/plan_file.hpp"
#include "rtl/generate/board_file.hpp"

namespace photonloom {

struct BoardRequest {
  std::string name;
  // One unit alone between a shift register and a signature register, clocked by the pin, so that
  // its own speed can be read; empty: board_core, all of the board.
  std::string unit;
  // Clock of the design in kHz, 0 for the board's default: what the PLL makes for the whole board,
  // what a unit alone is constrained to.
  int clock_khz = 0;
  std::string boards_dir;  // empty: default_boards_dir()
};

struct BoardFiles {
  std::string top;                   // module in rtl/TOP.sv
  std::string inner;                 // the module that it instantiates: a unit, or board_core
  int clock_khz = 0;                 // as chosen
  std::vector<std::string> sources;  // those of `files` that are RTL, in order
  std::map<std::string, std::string> files;  // path in the package -> text
  std::string lint;                          // options for Verilator: where the part's cells are
  std::string readme;                        // section of the package's README
};

// The first line of a plan that a board with room for a whole top cannot have: the kind of its
// photon memory, a clock of the SDRAM beyond the board's, or what board_problem(plan) tells.
std::optional<PlanProblem> board_problem(const Plan& plan, const BoardDescription& board);

// Throws std::runtime_error for an unknown board or one that cannot hold what is asked for.
void check_board(const Plan& plan, const BoardRequest& request);

// Throws too for a clock that the board's PLL cannot make, and for files of the board or its flow
// that do not fit together, naming file and key or place. `sources` are the files of the RTL in
// order, without the top.
BoardFiles board_files(const Plan& plan, const BoardRequest& request, const std::string& rtl_dir,
                       const std::vector<std::string>& sources);

}  // namespace photonloom
