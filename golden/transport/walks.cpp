// SPDX-License-Identifier: Apache-2.0
// Camera paths and final gather rays of the photon mapper.
#include "golden/transport/camera.hpp"
#include "golden/transport/direct.hpp"
#include "golden/transport/light_paths.hpp"
#include "golden/transport/roulette.hpp"
#include "golden/transport/sampling.hpp"
#include "golden/transport/shadow_rays.hpp"
#include "golden/transport/visibility.hpp"

namespace photonloom {
namespace {

// Dimensions of one bounce.
enum WalkDimension : uint64_t {
  kWalkLobe,
  kWalkDirection,
  kWalkChoice,
  kWalkPoint,
  kWalkPartner,
  kWalkRoulette,
  kWalkPart,
  kWalkOpening,
  kWalkPartnerOpening
};

// Numbers of one gather ray.
class RayNumbers {
 public:
  RayNumbers(uint64_t seed, uint64_t pixel, uint64_t sample, uint64_t ray)
      : random_(seed, Phase::kGather, hash_bits(pixel, sample, ray, 0)) {}
  Vec2 pair(uint64_t bounce, uint64_t dimension) const {
    return Vec2(random_.unit(bounce, 2 * dimension), random_.unit(bounce, 2 * dimension + 1));
  }
  double unit(uint64_t bounce, uint64_t dimension) const {
    return random_.unit(bounce, 2 * dimension);
  }

 private:
  Random random_;
};

// What a glossy lobe left behind for the emitter that its ray may find.
struct GlossyRay {
  bool exists = false;         // the walk has left a glossy lobe
  bool through_delta = false;  // and has met delta surfaces since
  bool from_first = false;     // the lobe was at the first non-delta hit
  ShadingPoint x;
  double pdf = 0;  // lobe probability included
};

struct Path {
  Ray ray;
  Rgb throughput{1};
  double ior2 = 1;  // what glass took from the throughput as radiance
  GlossyRay glossy;
};

// Follows a delta surface; false: absorbed.
bool pass_delta(const Surface& s, double u, Path& path) {
  Rgb weight;
  double ior2;
  if (!sample_delta(s, u, Carried::kRadiance, path.ray.direction, weight, ior2)) return false;
  path.throughput *= weight;
  path.ior2 *= ior2;
  path.glossy.through_delta = true;
  return true;
}

// Leaves by the glossy lobe, chosen with `probability`; false: below the horizon.
bool leave_glossy(const Hit& hit, const Surface& s, const Vec2& u, double probability, Path& path) {
  const Vec3 out = sample_glossy(s, u);
  const double pdf = probability * glossy_pdf(s, out);
  if (!(pdf > 0) || !s.reaches(out)) return false;
  if (!s.above(out)) path.ior2 *= s.relative_ior() * s.relative_ior();
  path.throughput *= glossy_times_cosine(s, out) / pdf;
  path.ray.direction = out;
  path.glossy = {true, false, false, shading_point(hit, s), pdf};
  return !is_black(path.throughput);
}

DiffuseHit diffuse_hit(const Hit& hit, const Surface& s, uint64_t segments) {
  return {hit.position, s.normal, s.shading_normal, hit, static_cast<uint32_t>(segments), s.coat};
}

// Radiance of an emitter found by a glossy lobe: in full through delta surfaces, else by its
// weight against the shadow ray.
Rgb found_by_glossy(const World& world, const Path& path, const Hit& hit) {
  const Rgb radiance = world.emission(hit, path.ray.direction);
  if (is_black(radiance)) return Rgb(0);
  const GlossyRay& g = path.glossy;
  const double w = g.through_delta ? 1.0 : found_weight(world, g.x, g.pdf, hit, path.ray.direction);
  return path.throughput * radiance * w;
}

// The same of an environment, for a path that left the scene.
Rgb escaped_by_glossy(const World& world, const Path& path) {
  if (!world.environment()) return Rgb(0);
  const GlossyRay& g = path.glossy;
  const double w = g.through_delta ? 1.0 : escaped_weight(world, g.x, g.pdf, path.ray.direction);
  return path.throughput * world.environment()->radiance(path.ray.direction) * w;
}

// The light path of one walk, traced when it is first asked for.
class JoinedLight {
 public:
  JoinedLight(const LightPaths* paths, const RayCaster& caster, const Random& random)
      : paths_(paths), caster_(caster), random_(random) {}
  Rgb from(const Hit& hit, const Surface& s, uint64_t segments, LightPaths::Walk walk) {
    if (!traced_) paths_->trace(caster_, random_, vertices_);
    traced_ = true;
    return paths_->connect(caster_, vertices_, hit, s, segments, walk);
  }

