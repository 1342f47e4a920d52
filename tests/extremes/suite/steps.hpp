// SPDX-License-Identifier: Apache-2.0
// Golden's arithmetic step by step: a bound on each step's error as a function of the plan, and the
// largest error that was measured (docs/error-analysis.md); and an estimate's error against every
// width (docs/extremes.md).
#pragma once
#include <functional>
#include <string>
#include <vector>

namespace photonloom::extremes {

// At one width: the largest error of many inputs, ends and ties among them, and what bounds it.
struct StepError {
  std::string width;
  double measured = 0, bound = 0;
};

struct Step {
  std::string name;
  std::string computes;  // the operation, with its function
  std::function<std::vector<StepError>()> measure;
  std::string bound = {};  // its formula of the plan's lines, from steps.bounds
};

std::vector<Step> arithmetic_steps();

// An error at each width of a line from its least to its greatest, all other lines at their
// greatest.
struct StabilityPoint {
  int bits;
  double error;
};
struct StabilityCurve {
  std::string line;
  std::string error;  // what it is
  std::vector<StabilityPoint> points;
};
std::vector<StabilityCurve> stability_curves();

// How many times the least error that the other lines leave a bit more may cost, and a bit less may
// be worth.
inline constexpr double kNoise = 1.3, kCliff = 16;
// What is wrong with a curve; empty: it falls within noise, without a cliff.
std::string curve_fault(const StabilityCurve& curve);

}  // namespace photonloom::extremes
