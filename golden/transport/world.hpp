// SPDX-License-Identifier: Apache-2.0
// A scene made ready for light transport: primitives, emitters with their powers, and a ray caster.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "golden/numeric/random.hpp"
#include "golden/numeric/vec.hpp"
#include "golden/scene/scene.hpp"

namespace photonloom {

struct Ray {
  Vec3 origin, direction;  // direction is a unit vector
};

// Where a ray met a surface. Normals are unit vectors on the surface's own side (not turned towards
// the ray).
struct Hit {
  Vec3 position;
  Vec3 normal;  // geometric
  Vec3 shading_normal;
  double distance = 0;
  uint32_t primitive = ~0u;
  uint32_t shape = ~0u;
  bool valid() const { return shape != ~0u; }
};

// Finds hits. A ray that starts on primitive `from` (of the hit it leaves) never hits itself again
// because of rounding, at any scale of the scene: no absolute epsilon.
class RayCaster {
 public:
  virtual ~RayCaster() = default;
  virtual Hit closest(const Ray& ray, const Hit* from) const = 0;
  // Whether anything stands between two points (`to` may lie on a surface given by `to_hit`).
  virtual bool occluded(const Ray& ray, double distance, const Hit* from,
                        const Hit* to_hit) const = 0;
};

class World;
std::unique_ptr<RayCaster> make_double_bvh(
    const World& world);  // our own; the photon mapper's, in both arithmetics
std::unique_ptr<RayCaster> make_embree(const World& world);  // the path tracer's

// A photon as it lands, in scene units.
struct Photon {
  Vec3 position;
  Vec3 direction;   // unit, to where the light came from
  Rgb power;        // W, already divided by the paths emitted
  uint64_t path;    // number of the emitted path
  uint32_t bounce;  // surface interactions before this one
};

struct PhotonPass {
  std::vector<Photon> photons;
  uint64_t paths = 0;  // emitted
  bool short_of_request = false;
};

// Where a walk stops to ask the photon map.
struct DiffuseHit {
  Vec3 position;
  Vec3 normal;          // geometric, turned to the side that is lit and seen
  Vec3 shading_normal;  // turned likewise
  Hit hit;
};

// The camera's path of one sample: everything but the caustic estimate and the final gather.
struct CameraSample {
  // What the first hit shows; zero where the ray leaves the scene.
  Rgb albedo{0};
  Vec3 normal{0};    // world
  double depth = 0;  // distance along the ray
  // Radiance found on the way, by layer.
  Rgb emission{0};       // emitters seen directly or through delta surfaces
  Rgb direct{0};         // shadow rays (and their MIS partner) at the first non-delta hit
  Rgb indirect{0};       // what glossy lobes gathered further on
  bool diffuse = false;  // x exists: the rest asks the photon map
  bool first =
      false;  // x is the first non-delta hit, so its caustic estimate belongs to the caustic layer
  DiffuseHit x;
  Rgb weight{0};  // throughput up to x, times rho_d / pi, over the probability of the lobe
};

// One final gather ray.
struct GatherSample {
  Rgb radiance{
      0};  // what glossy lobes saw of emitters on the way, already times `weight_in`'s path
  bool diffuse = false;  // y exists
  DiffuseHit y;
  Rgb weight{0};  // throughput from x to y, times rho_d / pi at y, over probabilities; without cos
                  // and pdf at x
};

}  // namespace photonloom
