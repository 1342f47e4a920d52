// SPDX-License-Identifier: Apache-2.0
#include "golden/transport/bidirectional.hpp"

#include <algorithm>
#include <cmath>

#include "golden/numeric/elementary.hpp"
#include "golden/transport/beam.hpp"
#include "golden/transport/direct.hpp"
#include "golden/transport/roulette.hpp"
#include "golden/transport/visibility.hpp"

namespace photonloom {
namespace {

// Dimensions of one bounce; a light path's come from numbers of their own.
enum BidirectionalDimension : uint64_t {
  kBothLobe,
  kBothDirection,
  kBothChoice,
  kBothPoint,
  kBothRoulette,
  kBothPart,
  kBothOpening,
  kBothDirectionV
};

bool is_delta_light(const World& world, const LightEnd& end) {
  return world.emitters()[end.emitter].light >= 0 &&
         !(world.environment() && end.emitter == world.environment_emitter());
}

bool depth_allows(const World& world, uint64_t segments) {
  const int depth = world.scene().max_depth;
  return depth < 0 || segments <= static_cast<uint64_t>(depth);
}

// Density per solid angle with which a camera path leaves the surface; 1 of a delta surface.
double camera_density(const Surface& s, const Vec3& out) {
  if (!s.bsdf) return 0;
  if (s.is_delta()) return 1;
  if (s.black()) return 0;
  const double p = s.diffuse_probability();
  return (p > 0 ? p * diffuse_pdf(s, out) : 0) + (p < 1 ? (1 - p) * glossy_pdf(s, out) : 0);
}

// The same of a photon, whose diffuse directions go by the geometric normal.
double light_density(const Surface& s, const Vec3& out) {
  if (!s.bsdf) return 0;
  if (s.is_delta()) return 1;
  if (s.black()) return 0;
  const double p = s.diffuse_probability();
  return p * std::max(0.0, glm::dot(s.normal, out)) / kPi +
         (p < 1 ? (1 - p) * glossy_pdf(s, out) : 0);
}

// A density per solid angle at `from`, per area at a hit.
double per_area(double density, const Vec3& from, const Hit& to) {
  const Vec3 d = to.position - from;
  const double distance2 = glm::dot(d, d);
  if (!(distance2 > 0)) return 0;
  return density * std::fabs(glm::dot(to.normal, d)) / (distance2 * std::sqrt(distance2));
}

// The vertex's surface as light or a camera ray from another point would meet it.
Surface met_from(const World& world, const PathVertex& v, const Vec3& ray_direction) {
  return make_part(world, v.hit, ray_direction, *v.surface.bsdf, v.surface.is_delta());
}

Vec3 from_to(const Vec3& a, const Vec3& b) { return glm::normalize(b - a); }

// Unit, from a point to the light.
Vec3 towards(const Vec3& from, const LightEnd& end) {
  return end.infinite ? end.direction : from_to(from, end.position);
}

// Of the emission's direction, per area at the first surface.
double emitted_density(const World& world, const LightEnd& end, const Hit& to) {
  const Vec3 d = -towards(to.position, end);
  if (end.infinite)
    return std::fabs(glm::dot(to.normal, d)) / (kPi * world.radius() * world.radius());
  const Emitter& e = world.emitters()[end.emitter];
  if (e.primitive >= 0)
    return per_area(std::max(0.0, glm::dot(end.hit.normal, d)) / kPi, end.position, to);
  const Light& light = world.scene().lights[static_cast<size_t>(e.light)];
  if (light.kind == LightKind::kCollimated) return 1;
  double per_angle = 1 / (4 * kPi);
  if (light.kind == LightKind::kSpot)
    per_angle = mean(light.intensity) * spot_falloff(light, d) / mean(e.power);
  return per_area(per_angle, end.position, to);
}

// Of the emission's choice of the end: emitter, and point or direction.
double end_density(const World& world, const LightEnd& end) {
  const Emitter& e = world.emitters()[end.emitter];
  if (e.primitive >= 0) return e.pmf / world.primitives()[static_cast<size_t>(e.primitive)].area;
  if (is_delta_light(world, end)) return e.pmf;
  return e.pmf * world.environment()->pdf(end.direction);
}

// Of a camera path that leaves a surface with `density` per solid angle and finds the end.
double found_density(const World& world, double density, const Vec3& from, const LightEnd& end) {
  if (is_delta_light(world, end)) return 0;
  return end.infinite ? density : per_area(density, from, end.hit);
}

// Of a shadow ray from this surface, as the camera meets it.
double direct_density(const World& world, const Hit& hit, const Surface& s, const LightEnd& end) {
  const ShadingPoint x = shading_point(hit, s);
  if (is_beam(world, end.emitter)) return 0;
  if (is_delta_light(world, end)) return emitter_probability(world, x, end.emitter);
  if (end.infinite) return environment_pdf(world, x, end.direction);
  const Vec3 d = from_to(hit.position, end.position);
  return per_area(light_pdf(world, x, end.hit, d), hit.position, end.hit);
}

// Pixels per area of the surface, of all pixels of the film.
double seen_density(const World& world, const Seen& seen, const Hit& hit) {
  const Film& film = world.scene().film;
  return seen.density * std::fabs(glm::dot(hit.normal, seen.to_camera)) /
         (static_cast<double>(film.width) * static_cast<double>(film.height));
}

// Base 2.
double log_of(double density) { return density > 0 ? log2_exact(density) : -HUGE_VAL; }
double relative_square(double log_ratio) {
  constexpr double kFar = 500;  // beyond it one of the two counts for nothing
  return exp2_exact(2 * std::clamp(log_ratio, -kFar, kFar));
}

Rgb sent_power(const Surface& s, const Vec3& out) {
  if (!s.reaches(out)) return Rgb(0);
  return (diffuse_times_cosine(s, out) + glossy_times_cosine(s, out, Carried::kPower)) /
         s.shading_ratio(out);
}

bool only_delta_before(const LightSubpath& light, size_t vertex) {
  return std::all_of(light.vertices.begin(),
                     light.vertices.begin() + static_cast<std::ptrdiff_t>(vertex),
                     [](const PathVertex& x) { return x.surface.is_delta(); });
}

}  // namespace

LightEnd Bidirectional::end_at(const Hit& hit, const Vec3& direction) const {
  LightEnd end;
  if (hit.valid()) {
    end.emitter = static_cast<uint32_t>(world_.primitives()[hit.primitive].emitter);
    end.hit = hit;
    end.position = hit.position;
  } else {
    end.emitter = world_.environment_emitter();
    end.direction = direction;
    end.infinite = true;
  }
  return end;
}

void Bidirectional::trace_light(const Random& random, LightSubpath& out) const {
  out.vertices.clear();
  out.end = LightEnd();
  out.end.emitter = world_.choose_emitter(random.unit(0, 0));
  const Emitter& emitter = world_.emitters()[out.end.emitter];
  const Emission e = emit_photon_from(world_, out.end.emitter, random);
  if (is_black(e.power)) return;
  out.end.hit = e.from;
  out.end.position = e.ray.origin;
  out.end.direction = -e.ray.direction;
  if (emitter.light >= 0) {
    const LightKind kind = world_.scene().lights[static_cast<size_t>(emitter.light)].kind;
    out.end.infinite = kind == LightKind::kDirectional || kind == LightKind::kEnvironment;
  }
  out.forward = end_density(world_, out.end);
  Ray ray = e.ray;
  const Rgb power = e.power / emitter.pmf;
  Rgb throughput(1);
  Hit hit = first_surface(world_, caster_, e);
  for (uint64_t segment = 1; depth_allows(world_, segment + 1); ++segment) {
    hit = pass_openings(world_, caster_, ray, hit, random.unit(segment, kBothOpening));
    if (!hit.valid()) return;
    const Surface s = make_surface(world_, hit, ray.direction, random.unit(segment, kBothPart));
    if (s.black()) return;
    PathVertex v{hit, s, power * throughput, segment, 0, 0};
    if (!s.is_delta()) v.carried *= s.shading_ratio(s.in);
    std::vector<PathVertex>& all = out.vertices;
    if (all.empty()) {
      v.forward = emitted_density(world_, out.end, hit);
    } else {
      PathVertex& before = all.back();
      v.forward = per_area(light_density(before.surface, -s.in), before.hit.position, hit);
      const Surface back = met_from(world_, before, s.in);
      if (all.size() == 1) {
        const Vec3 to_end = towards(before.hit.position, out.end);
        out.backward =
            found_density(world_, camera_density(back, to_end), before.hit.position, out.end);
        out.direct = back.bsdf ? direct_density(world_, before.hit, back, out.end) : 0;
      } else {
        PathVertex& far = all[all.size() - 2];
        far.backward =
            per_area(camera_density(back, before.surface.in), before.hit.position, far.hit);
      }
    }
    all.push_back(v);
    if (s.is_delta()) {
      Rgb factor;
      double ior2;
      if (!sample_delta(s, random.unit(segment, kBothLobe), Carried::kPower, ray.direction, factor,
                        ior2))
        return;
      throughput *= factor;
    } else {
      const Vec2 u(random.unit(segment, kBothDirection), random.unit(segment, kBothDirectionV));
      if (!leave_with_power(s, random.unit(segment, kBothLobe), u, ray.direction, throughput))
        return;
    }
    if (!survives(throughput, segment, world_.scene().rr_depth,
                  random.unit(segment, kBothRoulette)))
      return;
    ray.origin = hit.position;
    hit = caster_.closest(ray, &hit);
  }
}

// The weight of a path that the camera's vertices, the light's and an end were joined to: in order
// from the camera, x_1 ... x_k with x_k the end. Technique s takes s vertices from the light.
double Bidirectional::weight(const PathVertex* camera, size_t camera_count, const PathVertex* light,
                             size_t light_count, const LightSubpath* subpath, const LightEnd& end,
                             const Vec3& to_camera, double lens_density, bool found) const {
  const size_t k = camera_count + light_count + 1;
  if (k == 1) return 1;  // an emitter that the camera sees, which nothing else finds
  struct Density {
    double camera = 0, light = 0;
    bool delta = false;
  };
  thread_local std::vector<Density> x;
  x.assign(k + 1, Density());
  for (size_t i = 1; i <= camera_count; ++i) {
    const PathVertex& v = camera[i - 1];
    x[i] = {v.forward, v.backward, v.surface.is_delta()};
  }
  for (size_t j = 1; j <= light_count; ++j) {
    const PathVertex& v = light[j - 1];
    x[k - j] = {v.backward, v.forward, v.surface.is_delta()};
  }
  x[k].light = subpath ? subpath->forward : end_density(world_, end);
  double direct = 0;
  if (light_count == 0) {
    // The camera's path alone, and the end.
    if (camera_count > 0) {
      const PathVertex& last = camera[camera_count - 1];
      const Vec3 d = towards(last.hit.position, end);
      x[k].camera = found_density(world_, camera_density(last.surface, d), last.hit.position, end);
      direct = direct_density(world_, last.hit, last.surface, end);
      x[k - 1].light = emitted_density(world_, end, last.hit);
      if (camera_count > 1) {
        const PathVertex& before = camera[camera_count - 2];
        x[k - 2].light = per_area(light_density(met_from(world_, last, -d), last.surface.in),
                                  last.hit.position, before.hit);
      }
    }
  } else {
    const PathVertex& there = light[light_count - 1];
    const size_t at = k - light_count;  // its place
    if (camera_count > 0) {
      const PathVertex& here = camera[camera_count - 1];
      const Vec3 d = from_to(here.hit.position, there.hit.position);
      x[at].camera = per_area(camera_density(here.surface, d), here.hit.position, there.hit);
      x[at - 1].light = per_area(light_density(there.surface, -d), there.hit.position, here.hit);
      if (camera_count > 1)
        x[at - 2].light = per_area(light_density(met_from(world_, here, -d), here.surface.in),
                                   here.hit.position, camera[camera_count - 2].hit);
    } else {
      x[at].camera = lens_density;
    }
    const Surface seen = met_from(world_, there, -to_camera);
    if (light_count > 1) {
      x[at + 1].camera = per_area(camera_density(seen, there.surface.in), there.hit.position,
                                  light[light_count - 2].hit);
      x[k].camera = subpath->backward;
      direct = subpath->direct;
    } else {
      x[k].camera = found_density(world_, camera_density(seen, towards(there.hit.position, end)),
                                  there.hit.position, end);
      direct = seen.bsdf ? direct_density(world_, there.hit, seen, end) : 0;
    }
  }
  // Densities of the techniques, as logarithms: of k vertices products may leave the range.
  thread_local std::vector<double> beyond;  // of the light's part, x_i ... x_k
  beyond.assign(k + 2, 0);
  for (size_t i = k; i >= 1; --i) beyond[i] = beyond[i + 1] + log_of(x[i].light);
  const size_t own = found ? 0 : light_count + 1;
  double own_log = -HUGE_VAL, largest = -HUGE_VAL;
  thread_local std::vector<double> logs;
  logs.assign(k + 1, -HUGE_VAL);
  double from_camera = 0;  // of x_1 ... x_(k - s), while s falls
  for (size_t s = k;; --s) {
    const size_t t = k - s;  // surfaces of the camera's path
    if (t > 0) from_camera += log_of(x[t].camera);
    bool possible;
    double value;
    if (s == 0) {
      possible = !is_delta_light(world_, end);
      value = from_camera;
    } else if (s == 1) {
      possible = k >= 2 && !x[t].delta;
      value = from_camera + log_of(direct);
    } else {
      possible = !x[t + 1].delta && (t == 0 || !x[t].delta);
      value = from_camera + beyond[t + 1];
    }
    if (possible && !std::isnan(value)) logs[s] = value;
    largest = std::max(largest, logs[s]);
    if (s == own) own_log = logs[s];
    if (s == 0) break;
  }
  if (own_log == -HUGE_VAL || largest == HUGE_VAL) return 0;
  double sum = 0;
  for (const double l : logs) sum += l == -HUGE_VAL ? 0 : relative_square(l - own_log);
  return 1 / sum;
}

// Light of an emitter chosen for the last vertex, without its weight.
Rgb Bidirectional::sampled_light(const PathVertex* camera, size_t count, double choice,
                                 const Vec2& u, LightEnd& end) const {
  const PathVertex& v = camera[count - 1];
  LightSample light;
  if (!sample_light(world_, shading_point(v.hit, v.surface), choice, u, light)) return Rgb(0);
  if (is_beam(world_, light.emitter)) return Rgb(0);
  const Vec3& d = light.direction;
  const Rgb here = diffuse_times_cosine(v.surface, d) + glossy_times_cosine(v.surface, d);
  if (is_black(here)) return Rgb(0);
  // As direct_light: a lamp without a surface may lie on one.
  const double end_of_ray =
      light.on_surface ? light.distance
                       : light.distance - 0x1p-44 * (max_component(glm::abs(v.hit.position)) +
                                                     std::min(light.distance, world_.radius()));
  const double passing = transmittance(world_, caster_, Ray{v.hit.position, d}, end_of_ray, &v.hit,
                                       light.on_surface ? &light.hit : nullptr);
  if (passing == 0) return Rgb(0);
  end.emitter = light.emitter;
  end.hit = light.on_surface ? light.hit : Hit();
  end.infinite = std::isinf(light.distance);
  end.direction = d;
  if (light.on_surface)
    end.position = light.hit.position;
  else if (!end.infinite)
    end.position = v.hit.position + d * light.distance;
  return v.carried * here * light.radiance * passing;
}

// What the light's vertex sends to the camera by way of the other, without its weight.
Rgb Bidirectional::joined(const PathVertex& camera, const PathVertex& light) const {
  const Vec3 d = light.hit.position - camera.hit.position;
  const double distance2 = glm::dot(d, d);
  if (!(distance2 > 0)) return Rgb(0);
  const double distance = std::sqrt(distance2);
  const Vec3 out = d / distance;
  const Rgb here =
      diffuse_times_cosine(camera.surface, out) + glossy_times_cosine(camera.surface, out);
  if (is_black(here)) return Rgb(0);
  const Rgb there = sent_power(light.surface, -out);
  if (is_black(there)) return Rgb(0);
  const double passing = transmittance(world_, caster_, Ray{camera.hit.position, out}, distance,
                                       &camera.hit, &light.hit);
  return camera.carried * here * there * light.carried * (passing / distance2);
}

PathSample Bidirectional::sample(const Lens& lens, int px, int py, const PixelNumbers& numbers,
                                 const LightSubpath& light) const {
  const Vec2 jitter = numbers.pair(0, 0);
  const Vec2 lens_point = lens.has_aperture() ? numbers.pair(0, 1) : Vec2(0);
  const CameraRay camera = lens.through(px + jitter.x, py + jitter.y, lens_point);
  PathSample out;
  out.place = jitter;
  Ray ray = camera.ray;
  const auto opening = [&](uint64_t segment) {
    return world_.has_openings() ? numbers.unit(segment, kBothOpening) : 0;
  };
  Hit hit = first_hit(world_, caster_, camera, opening(1));
  if (hit.valid()) {
    out.normal = hit.shading_normal;
    out.depth = hit.distance;
    out.albedo = world_.albedo(hit, ray.direction);
  }
  thread_local std::vector<PathVertex> vertices;
  vertices.clear();
  Rgb throughput(1);
  double ior2 = 1;
  // Where the first surface that is not delta stands, and whether its diffuse lobe was left by.
  size_t first = 0;
  bool first_diffuse = false;
  const auto found_layer = [&]() -> Rgb& {
    if (first == 0) return out.emission;
    if (vertices.size() == first) return out.direct;
    const bool delta_since =
        std::all_of(vertices.begin() + static_cast<std::ptrdiff_t>(first), vertices.end(),
                    [](const PathVertex& v) { return v.surface.is_delta(); });
    return delta_since && first_diffuse ? out.caustic : out.indirect;
  };
  const auto add_found = [&](const Rgb& radiance) {
    if (is_black(radiance)) return;
    const double w = weight(vertices.data(), vertices.size(), nullptr, 0, nullptr,
                            end_at(hit, ray.direction), Vec3(0), 0, true);
    found_layer() += throughput * radiance * w;
  };
  for (uint64_t segment = 1; hit.valid(); ++segment) {
    add_found(world_.emission(hit, ray.direction));
    if (!depth_allows(world_, segment + 1)) break;
    const Surface s = make_surface(world_, hit, ray.direction,
                                   world_.has_choices() ? numbers.unit(segment, kBothPart) : 0);
    if (s.black()) break;
    PathVertex v{hit, s, throughput, segment, 0, 0};
    if (vertices.empty()) {
      Seen seen;
      if (lens.project(hit.position, lens_point, seen)) v.forward = seen_density(world_, seen, hit);
    } else {
      const PathVertex& before = vertices.back();
      v.forward = per_area(camera_density(before.surface, -s.in), before.hit.position, hit);
      if (vertices.size() > 1) {
        PathVertex& far = vertices[vertices.size() - 2];
        far.backward = per_area(light_density(met_from(world_, before, s.in), before.surface.in),
                                before.hit.position, far.hit);
      }
    }
    vertices.push_back(v);
    if (s.is_delta()) {
      Rgb factor;
      double index2;
      if (!sample_delta(s, numbers.unit(segment, kBothLobe), Carried::kRadiance, ray.direction,
                        factor, index2))
        break;
      throughput *= factor;
      ior2 *= index2;
    } else {
      if (first == 0) first = vertices.size();
      LightEnd end;
      const Rgb light_here =
          sampled_light(vertices.data(), vertices.size(), numbers.unit(segment, kBothChoice),
                        numbers.pair(segment, kBothPoint), end);
      if (!is_black(light_here))
        (first == vertices.size() ? out.direct : out.indirect) +=
            light_here *
            weight(vertices.data(), vertices.size(), nullptr, 0, nullptr, end, Vec3(0), 0, false);
      for (size_t j = 1; j <= light.vertices.size(); ++j) {
        const PathVertex& there = light.vertices[j - 1];
        if (there.surface.is_delta() || !depth_allows(world_, segment + 1 + there.segments))
          continue;
        const Rgb joint = joined(v, there);
        if (is_black(joint)) continue;
        // The place where a beam lands counts as its emitter.
        const bool lit = first == vertices.size() && is_beam(world_, light.end.emitter) &&
                         only_delta_before(light, j - 1);
        (lit ? out.direct : out.indirect) +=
            joint * weight(vertices.data(), vertices.size(), light.vertices.data(), j, &light,
                           light.end, from_to(there.hit.position, hit.position), 0, false);
      }
      const double p = s.diffuse_probability();
      const bool diffuse = numbers.unit(segment, kBothLobe) < p;
      if (first == vertices.size()) first_diffuse = diffuse;
      const Vec2 u = numbers.pair(segment, kBothDirection);
      ray.direction = diffuse ? sample_diffuse(s, u) : sample_glossy(s, u);
      const double pdf =
          diffuse ? p * diffuse_pdf(s, ray.direction) : (1 - p) * glossy_pdf(s, ray.direction);
      if (!(pdf > 0)) break;
      throughput *= (diffuse ? diffuse_times_cosine(s, ray.direction)
                             : glossy_times_cosine(s, ray.direction)) /
                    pdf;
      if (is_black(throughput)) break;
      if (s.transmits() && !s.above(ray.direction)) ior2 *= s.relative_ior() * s.relative_ior();
    }
    if (!survives(throughput, segment, world_.scene().rr_depth,
                  numbers.unit(segment, kBothRoulette), ior2))
      break;
    ray.origin = hit.position;
    hit = caster_.closest(ray, &hit);
    hit = pass_openings(world_, caster_, ray, hit, opening(segment + 1));
  }
  if (!hit.valid() && world_.environment())
    add_found(world_.environment()->radiance(ray.direction));
  return out;
}

bool Bidirectional::splat(const Lens& lens, const Vec2& u, const LightSubpath& light, size_t number,
                          Splat& out) const {
  const PathVertex& v = light.vertices[number];
  Seen seen;
  // Where a beam lands, nothing is seen.
  const bool by_delta = only_delta_before(light, number);
  if (by_delta && is_beam(world_, light.end.emitter)) return false;
  if (v.surface.is_delta() || !lens.project(v.hit.position, u, seen)) return false;
  const Vec3& d = seen.to_camera;
  if (!v.surface.reaches(d)) return false;
  const Rgb diffuse = diffuse_times_cosine(v.surface, d);
  const Rgb glossy = glossy_times_cosine(v.surface, d, Carried::kPower);
  if (is_black(diffuse) && is_black(glossy)) return false;
  const double passing =
      transmittance(world_, caster_, Ray{v.hit.position, d}, seen.distance, &v.hit, nullptr);
  if (passing == 0) return false;
  const double w = weight(nullptr, 0, light.vertices.data(), number + 1, &light, light.end, d,
                          seen_density(world_, seen, v.hit), false);
  const Rgb scale = v.carried * (w * passing * seen.density / v.surface.shading_ratio(d));
  out = Splat{seen.x, seen.y};
  (number == 0 ? out.direct : by_delta ? out.caustic : out.indirect) += diffuse * scale;
  (number == 0 ? out.direct : out.indirect) += glossy * scale;
  return true;
}

}  // namespace photonloom
