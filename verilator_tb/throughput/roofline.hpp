// SPDX-License-Identifier: Apache-2.0
// What bounds a gather from SDRAM, the gatherers or the SDRAM, and whether it comes near enough to
// that bound. Which of the two is asked for is told by their cycles alone, before anything is
// judged: docs/gather_cluster.md.
#pragma once
#include <cmath>
#include <cstdint>

#include "verilator_tb/chip/sdram_chip.hpp"

namespace photonloom {

// Share of the SDRAM's cycles that refreshes leave: one in 780 cycles, each 12 from the end of a
// line to the next ACTIVATE (3 PRECHARGE, 7 AUTO REFRESH, a cycle each to decide).
constexpr double kRefreshLeaves = 1 - 12.0 / 780;

// PRECHARGE and ACTIVATE, each in whole cycles of the SDRAM's clock: what a line waits for whose
// bank was just read from another row. Rows of other banks are changed beside the data of the last
// line.
inline double row_change_cycles(int sdram_khz) {
  const auto cycles = [&](int64_t picoseconds) {
    return std::ceil(static_cast<double>(picoseconds) * sdram_khz / 1e9);
  };
  return cycles(SdramTimes{}.precharge) + cycles(SdramTimes{}.row_to_column);
}

// Share of its bound that a gather is to reach, where it is bound by the SDRAM or by the gatherers.
constexpr double kRooflineGoal = 0.85, kGatherersGoal = 0.8;

// Cycles of the core per gather that one gather needs of what it shares, and the share of the
// measured cycles that these are.
struct Roof {
  double cycles, reached;
};

// Whether the gatherers bind: they need more cycles than the SDRAM.
constexpr bool binds(const Roof& gatherers, const Roof& sdram) {
  return gatherers.cycles > sdram.cycles;
}

constexpr bool reaches_its_bound(const Roof& gatherers, const Roof& sdram) {
  return binds(gatherers, sdram) ? gatherers.reached >= kGatherersGoal
                                 : sdram.reached >= kRooflineGoal;
}

}  // namespace photonloom
