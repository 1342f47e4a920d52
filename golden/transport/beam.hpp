// SPDX-License-Identifier: Apache-2.0
// Collimated beams: light along one ray. No path finds the point at which it lands, so that point
// is the emitter: it lights other points by shadow rays, as a point light does, and photons start
// there. Itself it has no area, and is not seen.
#pragma once
#include "golden/numeric/random.hpp"
#include "golden/transport/bsdf.hpp"

namespace photonloom {

inline bool is_beam(const World& world, uint32_t emitter) {
  const int32_t light = world.emitters()[emitter].light;
  return light >= 0 &&
         world.scene().lights[static_cast<size_t>(light)].kind == LightKind::kCollimated;
}

// Where a beam lands: the first surface on its way that is not a delta one. The way is one of
// several where glass divides it.
struct BeamSpot {
  Hit hit;
  Surface surface;
  Rgb power{0};  // of the shaded surface (bsdf.hpp), over the probability of the way
};

// False: on this way it leaves the scene, or is absorbed.
bool land_beam(const World& world, const RayCaster& caster, uint32_t emitter, const Random& random,
               BeamSpot& out);

// Radiance that a surface sends back along its ray for the light of a beam's spot, past what stands
// in between; by lobe.
struct BeamLight {
  Rgb diffuse{0}, glossy{0};
};
BeamLight light_of_beam(const World& world, const RayCaster& caster, const BeamSpot& spot,
                        const Hit& hit, const Surface& surface);

}  // namespace photonloom
