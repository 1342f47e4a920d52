// SPDX-License-Identifier: Apache-2.0
// The measure `layouts`: bytes that the plan's served order of final gathers fetches from the same
// photons laid out in other ways. docs/reordering.md defines the columns.
#pragma once
#include <string>
#include <vector>

#include "study/measures.hpp"

namespace photonloom {

std::vector<Column> layout_columns();
Measurement measure_layouts(PointRun& run);
std::string layout_settings(const Study& study, const StudyScene& scene);

}  // namespace photonloom
