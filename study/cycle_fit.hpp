// SPDX-License-Identifier: Apache-2.0
// The fit of cycles a gather to the RTL, written by scripts/cycle-fit from study/cycles.csv.
#pragma once

// clang-format off
namespace photonloom {

struct CycleFit {
  double power, fixed;
  double nodes, lanes, insertions, memory, latency;
};
inline constexpr CycleFit kCycleFit = {4.16936, 1.53842, 0.893542, 0.93941, 1.01529, 1.00746, 0.972143};
// Largest and mean relative error, each point predicted from a fit without its tenth, and the number of points.
inline constexpr double kCycleFitWorst = 0.0818, kCycleFitMean = 0.0240;
inline constexpr int kCycleFitPoints = 32;

}  // namespace photonloom
// clang-format on
