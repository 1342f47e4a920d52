// SPDX-License-Identifier: Apache-2.0
// The BVH against every primitive in turn, and what may not happen at edges and at other scales.
#include <cmath>

#include "golden/scene/mesh.hpp"
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
                         : meet_round(p, ray.origin, ray.direction, false, m);
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
    // A tube from the sphere's place to another, as the file's cylinders.
    const Vec3 from(r.unit(2, 0), r.unit(2, 1), r.unit(2, 2));
    const Vec3 along = 0.5 * (Vec3(r.unit(3, 0), r.unit(3, 1), r.unit(3, 2)) - 0.5);
    const Frame frame(glm::normalize(along));
    Shape& tube = add_sphere(s, grey, from, 1);
    tube.kind = ShapeKind::kCylinder;
    tube.to_world = Mat4(glm::dvec4(frame.s * 0.07, 0), glm::dvec4(frame.t * 0.07, 0),
                         glm::dvec4(along, 0), glm::dvec4(from, 1));
    // What an uneven instance makes of the two.
    Shape pressed = s.shapes[s.shapes.size() - 3], leaning = tube;
    for (Shape* shape : {&pressed, &leaning}) {
      Mat4 uneven(1);
      uneven[0][0] = 0.5;
      uneven[1] = glm::dvec4(0.4, 1.3, -0.2, 0);
      shape->to_world = uneven * shape->to_world;
      shape->uneven = true;
    }
    s.shapes.push_back(pressed);
    s.shapes.push_back(leaning);
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

TEST_CASE("instances: the hits of explicit copies, to the last bit") {
  const int triangles = 500;
  Scene copies, instanced;
  Shape mesh = soup(4, triangles).shapes[0];
  mesh.radiance.reset();
  mesh.mesh.normals.clear();
  for (const auto& t : mesh.mesh.triangles)
    for (int i = 0; i < 3; ++i)
      mesh.mesh.normals.push_back(
          glm::normalize(glm::cross(mesh.mesh.positions[t[1]] - mesh.mesh.positions[t[0]],
                                    mesh.mesh.positions[t[2]] - mesh.mesh.positions[t[0]]) +
                         Vec3(0, 1e-3 * i, 0)));
  for (const auto& t : mesh.mesh.triangles)
    for (const uint32_t v : t)
      mesh.mesh.uvs.emplace_back(mesh.mesh.positions[v].x, mesh.mesh.positions[v].y);
  const auto lamp = [](Scene& s) {
    add_quad(s, add_diffuse(s, Rgb(0.5)), Vec3(-9, -9, -9), Vec3(18, 0, 0), Vec3(0, 18, 0))
        .radiance = Rgb(1);
  };
  lamp(copies);
  lamp(instanced);
  Mat4 far(1), turned(1), sheared(1), mirrored(1);
  far[3] = {1e4, 0.1, 3, 1};
  const Vec2 c = cos_sin_turns(0.1);
  turned[0] = glm::dvec4(c.x, c.y, 0, 0) * 1.7;
  turned[1] = glm::dvec4(-c.y, c.x, 0, 0) * 1.7;
  turned[2] *= 1.7;
  turned[3] = {0.2, -0.3, 2, 1};
  sheared[1] = {0.4, 0.3, 0.1, 0};
  sheared[3] = {2, 0, 0, 1};
  mirrored[0] *= -1;
  const Mat4 places[] = {Mat4(1), far, turned, sheared, mirrored};
  for (const Mat4& m : places) {
    Shape copy = mesh;
    const bool turn = &m == &places[4];
    copy.mesh.positions.clear();
    for (const Vec3& p : mesh.mesh.positions)
      copy.mesh.positions.push_back(Vec3(m * glm::dvec4(p, 1)));
    for (Vec3& n : copy.mesh.normals)
      n = carried_normal(glm::transpose(glm::inverse(glm::dmat3(m))), n);
    for (auto& t : copy.mesh.triangles)
      if (turn) std::swap(t[1], t[2]);
    copies.shapes.push_back(copy);
    instanced.instances.push_back({0, m});
  }
  mesh.group = 0;
  instanced.shapes.push_back(mesh);
  const World explicit_world(copies), world(instanced);
  CHECK(world.lower() == explicit_world.lower());
  CHECK(world.upper() == explicit_world.upper());
  CHECK(world.radius() == explicit_world.radius());
  CHECK(world.surface_area() == Approx(explicit_world.surface_area()));
  CHECK(world.diffuse_area() == Approx(explicit_world.diffuse_area()));
  CHECK(world.primitives().size() == 2 + triangles);
  const auto expected_caster = make_double_bvh(explicit_world), caster = make_double_bvh(world);
  int hits[5] = {};
  for (uint64_t i = 0; i < 20000; ++i) {
    const Random r(5, Phase::kCamera, i);
    const uint64_t at = i % 5;
    const Vec3 inside = Vec3(places[at] * glm::dvec4(r.unit(0, 0), r.unit(0, 1), r.unit(0, 2), 1));
    Ray ray{inside, sample_sphere({r.unit(0, 3), r.unit(0, 4)})};
    ray.origin -= ray.direction * (3 * r.unit(0, 5));
    Hit expected, found;
    for (int bounce = 0; bounce < 2; ++bounce) {
      const Hit before_expected = expected, before = found;
      expected = expected_caster->closest(ray, bounce ? &before_expected : nullptr);
      found = caster->closest(ray, bounce ? &before : nullptr);
      CAPTURE(i, bounce);
      REQUIRE(found.valid() == expected.valid());
      if (!found.valid()) break;
      const bool is_copy = expected.shape > 0;
      REQUIRE((found.instance != ~0u) == is_copy);
      if (is_copy) {
        REQUIRE(found.instance + 1 == expected.shape);
        REQUIRE(world.primitives()[found.primitive].index ==
                explicit_world.primitives()[expected.primitive].index);
        ++hits[found.instance];
      }
      if (found.instance == 4) {  // another order of the corners
        REQUIRE(found.distance == Approx(expected.distance).epsilon(1e-12));
        REQUIRE(glm::length(found.normal - expected.normal) < 1e-12);
        break;
      }
      REQUIRE(found.distance == expected.distance);
      REQUIRE(found.position == expected.position);
      REQUIRE(found.normal == expected.normal);
      REQUIRE(found.shading_normal == expected.shading_normal);
      if (is_copy) {
        REQUIRE(world.uv(found) == explicit_world.uv(expected));
        REQUIRE(world.tangent(found) == explicit_world.tangent(expected));
      }
      const double beyond = found.distance * (1 + 1e-9);
      REQUIRE(caster->occluded(ray, beyond, bounce ? &before : nullptr, nullptr));
      REQUIRE_FALSE(caster->occluded(ray, beyond, bounce ? &before : nullptr, &found));
      ray = {found.position, sample_sphere({r.unit(1, 3), r.unit(1, 4)})};
    }
  }
  for (const int n : hits) CHECK(n > 500);
}

