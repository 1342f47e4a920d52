// SPDX-License-Identifier: Apache-2.0
// The fit of cycles a gather to the RTL, written by scripts/cycle-fit from study/cycles.csv.
#pragma once

// clang-format off
namespace photonloom {

struct CycleFit {
  double power, fixed;
  double nodes, lanes, insertions, memory, latency;
};
inline constexpr CycleFit kCycleFit = {6, 1.5, 1, 1, 1, 1, 1};
// Largest and mean relative error, each point predicted from the others, and the number of points.
inline constexpr double kCycleFitWorst = 1, kCycleFitMean = 1;
inline constexpr int kCycleFitPoints = 0;

}  // namespace photonloom
// clang-format on
