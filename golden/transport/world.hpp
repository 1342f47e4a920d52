// SPDX-License-Identifier: Apache-2.0
// A scene made ready for light transport: primitives, emitters with their powers, and a ray caster.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "golden/numeric/progress.hpp"
#include "golden/numeric/random.hpp"
#include "golden/numeric/vec.hpp"
#include "golden/scene/scene.hpp"
#include "golden/transport/environment.hpp"

namespace photonloom {

// Of the channels.
inline double mean(const Rgb& c) { return (c.x + c.y + c.z) / 3; }

struct Ray {
  Vec3 origin, direction;  // direction is a unit vector
};

// Where a ray met a surface. Normals are unit vectors on the surface's own side (not turned towards
// the ray).
struct Hit {
  Vec3 position;
  Vec3 normal;  // geometric
  Vec3 shading_normal;
  Vec2 coordinates{
      0};  // triangle: weights of its second and third vertex; disk: x, y of the unit one
  double distance = 0;
  uint32_t primitive = ~0u;
  uint32_t shape = ~0u;
  uint32_t instance = ~0u;  // index into World::instances(); none where the primitive is no group's
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

enum class PrimitiveKind : uint8_t {
  kTriangle,
  kSphere,
  kDisk,
  kCylinder,
  kUnevenSphere,    // an ellipsoid
  kUnevenCylinder,  // elliptic, and leaning where its transform shears
};

// What a ray can meet, in world space; a group's in the group's.
struct Primitive {
  PrimitiveKind kind = PrimitiveKind::kTriangle;
  bool inward = false;  // round ones: the normal points to the centre or axis
  uint32_t shape = 0;
  uint32_t index = 0;     // triangle: its number in the shape's mesh
  int32_t emitter = -1;   // area emitter: index into World::emitters()
  Vec3 a{0}, b{0}, c{0};  // triangle: vertices; sphere: centre a, radius b.x; disk: a + x b + y c,
                          // x^2 + y^2 <= 1; cylinder: foot a, axis b, c.x its radius; uneven
                          // ones: the unit shape's (x, y, z) stands at a + x b + y c + z axis
  Vec3 normal{0};         // triangle, disk: unit; others: unused
  Vec3 axis{0};           // uneven ones
  double area = 0;
};

// Something that emits: one primitive of a shape with radiance, or a light without a surface.
struct Emitter {
  int32_t primitive = -1;  // area emitter; else -1 and
  int32_t light = -1;      // index into Scene::lights
  Rgb radiance{0};         // area emitter, W/(m^2 sr); with a texture, its factor
  int32_t texture = -1;    // index into Scene::textures
  Rgb power{0};            // W; directional and environment: through the disk that covers the
                           // scene; textured: as if the texture were its mean everywhere
  double pmf = 0;          // probability of emission: its share of the total power
};

enum class CoatKind : uint8_t { kNone, kFresnel, kBurley };

// What light crosses on its way to a diffuse lobe and back: the coat of a plastic, smooth or rough,
// or of a coated BSDF; Burley's factor at each end of a principled one.
struct Coat {
  CoatKind kind = CoatKind::kNone;
  double ior = 1;
  double inner = 0;           // share of diffuse light from below that it reflects back
  std::vector<double> table;  // rough: what enters by the cosine, even steps from 0 to 1
  Rgb absorption{0};          // across its thickness
  // Share of light that enters from, or leaves to, a direction of this cosine.
  double enters(double cosine) const;
  // The same with what is left of it on the coat's other side.
  Rgb passes(double cosine) const;
};

// A group of primitives, shown at another place.
struct PlacedGroup {
  uint32_t group = 0;
  Mat4 to_world{1}, to_group{1};
  glm::dmat3 normals{1};    // carries normals: the inverse transpose
  Vec3 lower{0}, upper{0};  // in the world
  bool mirrored = false;
};

// A scene with primitives, emitters and bounds worked out. Throws SceneError when nothing emits.
class World {
 public:
  explicit World(Scene scene);

  const Scene& scene() const { return scene_; }
  // Those of the world first, then group by group.
  const std::vector<Primitive>& primitives() const { return primitives_; }
  struct Range {
    uint32_t begin, end;
  };
  Range world_primitives() const { return {0, groups_.empty() ? size() : groups_[0].begin}; }
  const std::vector<Range>& groups() const { return groups_; }  // into primitives()
  const std::vector<PlacedGroup>& instances() const { return instances_; }
  // A primitive as it stands in the world.
  Primitive placed(uint32_t primitive, uint32_t instance) const;
  const std::vector<Emitter>& emitters() const { return emitters_; }