TEST_CASE("a cylinder: its inside, its open ends, and no second meeting with itself") {
  Scene s;
  Shape& tube = add_sphere(s, add_diffuse(s, Rgb(0.5)), Vec3(0), 1);
  tube.kind = ShapeKind::kCylinder;
  tube.to_world = Mat4(1);
  tube.to_world[2] = glm::dvec4(0, 0, 4, 0);
  tube.radiance = Rgb(1);
  const World world(s);
  CHECK(world.surface_area() == Approx(8 * kPi));
  CHECK(world.lower() == Vec3(-1, -1, 0));
  CHECK(world.upper() == Vec3(1, 1, 4));
  for (const auto& caster : {make_double_bvh(world), make_embree(world)}) {
    // Through an end onto the far inside; along the axis through both ends.
    const Hit inside = caster->closest({Vec3(-1.5, 0, -1), glm::normalize(Vec3(1, 0, 1))}, nullptr);
    REQUIRE(inside.valid());
    CHECK(glm::length(inside.position - Vec3(1, 0, 1.5)) < 1e-14);
    CHECK(glm::length(inside.normal - Vec3(1, 0, 0)) < 1e-15);
    CHECK(world.uv(inside).y == Approx(0.375));
    CHECK(std::fabs(glm::dot(world.tangent(inside), Vec3(0, 0, 1))) < 1e-15);
    CHECK_FALSE(caster->closest({Vec3(0.3, 0.2, -1), Vec3(0, 0, 1)}, nullptr).valid());
    // A chord from the inside meets the wall once more, and leaves by an end.
    for (uint64_t i = 0; i < 1000; ++i) {
      const Random r(3, Phase::kPath, i);
      const Vec3 d = sample_sphere({r.unit(0, 0), r.unit(0, 1)});
      const Hit again = caster->closest({inside.position, d}, &inside);
      const double across = d.x * d.x + d.y * d.y, t = -2 * d.x / across;
      const bool expected = d.x < 0 && 1.5 + t * d.z > 0 && 1.5 + t * d.z < 4;
      CAPTURE(i);
      REQUIRE(again.valid() == expected);
      if (expected) REQUIRE(again.distance == Approx(t).epsilon(1e-12));
    }
  }
}

