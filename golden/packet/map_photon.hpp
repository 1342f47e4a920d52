// SPDX-License-Identifier: Apache-2.0
// A photon of a map as text: no packet of a stream, but listed and written like one.
#pragma once
#include "golden/packet/packet.hpp"

namespace photonloom {

#define PHOTONLOOM_MAP_PHOTON(FIELD)                                                        \
  FIELD(UVec3, position, 3, plan.position_bits, "position unit", "x, y, z")                 \
  FIELD(Channels32, mantissa, plan.channels, plan.mantissa_bits, "power unit * 2^exponent", \
        "power, a channel each")                                                            \
  FIELD(uint32_t, exponent, 1, plan.exponent_bits, "", "shared exponent of the power")      \
  FIELD(Pair32, direction, 2, plan.direction_bits, "octahedral cell",                       \
        "to where the light came from")

PHOTONLOOM_PACKET(MapPhoton, "map_photon", PHOTONLOOM_MAP_PHOTON)

}  // namespace photonloom
