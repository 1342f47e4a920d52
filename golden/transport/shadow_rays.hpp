// SPDX-License-Identifier: Apache-2.0
// Direct light of a camera path's hits, by two kinds of ray that share it by the power heuristic.
// Weights are those of one ray of each kind whatever their numbers, so that the mean of each kind
// may be taken over any number of rays.
#pragma once
#include "golden/transport/direct.hpp"
#include "golden/transport/sampling.hpp"

namespace photonloom {

// The diffuse lobe's own sample of direct light: one ray along the cosine.
Rgb diffuse_partner(const World& world, const RayCaster& caster, const Hit& hit, const Surface& s,
                    const Vec2& u, double opening);

// A ray towards an emitter, and one along the diffuse lobe's cosine.
enum class ShadowRay : size_t { kLight, kCosine };
inline constexpr size_t kShadowRays = 2;  // kinds

// The shadow rays of one hit.
class HitShadows {
 public:
  HitShadows(const World& world, const RayCaster& caster, const LitHit& lit);
  // Adds the light of one ray; black where the surface has no lobe for its kind. Rays of a pixel
  // are numbered through, each kind for itself, by what `numbers` were made with. False: no ray was
  // cast, for no light could come.
  bool add(ShadowRay kind, const PixelNumbers& numbers, Rgb& sum) const;

 private:
  const World& world_;
  const RayCaster& caster_;
  const LitHit& lit_;
  Surface surface_;
};

}  // namespace photonloom
