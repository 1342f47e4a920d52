// SPDX-License-Identifier: Apache-2.0
// Bump and normal maps against their definitions (docs/materials.md), and photons against paths.
#include <cmath>

#include "golden/numeric/elementary.hpp"
#include "golden/pipeline/prepare.hpp"
#include "tests/catch.hpp"
#include "tests/oracles/scenes.hpp"

using namespace photonloom;
using namespace photonloom::oracle;

namespace {

// A square of one BSDF in z = 0 under a sun, seen from above, with textures' coordinates.
Scene sunlit(const Bsdf& b, const std::vector<Texture>& textures, const Vec3& to_sun) {
  Scene s;
  s.textures = textures;
  add_quad(s, add_bsdf(s, b), Vec3(-1, -1, 0), Vec3(2, 0, 0), Vec3(0, 2, 0)).mesh.uvs = {
      {0, 0}, {1, 0}, {1, 1}, {0, 1}};
  Light sun;
  sun.kind = LightKind::kDirectional;
  sun.direction = -glm::normalize(to_sun);
  sun.intensity = Rgb(2);
  s.lights.push_back(sun);
  set_camera(s, Vec3(0, 0, 3), Vec3(0), Vec3(0, 1, 0), 2, 2, 2);
  return s;
}

Texture of_texels(int width, const std::vector<float>& rgb) {
  auto bitmap = std::make_shared<Bitmap>();
  bitmap->width = width;
  bitmap->height = static_cast<int>(rgb.size()) / 3 / width;
  bitmap->channels = 3;
  bitmap->texels = rgb;
  Texture t;
  t.bitmap = bitmap;
  t.wrap_u = t.wrap_v = Wrap::kClamp;
  return t;
}

// Two rows or columns: a slope from `low` to `high` between the middles of the halves.
Texture slope(bool along_u, float low, float high) {
  return of_texels(along_u ? 2 : 1, {low, low, low, high, high, high});
}

}  // namespace

TEST_CASE("normal and bump maps: rho / pi E cos to the normal that they make") {
  Bsdf grey;
  grey.diffuse = Rgb(0.5);
  const Vec3 to_sun = glm::normalize(Vec3(0.3, -0.2, 0.9));
  const auto seen = [&](const Bsdf& b, const std::vector<Texture>& textures) {
    return channel_mean(path_image(sunlit(b, textures, to_sun), 4, 1), "G");
  };
  const auto expected = [&](const Vec3& normal) {
    return 0.5 / kPi * 2 * glm::dot(glm::normalize(normal), to_sun);
  };
  Bsdf turned = grey;
  turned.normal_map = 0;
  CHECK(seen(turned, {of_texels(1, {0.5f, 0.5f, 1})}) == Approx(expected(Vec3(0, 0, 1))));
  // u runs along x, v along y.
  CHECK(seen(turned, {of_texels(1, {0.75f, 0.5f, 1})}) == Approx(expected(Vec3(0.5, 0, 1))));
  CHECK(seen(turned, {of_texels(1, {0.5f, 0.25f, 1})}) == Approx(expected(Vec3(0, -0.5, 1))));
  CHECK(seen(turned, {of_texels(1, {0, 0.5f, 0.5f})}) == 0);  // from behind
  Bsdf bumped = grey;
  bumped.bump_map = 0;
  CHECK(seen(bumped, {of_texels(1, {0.7f, 0.7f, 0.7f})}) == Approx(expected(Vec3(0, 0, 1))));
  // A height h grows by 2 h a unit of u, which is 2 long: its slope is h.
  CHECK(seen(bumped, {slope(true, 0, 0.25f)}) == Approx(expected(Vec3(-0.25, 0, 1))).epsilon(1e-6));
  CHECK(seen(bumped, {slope(false, 0.5f, 0)}) == Approx(expected(Vec3(0, 0.5, 1))).epsilon(1e-6));
  // Sides are the geometric normal's: from below the surface is black.
  Scene below = sunlit(turned, {of_texels(1, {0.75f, 0.5f, 1})}, Vec3(0, 0, -1));
  set_camera(below, Vec3(0, 0, -3), Vec3(0), Vec3(0, 1, 0), 2, 2, 2);
  CHECK(channel_mean(path_image(below, 4, 1), "G") == 0);
}