TEST_CASE("uneven spheres and cylinders: closed forms, and the triangles of a fine mesh") {
  const auto stretched = [](ShapeKind kind, const glm::dmat3& m) {
    Scene s;
    Shape& shape = add_sphere(s, add_diffuse(s, Rgb(0.5)), Vec3(0), 1);
    shape.kind = kind;
    shape.to_world = Mat4(m);
    shape.to_world[3] = glm::dvec4(0.5, -1, 2, 1);
    shape.uneven = true;
    add_quad(s, -1, Vec3(-0.5, -0.5, 50), Vec3(0, 1, 0), Vec3(1, 0, 0)).radiance = Rgb(1);
    return s;
  };
  // An oblate spheroid of half axes 2, 2, 1; a round cylinder of radius 2 and height 3.
  const double e = std::sqrt(0.75);
  const World oblate(stretched(ShapeKind::kSphere, glm::dmat3(2, 0, 0, 0, 2, 0, 0, 0, 1)));
  CHECK(oblate.surface_area() ==
        Approx(1 + 8 * kPi * (1 + (1 - e * e) / e * std::atanh(e))).epsilon(1e-4));
  const World round(stretched(ShapeKind::kCylinder, glm::dmat3(2, 0, 0, 0, 2, 0, 0, 0, 3)));
  CHECK(round.surface_area() == Approx(1 + 12 * kPi));
  const glm::dmat3 lean(2, 0.3, 0, -0.2, 0.7, 0.4, 0.5, 0.1, -1.5);  // and mirrored
  for (const ShapeKind kind : {ShapeKind::kSphere, ShapeKind::kCylinder}) {
    const Scene s = stretched(kind, lean);
    const World world(s);
    const Shape& shape = world.scene().shapes[0];
    // The same of facets.
    const bool is_sphere = kind == ShapeKind::kSphere;
    const auto unit = [&](const Vec2& uv) {
      const Vec2 around = cos_sin_turns(uv.x), down = cos_sin_turns(uv.y / 2);
      return is_sphere ? Vec3(around * down.y, down.x) : Vec3(around, uv.y);
    };
    Scene facets = s;
    Shape mesh;
    mesh.bsdf = shape.bsdf;
    constexpr int kTurns = 400, kRows = 200;
    for (int row = 0; row <= kRows; ++row)
      for (int turn = 0; turn <= kTurns; ++turn) {
        const Vec2 uv(turn / double{kTurns}, row / double{kRows});
        mesh.mesh.positions.push_back(Vec3(shape.to_world * glm::dvec4(unit(uv), 1)));
        if (row == kRows || turn == kTurns) continue;
        const auto at = static_cast<uint32_t>(row * (kTurns + 1) + turn);
        const uint32_t below = at + kTurns + 1;
        mesh.mesh.triangles.push_back({at, below, at + 1});
        mesh.mesh.triangles.push_back({at + 1, below, below + 1});
      }
    facets.shapes[0] = mesh;
    const World fine(facets);
    CHECK(world.surface_area() == Approx(fine.surface_area()).epsilon(1e-3));
    CHECK(glm::length(world.lower() - fine.lower()) < 1e-3);
    CHECK(world.radius() >= fine.radius());
    const auto caster = make_double_bvh(world), of_facets = make_double_bvh(fine),
               embree = make_embree(world);
    int hits = 0, near = 0;
    for (uint64_t i = 0; i < 2000; ++i) {
      const Random r(9, Phase::kCamera, i);
      const Vec3 target(0.5 + r.unit(0, 0) - 0.5, -1.5 + r.unit(0, 1), 1.5 + r.unit(0, 2));
      const Vec3 d = sample_sphere({r.unit(1, 0), r.unit(1, 1)});
      const Ray ray{target - d * 6.0, d};
      const Hit found = caster->closest(ray, nullptr), expected = of_facets->closest(ray, nullptr);
      CAPTURE(i);
      REQUIRE(embree->closest(ray, nullptr).primitive == found.primitive);
      if (!found.valid() || found.primitive != 0) continue;
      ++hits;
      REQUIRE(glm::length(found.position - (ray.origin + ray.direction * found.distance)) < 1e-13);
      REQUIRE(glm::length(found.normal) == Approx(1));
      // What u and v mean, and their derivatives.
      Vec3 du, dv;
      REQUIRE(world.derivatives(found, du, dv));
      const Vec2 uv = world.uv(found);
      REQUIRE(glm::length(found.position - Vec3(shape.to_world * glm::dvec4(unit(uv), 1))) < 1e-12);
      const Vec2 around = cos_sin_turns(uv.x), down = cos_sin_turns(uv.y / 2);
      const Vec3 turned = Vec3(-around.y, around.x, 0) * (2 * kPi);
      REQUIRE(glm::length(du - lean * (is_sphere ? turned * down.y : turned)) < 1e-11);
      REQUIRE(glm::length(dv - lean * (is_sphere ? Vec3(around * down.x, -down.y) * kPi
                                                 : Vec3(0, 0, 1))) < 1e-11);
      REQUIRE(std::fabs(glm::dot(found.normal, du)) < 1e-12 * glm::length(du));
      REQUIRE(std::fabs(glm::dot(found.normal, dv)) < 1e-12 * glm::length(dv));
      // No second meeting with itself where the ray comes from.
      const Hit back = caster->closest({found.position, -ray.direction}, &found);
      REQUIRE((!back.valid() || back.distance > 1e-3));
      if (!expected.valid() || std::fabs(found.distance - expected.distance) > 1e-2) continue;
      ++near;
      const double side = glm::dot(expected.normal, found.normal);
      REQUIRE(std::fabs(side) > 0.99);
      const Vec3 out = found.position - Vec3(0.5, -1, 2);
      if (is_sphere) REQUIRE(glm::dot(found.normal, out) > 0);
    }
    CHECK(hits > 500);
    CHECK(near > 0.95 * hits);
  }
  Scene lit = stretched(ShapeKind::kSphere, lean);
  lit.shapes[0].radiance = Rgb(1);
  CHECK_THROWS_WITH(World(lit), ContainsSubstring("uneven scales emits"));
}

