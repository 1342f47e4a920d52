// SPDX-License-Identifier: Apache-2.0
// What bounds a gather from SDRAM, the gatherers or the SDRAM, and whether it comes near enough to
// that bound. Which of the two is asked for is told by their cycles alone, before anything is
// judged: docs/gather_cluster.md.
#pragma once

namespace photonloom {

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