TEST_CASE("derivatives of positions: by differences of texture coordinates, on every shape") {
  Scene s;
  const int grey = add_diffuse(s, Rgb(0.5));
  Shape& square = add_quad(s, grey, Vec3(-9, -9, -4), Vec3(18, 0, 3), Vec3(2, 18, 0));
  square.mesh.uvs = {{0, 0}, {2, 0.5}, {3, 4}, {1, 3.5}};
  square.radiance = Rgb(1);
  add_sphere(s, grey, Vec3(-3, 0, 0), 1.5);
  Shape& disk = add_sphere(s, grey, Vec3(0.5, 0, 0), 1);
  disk.kind = ShapeKind::kDisk;
  Shape& tube = add_sphere(s, grey, Vec3(4, 0, -1), 1.2);
  tube.kind = ShapeKind::kCylinder;
  tube.to_world[2] = glm::dvec4(0, 0.5, 2, 0);
  tube.to_world[1] = glm::dvec4(glm::normalize(Vec3(0, 2, -0.5)) * 1.2, 0);
  const World world(s);
  const auto caster = make_double_bvh(world);
  int seen[4] = {};
  for (uint64_t i = 0; i < 400; ++i) {
    const Random r(9, Phase::kPath, i);
    const Vec3 from(12 * r.unit(0, 0) - 6, 4 * r.unit(0, 1) - 2, 9);
    const auto met = [&](const Vec3& shift) {
      return caster->closest(Ray{from + shift, glm::normalize(Vec3(0.1, 0.05, -1))}, nullptr);
    };
    constexpr double kShift = 1e-6;
    const Hit hit = met(Vec3(0));
    Vec3 du, dv;
    REQUIRE(hit.valid());
    REQUIRE(world.derivatives(hit, du, dv));
    for (const Vec3& shift : {Vec3(kShift, 0, 0), Vec3(0, kShift, 0)}) {
      const Hit next = met(shift);
      if (next.primitive != hit.primitive) continue;
      const Vec2 uv = world.uv(next) - world.uv(hit);
      if (std::fabs(uv.x) > 0.5) continue;  // across the seam
      const Vec3 moved = next.position - hit.position;
      CAPTURE(i, hit.shape);
      CHECK(glm::length(du * uv.x + dv * uv.y - moved) < 1e-3 * glm::length(moved));
      ++seen[hit.shape];
    }
  }
  for (const int n : seen) CHECK(n > 20);
}

TEST_CASE("a bumped and a mapped floor: photons bring what paths see, within 3 %", "[slow]") {
  // Indirect light: a lamp shines on a wall, the wall on the floor.
  for (const bool bump : {true, false}) {
    Scene s;
    s.textures = {bump ? slope(true, 0, 0.5f) : of_texels(1, {0.7f, 0.6f, 0.9f})};
    Bsdf floor;
    floor.diffuse = Rgb(0.7);
    (bump ? floor.bump_map : floor.normal_map) = 0;
    add_room(s, add_diffuse(s, Rgb(0.6)), Vec3(-1, -1, 0), Vec3(1, 1, 2));
    add_quad(s, add_bsdf(s, floor), Vec3(-0.9, -0.9, 0.01), Vec3(1.8, 0, 0), Vec3(0, 1.8, 0))
        .mesh.uvs = {{0.3, 0}, {0.7, 0}, {0.7, 1}, {0.3, 1}};
    add_quad(s, -1, Vec3(-0.3, -0.3, 1.9), Vec3(0, 0.6, 0), Vec3(0.6, 0, 0)).radiance = Rgb(5);
    set_camera(s, Vec3(0, -0.8, 1.2), Vec3(0, 0.1, 0), Vec3(0, 0, 1), 40, 8, 8);
    FrameRequest request;
    request.photons = 100000;
    request.k = 50;
    request.spp = 64;
    request.gather_rays = 16;
    const PreparedFrame frame =
        prepare_frame(std::make_unique<World>(s), request, Arithmetic::kGolden, nullptr);
    FrameUnits units = make_golden_units(frame.plan);
    FrameCounts counts;
    const Image image = render_frame(frame.input(Arithmetic::kGolden), units, counts);
    const Image path = path_image(s, 1024, 3);
    CHECK(channel_mean(image, "G") == Approx(channel_mean(path, "G")).epsilon(0.03));
  }
}