  // Axis-aligned box of all primitives.
  const Vec3& lower() const { return lower_; }
  const Vec3& upper() const { return upper_; }
  // The cube of the plan: concentric with the box, its edge the box's longest edge times 1 + 2^-16,
  // so that no surface lies on its upper faces.
  const Vec3& cube_origin() const { return cube_origin_; }
  double cube_extent() const { return cube_extent_; }
  // Smallest sphere around the box's centre that holds all primitives.
  const Vec3& centre() const { return centre_; }
  double radius() const { return radius_; }

  double surface_area() const { return surface_area_; }  // one side, all shapes
  // Area that can hold photons: both sides where both sides have a diffuse lobe.
  double diffuse_area() const { return diffuse_area_; }
  bool has_delta() const { return has_delta_; }    // some surface is a mirror or glass
  bool has_glossy() const { return has_glossy_; }  // some surface has a glossy lobe
  // Some surface lets part of the light straight on (mask, null).
  bool has_openings() const { return has_openings_; }
  // Some surface has parts of which one is chosen at random.
  bool has_choices() const { return has_choices_; }
  const Environment* environment() const { return environment_.get(); }  // null: none
  uint32_t environment_emitter() const { return environment_emitter_; }
  Rgb emitted_power() const { return emitted_power_; }

  // Emission: the emitter for a number in [0, 1), in proportion to power (mean of the channels).
  uint32_t choose_emitter(double u) const;

  // The BSDF that a ray of this direction meets at the hit: front or back by the geometric normal.
  // Null: black.
  const Bsdf* bsdf(const Hit& hit, const Vec3& ray_direction) const {
    return bsdf(hit.shape, glm::dot(hit.normal, ray_direction) < 0);
  }
  const Bsdf* bsdf(uint32_t shape, bool front) const {
    const int index = side_bsdf_[2 * shape + (front ? 0 : 1)];
    return index < 0 ? nullptr : &scene_.bsdfs[static_cast<size_t>(index)];
  }
  // Share of light of this direction that the surface does not let straight on.
  double opacity(const Hit& hit, const Vec3& ray_direction) const {
    const bool front = glm::dot(hit.normal, ray_direction) < 0;
    if (!has_openings_ || !side_open_[2 * hit.shape + (front ? 0 : 1)]) return 1;
    return opacity(*bsdf(hit.shape, front), hit);
  }
  double opacity(const Bsdf& b, const Hit& hit) const;
  // Shares of a mixture's parts at a hit.
  double share(const Bsdf& mixture, size_t part, const Hit& hit) const;
  // Coat of a BSDF that is no mixture; null: none.
  const Coat* coat(const Bsdf& b) const {
    const size_t i = static_cast<size_t>(&b - scene_.bsdfs.data());
    return i < coats_.size() && coats_[i].kind != CoatKind::kNone ? &coats_[i] : nullptr;
  }

  // Mitsuba's texture coordinates; (0, 0) on meshes without.
  Vec2 uv(const Hit& hit) const;
  // Along which u grows, not normalised; 0 where there is none.
  Vec3 tangent(const Hit& hit) const;
  // How the position changes with u and v; false where there are no coordinates.
  bool derivatives(const Hit& hit, Vec3& du, Vec3& dv) const;
  // A texture's value, or 1 for index -1.
  Rgb texture(int index, const Hit& hit) const {
    return index < 0 ? Rgb(1) : texture_at(index, hit);
  }
  // Reflectance of all lobes, for the albedo layer.
  Rgb albedo(const Hit& hit, const Vec3& ray_direction) const {
    const Bsdf* b = bsdf(hit, ray_direction);
    return b ? albedo(*b, hit) : Rgb(0);
  }

  // Radiance leaving a hit against the ray: black but on the normal side of an emitter.
  Rgb emission(const Hit& hit, const Vec3& ray_direction) const {
    const int32_t e = primitives_[hit.primitive].emitter;
    return e >= 0 && glm::dot(hit.normal, ray_direction) < 0
               ? emitted(emitters_[static_cast<size_t>(e)], hit)
               : Rgb(0);
  }
  // Radiance of an area emitter at a point on it.
  Rgb emitted(const Emitter& e, const Hit& hit) const {
    return e.texture < 0 ? e.radiance : e.radiance * texture_at(e.texture, hit);
  }

