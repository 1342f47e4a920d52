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

namespace {

// Everything that makes weights: rough and smooth glass, coats, mixtures, masks, principled lobes,
// lamps, an environment and a spot.
Scene everything() {
  Scene s = room(true);
  Bsdf frosted;
  frosted.kind = BsdfKind::kRoughDielectric;
  frosted.specular = Rgb(1);
  frosted.ior = 1.5;
  frosted.alpha_u = frosted.alpha_v = 0.3;
  add_sphere(s, add_bsdf(s, frosted), Vec3(0.25, 0.2, 0.6), 0.18);
  add_sphere(s, add_glass(s, 1.5), Vec3(0.7, 0.2, 0.35), 0.15);
  Bsdf plastic;
  plastic.kind = BsdfKind::kPlastic;
  plastic.diffuse = Rgb(0.2, 0.5, 0.7);
  plastic.specular = Rgb(1);
  plastic.ior = 1.5;
  add_sphere(s, add_bsdf(s, plastic), Vec3(0.5, 0.6, 0.7), 0.15);
  Bsdf paint;
  paint.kind = BsdfKind::kPrincipled;
  paint.diffuse = Rgb(0.7, 0.3, 0.2);
  paint.ior = 1.5;
  paint.principled = {0.6, 0.3, 0.2, 0.4, 0.2, 0.4, 0.5, 0.3, 0.5, 0.1};
  add_sphere(s, add_bsdf(s, paint), Vec3(0.8, 0.6, 0.6), 0.14);
  Bsdf varnished;
  varnished.kind = BsdfKind::kRoughConductor;
  varnished.specular = Rgb(1);
  varnished.alpha_u = varnished.alpha_v = 0.3;
  varnished.coat_ior = 1.5;
  varnished.coat_absorption = Rgb(0.1, 0.2, 0.4);
  Bsdf coated;
  coated.diffuse = Rgb(0.6);
  coated.coat_ior = 1.5;
  coated.coat_absorption = Rgb(0.1, 0.2, 0.4);
  const int parts[] = {add_bsdf(s, varnished), add_bsdf(s, coated)};
  Bsdf mixture;
  mixture.kind = BsdfKind::kMixture;
  mixture.parts = {parts[0], parts[1]};
  mixture.shares = {0.4, 0.5};
  mixture.opacity = 0.7;
  mixture.two_sided = true;
  add_quad(s, add_bsdf(s, mixture), Vec3(0.05, 0.3, 0.2), Vec3(0.25, 0, 0.1), Vec3(0, 0.4, 0));
  Light sky;
  sky.kind = LightKind::kEnvironment;
  sky.intensity = Rgb(0.3, 0.4, 0.5);
  Light spot;
  spot.kind = LightKind::kSpot;
  spot.position = Vec3(0.5, 0.9, -0.5);
  spot.direction = glm::normalize(Vec3(0.1, -0.6, 1));
  spot.intensity = Rgb(2);
  spot.cutoff_angle = 0.6;
  spot.beam_angle = 0.4;
  spot.cutoff_cos = std::cos(0.6);
  spot.beam_cos = std::cos(0.4);
  s.lights = {sky, spot};
  return s;
}

// Bidirectional path tracing and the path tracer have the same mean, within what is stated.
void check_both_ends(const char* name, const Scene& scene, int path_spp, int spp, uint64_t seed,
                     double stated) {
  const World world(scene);
  const auto caster = make_embree(world);
  PathOptions path{.spp = path_spp, .seed = seed};
  PathOptions both{.spp = spp, .seed = seed + 1, .bidirectional = true};
  const Image a = render_path(world, *caster, path), b = render_path(world, *caster, both);
  const Estimate one = image_estimate(a), two = image_estimate(b);
  INFO(name << ": path " << one.mean << " +- " << one.error << ", bidirectional " << two.mean
            << " +- " << two.error);
  CHECK(std::hypot(one.error, two.error) <= stated * one.mean / 4);
  CHECK(std::fabs(one.mean - two.mean) <= stated * one.mean);
}

}  // namespace

TEST_CASE("paths from both ends have the mean of paths from one, within 3 %") {
  check_both_ends("everything", everything(), 512, 192, 3, 0.03);
}

