// SPDX-License-Identifier: Apache-2.0
// The path tracer and the photons against closed forms.
#include <algorithm>
#include <array>
#include <cmath>

#include "golden/numeric/elementary.hpp"
#include "golden/transport/bsdf.hpp"
#include "tests/catch.hpp"
#include "tests/oracles/scenes.hpp"
#include "tests/oracles/statistics.hpp"

using namespace photonloom;
using namespace photonloom::oracle;

namespace {

double power_sum(const PhotonPass& pass) {
  double sum = 0;
  for (const Photon& p : pass.photons) sum += p.power.y;
  return sum;
}

Scene furnace(bool sphere, double rho) {
  Scene s;
  const int grey = add_diffuse(s, Rgb(rho));
  (sphere ? add_sphere(s, grey, Vec3(1, 2, 3), 2, true) : add_room(s, grey, Vec3(0), Vec3(1, 2, 3)))
      .radiance = Rgb(1);
  set_camera(s, sphere ? Vec3(1.5, 2, 3) : Vec3(0.3, 0.4, 0.5), Vec3(1, 1, 1), Vec3(0, 1, 0), 90, 8,
             8);
  return s;
}

}  // namespace

TEST_CASE("white furnace: L = Le / (1 - rho) in a sphere and in a box, within 1 %") {
  for (uint64_t seed : kSeeds)
    for (double rho : {0.5, 0.9})
      for (bool sphere : {true, false})
        check_estimate(
            sphere ? "sphere" : "box", seed,
            image_estimate(path_image(furnace(sphere, rho), rho > 0.7 ? 2048 : 512, seed)),
            1 / (1 - rho), 0.01);
}

TEST_CASE(
    "integrating sphere: light that was reflected once is L = rho^2 Phi / (4 pi^2 R^2 (1 - rho)), "
    "within 2 %") {
  for (uint64_t seed : kSeeds)
    for (double rho : {0.3, 0.8}) {
      Scene s;
      add_sphere(s, add_diffuse(s, Rgb(rho)), Vec3(0), 2, true);
      Light light;
      light.position = Vec3(0.9, 0.3, -0.4);
      light.intensity = Rgb(5);
      s.lights.push_back(light);
      set_camera(s, Vec3(-1, 0, 0), Vec3(0, 0, 1), Vec3(0, 1, 0), 70, 8, 8);
      const double phi = 4 * kPi * 5;
      check_estimate("indirect", seed, image_estimate(path_image(s, 1024, seed), "indirect"),
                     rho * rho * phi / (4 * kPi * kPi * 4 * (1 - rho)), 0.02);
    }
}

TEST_CASE("point light over a plane: L = rho / pi I cos / d^2") {
  Scene s;
  add_quad(s, add_diffuse(s, Rgb(0.6)), Vec3(-5, -5, 0), Vec3(10, 0, 0), Vec3(0, 10, 0));
  Light light;
  light.position = Vec3(0, 0, 2);
  light.intensity = Rgb(7);
  s.lights.push_back(light);
  for (double x : {0.0, 1.0, 3.0}) {
    set_camera(s, Vec3(x, -0.5, 1), Vec3(x, 0, 0), Vec3(0, 0, 1), 1e-3, 1, 1);
    const double d2 = x * x + 4;
    CHECK(channel_mean(path_image(s, 4, 1), "direct.R") ==
          Approx(0.6 / kPi * 7 * (2 / std::sqrt(d2)) / d2).epsilon(1e-5));
  }
}

TEST_CASE("disc light over a point: E = pi L R^2 / (R^2 + h^2), within 1 %") {
  Scene s;
  add_quad(s, add_diffuse(s, Rgb(0.5)), Vec3(-1, -1, 0), Vec3(2, 0, 0), Vec3(0, 2, 0));
  Shape& disc = add_sphere(s, -1, Vec3(0, 0, 1.5), 1);
  disc.kind = ShapeKind::kDisk;
  disc.flip_normals = true;  // down
  disc.radiance = Rgb(3);
  set_camera(s, Vec3(0.3, 0, 0.5), Vec3(0), Vec3(0, 0, 1), 1e-3, 8, 8);
  for (uint64_t seed : kSeeds)
    check_estimate("disc", seed, image_estimate(path_image(s, 256, seed)),
                   0.5 / kPi * (kPi * 3 / (1 + 1.5 * 1.5)), 0.01);
}

