// SPDX-License-Identifier: Apache-2.0
// Rays past surfaces that let part of the light straight on (mask, null). Such a surface is no
// bounce: a path's segments and what is a caustic do not depend on it.
#pragma once
#include <bit>

#include "golden/numeric/random.hpp"
#include "golden/transport/world.hpp"

namespace photonloom {

// Number of one decision at the i-th open surface that a ray meets, from the ray's own u.
inline double opening_number(double u, uint64_t i) {
  return to_unit(mix64(std::bit_cast<uint64_t>(u) + i * 0x9e3779b97f4a7c15ull));
}

// From the first hit of a ray on to the first surface that it does not pass; its distance counts
// from the ray's origin. `u` counts where World::has_openings().
inline Hit pass_openings(const World& world, const RayCaster& caster, const Ray& ray, Hit hit,
                         double u) {
  if (!world.has_openings()) return hit;
  double before = 0;
  for (uint64_t i = 0; hit.valid(); ++i) {
    const double opacity = world.opacity(hit, ray.direction);
    if (opacity >= 1 || opening_number(u, i) < opacity) break;
    before += hit.distance;
    hit = caster.closest(Ray{hit.position, ray.direction}, &hit);
  }
  hit.distance += before;
  return hit;
}

// Share of light that comes from `distance` along the ray to its origin; arguments as of
// RayCaster::occluded.
inline double transmittance(const World& world, const RayCaster& caster, const Ray& ray,
                            double distance, const Hit* from, const Hit* to_hit) {
  if (!world.has_openings()) return caster.occluded(ray, distance, from, to_hit) ? 0 : 1;
  // Only what is met before the end counts; each stretch between two surfaces asks for itself.
  double share = 1, left = distance;
  Ray rest = ray;
  Hit last;
  if (from) last = *from;
  const Hit* leaving = from;
  while (caster.occluded(rest, left, leaving, to_hit)) {
    const Hit hit = caster.closest(rest, leaving);
    if (!hit.valid()) return 0;
    share *= 1 - world.opacity(hit, ray.direction);
    if (share == 0) return 0;
    left -= hit.distance;
    rest.origin = hit.position;
    last = hit;
    leaving = &last;
    if (!(left > 0)) return share;
  }
  return share;
}

}  // namespace photonloom
