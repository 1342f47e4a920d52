// SPDX-License-Identifier: Apache-2.0
// What follows from the frequencies of a board: dividers of its PLL, rate of its link, whether the
// SDRAM is served.
#pragma once
#include <string>

#include "rtl/generate/board_file.hpp"

namespace photonloom {

struct BoardClocks {
  int core_khz = 0;
  int reference = 0, feedback = 0, output = 0;  // dividers of the PLL
  int vco_khz = 0;
  int baud = 0;
  long clocks_per_bit = 0;
  int sdram_khz = 0;  // 0: no SDRAM
};

// Throws std::runtime_error for a clock that the PLL cannot make exactly, beside that of the
// SDRAM's controller if `sdram`, and for one that is too slow for the link. With `sdram` too for a
// chip that the controller in `rtl_dir` does not serve, naming the key.
BoardClocks board_clocks(const BoardDescription& board, int core_khz, bool sdram,
                         const std::string& rtl_dir);

}  // namespace photonloom
