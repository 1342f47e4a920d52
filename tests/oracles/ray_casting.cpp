// SPDX-License-Identifier: Apache-2.0
// The BVH against every primitive in turn, and what may not happen at edges and at other scales.
#include <cmath>

#include "golden/transport/emitters.hpp"
#include "golden/transport/intersect.hpp"
#include "golden/transport/sampling.hpp"
#include "tests/catch.hpp"
#include "tests/oracles/scenes.hpp"

using namespace photonloom;
using namespace photonloom::oracle;

namespace {

// All primitives, one after another.
Hit brute_force(const World& world, const Ray& ray) {
  Meeting best;
  best.t = HUGE_VAL;
  uint32_t primitive = ~0u;
  for (uint32_t i = 0; i < world.primitives().size(); ++i) {
    const Primitive& p = world.primitives()[i];
    Meeting m;
    const bool met = p.kind == PrimitiveKind::kTriangle
                         ? meet_triangle(p.a, p.b, p.c, ray.origin, Shear(ray.direction), m)
                     : p.kind == PrimitiveKind::kSphere
                         ? meet_sphere(p, ray.origin, ray.direction, false, m)
                         : meet_disk(p, ray.origin, ray.direction, m);
    if (met && m.t < best.t) {
      best = m;
      primitive = i;
    }
  }
  return primitive == ~0u ? Hit() : finish_hit(world, primitive, ray, best);
}

Scene soup(uint64_t seed, int triangles) {
  Scene s;
  const int grey = add_diffuse(s, Rgb(0.5));
  Shape mesh;
  mesh.bsdf = grey;
  for (int i = 0; i < triangles; ++i) {
    const Random r(seed, Phase::kPath, static_cast<uint64_t>(i));
    const Vec3 middle(r.unit(0, 0), r.unit(0, 1), r.unit(0, 2));
    const uint32_t n = static_cast<uint32_t>(mesh.mesh.positions.size());
    for (uint64_t v = 0; v < 3; ++v)
      mesh.mesh.positions.push_back(
          middle + 0.2 * (Vec3(r.unit(1 + v, 0), r.unit(1 + v, 1), r.unit(1 + v, 2)) - 0.5));
    mesh.mesh.triangles.push_back({n, n + 1, n + 2});
  }
  s.shapes.push_back(mesh);
  for (uint64_t i = 0; i < 10; ++i) {
    const Random r(seed, Phase::kPath, 100000 + i);
    add_sphere(s, grey, Vec3(r.unit(0, 0), r.unit(0, 1), r.unit(0, 2)), 0.1 * r.unit(0, 3));
    Shape& disk = add_sphere(s, grey, Vec3(r.unit(1, 0), r.unit(1, 1), r.unit(1, 2)), 0.2);
    disk.kind = ShapeKind::kDisk;
    disk.to_world[0] *= 0.5;
  }
  s.shapes[0].radiance = Rgb(1);
  return s;
}

}  // namespace

TEST_CASE("the BVH finds what a look at every primitive finds") {
  for (uint64_t seed : {1u, 2u, 3u}) {
    const World world(soup(seed, 700));
    const auto bvh = make_double_bvh(world);
    int hits = 0;
    for (uint64_t i = 0; i < 3000; ++i) {
      const Random r(seed, Phase::kCamera, i);
      Ray ray{Vec3(r.unit(0, 0), r.unit(0, 1), r.unit(0, 2)) * 3.0 - 1.0,
              sample_sphere({r.unit(0, 3), r.unit(0, 4)})};
      if (i % 10 == 0) ray.direction = Vec3(i % 20 ? 1 : 0, 0, i % 20 ? 0 : -1);
      const Hit expected = brute_force(world, ray), found = bvh->closest(ray, nullptr);
      CAPTURE(seed, i);
      REQUIRE(found.primitive == expected.primitive);
      REQUIRE(found.distance == expected.distance);
      if (!found.valid()) continue;
      ++hits;
      REQUIRE(bvh->occluded(ray, found.distance * (1 + 1e-9), nullptr, nullptr));
      REQUIRE_FALSE(bvh->occluded(ray, found.distance * (1 - 1e-9), nullptr, nullptr));
      REQUIRE(glm::length(found.position - (ray.origin + ray.direction * found.distance)) < 1e-13);
    }
    REQUIRE(hits > 100);
  }
}

