// SPDX-License-Identifier: Apache-2.0
// The fit of cycles a gather to the RTL, written by scripts/cycle-fit from study/cycles.csv.
#pragma once

// clang-format off
namespace photonloom {

struct CycleFit {
  double power, fixed;
  double nodes, lanes, insertions, memory, latency;
};
inline constexpr CycleFit kCycleFit = {4.10359, 1.61275, 0.901841, 0.932095, 0.935883, 1.01964, 0.962206};
// Largest and mean relative error, each point predicted from a fit without its tenth, and the number of points.
inline constexpr double kCycleFitWorst = 0.0746, kCycleFitMean = 0.0202;
inline constexpr int kCycleFitPoints = 32;

}  // namespace photonloom
// clang-format on
