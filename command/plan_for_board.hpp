// SPDX-License-Identifier: Apache-2.0
// photonloom plan SCENE --board BOARD: the fastest gather engine that the board has room for.
#pragma once
#include <string>

#include "golden/pipeline/prepare.hpp"
#include "study/engine_search.hpp"

namespace photonloom {

struct BoardPlan {
  EngineSearch engine;
  int core_khz = 0;     // of the board's core, by default
  PlanReasons reasons;  // of all lines
};

// Traces the photons, renders one sample a pixel for the gathers that the scene asks for, and
// searches. Throws std::runtime_error for a board that the prediction does not know.
BoardPlan plan_for_board(const FrameRequest& request, const std::string& board);

// What was found, for people.
std::string engine_text(const BoardPlan& found, const std::string& board);

}  // namespace photonloom