TEST_CASE("no ray leaves a closed room, at any scale and any place") {
  for (double scale : {1e-3, 1.0, 1e3})
    for (double shift : {0.0, 1e3}) {
      Scene s;
      const int grey = add_diffuse(s, Rgb(0.5));
      const Vec3 lo = Vec3(-1, -2, -0.5) * scale + shift * scale,
                 hi = Vec3(1, 1.5, 0.7) * scale + shift * scale;
      add_room(s, grey, lo, hi).radiance = Rgb(1);
      const World world(s);
      const auto bvh = make_double_bvh(world);
      for (uint64_t path = 0; path < 2000; ++path) {
        const Random r(5, Phase::kPath, path);
        Ray ray{(lo + hi) * 0.5, sample_sphere({r.unit(0, 0), r.unit(0, 1)})};
        Hit hit = bvh->closest(ray, nullptr);
        for (uint64_t bounce = 1; bounce < 10; ++bounce) {
          CAPTURE(scale, shift, path, bounce);
          REQUIRE(hit.valid());
          REQUIRE(glm::dot(hit.normal, ray.direction) < 0);
          ray.origin = hit.position;
          // Grazing directions too.
          const double u = bounce % 3 ? r.unit(bounce, 0) : 1 - 1e-9 * r.unit(bounce, 0);
          ray.direction = Frame(hit.normal).to_world(sample_cosine({u, r.unit(bounce, 1)}));
          hit = bvh->closest(ray, &hit);
        }
      }
    }
}

TEST_CASE("rays through shared edges and vertices meet one of the neighbours") {
  // A fan of triangles around a vertex, rays aimed at points of its edges.
  Scene s;
  Shape fan;
  fan.bsdf = add_diffuse(s, Rgb(0.5));
  fan.radiance = Rgb(1);
  const int n = 31;
  fan.mesh.positions.push_back(Vec3(0.1, 0.2, 0.3));
  for (int i = 0; i < n; ++i) {
    const Vec2 c = cos_sin_turns(static_cast<double>(i) / n);
    fan.mesh.positions.push_back(Vec3(c.x, c.y, 0.1 * c.x * c.y));
  }
  for (uint32_t i = 0; i < n; ++i) fan.mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % n});
  s.shapes.push_back(fan);
  const World world(s);
  const auto bvh = make_double_bvh(world);
  for (uint64_t i = 0; i < 20000; ++i) {
    const Random r(11, Phase::kPath, i);
    const Vec3& rim = fan.mesh.positions[1 + i % n];
    const double w = i % 5 ? r.unit(0, 0) * 0.999 : 0;
    const Vec3 target = fan.mesh.positions[0] * (1 - w) + rim * w;
    const Vec3 origin = Vec3(r.unit(0, 1) - 0.5, r.unit(0, 2) - 0.5, 2 + r.unit(0, 3));
    CAPTURE(i);
    REQUIRE(bvh->closest(Ray{origin, glm::normalize(target - origin)}, nullptr).valid());
  }
}

TEST_CASE("the world's measures") {
  Scene s;
  const int grey = add_diffuse(s, Rgb(0.5)), mirror = add_mirror(s);
  add_room(s, grey, Vec3(0), Vec3(1, 2, 3));
  add_sphere(s, mirror, Vec3(0.5), 0.25);
  add_quad(s, add_diffuse(s, Rgb(0.3), true), Vec3(0.2, 1, 1), Vec3(0.5, 0, 0), Vec3(0, 0, 0.5))
      .radiance = Rgb(1, 2, 3);
  Light spot;
  spot.kind = LightKind::kSpot;
  spot.cutoff_angle = kPi / 3;
  spot.beam_angle = kPi / 4;
  spot.cutoff_cos = 0.5;
  spot.beam_cos = std::sqrt(0.5);
  s.lights.push_back(spot);
  const World world(s);
  REQUIRE(world.surface_area() == Approx(22 + kPi / 4 + 0.25));
  REQUIRE(world.diffuse_area() == Approx(22 + 0.5));
  REQUIRE(world.has_delta());
  REQUIRE_FALSE(world.has_glossy());
  REQUIRE(world.cube_extent() == Approx(3).epsilon(1e-4));
  REQUIRE(world.cube_origin().x < -0.99);
  REQUIRE(world.radius() == Approx(std::sqrt(14.0) / 2));
  // Area: pi A L; spot: the integral of its falloff by the midpoint rule.
  double integral = 0;
  for (int i = 0; i < 100000; ++i) {
    const double a = (i + 0.5) / 100000 * kPi / 3;
    integral += std::min(1.0, (kPi / 3 - a) / (kPi / 12)) * std::sin(a) * kPi / 3 / 100000;
  }
  REQUIRE(light_power(spot, 1).x == Approx(2 * kPi * integral).epsilon(1e-8));
  REQUIRE(world.emitted_power().y == Approx(kPi * 0.25 * 2 + 2 * kPi * integral).epsilon(1e-8));
  REQUIRE(world.emitters().size() == 3);
}