TEST_CASE("tube light beside a point: E = pi L r / d, within 4 %") {
  // For an endless tube; the ends of this one, along y above the point, hold 1 / 2000 of it.
  Scene s;
  add_quad(s, add_diffuse(s, Rgb(0.5)), Vec3(-1, -1, 0), Vec3(2, 0, 0), Vec3(0, 2, 0));
  Shape& tube = add_sphere(s, -1, Vec3(0), 1);
  tube.kind = ShapeKind::kCylinder;
  tube.to_world = Mat4(glm::dvec4(0.5, 0, 0, 0), glm::dvec4(0, 0, -0.5, 0), glm::dvec4(0, 40, 0, 0),
                       glm::dvec4(0, -20, 2, 1));
  tube.radiance = Rgb(3);
  set_camera(s, Vec3(0.3, 0, 0.5), Vec3(0), Vec3(0, 0, 1), 1e-3, 8, 8);
  for (uint64_t seed : kSeeds)
    check_estimate("tube", seed, image_estimate(path_image(s, 512, seed)),
                   0.5 / kPi * (kPi * 3 * 0.5 / 2), 0.04);
}

TEST_CASE("polygon light over a point: E = L / 2 times the sum of beta_i cos gamma_i, within 1 %") {
  // Lambert's formula: beta_i is the angle an edge subtends, gamma_i the one between the normals of
  // the receiver and of the plane through the edge and the point.
  Scene s;
  add_quad(s, add_diffuse(s, Rgb(0.5)), Vec3(-1, -1, 0), Vec3(2, 0, 0), Vec3(0, 2, 0));
  const Vec3 corner(0.2, -0.7, 1.0), u(0, 1.5, 0), v(1, 0.2, 0.3);
  add_quad(s, -1, corner, u, v).radiance = Rgb(2);
  REQUIRE(glm::cross(u, v).z < 0);  // lights downward
  set_camera(s, Vec3(-0.3, 0, 0.5), Vec3(0), Vec3(0, 0, 1), 1e-3, 8, 8);
  const Vec3 p[4] = {corner, corner + u, corner + u + v, corner + v};
  double sum = 0;
  for (int i = 0; i < 4; ++i) {
    const Vec3 a = glm::normalize(p[i]), b = glm::normalize(p[(i + 1) % 4]);
    sum += std::acos(glm::dot(a, b)) * glm::normalize(glm::cross(b, a)).z;
  }
  for (uint64_t seed : kSeeds)
    check_estimate("polygon", seed, image_estimate(path_image(s, 1024, seed)),
                   0.5 / kPi * (2 * sum / 2), 0.01);
}

TEST_CASE("form factors of unit squares: parallel 0.1998, perpendicular 0.2000, within 1.5 %") {
  // Parallel at distance 1, and sharing an edge (Howell, A Catalog of Radiation Heat Transfer
  // Configuration Factors, C-11 and C-14, with all lengths 1).
  const double root2 = std::sqrt(2.0);
  const double parallel =
      2 / kPi *
      (std::log(std::sqrt(4.0 / 3)) + 2 * root2 * std::atan(1 / root2) - 2 * std::atan(1.0));
  const double perpendicular =
      1 / kPi *
      (2 * std::atan(1.0) - root2 * std::atan(1 / root2) + std::log(4.0 / 3 * 3 / 4 * 3 / 4) / 4);
  REQUIRE(parallel == Approx(0.1998).margin(5e-5));
  REQUIRE(perpendicular == Approx(0.2000).margin(5e-5));
  // From a wall of a cube all light goes to the one opposite and the four beside it.
  REQUIRE(parallel + 4 * perpendicular == Approx(1).epsilon(1e-12));
  for (uint64_t seed : kSeeds)
    for (bool facing : {true, false}) {
      Scene s;
      add_quad(s, -1, Vec3(0), Vec3(1, 0, 0), Vec3(0, 1, 0)).radiance = Rgb(1);  // normal +z
      const int black = add_diffuse(s, Rgb(1));
      if (facing)
        add_quad(s, black, Vec3(0, 0, 1), Vec3(0, 1, 0), Vec3(1, 0, 0));
      else
        add_quad(s, black, Vec3(0, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1));  // in x = 0, normal +x
      const World world(s);
      const PhotonPass pass = trace_global_photons(world, *make_double_bvh(world), 60000, seed);
      check_estimate(facing ? "parallel" : "perpendicular", seed,
                     per_path(pass, [](const Photon& p) { return p.bounce == 0 ? p.power.y : 0; }),
                     kPi * (facing ? parallel : perpendicular), 0.015);
    }
}

