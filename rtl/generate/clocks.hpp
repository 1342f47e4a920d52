// SPDX-License-Identifier: Apache-2.0
// What follows from the frequencies of a board: dividers of its PLL, rate of its link, whether the
// SDRAM is served.
#pragma once
#include <optional>
#include <string>

#include "golden/plan/plan_file.hpp"
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

// `sdram_khz`: clock of the SDRAM's controller, the plan's board.sdram_khz, or 0 where there is
// none. Throws std::runtime_error for a clock that the PLL cannot make exactly, beside that of the
// controller, and for one that is too slow for the link; with a controller too for a chip that the
// one in `rtl_dir` does not serve, naming the key.
BoardClocks board_clocks(const BoardDescription& board, int core_khz, int sdram_khz,
                         const std::string& rtl_dir);

// The fastest clock of the board's SDRAM, at most `most_khz`, that its PLL makes beside the core's
// default one; `most_khz` or the board's most where there is none.
int sdram_clock(const BoardDescription& board, int most_khz);

// A board.sdram_khz of an SDRAM that the board's PLL cannot make beside the core's default clock.
std::optional<PlanProblem> clock_problem(const Plan& plan, const BoardDescription& board);

}  // namespace photonloom
