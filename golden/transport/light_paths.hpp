// SPDX-License-Identifier: Apache-2.0
// Light of point, spot and directional emitters that comes by way of mirrors and glass: a path from
// the camera never finds it, so the path tracer follows it from the light to the first surface that
// is not delta (a light vertex), and connects that vertex to the camera and to camera paths. From
// there the light path goes on as long as it meets mirrors or glass again before the next surface
// that is not delta, which is a further light vertex. Each path of light has one place at which it
// is connected: the first of its segments between two surfaces that are not delta (or such a
// surface and the camera).
// A photon mapper has what diffuse lobes get of such light: the caustic map at the camera's first
// diffuse hit, the global map where a final gather ray ends. What rough lobes get of it it lacks,
// and adds from the same light paths.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "golden/transport/bsdf.hpp"
#include "golden/transport/camera.hpp"
#include "golden/transport/caustic_emission.hpp"
#include "golden/transport/delta_boxes.hpp"
#include "golden/transport/path_sample.hpp"

namespace photonloom {

struct LightVertex {
  Hit hit;
  Surface surface;
  Rgb power{0};           // W, of the shaded surface (see bsdf.hpp)
  uint64_t segments = 0;  // from the light to here
  bool first = true;      // delta surfaces only between the light and here
};

// Where photons are stored, and so what light paths leave to them.
enum class Photons { kNone, kOnDiffuse };

class LightPaths {
 public:
  LightPaths(const World& world, Photons photons);

  // Whether the scene has such light: an emitter without a surface, a delta surface and, beside
  // photons, a glossy lobe.
  bool needed() const { return !emitters_.empty(); }

  // The light vertices of one path, in its order.
  void trace(const RayCaster& caster, const Random& random, std::vector<LightVertex>& out) const;

  // Radiance that a surface sends back along its ray for the light of all vertices of a path. The
  // walk came to the surface in so many segments; on a final gather ray, beside photons, only the
  // surface's glossy lobe is asked.
  enum class Walk { kCamera, kGather };
  Rgb connect(const RayCaster& caster, std::span<const LightVertex> vertices, const Hit& hit,
              const Surface& surface, uint64_t segments, Walk walk) const;

  // What one path adds to the mean radiance of the pixel that sees the vertex through the point u
  // of the lens; false: nothing. Beside photons all of it is indirect light.
  bool splat(const RayCaster& caster, const Lens& lens, const Vec2& u, const LightVertex& vertex,
             Splat& out) const;

 private:
  Rgb connect(const RayCaster& caster, const LightVertex& vertex, const Hit& hit,
              const Surface& surface, Walk walk) const;
  // Whether photons have what the vertex's diffuse lobe sends on.
  bool is_stored(const LightVertex& vertex) const { return beside_photons_ && vertex.first; }
  bool depth_left(uint64_t segments) const {
    const int depth = world_.scene().max_depth;
    return depth < 0 || segments < static_cast<uint64_t>(depth);
  }

  const World& world_;
  bool beside_photons_;
  DeltaBoxes boxes_;
  CausticEmission emission_;
  std::vector<uint32_t> emitters_;  // those without a surface
  std::vector<double> cdf_;         // by power
};

}  // namespace photonloom
