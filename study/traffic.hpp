// SPDX-License-Identifier: Apache-2.0
// The measure `traffic`: bytes that a frame's final gathers fetch from the photon map, in the order
// of the plan and in the orders that it is compared with. docs/reordering.md defines the columns.
#pragma once
#include <string>
#include <vector>

#include "study/measures.hpp"

namespace photonloom {

// Of a query that waits in a buffer: what storage is counted in.
inline constexpr int kPacketBytes = 32;

std::vector<Column> traffic_columns();
Measurement measure_traffic(PointRun& run);
std::string traffic_settings(const Study& study, const StudyScene& scene);

}  // namespace photonloom
