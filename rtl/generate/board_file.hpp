// SPDX-License-Identifier: Apache-2.0
// A board is a folder, fpga/boards/NAME: board.toml, constraints and tops. docs/porting.md.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "rtl/generate/fill.hpp"

namespace photonloom {

// Both included.
struct IntRange {
  int least = 0, most = 0;
};

// What dividers a PLL has, frequencies in kHz. The detector sees f_in / reference; the VCO runs at
// that times feedback, and times output too where the PLL is fed back from its output.
struct PllLimits {
  bool fed_back_from_output = false;
  IntRange reference, feedback, output;
  int detector_least_khz = 0;
  IntRange vco_khz, output_khz;
  int vco_best_khz = 0;  // of several choices that with the nearest VCO is taken
};

struct BoardSdram {
  int clock_khz = 0;                    // of its controller
  std::map<std::string, int> times_ns;  // "row_to_column_ns" -> the chip's; as in board.toml
};

struct BoardTop {
  std::string file;                      // hand-written, in the folder; empty for a unit alone
  std::vector<std::string> constraints;  // files of the folder, one after the other
};

struct BoardDescription {
  std::string name;    // of the folder: "ulx3s-85f"
  std::string prefix;  // of its modules: "ulx3s_85f"
  std::string folder;
  std::string file;  // folder/board.toml
  std::string part, tested, leds;
  std::map<std::string, int> resources;  // how many of each the part has
  std::string clock_port;                // of the top: the oscillator
  int oscillator_khz = 0;
  int core_khz = 0;  // default clock of board_core
  int unit_khz = 0;  // what a unit alone is constrained to
  std::optional<PllLimits> pll;
  std::string serial_port;  // for people
  std::vector<int> baud;    // rates of the serial port, fastest first
  std::optional<BoardSdram> sdram;
  std::string flow;                          // fpga/flows/FLOW
  std::map<std::string, std::string> tools;  // the oldest version of each, by its command
  Places flow_places;                        // further keys of [flow]: places of the flow's files
  // What the board can be: "block_ram" and "sdram" (board_core with photons there), "unit" (one
  // unit alone).
  std::map<std::string, BoardTop> tops;

  bool has_core() const { return tops.count("block_ram") || tops.count("sdram"); }
};

// Names of the folders in `boards_dir` that have a board.toml, in order; none where it is no
// folder. Empty: default_boards_dir().
std::vector<std::string> board_names(const std::string& boards_dir = "");

// Throws std::runtime_error for a board that there is not, and for a key of board.toml that is
// missing, unknown or out of range, naming file and key.
BoardDescription read_board(const std::string& name, const std::string& boards_dir = "");

}  // namespace photonloom
