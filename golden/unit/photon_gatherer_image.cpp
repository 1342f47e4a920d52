// SPDX-License-Identifier: Apache-2.0
#include "golden/unit/photon_gatherer_image.hpp"

#include "golden/plan/plan_file.hpp"
#include "golden/unit/photon_lines.hpp"

namespace photonloom {

PhotonGathererImage photon_gatherer_image(const Plan& plan, const PhotonMap& global,
                                          const PhotonMap& caustic) {
  PhotonGathererImage image;
  for (const bool is_caustic : {false, true}) {
    const PhotonMap& map = is_caustic ? caustic : global;
    image.lines[is_caustic ? 1 : 0] = photon_lines(plan, map, is_caustic);
    const uint32_t base = is_caustic ? static_cast<uint32_t>(plan.lines(plan.global)) : 0;
    for (uint32_t node = 1; node < map.lines; ++node)
      image.cfg.push_back({base + node, uint64_t{map.nodes[node].axis} << plan.position_bits |
                                            map.nodes[node].split});
    const uint32_t registers = kNodeAddresses + (is_caustic ? 2 : 0);  // two a map
    image.cfg.push_back({registers, map.lines});
    image.cfg.push_back({registers + 1, plan.map(is_caustic).r2_max});
  }
  return image;
}

}  // namespace photonloom