TEST_CASE(
    "photon energy: after n bounces in a closed grey room Phi rho^n is left, within 8 %, of all "
    "bounces within 2 %") {
  for (uint64_t seed : kSeeds) {
    Scene s;
    const double rho = 0.7;
    add_room(s, add_diffuse(s, Rgb(rho)), Vec3(0), Vec3(2, 1, 1));
    Shape& lamp = add_sphere(s, add_diffuse(s, Rgb(rho)), Vec3(1, 0.5, 0.5), 0.1);
    lamp.radiance = Rgb(2);
    const World world(s);
    const PhotonPass pass = trace_global_photons(world, *make_double_bvh(world), 300000, seed);
    const double phi = 2 * kPi * 4 * kPi * 0.01;
    REQUIRE(world.emitted_power().y == Approx(phi));
    check_estimate("all bounces", seed, per_path(pass, [](const Photon& p) { return p.power.y; }),
                   phi / (1 - rho), 0.02);
    for (uint32_t n : {0u, 1u, 5u, 8u})
      check_estimate("one bounce", seed,
                     per_path(pass, [n](const Photon& p) { return p.bounce == n ? p.power.y : 0; }),
                     phi * std::pow(rho, n), 0.08);
    // Russian roulette keeps powers equal, so no photon stands out.
    for (const Photon& p : pass.photons)
      REQUIRE(p.power.y * static_cast<double>(pass.paths) <= phi * (1 + 1e-12));
  }
}

// Fresnel's equations by the angles of incidence and refraction, mean of both polarisations.
double fresnel_by_angles(double incidence, double ior) {
  if (incidence == 0) return std::pow((ior - 1) / (ior + 1), 2);
  const double refraction = std::asin(std::sin(incidence) / ior);
  const double difference = incidence - refraction, sum = incidence + refraction;
  return (std::pow(std::sin(difference) / std::sin(sum), 2) +
          std::pow(std::tan(difference) / std::tan(sum), 2)) /
         2;
}

TEST_CASE(
    "glass ball: two refractions carry 0.8355 of the intercepted power at n = 1.5, 0.8095 at 1.6, "
    "within 2 %") {
  // Parallel light: the mean of (1 - F)^2 over the disc, F at sin(angle) = distance from the axis.
  for (double n : {1.5, 1.6}) {
    double expected = 0;
    for (int i = 0; i < 20000; ++i) {
      const double b2 = (i + 0.5) / 20000;
      const double t = 1 - fresnel_by_angles(std::asin(std::sqrt(b2)), n);
      expected += t * t / 20000;
    }
    CHECK(expected == Approx(n == 1.5 ? 0.8355 : 0.8095).margin(1e-4));
    Scene s;
    add_sphere(s, add_glass(s, n), Vec3(0, 0, 2), 1);
    // A pit that catches what leaves the ball sideways.
    const int grey = add_diffuse(s, Rgb(0.5), true);
    add_quad(s, grey, Vec3(-3, -3, 0), Vec3(6, 0, 0), Vec3(0, 6, 0));
    for (int side = 0; side < 4; ++side) {
      const Vec2 c = 3.0 * cos_sin_turns(side / 4.0);
      add_quad(s, grey, Vec3(c.x + c.y, c.y - c.x, 0), Vec3(-2 * c.y, 2 * c.x, 0), Vec3(0, 0, 4));
    }
    Light sun;
    sun.kind = LightKind::kDirectional;
    sun.direction = Vec3(0, 0, -1);
    sun.intensity = Rgb(10);
    s.lights.push_back(sun);
    const World world(s);
    for (uint64_t seed : kSeeds) {
      const PhotonPass pass = trace_caustic_photons(world, *make_double_bvh(world), 60000, seed);
      REQUIRE(pass.photons.size() >= 60000);
      check_estimate("caustic power", seed,
                     per_path(pass, [](const Photon& p) { return p.bounce == 2 ? p.power.y : 0; }),
                     10 * kPi * expected, 0.02);
    }
  }
}

