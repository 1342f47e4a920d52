// SPDX-License-Identifier: Apache-2.0
// The fit of cycles a gather to the RTL, written by scripts/cycle-fit from study/cycles.csv.
#pragma once

// clang-format off
namespace photonloom {

struct CycleFit {
  double power, fixed;
  double nodes, lanes, insertions, memory, latency;
};
inline constexpr CycleFit kCycleFit = {4.98625, 1.50092, 0.95873, 0.95775, 1.07257, 1.06469, 0.970073};
// Largest and mean relative error, each point predicted from a fit without its tenth, and the number of points.
inline constexpr double kCycleFitWorst = 0.0775, kCycleFitMean = 0.0257;
inline constexpr int kCycleFitPoints = 32;

}  // namespace photonloom
// clang-format on
