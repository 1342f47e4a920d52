// SPDX-License-Identifier: Apache-2.0
#include "golden/transport/emitters.hpp"

#include <algorithm>
#include <cmath>

#include "golden/transport/beam.hpp"
#include "golden/transport/sampling.hpp"

namespace photonloom {
namespace {

// Up to here every emitter is looked at from every point; beyond, emitters are chosen by power.
constexpr size_t kFewEmitters = 64;

double sine(double angle) { return cos_sin_turns(angle / (2 * kPi)).y; }
double cosine(double angle) { return cos_sin_turns(angle / (2 * kPi)).x; }

bool behind(const ShadingPoint& x, const Vec3& p) {
  return !x.both_sides && glm::dot(x.normal, p - x.position) <= 0;
}

// Irradiance the emitter could send to x, roughly; 0 only where it can send none.
double area_importance(const Primitive& p, const Emitter& e, const ShadingPoint& x) {
  Vec3 middle = p.a;
  if (p.kind == PrimitiveKind::kSphere) {
    const double r = p.b.x;
    if (!p.inward && glm::dot(x.position - p.a, x.position - p.a) < r * r) return 0;
    if (!x.both_sides && glm::dot(x.normal, p.a - x.position) <= -r) return 0;
  } else if (p.kind == PrimitiveKind::kCylinder) {
    middle = p.a + p.b * 0.5;
    const double reach = std::sqrt(glm::dot(p.b, p.b) / 4 + p.c.x * p.c.x);
    if (!x.both_sides && glm::dot(x.normal, middle - x.position) <= -reach) return 0;
  } else {
    if (glm::dot(p.normal, x.position - p.a) <= 0) return 0;
    if (p.kind == PrimitiveKind::kTriangle) {
      if (behind(x, p.a) && behind(x, p.b) && behind(x, p.c)) return 0;
      middle = (p.a + p.b + p.c) / 3.0;
    }
  }
  const Vec3 d = middle - x.position;
  return mean(e.power) / (kPi * (glm::dot(d, d) + p.area));
}

// Of a beam, whose place is not known: as if it were as far as the scene is wide.
double light_importance(const World& world, const Light& light, const ShadingPoint& x) {
  if (light.kind == LightKind::kDirectional)
    return x.both_sides || glm::dot(x.normal, light.direction) < 0 ? mean(light.intensity) : 0;
  // It shines from where it lands, which may be anywhere.
  if (light.kind == LightKind::kCollimated)
    return mean(light.intensity) / (4 * kPi * world.radius() * world.radius());
  if (behind(x, light.position)) return 0;
  const Vec3 d = x.position - light.position;
  double intensity = mean(light.intensity);
  if (light.kind == LightKind::kSpot) intensity *= spot_falloff(light, glm::normalize(d));
  return intensity / glm::dot(d, d);
}

double importance(const World& world, const Emitter& e, const ShadingPoint& x) {
  // About half of it comes from above, at a mean cosine of about a half.
  if (world.environment() && &e == &world.emitters()[world.environment_emitter()])
    return mean(world.environment()->integral()) / 4;
  return e.primitive >= 0
             ? area_importance(world.primitives()[static_cast<size_t>(e.primitive)], e, x)
             : light_importance(world, world.scene().lights[static_cast<size_t>(e.light)], x);
}

struct Choice {
  uint32_t emitter = 0;
  double probability = 0;
};

Choice choose_light(const World& world, const ShadingPoint& x, double u) {
  const auto& emitters = world.emitters();
  if (emitters.size() > kFewEmitters) {
    const uint32_t i = world.choose_emitter(u);
    return {i, emitters[i].pmf};
  }
  double weights[kFewEmitters];
  double total = 0;
  for (size_t i = 0; i < emitters.size(); ++i)
    total += weights[i] = importance(world, emitters[i], x);
  if (!(total > 0)) return {};
  double rest = u * total;
  Choice choice;
  for (size_t i = 0; i < emitters.size(); ++i) {
    if (weights[i] == 0) continue;
    choice = {static_cast<uint32_t>(i), weights[i] / total};
    if (rest < weights[i]) break;
    rest -= weights[i];
  }
  return choice;
}

// Uniform by area.
Hit point_on(const Primitive& p, uint32_t number, const Vec2& u) {
  Hit hit;
  hit.primitive = number;
  hit.shape = p.shape;
  hit.normal = p.normal;
  switch (p.kind) {
    case PrimitiveKind::kTriangle: {
      const double root = std::sqrt(u.x);
      const double wb = (1 - u.y) * root, wc = u.y * root;
      hit.position = p.a * (1 - wb - wc) + p.b * wb + p.c * wc;
      hit.coordinates = Vec2(wb, wc);
      break;
    }
    case PrimitiveKind::kSphere: {
      const Vec3 out = sample_sphere(u);
      hit.position = p.a + out * p.b.x;
      hit.normal = p.inward ? -out : out;
      break;
    }
    case PrimitiveKind::kDisk: {
      const Vec2 d = sample_disk(u);
      hit.position = p.a + p.b * d.x + p.c * d.y;
      hit.coordinates = d;
      break;
    }
    case PrimitiveKind::kCylinder: {
      const Frame frame(glm::normalize(p.b));
      const Vec2 turn = cos_sin_turns(u.y);
      const Vec3 out = frame.s * turn.x + frame.t * turn.y;
      hit.position = p.a + p.b * u.x + out * p.c.x;
      hit.normal = p.inward ? -out : out;
      break;
    }
    case PrimitiveKind::kUnevenSphere:
    case PrimitiveKind::kUnevenCylinder:
      break;  // these do not emit (World)
  }
  hit.shading_normal = hit.normal;
  return hit;
}

// 1 - cos of the half angle of the cone in which a sphere is seen from outside.
double sphere_cone(double r, double distance2) {
  const double sin2 = r * r / distance2;
  return sin2 / (1 + std::sqrt(std::max(0.0, 1 - sin2)));
}

bool cone_visible(const Primitive& p, const Vec3& x) {
  const Vec3 d = p.a - x;
  return p.kind == PrimitiveKind::kSphere && !p.inward && glm::dot(d, d) > p.b.x * p.b.x;
}

bool sample_area(const Primitive& p, const Emitter& e, const ShadingPoint& x, const Vec2& u,
                 LightSample& s) {
  s.on_surface = true;
  if (cone_visible(p, x.position)) {
    const Vec3 d = p.a - x.position;
    const double distance2 = glm::dot(d, d), distance = std::sqrt(distance2);
    const double h = sphere_cone(p.b.x, distance2);
    s.direction = Frame(d / distance).to_world(sample_cone(u, h));
    const double b = glm::dot(d, s.direction);
    const Vec3 across = d - s.direction * b;
    const double root = std::sqrt(std::max(0.0, p.b.x * p.b.x - glm::dot(across, across)));
    // Of a ball that is nearly a point nothing is left of the difference but rounding.
    constexpr double kPoint = 0x1p-30;
    const Vec3 out =
        p.b.x < kPoint * distance ? -s.direction : glm::normalize(s.direction * (b - root) - d);
    s.hit.position = p.a + out * p.b.x;
    s.hit.normal = s.hit.shading_normal = out;
    s.hit.primitive = static_cast<uint32_t>(e.primitive);
    s.hit.shape = p.shape;
    s.distance = b - root;
    s.pdf = 1 / (2 * kPi * h);
  } else {
    s.hit = point_on(p, static_cast<uint32_t>(e.primitive), u);
    const Vec3 d = s.hit.position - x.position;
    const double distance2 = glm::dot(d, d);
    if (!(distance2 > 0)) return false;
    s.distance = std::sqrt(distance2);
    s.direction = d / s.distance;
    const double cos_light = -glm::dot(s.hit.normal, s.direction);
    if (!(cos_light > 0)) return false;
    s.pdf = distance2 / (cos_light * p.area);
  }
  s.radiance = e.radiance;
  return true;
}

bool sample_delta_light(const Light& light, const ShadingPoint& x, LightSample& s) {
  s.on_surface = false;
  s.pdf = 0;
  if (light.kind == LightKind::kDirectional) {
    s.direction = -light.direction;
    s.distance = HUGE_VAL;
    s.radiance = light.intensity;
    return true;
  }
  const Vec3 d = light.position - x.position;
  const double distance2 = glm::dot(d, d);
  if (!(distance2 > 0)) return false;
  s.distance = std::sqrt(distance2);
  s.direction = d / s.distance;
  s.radiance = light.intensity / distance2;
  if (light.kind == LightKind::kSpot) s.radiance *= spot_falloff(light, -s.direction);
  return !is_black(s.radiance);
}

// A beam of parallel rays that covers the scene.
Ray from_disk(const World& world, const Vec3& direction, const Vec2& u) {
  const Frame frame(direction);
  const Vec2 d = sample_disk(u) * world.radius();
  return {world.centre() + frame.s * d.x + frame.t * d.y - frame.n * (2 * world.radius()),
          direction};
}

Ray emit_from_light(const World& world, const Light& light, const Random& random) {
  const auto pair = [&](uint64_t dimension) {
    return Vec2(random.unit(0, dimension), random.unit(0, dimension + 1));
  };
  switch (light.kind) {
    case LightKind::kCollimated:
      return {light.position, light.direction};
    case LightKind::kPoint:
      return {light.position, sample_sphere(pair(3))};
    case LightKind::kSpot: {
      // Uniform in the cone, kept in proportion to the falloff; every try has numbers of its own.
      const Frame frame(light.direction);
      for (uint64_t attempt = 0;; ++attempt) {
        const Vec3 d = frame.to_world(sample_cone(pair(3 + 3 * attempt), 1 - light.cutoff_cos));
        if (random.unit(0, 5 + 3 * attempt) < spot_falloff(light, d)) return {light.position, d};
      }
    }
    default:
      break;
  }
  return from_disk(world, light.direction, pair(3));
}

}  // namespace

double spot_falloff(const Light& light, const Vec3& direction) {
  const double c = glm::dot(light.direction, direction);
  if (c <= light.cutoff_cos) return 0;
  if (c >= light.beam_cos) return 1;
  const double angle = angle_of(c, glm::length(glm::cross(light.direction, direction)));
  return std::clamp((light.cutoff_angle - angle) / (light.cutoff_angle - light.beam_angle), 0.0,
                    1.0);
}

Rgb light_power(const Light& light, double scene_radius) {
  switch (light.kind) {
    case LightKind::kCollimated:
      return light.intensity;
    case LightKind::kPoint:
      return light.intensity * (4 * kPi);
    case LightKind::kDirectional:
      return light.intensity * (kPi * scene_radius * scene_radius);
    default:
      break;
  }
  // 2 pi times the integral of falloff(a) sin(a): 1 - (sin c - sin b) / (c - b).
  const double c = light.cutoff_angle, b = light.beam_angle;
  const double lobe = c > b ? 1 - (sine(c) - sine(b)) / (c - b) : 1 - cosine(c);
  return light.intensity * (2 * kPi * lobe);
}

bool sample_light(const World& world, const ShadingPoint& x, double choice, const Vec2& u,
                  LightSample& sample) {
  const Choice chosen = choose_light(world, x, choice);
  if (chosen.probability == 0) return false;
  sample.emitter = chosen.emitter;
  const Emitter& e = world.emitters()[chosen.emitter];
  if (e.primitive >= 0) {
    const Primitive& p = world.primitives()[static_cast<size_t>(e.primitive)];
    if (!sample_area(p, e, x, u, sample)) return false;
    if (e.texture >= 0) sample.radiance = world.emitted(e, sample.hit);
    sample.pdf *= chosen.probability;
    sample.radiance /= sample.pdf;
    return true;
  }
  if (world.environment() && chosen.emitter == world.environment_emitter()) {
    sample.direction = world.environment()->sample(u, sample.pdf);
    sample.distance = HUGE_VAL;
    sample.pdf *= chosen.probability;
    if (!(sample.pdf > 0)) return false;
    sample.radiance = world.environment()->radiance(sample.direction) / sample.pdf;
    return !is_black(sample.radiance);
  }
  sample.probability = chosen.probability;
  if (is_beam(world, chosen.emitter)) return true;
  if (!sample_delta_light(world.scene().lights[static_cast<size_t>(e.light)], x, sample))
    return false;
  sample.radiance /= chosen.probability;
  return true;
}

double emitter_probability(const World& world, const ShadingPoint& x, size_t emitter) {
  const auto& emitters = world.emitters();
  if (emitters.size() > kFewEmitters) return emitters[emitter].pmf;
  if (emitters.size() == 1) return importance(world, emitters[0], x) > 0 ? 1 : 0;
  double total = 0, own = 0;
  for (size_t i = 0; i < emitters.size(); ++i) {
    const double w = importance(world, emitters[i], x);
    total += w;
    if (i == emitter) own = w;
  }
  return total > 0 ? own / total : 0;
}

double light_pdf(const World& world, const ShadingPoint& x, const Hit& hit, const Vec3& direction) {
  const Primitive& p = world.primitives()[hit.primitive];
  if (p.emitter < 0) return 0;
  const double probability = emitter_probability(world, x, static_cast<size_t>(p.emitter));
  const Vec3 d = cone_visible(p, x.position) ? p.a - x.position : hit.position - x.position;
  const double distance2 = glm::dot(d, d);
  if (cone_visible(p, x.position)) return probability / (2 * kPi * sphere_cone(p.b.x, distance2));
  const double cos_light = -glm::dot(hit.normal, direction);
  return cos_light > 0 ? probability * distance2 / (cos_light * p.area) : 0;
}

double environment_pdf(const World& world, const ShadingPoint& x, const Vec3& direction) {
  return emitter_probability(world, x, world.environment_emitter()) *
         world.environment()->pdf(direction);
}

Emission emit_photon_from(const World& world, uint32_t emitter, const Random& random) {
  const Emitter& e = world.emitters()[emitter];
  Emission out;
  out.power = e.power;
  if (e.primitive >= 0) {
    const Primitive& p = world.primitives()[static_cast<size_t>(e.primitive)];
    out.from =
        point_on(p, static_cast<uint32_t>(e.primitive), Vec2(random.unit(0, 1), random.unit(0, 2)));
    const Vec3 local = sample_cosine(Vec2(random.unit(0, 3), random.unit(0, 4)));
    out.ray = {out.from.position, Frame(out.from.normal).to_world(local)};
    if (e.texture >= 0) out.power = world.emitted(e, out.from) * (kPi * p.area);
  } else if (world.environment() && emitter == world.environment_emitter()) {
    double pdf;
    const Vec3 to_sky =
        world.environment()->sample(Vec2(random.unit(0, 1), random.unit(0, 2)), pdf);
    out.ray = from_disk(world, -to_sky, Vec2(random.unit(0, 3), random.unit(0, 4)));
    const double area = kPi * world.radius() * world.radius();
    out.power = pdf > 0 ? world.environment()->radiance(to_sky) * (area / pdf) : Rgb(0);
  } else {
    out.ray = emit_from_light(world, world.scene().lights[static_cast<size_t>(e.light)], random);
  }
  return out;
}

Emission emit_photon(const World& world, const Random& random) {
  uint32_t emitter;
  return emit_photon(world, random, emitter);
}

Emission emit_photon(const World& world, const Random& random, uint32_t& emitter) {
  emitter = world.choose_emitter(random.unit(0, 0));
  Emission out = emit_photon_from(world, emitter, random);
  out.power /= world.emitters()[emitter].pmf;
  return out;
}

Hit first_surface(const World& world, const RayCaster& caster, const Emission& e) {
  if (e.from.valid()) return caster.closest(e.ray, &e.from);
  const Hit hit = caster.closest(e.ray, nullptr);
  const bool lies_on_it =
      hit.valid() &&
      hit.distance <= 0x1p-44 * (max_component(glm::abs(e.ray.origin)) + world.radius());
  return lies_on_it ? caster.closest(e.ray, &hit) : hit;
}

}  // namespace photonloom
