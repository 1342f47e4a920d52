// SPDX-License-Identifier: Apache-2.0
// Photon maps as the hardware gatherer takes them: words for its configuration port and the bytes
// of its line memory. Address map: docs/photon_gatherer.md, lines: docs/photon_memory.md.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "golden/plan/plan.hpp"
#include "golden/unit/photon_map.hpp"

namespace photonloom {

struct CfgWrite {
  uint32_t address = 0;  // 24 bits
  uint64_t data = 0;
};

struct PhotonGathererImage {
  std::vector<CfgWrite> cfg;                  // to be written in this order while idle
  std::array<std::vector<uint8_t>, 2> lines;  // by map, as photon_lines gives them
};

PhotonGathererImage photon_gatherer_image(const Plan& plan, const PhotonMap& global,
                                          const PhotonMap& caustic);

}  // namespace photonloom