TEST_CASE("paths from both ends have the mean of paths from one, within 0.5 %", "[slow]") {
  check_both_ends("everything", everything(), 8192, 4096, 4, 0.005);
  Scene lens = everything();
  lens.camera.kind = CameraKind::kThinLens;
  lens.camera.aperture_radius = 0.05;
  lens.camera.focus_distance = 1.6;
  lens.film.filter = {FilterKind::kTent, 1};
  lens.max_depth = 4;
  check_both_ends("lens", lens, 8192, 1536, 5, 0.005);
}

TEST_CASE("a beam lights what its spot sees: E = P rho / pi cos cos / d^2, within 1 %") {
  // Down a mirror's slope to the floor, and from there to a wall that is seen alone.
  Scene s;
  const int white = add_diffuse(s, Rgb(0.6)), black = add_diffuse(s, Rgb(0));
  add_quad(s, white, Vec3(-1, 0, -1), Vec3(0, 0, 2), Vec3(2, 0, 0));
  add_quad(s, white, Vec3(1, 0.49, -0.01), Vec3(0, 0, 0.02), Vec3(0, 0.02, 0));
  add_quad(s, black, Vec3(-1, 3, -1), Vec3(2, 0, 0), Vec3(0, 0, 2));
  add_quad(s, add_mirror(s, Rgb(0.8), true), Vec3(-0.1, 1.9, -0.1), Vec3(0.2, 0.2, 0),
           Vec3(0, 0, 0.2));
  Light beam;
  beam.kind = LightKind::kCollimated;
  beam.position = Vec3(-0.9, 2, 0);
  beam.direction = Vec3(1, 0, 0);
  beam.intensity = Rgb(5);
  s.lights.push_back(beam);
  s.max_depth = 8;
  // The mirror turns +x to +y or -y by its slope; only the way down lights the floor.
  set_camera(s, Vec3(0.9, 0.5, 0), Vec3(1, 0.5, 0), Vec3(0, 1, 0), 8, 4, 4);
  Scene down = s;
  down.shapes[3].mesh.positions = {Vec3(-0.1, 2.1, -0.1), Vec3(-0.1, 2.1, 0.1), Vec3(0.1, 1.9, 0.1),
                                   Vec3(0.1, 1.9, -0.1)};
  const World world(down);
  const auto caster = make_embree(world);
  // The spot is the floor's point below the mirror's middle, half a metre up the wall a metre away.
  const double d2 = 1 + 0.25, at_floor = 0.5 / std::sqrt(d2), at_wall = 1 / std::sqrt(d2);
  const double irradiance = 5 * 0.8 * 0.6 / kPi * at_floor * at_wall / d2;
  for (const bool both : {false, true}) {
    PathOptions options{.spp = 512, .seed = 2, .bidirectional = both};
    const Image image = render_path(world, *caster, options);
    // From the wall to the floor and back there is hardly any light: the wall is two centimetres.
    check_estimate(both ? "bidirectional" : "path", 2, image_estimate(image),
                   irradiance * 0.6 / kPi, 0.01);
  }
}

TEST_CASE("layers agree: a beam through a glass ball, a mirror beside it, caustic 5 %", "[slow]") {
  Scene s = room(false);
  add_sphere(s, add_glass(s, 1.5), Vec3(0.5, 0.5, 0.5), 0.2);
  add_sphere(s, add_mirror(s, Rgb(0.9)), Vec3(0.25, 0.2, 0.7), 0.18);
  Light beam;
  beam.kind = LightKind::kCollimated;
  beam.position = Vec3(0.45, 0.95, 0.4);
  beam.direction = glm::normalize(Vec3(0.05, -1, 0.2));
  beam.intensity = Rgb(3);
  s.lights.push_back(beam);
  // The camera looks past both: what they show of a caustic no path of the path tracer finds.
  set_camera(s, Vec3(0.9, 0.8, -1.4), Vec3(0.9, 0.8, 0), Vec3(0, 1, 0), 10, kSize, kSize);
  check_layers("beam", s, 2048, 7, 0.05);
}
