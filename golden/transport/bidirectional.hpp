// SPDX-License-Identifier: Apache-2.0
// Bidirectional path tracing (Veach 1997, chapter 10): a path from the camera and one from a light,
// every vertex of the one joined to every vertex of the other, each path of light weighted by the
// power heuristic over all the ways in which it could have been put together. It shares surfaces
// and emitters with the path tracer and no transport, so that each checks the other.
//
// Weights are functions of a path's points and of the parts chosen on them, so they add up to 1
// whatever they leave out; they leave out Russian roulette, passages of open surfaces and the
// choice within a delta surface.
#pragma once
#include <cstdint>
#include <vector>

#include "golden/transport/bsdf.hpp"
#include "golden/transport/camera.hpp"
#include "golden/transport/emitters.hpp"
#include "golden/transport/path_sample.hpp"
#include "golden/transport/sampling.hpp"

namespace photonloom {

// A surface on a path from the camera or from a light, as that path met it.
struct PathVertex {
  Hit hit;
  Surface surface;
  Rgb carried{0};         // camera: throughput; light: power, of the shaded surface (bsdf.hpp)
  uint64_t segments = 0;  // from the path's start to here
  double forward = 0;     // density, per area, with which its own path comes here
  double backward = 0;  // and with which a path the other way would; once two more vertices follow
};

// Where a path of light ends or begins.
struct LightEnd {
  uint32_t emitter = 0;
  Hit hit;                // on area emitters
  Vec3 position{0};       // of emitters at a finite distance
  Vec3 direction{0};      // to an infinitely distant one, unit
  bool infinite = false;  // directional, environment
};

struct LightSubpath {
  std::vector<PathVertex> vertices;  // from the light on
  LightEnd end;
  double forward = 0;   // density of the end: choice of emitter and point or direction
  double backward = 0;  // of a camera path that finds it, once two vertices are there
  double direct = 0;    // of a shadow ray from the first vertex, once two vertices are there
};

class Bidirectional {
 public:
  Bidirectional(const World& world, const RayCaster& caster) : world_(world), caster_(caster) {}

  void trace_light(const Random& random, LightSubpath& out) const;

  // One sample of pixel (px, py), without what reaches the camera as a splat.
  PathSample sample(const Lens& lens, int px, int py, const PixelNumbers& numbers,
                    const LightSubpath& light) const;

  // What the vertex of that number adds to the pixel that sees it through the point u of the lens;
  // false: nothing. To be counted over as many light paths as there are camera samples on the film.
  bool splat(const Lens& lens, const Vec2& u, const LightSubpath& light, size_t vertex,
             Splat& out) const;

 private:
  LightEnd end_at(const Hit& hit, const Vec3& direction) const;
  Rgb sampled_light(const PathVertex* camera, size_t count, double choice, const Vec2& u,
                    LightEnd& end) const;
  Rgb joined(const PathVertex& camera, const PathVertex& light) const;
  double weight(const PathVertex* camera, size_t camera_count, const PathVertex* light,
                size_t light_count, const LightSubpath* subpath, const LightEnd& end,
                const Vec3& to_camera, double lens_density, bool found) const;

  const World& world_;
  const RayCaster& caster_;
};

}  // namespace photonloom
