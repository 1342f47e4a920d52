// SPDX-License-Identifier: Apache-2.0
#include "golden/transport/direct.hpp"

#include <algorithm>
#include <bit>

#include "golden/transport/beam.hpp"
#include "golden/transport/sampling.hpp"
#include "golden/transport/visibility.hpp"

namespace photonloom {

DirectLight direct_light(const World& world, const RayCaster& caster, const Hit& hit,
                         const Surface& surface, double choice, const Vec2& u, LobeShare share) {
  DirectLight out;
  LightSample light;
  if (!sample_light(world, shading_point(hit, surface), choice, u, light)) return out;
  if (is_beam(world, light.emitter)) {
    const Random random(std::bit_cast<uint64_t>(u.x), Phase::kDirect, std::bit_cast<uint64_t>(u.y));
    out.cast = true;
    BeamSpot spot;
    if (!land_beam(world, caster, light.emitter, random, spot)) return out;
    const BeamLight beam = light_of_beam(world, caster, spot, hit, surface);
    if (share.diffuse > 0) out.diffuse = beam.diffuse / light.probability;
    if (share.glossy > 0) out.glossy = beam.glossy / light.probability;
    return out;
  }
  const Vec3& d = light.direction;
  if (share.diffuse > 0) out.diffuse = diffuse_times_cosine(surface, d);
  if (share.glossy > 0) out.glossy = glossy_times_cosine(surface, d);
  if (is_black(out.diffuse) && is_black(out.glossy)) return out;
  out.cast = true;
  const Ray ray{hit.position, d};
  // A lamp without a surface may lie on one: the shadow ray ends before it by more than rounding.
  const double end = light.on_surface
                         ? light.distance
                         : light.distance - 0x1p-44 * (max_component(glm::abs(hit.position)) +
                                                       std::min(light.distance, world.radius()));
  const double passing =
      transmittance(world, caster, ray, end, &hit, light.on_surface ? &light.hit : nullptr);
  if (passing == 0) return {.cast = true};
  out.diffuse *= light.radiance;
  out.glossy *= light.radiance;
  if (passing != 1) {
    out.diffuse *= passing;
    out.glossy *= passing;
  }
  if (light.pdf > 0) {
    out.diffuse *= power_heuristic(light.pdf, share.diffuse * diffuse_pdf(surface, d));
    if (share.glossy > 0)
      out.glossy *= power_heuristic(light.pdf, share.glossy * glossy_pdf(surface, d));
  }
  return out;
}

double found_weight(const World& world, const ShadingPoint& x, double lobe_pdf, const Hit& hit,
                    const Vec3& direction) {
  return power_heuristic(lobe_pdf, light_pdf(world, x, hit, direction));
}

double escaped_weight(const World& world, const ShadingPoint& x, double lobe_pdf,
                      const Vec3& direction) {
  return power_heuristic(lobe_pdf, environment_pdf(world, x, direction));
}

}  // namespace photonloom
