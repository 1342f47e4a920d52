// SPDX-License-Identifier: Apache-2.0
// Direct light by shadow ray, one lobe at a time, weighted against the lobe's own samples.
#pragma once
#include "golden/transport/bsdf.hpp"
#include "golden/transport/emitters.hpp"

namespace photonloom {

// How often each lobe's own sample will look for emitters too: its probability, 0 for lobes that
// are not asked for.
struct LobeShare {
  double diffuse = 0, glossy = 0;
};

struct DirectLight {
  Rgb diffuse{0}, glossy{0};
  bool cast = false;  // a ray was, to an emitter that light could come from
};

inline ShadingPoint shading_point(const Hit& hit, const Surface& s) {
  return {hit.position, s.normal, s.transmits()};
}

// One shadow ray to one emitter.
DirectLight direct_light(const World& world, const RayCaster& caster, const Hit& hit,
                         const Surface& surface, double choice, const Vec2& u, LobeShare share);

// Weight of an emitter that a lobe sample (density `lobe_pdf`, lobe probability included) from x
// found at `hit`.
double found_weight(const World& world, const ShadingPoint& x, double lobe_pdf, const Hit& hit,
                    const Vec3& direction);
// The same where the ray left the scene, to its environment.
double escaped_weight(const World& world, const ShadingPoint& x, double lobe_pdf,
                      const Vec3& direction);

}  // namespace photonloom
