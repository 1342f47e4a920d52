// SPDX-License-Identifier: Apache-2.0
// Emitters as seen from a point, and as sources of photons.
#pragma once
#include "golden/numeric/random.hpp"
#include "golden/transport/world.hpp"

namespace photonloom {

// Power of a light in a scene of this radius, W: point 4 pi I; spot the integral of its falloff;
// directional E pi R^2.
Rgb light_power(const Light& light, double scene_radius);

// Share of a spot's intensity in a direction: 1 up to the beam angle, then linear in the angle to 0
// at the cutoff.
double spot_falloff(const Light& light, const Vec3& direction);

// A point of an emitter chosen for direct light at a surface point.
struct LightSample {
  Vec3 direction{0};    // from the surface to the light, unit
  double distance = 0;  // to the light; infinite for directional ones
  Rgb radiance{0};  // arriving, over the density it was chosen with (choice of emitter included)
  double pdf = 0;   // per solid angle; 0: no lobe sample can find this light
  bool on_surface = false;
  Hit hit;                 // where, for area emitters
  uint32_t emitter = 0;    // index into World::emitters()
  double probability = 0;  // of that choice; where it is a beam (beam.hpp), nothing else is told
};

// What the choice of an emitter knows of the surface point.
struct ShadingPoint {
  Vec3 position;
  Vec3 normal;              // geometric, on the side that is lit
  bool both_sides = false;  // light on the other side counts too: the surface transmits
};

// Chooses an emitter by the light it could send (few emitters) or by power (many), then a point on
// it: visible cone of a sphere, area of a triangle or disk. False: nothing can arrive.
bool sample_light(const World& world, const ShadingPoint& x, double choice, const Vec2& u,
                  LightSample& sample);

// Probability of an emitter in the choice of sample_light.
double emitter_probability(const World& world, const ShadingPoint& x, size_t emitter);

// Density, per solid angle, with which sample_light finds this hit on an emitter from x.
double light_pdf(const World& world, const ShadingPoint& x, const Hit& hit, const Vec3& direction);

// The same for a ray from x that leaves the scene, to an environment.
double environment_pdf(const World& world, const ShadingPoint& x, const Vec3& direction);

// A photon as it leaves its emitter. `from` is valid on area emitters.
struct Emission {
  Ray ray;
  Rgb power{0};
  Hit from;
};
Emission emit_photon(const World& world, const Random& random);
Emission emit_photon(const World& world, const Random& random, uint32_t& emitter);
// The same from one emitter; `power` is what all its photons carry together.
Emission emit_photon_from(const World& world, uint32_t emitter, const Random& random);

// The first surface that light of this emission meets. A point, spot or directional emitter has no
// surface of its own to leave out; one that it lies on, to within rounding, it shines away from.
Hit first_surface(const World& world, const RayCaster& caster, const Emission& e);

}  // namespace photonloom
