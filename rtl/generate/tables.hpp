// SPDX-License-Identifier: Apache-2.0
// Markdown tables of packets, for docs/packets.md and for generated packages.
#pragma once
#include <string>
#include <vector>

#include "golden/plan/plan.hpp"

namespace photonloom {

// The packet `name` with this plan: field, elements, bits, place in the vector, unit, meaning. An
// unknown name is an error.
std::string packet_table(const Plan& plan, const std::string& name);

// Names of all packets, and of map_photon, which is one in text only.
std::vector<std::string> packet_names();

}  // namespace photonloom