TEST_CASE("mirror ring: nephroid of parallel light, cardioid of a point on the rim") {
  // Parallel light that meets the ring at the polar angle a leaves at the angle pi + 2a and passes
  // the centre at R sin a; light from a point of the rim at the angle a to the axis leaves at pi +
  // 3a and passes at R sin a. The envelopes of these lines are the nephroid, cusp at R/2, and the
  // cardioid, cusp at R/3; along the axis photons are densest there.
  const double r = 1;
  for (bool nephroid : {true, false}) {
    Scene s;
    const int mirror = add_mirror(s);
    add_quad(s, add_diffuse(s, Rgb(0.5)), Vec3(-r, -r, 0), Vec3(2 * r, 0, 0), Vec3(0, 2 * r, 0));
    // The half of the ring that the light meets first, x > 0; normals to the axis.
    Shape ring;
    ring.bsdf = mirror;
    const int parts = 4000;
    for (int i = 0; i <= parts; ++i) {
      const Vec2 c = cos_sin_turns(0.5 * i / parts - 0.25);
      for (double z : {0.0, 1.0}) {
        ring.mesh.positions.push_back(Vec3(r * c.x, r * c.y, z));
        ring.mesh.normals.push_back(Vec3(-c.x, -c.y, 0));
      }
    }
    for (uint32_t i = 0; i < parts; ++i) {
      const uint32_t n = 2 * i;
      ring.mesh.triangles.push_back({n, n + 1, n + 2});
      ring.mesh.triangles.push_back({n + 2, n + 1, n + 3});
    }
    s.shapes.push_back(ring);
    Light light;
    if (nephroid) {
      light.kind = LightKind::kDirectional;
      light.direction = glm::normalize(Vec3(1, 0, -0.4));
    } else {
      light.position = Vec3(-r, 0, 0.5);
    }
    s.lights.push_back(light);
    const World world(s);
    const double cusp = nephroid ? r / 2 : r / 3;
    for (uint64_t seed : kSeeds) {
      const PhotonPass pass = trace_caustic_photons(world, *make_double_bvh(world), 40000, seed);
      std::array<int, 50> histogram{};
      for (const Photon& p : pass.photons) {
        if (p.bounce != 1) continue;
        const Vec2 d = glm::normalize(Vec2(p.direction.x, p.direction.y));  // back to the ring
        const double distance = std::fabs(p.position.x * d.y - p.position.y * d.x);
        const double a = std::atan2(d.y, d.x) / (nephroid ? 2 : 3);
        REQUIRE(std::fabs(distance - r * std::fabs(std::sin(a))) < 1e-5 * r);
        const double x = p.position.x / r;
        if (x > 0 && x < 1 && std::fabs(p.position.y) < 0.01 * r)
          ++histogram[static_cast<size_t>(x * 50)];
      }
      const auto peak = std::max_element(histogram.begin(), histogram.end());
      INFO((nephroid ? "nephroid" : "cardioid") << ", seed " << seed << ": " << *peak);
      CHECK(std::fabs((static_cast<double>(peak - histogram.begin()) + 0.5) / 50 - cusp / r) <
            0.04);
      CHECK(*peak > 50);
    }
  }
}

TEST_CASE(
    "glass slab: T = (1 - F) / (1 + F) with all inner reflections, at any angle, within 1 %") {
  for (double angle : {0.0, 0.6, 1.2}) {
    Scene s;
    const int glass = add_glass(s, 1.5);
    add_quad(s, glass, Vec3(-500, -500, 0.5), Vec3(1000, 0, 0), Vec3(0, 1000, 0));
    add_quad(s, glass, Vec3(-500, 500, 0), Vec3(1000, 0, 0), Vec3(0, -1000, 0));
    add_quad(s, -1, Vec3(-900, -900, -1), Vec3(1800, 0, 0), Vec3(0, 1800, 0)).radiance = Rgb(4);
    const Vec3 eye(0, -std::sin(angle), std::cos(angle));
    set_camera(s, eye + Vec3(0, 0, 0.5), Vec3(0, 0, 0.5), Vec3(1, 0, 0), 1e-3, 8, 8);
    const double f = fresnel_by_angles(angle, 1.5);
    for (uint64_t seed : kSeeds)
      check_estimate("slab", seed, image_estimate(path_image(s, 1024, seed), "emission"),
                     4 * (1 - f) / (1 + f), 0.01);
  }
}

