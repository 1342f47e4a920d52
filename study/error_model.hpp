// SPDX-License-Identifier: Apache-2.0
// Visible error of plans that were not rendered, from those that were: a sum of terms, each what
// one cause adds, with coefficients of at least 0; what is left over counts for plans near by.
// docs/planner.md has the terms.
#pragma once
#include <vector>

#include "golden/plan/plan.hpp"

namespace photonloom {

// What decides the error of a plan, as ratios to `base`.
std::vector<double> error_terms(const Plan& plan, const Plan& base);
// What each is, for people; as many as error_terms has.
const std::vector<const char*>& error_term_names();

struct ErrorSample {
  std::vector<double> terms;
  std::vector<double> place;  // two plans are near when these are, in steps of each line
  double error = 0;           // as a ratio to the base's
};

class ErrorModel {
 public:
  // Least squares of relative differences, drawn to what scenes have in common where the samples
  // say little.
  explicit ErrorModel(std::vector<ErrorSample> samples);

  double predict(const std::vector<double>& terms, const std::vector<double>& place) const;
  // What each term adds.
  std::vector<double> parts(const std::vector<double>& terms) const;
  // Root mean square of the relative error over the samples, each predicted from all others.
  double cross_validated() const { return cross_validated_; }

 private:
  ErrorModel(std::vector<ErrorSample> samples, bool validate);

  std::vector<ErrorSample> samples_;
  std::vector<double> coefficients_;
  std::vector<double> left_over_;  // log of measured over the sum of the terms
  double cross_validated_ = 0;
};

}  // namespace photonloom
