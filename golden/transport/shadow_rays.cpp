// SPDX-License-Identifier: Apache-2.0
#include "golden/transport/shadow_rays.hpp"

#include "golden/transport/visibility.hpp"

namespace photonloom {
namespace {

// Dimensions of a shadow ray.
enum ShadowDimension : uint64_t {
  kShadowChoice,
  kShadowPoint,
  kShadowCosine,
  kShadowOpening,
};

}  // namespace

// The diffuse lobe's own sample of direct light: one ray along the cosine.
Rgb diffuse_partner(const World& world, const RayCaster& caster, const Hit& hit, const Surface& s,
                    const Vec2& u, double opening) {
  const Vec3 d = sample_diffuse(s, u);
  if (!s.above(d)) return Rgb(0);
  const Ray ray{hit.position, d};
  const Hit found = pass_openings(world, caster, ray, caster.closest(ray, &hit), opening);
  if (!found.valid() && !world.environment()) return Rgb(0);
  const Rgb radiance = found.valid() ? world.emission(found, d) : world.environment()->radiance(d);
  if (is_black(radiance)) return Rgb(0);
  const ShadingPoint x = shading_point(hit, s);
  const double w = found.valid() ? found_weight(world, x, diffuse_pdf(s, d), found, d)
                                 : escaped_weight(world, x, diffuse_pdf(s, d), d);
  const Rgb sent = s.diffuse() * radiance * w;
  return s.coat ? sent * s.coat->passes(glm::dot(s.shading_normal, d)) : sent;
}

HitShadows::HitShadows(const World& world, const RayCaster& caster, const LitHit& lit)
    : world_(world),
      caster_(caster),
      lit_(lit),
      surface_(make_surface(world, lit.hit, lit.direction, lit.part)) {}

bool HitShadows::add(ShadowRay kind, const PixelNumbers& numbers, Rgb& sum) const {
  const double p = surface_.diffuse_probability();
  if (kind == ShadowRay::kLight) {
    const DirectLight light =
        direct_light(world_, caster_, lit_.hit, surface_, numbers.unit(0, kShadowChoice),
                     numbers.pair(0, kShadowPoint), {p > 0 ? 1.0 : 0.0, 1 - p});
    sum += lit_.throughput * (light.diffuse + light.glossy);
    return light.cast;
  }
  if (!(p > 0)) return false;
  const double opening = world_.has_openings() ? numbers.unit(0, kShadowOpening) : 0;
  sum += lit_.throughput * diffuse_partner(world_, caster_, lit_.hit, surface_,
                                           numbers.pair(0, kShadowCosine), opening);
  return true;
}

}  // namespace photonloom