TEST_CASE("a mirror shows the mirrored scene") {
  Scene s;
  const int grey = add_diffuse(s, Rgb(0.5), true);
  add_quad(s, grey, Vec3(-0.4, 0.2, 0.6), Vec3(0.5, 0, 0), Vec3(0, 0.3, 0.2));
  Light light;
  light.position = Vec3(0.2, 0.5, 0.1);
  light.intensity = Rgb(3, 2, 1);
  s.lights.push_back(light);
  Scene behind = s;
  // The same seen by a camera mirrored at z = 0, and in a mirror there.
  set_camera(behind, Vec3(0, -1, -0.4), Vec3(-0.15, 0.35, 0.7), Vec3(0, 1, 0), 40, 32, 32);
  Scene with_mirror = s;
  add_quad(with_mirror, add_mirror(with_mirror, Rgb(0.5)), Vec3(-9, -9, 0), Vec3(18, 0, 0),
           Vec3(0, 18, 0));
  set_camera(with_mirror, Vec3(0, -1, 0.4), Vec3(-0.15, 0.35, -0.7), Vec3(0, 1, 0), 40, 32, 32);
  const Image a = path_image(behind, 256, 1), b = path_image(with_mirror, 256, 1);
  double difference = 0, sum = 0;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      const size_t here = static_cast<size_t>(32 * y + x),
                   there = static_cast<size_t>(32 * y + 31 - x);
      const double pa = static_cast<double>(a.find("R")->pixels[here]),
                   pb = 2 * static_cast<double>(b.find("direct.R")->pixels[there]);
      difference += std::fabs(pa - pb);
      sum += pa;
    }
  CHECK(sum > 0);
  CHECK(difference / sum < 0.02);
}

TEST_CASE("a lamp close to the ceiling leaks no light, and scale does not matter") {
  double reference = 0;
  for (double scale : {1.0, 1e-3, 1e3}) {
    Scene s;
    const int grey = add_diffuse(s, Rgb(0.5), true), black = add_diffuse(s, Rgb(0.5), true);
    // A ceiling with an attic above it: the lamp hangs 1e-3 of the height below.
    add_quad(s, grey, Vec3(-1, -1, 1) * scale, Vec3(2, 0, 0) * scale, Vec3(0, 2, 0) * scale);
    add_quad(s, grey, Vec3(-1, -1, 0) * scale, Vec3(2, 0, 0) * scale, Vec3(0, 2, 0) * scale);
    add_quad(s, black, Vec3(-1, -1, 1.5) * scale, Vec3(2, 0, 0) * scale, Vec3(0, 2, 0) * scale);
    for (int side = 0; side < 4; ++side) {
      const Vec2 c = cos_sin_turns(side / 4.0);
      const Vec3 out(c.x, c.y, 0), along(-c.y, c.x, 0);
      add_quad(s, grey, (out - along) * scale, along * (2 * scale), Vec3(0, 0, 1.5) * scale);
    }
    add_quad(s, grey, Vec3(-0.2, -0.2, 0.999) * scale, Vec3(0, 0.4, 0) * scale,
             Vec3(0.4, 0, 0) * scale)
        .radiance = Rgb(1);
    set_camera(s, Vec3(0, -0.9, 0.5) * scale, Vec3(0, 0, 0.3) * scale, Vec3(0, 0, 1), 80, 24, 24);
    const World world(s);
    // The room itself: the same image at every scale, of the same paths.
    const double room = channel_mean(path_image(s, 64, 1), "G");
    if (scale == 1.0) reference = room;
    CHECK(room == Approx(reference).epsilon(1e-4));
    // The attic is dark, for the path tracer and for photons.
    Scene attic = s;
    set_camera(attic, Vec3(0, -0.9, 1.3) * scale, Vec3(0, 0, 1.2) * scale, Vec3(0, 0, 1), 100, 24,
               24);
    const Image dark = path_image(attic, 64, 1);
    for (float p : dark.find("G")->pixels) REQUIRE(p == 0.0f);
    const PhotonPass pass = trace_global_photons(world, *make_double_bvh(world), 50000, 1);
    for (const Photon& p : pass.photons) REQUIRE(p.position.z <= scale * (1 + 1e-12));
    for (const Photon& p : pass.photons)
      if (p.position.z > 0.9995 * scale &&
          std::max(std::fabs(p.position.x), std::fabs(p.position.y)) < 0.99 * scale)
        REQUIRE(p.direction.z < 0);
    REQUIRE(power_sum(pass) > 0);
  }
}
