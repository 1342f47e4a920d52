// SPDX-License-Identifier: Apache-2.0
// The corners of the search, as stimuli for whatever answers gather queries.
#pragma once
#include <vector>

#include "verilator_tb/bench/bench.hpp"

namespace photonloom {

std::vector<GatherCase> gather_cases();

}  // namespace photonloom
