// SPDX-License-Identifier: Apache-2.0
// The fit of cycles a gather to the RTL, written by scripts/cycle-fit from study/cycles.csv.
#pragma once

// clang-format off
namespace photonloom {

struct CycleFit {
  double power, fixed;
  double nodes, lanes, insertions, memory, latency;
};
inline constexpr CycleFit kCycleFit = {4.11899, 1.73968, 0.894159, 0.936503, 0.938127, 1.01304, 0.956823};
// Largest and mean relative error, each point predicted from a fit without its tenth, and the number of points.
inline constexpr double kCycleFitWorst = 0.0749, kCycleFitMean = 0.0205;
inline constexpr int kCycleFitPoints = 32;

}  // namespace photonloom
// clang-format on