 private:
  const LightPaths* paths_;
  const RayCaster& caster_;
  Random random_;
  bool traced_ = false;
  std::vector<LightVertex> vertices_;
};

// Numbers that only some scenes ask for.
template <class Numbers>
double part_number(const World& world, const Numbers& numbers, uint64_t segment) {
  return world.has_choices() ? numbers.unit(segment, kWalkPart) : 0;
}
template <class Numbers>
double opening_number(const World& world, const Numbers& numbers, uint64_t segment,
                      WalkDimension dimension = kWalkOpening) {
  return world.has_openings() ? numbers.unit(segment, dimension) : 0;
}

bool depth_left(const World& world, uint64_t segments) {
  const int depth = world.scene().max_depth;
  return depth < 0 || segments < static_cast<uint64_t>(depth);
}

// Direct light of all lobes at a camera path's non-delta hit.
Rgb camera_direct(const World& world, const RayCaster& caster, const Hit& hit, const Surface& s,
                  const PixelNumbers& numbers, uint64_t segment) {
  const double p = s.diffuse_probability();
  const DirectLight light =
      direct_light(world, caster, hit, s, numbers.unit(segment, kWalkChoice),
                   numbers.pair(segment, kWalkPoint), {p > 0 ? 1.0 : 0.0, 1 - p});
  Rgb sum = light.diffuse + light.glossy;
  if (p > 0)
    sum += diffuse_partner(world, caster, hit, s, numbers.pair(segment, kWalkPartner),
                           opening_number(world, numbers, segment, kWalkPartnerOpening));
  return sum;
}

}  // namespace

CameraSample trace_camera(const World& world, const RayCaster& caster, int px, int py,
                          uint64_t sample, uint64_t seed, ShadowRays shadow_rays,
                          const LightPaths* light_paths) {
  const Scene& scene = world.scene();
  const uint64_t pixel = static_cast<uint64_t>(py) * static_cast<uint64_t>(scene.film.width) +
                         static_cast<uint64_t>(px);
  const PixelNumbers numbers(seed, Phase::kCamera, pixel, sample);
  const Vec2 jitter = numbers.pair(0, 0);
  const Lens lens(scene);
  const CameraRay camera = lens.through(px + jitter.x, py + jitter.y,
                                        lens.has_aperture() ? numbers.pair(0, 1) : Vec2(0));
  CameraSample out;
  out.place = jitter;
  Path path{camera.ray, Rgb(1), 1, {}};
  Hit hit = first_hit(world, caster, camera, opening_number(world, numbers, 1));
  if (hit.valid()) {
    out.normal = hit.shading_normal;
    out.depth = hit.distance;
    out.albedo = world.albedo(hit, path.ray.direction);
  }
  JoinedLight joined(light_paths, caster,
                     Random(seed, Phase::kLightPath, hash_bits(pixel, sample, 0, 0)));
  bool at_first = true;  // no non-delta hit yet
  for (uint64_t segment = 1; hit.valid(); ++segment) {
    if (at_first) {
      out.emission += path.throughput * world.emission(hit, path.ray.direction);
    } else {
      const Rgb found = found_by_glossy(world, path, hit);
      (path.glossy.from_first && !path.glossy.through_delta ? out.direct : out.indirect) += found;
    }
    if (!depth_left(world, segment)) break;
    const Surface s =
        make_surface(world, hit, path.ray.direction, part_number(world, numbers, segment));
    if (s.black()) break;
    if (s.is_delta()) {
      if (!pass_delta(s, numbers.unit(segment, kWalkLobe), path)) break;
    } else {
      if (at_first && shadow_rays == ShadowRays::kLater) {
        out.lit = {true, hit, path.ray.direction, part_number(world, numbers, segment),
                   path.throughput};
      } else {
        const Rgb direct = camera_direct(world, caster, hit, s, numbers, segment);
        (at_first ? out.direct : out.indirect) += path.throughput * direct;
      }
      if (light_paths)
        out.indirect += path.throughput * joined.from(hit, s, segment, LightPaths::Walk::kCamera);
      const double p = s.diffuse_probability();
      if (numbers.unit(segment, kWalkLobe) < p) {
        // Photons take one segment more at least.
        if (depth_left(world, segment + 1)) {
          out.diffuse = true;
          out.first = at_first;
          out.x = diffuse_hit(hit, s, segment);
          out.weight = path.throughput * s.diffuse() * (1 / (kPi * p));
        }
        break;
      }
      if (!leave_glossy(hit, s, numbers.pair(segment, kWalkDirection), 1 - p, path)) break;
      path.glossy.from_first = at_first;
      at_first = false;
    }
    if (!survives(path.throughput, segment, scene.rr_depth, numbers.unit(segment, kWalkRoulette),
                  path.ior2))
      break;
    path.ray.origin = hit.position;
    hit = pass_openings(world, caster, path.ray, caster.closest(path.ray, &hit),
                        opening_number(world, numbers, segment + 1));
  }
  if (!hit.valid() && world.environment()) {
    if (at_first) {
      out.emission += path.throughput * world.environment()->radiance(path.ray.direction);
    } else {
      (path.glossy.from_first && !path.glossy.through_delta ? out.direct : out.indirect) +=
          escaped_by_glossy(world, path);
    }
  }
  return out;
}

GatherSample trace_gather(const World& world, const RayCaster& caster, const DiffuseHit& x,
                          const Vec3& direction, uint64_t pixel, uint64_t sample, uint64_t ray,
                          uint64_t seed, const LightPaths* light_paths) {
  GatherSample out;
  if (glm::dot(direction, x.normal) <= 0 || glm::dot(direction, x.shading_normal) <= 0) return out;
  const RayNumbers numbers(seed, pixel, sample, ray);
  Path path{{x.position, direction}, Rgb(1), 1, {}};
  JoinedLight joined(light_paths, caster,
                     Random(seed, Phase::kLightPath, hash_bits(pixel, sample, ray, 1)));
  if (x.coat) path.throughput *= x.coat->passes(glm::dot(direction, x.shading_normal));
  Hit hit = pass_openings(world, caster, path.ray, caster.closest(path.ray, &x.hit),
                          opening_number(world, numbers, x.segments + uint64_t{1}));
  for (uint64_t segment = x.segments + uint64_t{1}; hit.valid(); ++segment) {
    if (path.glossy.exists) out.radiance += found_by_glossy(world, path, hit);
    if (!depth_left(world, segment)) break;
    const Surface s =
        make_surface(world, hit, path.ray.direction, part_number(world, numbers, segment));
    if (s.black()) break;
    if (s.is_delta()) {
      if (!pass_delta(s, numbers.unit(segment, kWalkLobe), path)) break;
    } else {
      const double p = s.diffuse_probability();
      if (p < 1) {
        const DirectLight light =
            direct_light(world, caster, hit, s, numbers.unit(segment, kWalkChoice),
                         numbers.pair(segment, kWalkPoint), {0, 1 - p});
        out.radiance += path.throughput * light.glossy;
        if (light_paths)
          out.radiance += path.throughput * joined.from(hit, s, segment, LightPaths::Walk::kGather);
      }
      if (numbers.unit(segment, kWalkLobe) < p) {
        out.diffuse = true;
        out.y = diffuse_hit(hit, s, segment);
        out.weight = path.throughput * s.diffuse() * (1 / (kPi * p));
        break;
      }
      if (!leave_glossy(hit, s, numbers.pair(segment, kWalkDirection), 1 - p, path)) break;
    }
    if (!survives(path.throughput, segment, world.scene().rr_depth,
                  numbers.unit(segment, kWalkRoulette), path.ior2))
      break;
    path.ray.origin = hit.position;
    hit = pass_openings(world, caster, path.ray, caster.closest(path.ray, &hit),
                        opening_number(world, numbers, segment + 1));
  }
  if (!hit.valid() && path.glossy.exists) out.radiance += escaped_by_glossy(world, path);
  return out;
}

}  // namespace photonloom
