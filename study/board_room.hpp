// SPDX-License-Identifier: Apache-2.0
// Whether a board's part has room for a plan's hardware, by prediction (docs/fpga-plans.md).
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "golden/plan/plan.hpp"
#include "rtl/generate/board_file.hpp"

namespace photonloom {

// The part of a board's logic and of its block RAM that is planned for.
struct BoardShare {
  double logic = 1, blocks = 1;
};
// The rest of the logic is for link, memory controller and routing.
inline constexpr BoardShare kBoardShare = {.logic = 0.85};

// The board of this name. Throws std::runtime_error, naming --board and the boards there are, for
// one that there is not and for one whose resources the prediction does not count.
BoardDescription predicted_board(const std::string& name);

// The block RAMs of 18 Kibit that a board's part states, whatever its family calls them.
std::optional<int> block_rams_of(const BoardDescription& board);

// LUT-equivalents and flip-flops, larger by the largest error of their prediction, multipliers and
// block RAMs.
struct BoardNeeds {
  double lut = 0, ff = 0, dsp = 0, blocks = 0;
};
BoardNeeds operator+(const BoardNeeds& a, const BoardNeeds& b);
BoardNeeds operator*(int n, const BoardNeeds& a);
// Of one gatherer, and of all else on the board that is predicted: other units, memories, link.
BoardNeeds gatherer_needs(const Plan& plan);
BoardNeeds other_needs(const Plan& plan);

// What a board's part has too little of for a plan's whole top, as predicted, without a margin for
// errors and for what is not predicted. Of parts that the prediction of logic is not of, block RAM
// alone.
struct BoardShortage {
  std::string resource;  // as a sentence has it
  long needed, has;
};
std::vector<BoardShortage> board_shortages(const Plan& plan, const BoardDescription& board);

// Why these do not fit in this share of the board and in all of its multipliers; empty: they do.
std::string misfit(const BoardNeeds& needs, const BoardDescription& board, const BoardShare& share);
// The same of a plan's, or which of its lines no top of the board can have.
std::string misfit(const Plan& plan, const BoardDescription& board, const BoardShare& share);

}  // namespace photonloom
