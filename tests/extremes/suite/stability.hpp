// SPDX-License-Identifier: Apache-2.0
// The error against every width that is a line of the plan (docs/extremes.md, "Stability").
#pragma once
#include <string>
#include <vector>

#include "tests/extremes/suite/steps.hpp"

namespace photonloom::extremes {

// A curve for each line of the plan that is a number of bits, in the plan's order.
std::vector<StabilityCurve> width_curves();

// Lines of the plan that are a number of bits and have no curve, or none over their whole range,
// and curves of no such line; empty: none.
std::vector<std::string> missing_widths(const std::vector<StabilityCurve>& curves);

// Whether curve_fault refuses curves that rise, end in a cliff or are no number, and takes one that
// falls to a floor.
bool curve_fault_works();

// Whether no width of this line changes any number: it decides when packets come, never which.
bool changes_nothing(const StabilityCurve& curve);

}  // namespace photonloom::extremes
