// SPDX-License-Identifier: Apache-2.0
// Photon map and path tracer integrate the same light: the means of their layers agree, on scenes
// with mirrors, glass, glossy lobes, shading normals and every emitter.
#include "golden/numeric/elementary.hpp"
#include "tests/catch.hpp"
#include "tests/oracles/photon_mapper.hpp"

using namespace photonloom;
using namespace photonloom::oracle;

namespace {

// A ball of flat triangles with the ball's normals.
void add_smooth_ball(Scene& s, int bsdf, const Vec3& centre, double r, uint32_t n) {
  Shape ball;
  ball.bsdf = bsdf;
  for (uint32_t i = 0; i <= n; ++i)
    for (uint32_t j = 0; j <= 2 * n; ++j) {
      const Vec2 t = cos_sin_turns(0.5 * i / n), p = cos_sin_turns(0.5 * j / n);
      const Vec3 d(t.y * p.x, t.x, t.y * p.y);
      ball.mesh.positions.push_back(centre + r * d);
      ball.mesh.normals.push_back(d);
    }
  for (uint32_t i = 0; i < n; ++i)
    for (uint32_t j = 0; j < 2 * n; ++j) {
      const uint32_t a = i * (2 * n + 1) + j, b = a + 2 * n + 1;
      ball.mesh.triangles.push_back({a, a + 1, b});
      ball.mesh.triangles.push_back({a + 1, b + 1, b});
    }
  s.shapes.push_back(ball);
}

}  // namespace

TEST_CASE("layers agree: mirror and glass balls, caustic within 3 %, indirect 3 %, direct 1 %",
          "[slow]") {
  Scene s = room(true);
  add_sphere(s, add_mirror(s, Rgb(0.9)), Vec3(0.3, 0.2, 0.65), 0.2);
  add_sphere(s, add_glass(s, 1.5), Vec3(0.7, 0.2, 0.35), 0.2);
  check_layers("balls", s, 2048, 1, 0.03);
}

TEST_CASE(
    "layers agree: glossy surfaces, seen in glass, caustic within 5 %, indirect 3 %, direct 1 %",
    "[slow]") {
  Scene s = room(true);
  add_sphere(s, add_phong(s, Rgb(0.3), Rgb(0.5), 30), Vec3(0.3, 0.2, 0.65), 0.2);
  add_quad(s, add_phong(s, Rgb(0.1), Rgb(0.6), 300), Vec3(0.1, 0.01, 0.1), Vec3(0, 0, 0.5),
           Vec3(0.8, 0, 0));
  add_sphere(s, add_glass(s, 1.5), Vec3(0.7, 0.3, 0.35), 0.2);
  check_layers("glossy", s, 2048, 2, 0.05);
}

TEST_CASE(
    "layers agree: a point light whose light meets a mirror more than once, caustic within 3 %, "
    "indirect 3 %, direct 1 %") {
  Scene s;
  const int white = add_diffuse(s, Rgb(0.7));
  const Vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  add_quad(s, white, Vec3(0), z, x);
  add_quad(s, white, x, z, y);
  add_quad(s, add_mirror(s, Rgb(0.95)), Vec3(0), y, z);
  Light light;
  light.position = Vec3(0.5, 0.6, 0.5);
  light.intensity = Rgb(1);
  s.lights.push_back(light);
  // With the back to the mirror: what is seen in it of its own caustic no camera path can find.
  set_camera(s, Vec3(0.1, 0.5, 0.5), Vec3(1, 0.4, 0.5), y, 70, kSize, kSize);
  check_layers("mirror twice", s, 256, 5, 0.03);
}

TEST_CASE(
    "layers agree: coarse balls with smooth normals, caustic within 3 %, indirect 3 %, direct 1 "
    "%",
    "[slow]") {
  Scene s = room(true);
  add_smooth_ball(s, add_diffuse(s, Rgb(0.8)), Vec3(0.3, 0.25, 0.65), 0.2, 6);
  add_smooth_ball(s, add_glass(s, 1.5), Vec3(0.7, 0.25, 0.35), 0.2, 8);
  add_smooth_ball(s, add_mirror(s), Vec3(0.7, 0.7, 0.65), 0.15, 8);
  add_smooth_ball(s, add_phong(s, Rgb(0.3), Rgb(0.5), 20), Vec3(0.3, 0.7, 0.65), 0.15, 5);
  check_layers("smooth normals", s, 1024, 3, 0.03);
}

TEST_CASE(
    "layers agree: sphere, disk, point, spot and directional light, caustic within 3 %, indirect 3 "
    "%, direct 1 %",
    "[slow]") {
  Scene s = room(false);
  add_sphere(s, add_diffuse(s, Rgb(0.5)), Vec3(0.3, 0.6, 0.5), 0.05).radiance = Rgb(10, 20, 5);
  Shape& disk = add_sphere(s, -1, Vec3(0.99, 0.5, 0.5), 0.1);
  disk.kind = ShapeKind::kDisk;
  disk.to_world[0] = {0, 0.1, 0, 0};
  disk.to_world[1] = {0, 0, 0.2, 0};
  disk.to_world[2] = {-0.1, 0, 0, 0};
  disk.radiance = Rgb(5);
  Light light;
  light.position = Vec3(0.4, 0.7, 0.3);
  light.intensity = Rgb(0.2);
  s.lights.push_back(light);
  light.kind = LightKind::kSpot;
  light.position = Vec3(0.2, 0.9, 0.2);
  light.direction = glm::normalize(Vec3(0.5, -1, 0.4));
  light.cutoff_angle = 0.6;
  light.beam_angle = 0.3;
  light.cutoff_cos = std::cos(0.6);
  light.beam_cos = std::cos(0.3);
  light.intensity = Rgb(2);
  s.lights.push_back(light);
  light.kind = LightKind::kDirectional;
  light.direction = glm::normalize(Vec3(0.3, -0.5, 1));
  light.intensity = Rgb(0.5);
  s.lights.push_back(light);
  check_layers("emitters", s, 256, 4, 0.03);
}