TEST_CASE("a segment to the inside of a round wall is cut by that wall, but for a chord") {
  Scene s;
  const int grey = add_diffuse(s, Rgb(0.5));
  add_sphere(s, grey, Vec3(0), 1);
  Shape& tube = add_sphere(s, grey, Vec3(0), 1);
  tube.kind = ShapeKind::kCylinder;
  tube.to_world = Mat4(1);
  tube.to_world[2] = glm::dvec4(0, 0, 4, 0);
  tube.to_world[3] = glm::dvec4(10, 0, 0, 1);
  tube.radiance = Rgb(1);
  const World world(s);
  for (const auto& caster : {make_double_bvh(world), make_embree(world)}) {
    for (const double x : {0.0, 10.0}) {
      const Vec3 middle(x, 0, x > 0 ? 2 : 0), along(1, 0, 0);
      const Hit inside = caster->closest({middle, along}, nullptr);
      const Hit outside = caster->closest({middle - along * 3.0, along}, nullptr);
      REQUIRE((inside.valid() && outside.valid()));
      const auto cut = [&](const Vec3& origin, const Hit* from, const Hit& to) {
        return caster->occluded({origin, along}, to.position.x - origin.x, from, &to);
      };
      CHECK(cut(middle - along * 3.0, nullptr, inside));
      CHECK_FALSE(cut(middle - along * 3.0, nullptr, outside));
      CHECK_FALSE(cut(middle, nullptr, inside));
      CHECK_FALSE(cut(outside.position, &outside, inside));
    }
    // Into the tube by its open end.
    const Vec3 direction = glm::normalize(Vec3(1, 0, 1)), origin(8.5, 0, -1);
    const Hit wall = caster->closest({origin, direction}, nullptr);
    REQUIRE(wall.valid());
    CHECK_FALSE(caster->occluded({origin, direction}, wall.distance, nullptr, &wall));
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

TEST_CASE("a room stays whole and bright however far away a ball is") {
  for (const double far : {1e5, 1e7, 1e9}) {
    Scene s;
    add_room(s, add_diffuse(s, Rgb(0.5)), Vec3(-1), Vec3(1)).radiance = Rgb(1);
    add_sphere(s, 0, Vec3(far, 0, 0), 0.5);
    set_camera(s, Vec3(0.2, 0.1, -0.3), Vec3(0, 0, 1), Vec3(0, 1, 0), 60, 16, 16);
    INFO("at " << far);
    // Le / (1 - rho)
    CHECK(channel_mean(path_image(s, 64, 1), "R") == Approx(2).epsilon(0.01));
  }
}

TEST_CASE("ball lamps of the same power light a floor the same, down to a point") {
  const auto lit = [](double radius) {
    Scene s;
    const int grey = add_diffuse(s, Rgb(0.5));
    add_quad(s, grey, Vec3(-1, 0, 1), Vec3(2, 0, 0), Vec3(0, 0, -2));
    add_sphere(s, grey, Vec3(0.1, 1, 0.2), radius).radiance = Rgb(1e-14 / (radius * radius));
    set_camera(s, Vec3(0, 3, 0), Vec3(0), Vec3(0, 0, 1), 30, 8, 8);
    return channel_mean(path_image(s, 16, 1), "R");
  };
  const double expected = lit(1e-3);
  CHECK(expected > 0);
  for (const double radius : {1e-6, 1e-9, 1e-12, 1e-15, 1e-16, 1e-17, 1e-20}) {
    INFO("radius " << radius);
    CHECK(lit(radius) == Approx(expected).epsilon(0.01));
  }
}
