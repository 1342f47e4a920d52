// SPDX-License-Identifier: Apache-2.0
// Multi-objective search: Optuna's NSGA-II, asked generation by generation.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "study/study_file.hpp"

namespace photonloom {

// Why there is no search on this machine; empty: there is.
std::string search_missing();

// The points of generation `generation` from the objectives of all before it, in order; a point
// without figures has none. The same arguments give the same points. `folder` is for the files
// through which the library is asked.
std::vector<LineValues> next_generation(const PointSet& set, int generation,
                                        const std::vector<std::vector<double>>& objectives,
                                        const std::string& folder);

}  // namespace photonloom