 private:
  uint32_t size() const { return static_cast<uint32_t>(primitives_.size()); }
  void add_primitives();
  void add_shape(uint32_t shape);
  void add_instances();
  void measure();
  // Whether it matters which of two triangles of equal corners a ray meets.
  bool differ(const Primitive& p, const Primitive& q) const;
  void warn_of_twins();
  void add_emitters();
  void add_coats();
  Rgb texture_at(int index, const Hit& hit) const;
  Rgb albedo(const Bsdf& b, const Hit& hit) const;

  Scene scene_;
  std::vector<Primitive> primitives_;
  std::vector<Range> groups_;
  std::vector<PlacedGroup> instances_;
  std::vector<Emitter> emitters_;
  std::vector<double> emitter_cdf_;
  std::vector<int> side_bsdf_;  // two per shape: front, back; -1: black
  Vec3 lower_{0}, upper_{0}, cube_origin_{0}, centre_{0};
  double cube_extent_ = 1, radius_ = 0, surface_area_ = 0, diffuse_area_ = 0;
  bool has_delta_ = false, has_glossy_ = false, has_openings_ = false, has_choices_ = false;
  std::vector<char> side_open_;  // as side_bsdf_
  std::vector<Coat> coats_;      // by BSDF
  std::shared_ptr<const Environment> environment_;
  uint32_t environment_emitter_ = 0;
  Rgb emitted_power_{0};
};

// Our own BVH in double, the photon mapper's in both arithmetics. The world must outlive it.
std::unique_ptr<RayCaster> make_double_bvh(const World& world);
// Embree finds the primitive, the hit is refined in double; the path tracer's. With instances it is
// our own BVH.
std::unique_ptr<RayCaster> make_embree(const World& world);

// A photon as it lands, in scene units.
struct Photon {
  Vec3 position;
  Vec3 direction;   // unit, to where the light came from
  Rgb power;        // W, already divided by the paths emitted
  uint64_t path;    // number of the emitted path
  uint32_t bounce;  // surface interactions before this one
  // How far the light came from the last surface that was not a delta one, scene units; 0: it came
  // from an emitter, past delta surfaces at most, or nobody knows.
  double flight = 0;
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
  Vec3 shading_normal;  // turned likewise; the cosine of the BSDF is taken to it
  Hit hit;
  uint32_t segments = 0;       // of the path from the camera to here
  const Coat* coat = nullptr;  // through which light enters; null: none
};

// A camera path's first hit that is neither mirror nor glass, as its direct light needs it.
struct LitHit {
  bool exists = false;
  Hit hit;
  Vec3 direction{0};  // of the ray that came
  double part = 0;    // chooses among the parts of its BSDF
  Rgb throughput{0};
};

// The camera's path of one sample: everything but the caustic estimate and the final gather.
struct CameraSample {
  Vec2 place{0};  // on the film, within its pixel
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
  LitHit lit;     // where `direct` still lacks its shadow rays
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

// Photons for the global map: every photon that reaches a diffuse lobe. Paths are emitted in index
// order until `stored` photons are there (the last path is kept whole) or 100 * stored paths are
// out. Uses threads; the result does not depend on them.
PhotonPass trace_global_photons(const World& world, const RayCaster& caster, uint64_t stored,
                                uint64_t seed, Progress* progress = nullptr);
// Photons for the caustic map: light, one or more delta surfaces, diffuse lobe. Empty without delta
// surfaces. Ends as the global pass does, or when 32 * stored paths went towards a delta surface.
PhotonPass trace_caustic_photons(const World& world, const RayCaster& caster, uint64_t stored,
                                 uint64_t seed, Progress* progress = nullptr);

// Who casts the shadow rays of a camera path's first hit that is neither mirror nor glass: the
// path, one of each kind, or whoever calls trace_camera (shadow_rays.hpp).
enum class ShadowRays { kWithPath, kLater };

class LightPaths;

// One camera path through pixel (px, py) of the film, (0, 0) top left. `light_paths` are those
// beside photons, where a scene needs them (light_paths.hpp).
CameraSample trace_camera(const World& world, const RayCaster& caster, int px, int py,
                          uint64_t sample, uint64_t seed,
                          ShadowRays shadow_rays = ShadowRays::kWithPath,
                          const LightPaths* light_paths = nullptr);

// One final gather ray from x; zero where the direction is below x's surface.
GatherSample trace_gather(const World& world, const RayCaster& caster, const DiffuseHit& x,
                          const Vec3& direction, uint64_t pixel, uint64_t sample, uint64_t ray,
                          uint64_t seed, const LightPaths* light_paths = nullptr);

}  // namespace photonloom
