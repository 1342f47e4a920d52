// SPDX-License-Identifier: Apache-2.0
#include "golden/transport/light_paths.hpp"

#include <algorithm>
#include <cmath>

#include "golden/transport/beam.hpp"
#include "golden/transport/emitters.hpp"
#include "golden/transport/roulette.hpp"
#include "golden/transport/visibility.hpp"

namespace photonloom {
namespace {

enum LightDimension : uint64_t {
  kLightLobe,
  kLightRoulette,
  kLightDirectionU,
  kLightDirectionV,
  kLightPart,
  kLightOpening
};
constexpr uint64_t kLightChoice = 1 << 20;  // a dimension of bounce 0 that emission does not use

// Power per solid angle that the vertex sends into a direction, over its power; by lobe.
Rgb sent(const Rgb& bsdf_times_cosine, const Surface& s, const Vec3& out) {
  return s.reaches(out) ? bsdf_times_cosine / s.shading_ratio(out) : Rgb(0);
}

}  // namespace

LightPaths::LightPaths(const World& world, Photons photons)
    : world_(world),
      beside_photons_(photons == Photons::kOnDiffuse),
      boxes_(world),
      emission_(world, boxes_) {
  if (!world.has_delta() || (beside_photons_ && !world.has_glossy())) return;
  double sum = 0;
  for (uint32_t i = 0; i < world.emitters().size(); ++i) {
    if (world.emitters()[i].light < 0) continue;
    // Rays that leave the scene find the environment.
    if (world.environment() && i == world.environment_emitter()) continue;
    emitters_.push_back(i);
    cdf_.push_back(sum += world.emitters()[i].pmf * emission_.share(i));
  }
}

void LightPaths::trace(const RayCaster& caster, const Random& random,
                       std::vector<LightVertex>& out) const {
  out.clear();
  const double u = random.unit(0, kLightChoice) * cdf_.back();
  const size_t chosen = std::min<size_t>(
      static_cast<size_t>(std::upper_bound(cdf_.begin(), cdf_.end(), u) - cdf_.begin()),
      cdf_.size() - 1);
  const Emission e = emission_.from(emitters_[chosen], random);
  Ray ray = e.ray;
  // A beam's light starts where it lands (beam.hpp).
  bool on_its_way = is_beam(world_, emitters_[chosen]);
  if (!on_its_way && !boxes_.met_by(ray)) return;
  Rgb throughput(cdf_.back() / (cdf_[chosen] - (chosen > 0 ? cdf_[chosen - 1] : 0)));
  Hit hit = first_surface(world_, caster, e);
  bool through_delta = false;  // since the light or the last vertex
  bool first = true;
  for (uint64_t segment = 1; hit.valid() && depth_left(segment); ++segment) {
    hit = pass_openings(world_, caster, ray, hit, random.unit(segment, kLightOpening));
    if (!hit.valid()) return;
    const Surface s = make_surface(world_, hit, ray.direction, random.unit(segment, kLightPart));
    if (s.is_delta()) {
      Rgb weight;
      double ior2;
      if (!sample_delta(s, random.unit(segment, kLightLobe), Carried::kPower, ray.direction, weight,
                        ior2))
        return;
      throughput *= weight;
      through_delta = true;
    } else {
      if (s.black() || (!through_delta && !on_its_way)) return;
      const double p = s.diffuse_probability();
      const double lobe = random.unit(segment, kLightLobe);
      if (!on_its_way) {
        const LightVertex v{hit, s, e.power * throughput * s.shading_ratio(s.in), segment, first};
        if (!is_stored(v) || p < 1) out.push_back(v);
        // What a diffuse lobe sends through mirrors and glass, paths from the camera find again.
        if (beside_photons_ && lobe < p) return;
        first = false;
      }
      on_its_way = false;
      through_delta = false;
      const Vec2 u(random.unit(segment, kLightDirectionU), random.unit(segment, kLightDirectionV));
      if (!leave_with_power(s, lobe, u, ray.direction, throughput)) return;
      if (!boxes_.met_by(Ray{hit.position, ray.direction})) return;
    }
    if (!survives(throughput, segment, world_.scene().rr_depth,
                  random.unit(segment, kLightRoulette)))
      return;
    ray.origin = hit.position;
    hit = caster.closest(ray, &hit);
  }
}

Rgb LightPaths::connect(const RayCaster& caster, std::span<const LightVertex> vertices,
                        const Hit& hit, const Surface& surface, uint64_t segments,
                        Walk walk) const {
  Rgb sum(0);
  for (const LightVertex& v : vertices)
    if (depth_left(segments + v.segments)) sum += connect(caster, v, hit, surface, walk);
  return sum;
}

// Beside photons: where the camera's diffuse lobe meets a diffuse lobe of the vertex, and where a
// gather ray meets one, the global map has the light.
Rgb LightPaths::connect(const RayCaster& caster, const LightVertex& vertex, const Hit& hit,
                        const Surface& surface, Walk walk) const {
  const Vec3 d = vertex.hit.position - hit.position;
  const double distance2 = glm::dot(d, d);
  if (!(distance2 > 0)) return Rgb(0);
  const double distance = std::sqrt(distance2);
  const Vec3 out = d / distance;
  const Surface& v = vertex.surface;
  const Rgb here_diffuse = walk == Walk::kCamera ? diffuse_times_cosine(surface, out) : Rgb(0);
  const Rgb here_glossy = glossy_times_cosine(surface, out);
  if (is_black(here_diffuse) && is_black(here_glossy)) return Rgb(0);
  const Rgb glossy = sent(glossy_times_cosine(v, -out, Carried::kPower), v, -out);
  const Rgb diffuse = is_stored(vertex) ? Rgb(0) : sent(diffuse_times_cosine(v, -out), v, -out);
  Rgb light;
  if (!beside_photons_)
    light = (here_diffuse + here_glossy) * (diffuse + glossy);
  else if (walk == Walk::kCamera)
    light = here_diffuse * glossy + here_glossy * (diffuse + glossy);
  else
    light = here_glossy * glossy;
  if (is_black(light)) return Rgb(0);
  const double passing =
      transmittance(world_, caster, Ray{hit.position, out}, distance, &hit, &vertex.hit);
  if (passing == 0) return Rgb(0);
  return light * vertex.power * (passing / distance2);
}

bool LightPaths::splat(const RayCaster& caster, const Lens& lens, const Vec2& u,
                       const LightVertex& vertex, Splat& out) const {
  Seen seen;
  if (!depth_left(vertex.segments) || !lens.project(vertex.hit.position, u, seen)) return false;
  const Vec3& to_camera = seen.to_camera;
  const Surface& v = vertex.surface;
  const Rgb scale = vertex.power * seen.density;
  out.caustic = sent(diffuse_times_cosine(v, to_camera), v, to_camera) * scale;
  out.indirect = sent(glossy_times_cosine(v, to_camera, Carried::kPower), v, to_camera) * scale;
  if (is_stored(vertex)) out.caustic = Rgb(0);
  if (!vertex.first) {
    out.indirect += out.caustic;
    out.caustic = Rgb(0);
  }
  if (is_black(out.caustic) && is_black(out.indirect)) return false;
  const double passing = transmittance(world_, caster, Ray{vertex.hit.position, to_camera},
                                       seen.distance, &vertex.hit, nullptr);
  if (passing == 0) return false;
  out.caustic *= passing;
  out.indirect *= passing;
  out.x = seen.x;
  out.y = seen.y;
  return true;
}

}  // namespace photonloom
