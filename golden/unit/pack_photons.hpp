// SPDX-License-Identifier: Apache-2.0
// The named conversion from photons in scene units to the plan's formats.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "golden/plan/plan.hpp"
#include "golden/transport/world.hpp"
#include "golden/unit/photon_map.hpp"

namespace photonloom {

// What the power format did to the photons of a map.
struct PackCounts {
  uint64_t zeroed = 0;     // had power, and every mantissa became 0
  uint64_t saturated = 0;  // a channel did not fit and became the largest code
  uint64_t outside = 0;    // lay outside of the cube and became its nearest unit
};

// Position by quantise_position, direction by oct_encode, power in units of 2^map.power_exponent W
// by encode_power. With one channel the value is that of the channel in which plan.channel_color is
// largest, over that colour. `counts` may be null.
PackedPhoton pack(const Photon& photon, const Plan& plan, const MapPlan& map, PackCounts* counts);

// All photons of a map, in their order. Uses threads.
std::vector<PackedPhoton> pack_photons(std::span<const Photon> photons, const Plan& plan,
                                       const MapPlan& map, PackCounts* counts);

// The smallest power exponent with which no photon saturates; 0 where no photon has power.
int choose_power_exponent(std::span<const Photon> photons, const Plan& plan);

}  // namespace photonloom
