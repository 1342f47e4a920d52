// SPDX-License-Identifier: Apache-2.0
// Light that becomes a caustic, as it leaves its emitters. Only what meets a delta surface counts,
// so what comes from infinitely far away is emitted into the boxes of these surfaces alone.
#pragma once
#include <vector>

#include "golden/transport/delta_boxes.hpp"
#include "golden/transport/emitters.hpp"

namespace photonloom {

class CausticEmission {
 public:
  // `boxes` are the world's; both must outlive this.
  CausticEmission(const World& world, const DeltaBoxes& boxes);

  // As emit_photon: what the mean over paths of a function of the light that meets a delta surface
  // is worth is the same. Without light from infinitely far away the paths are the same too.
  Emission emit(const Random& random, uint32_t& emitter) const;

  // The same of one emitter. What `share` of its power leaves it; and its light, as
  // emit_photon_from.
  double share(uint32_t emitter) const;
  Emission from(uint32_t emitter, const Random& random) const;

 private:
  bool is_aimed(uint32_t emitter) const;

  const World& world_;
  const DeltaBoxes& boxes_;
  std::vector<double> cdf_;  // of emitters, by the power that they emit here; empty: as the world's
};

}  // namespace photonloom
