// SPDX-License-Identifier: Apache-2.0
// Engines' predicted cycles beside simulated ones, of tests that compare them, for
// scripts/engine-predictions, which puts them onto docs/planner.md.
#pragma once
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/catch.hpp"

namespace photonloom::test {

// How far a prediction may be off, as docs/planner.md has it.
inline constexpr double kPredictedWithin = 0.15;

// Checks a prediction, and adds it as a line of JSON to the file that PHOTONLOOM_PREDICTIONS names,
// where it is set. row: of which engine, on what.
inline void check_prediction(nlohmann::json row, double predicted, double simulated) {
  row["predicted"] = predicted;
  row["simulated"] = simulated;
  WARN(row.dump());
  CHECK(predicted > (1 - kPredictedWithin) * simulated);
  CHECK(predicted < (1 + kPredictedWithin) * simulated);
  if (const char* file = std::getenv("PHOTONLOOM_PREDICTIONS"))
    REQUIRE(std::ofstream(file, std::ios::app) << row.dump() << '\n');
}

}  // namespace photonloom::test
