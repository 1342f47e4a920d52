// SPDX-License-Identifier: Apache-2.0
#include "golden/transport/beam.hpp"

#include <cmath>

#include "golden/transport/emitters.hpp"
#include "golden/transport/roulette.hpp"
#include "golden/transport/visibility.hpp"

namespace photonloom {
namespace {

enum BeamDimension : uint64_t { kBeamDelta, kBeamRoulette, kBeamPart, kBeamOpening };

}  // namespace

bool land_beam(const World& world, const RayCaster& caster, uint32_t emitter, const Random& random,
               BeamSpot& out) {
  const Emission e = emit_photon_from(world, emitter, random);
  Ray ray = e.ray;
  Rgb throughput(1);
  Hit hit = first_surface(world, caster, e);
  for (uint64_t segment = 1; hit.valid(); ++segment) {
    hit = pass_openings(world, caster, ray, hit, random.unit(segment, kBeamOpening));
    if (!hit.valid()) return false;
    const Surface s = make_surface(world, hit, ray.direction, random.unit(segment, kBeamPart));
    if (s.black()) return false;
    if (!s.is_delta()) {
      out = {hit, s, e.power * throughput * s.shading_ratio(s.in)};
      return true;
    }
    Rgb weight;
    double ior2;
    if (!sample_delta(s, random.unit(segment, kBeamDelta), Carried::kPower, ray.direction, weight,
                      ior2))
      return false;
    throughput *= weight;
    if (!survives(throughput, segment, world.scene().rr_depth, random.unit(segment, kBeamRoulette)))
      return false;
    ray.origin = hit.position;
    hit = caster.closest(ray, &hit);
  }
  return false;
}

BeamLight light_of_beam(const World& world, const RayCaster& caster, const BeamSpot& spot,
                        const Hit& hit, const Surface& surface) {
  BeamLight light;
  const Vec3 d = spot.hit.position - hit.position;
  const double distance2 = glm::dot(d, d);
  if (!(distance2 > 0)) return light;
  const double distance = std::sqrt(distance2);
  const Vec3 out = d / distance;
  const Surface& v = spot.surface;
  if (!v.reaches(-out)) return light;
  light.diffuse = diffuse_times_cosine(surface, out);
  light.glossy = glossy_times_cosine(surface, out);
  if (is_black(light.diffuse) && is_black(light.glossy)) return light;
  Rgb sent = (diffuse_times_cosine(v, -out) + glossy_times_cosine(v, -out, Carried::kPower)) *
             spot.power / v.shading_ratio(-out);
  if (is_black(sent)) return BeamLight();
  sent *=
      transmittance(world, caster, Ray{hit.position, out}, distance, &hit, &spot.hit) / distance2;
  light.diffuse *= sent;
  light.glossy *= sent;
  return light;
}

}  // namespace photonloom
