// SPDX-License-Identifier: Apache-2.0
// What is fixed by convention and easily turned round: sides, handedness, depth, radiance and power
// in glass, lobes and their densities.
#include <cmath>

#include "golden/numeric/elementary.hpp"
#include "golden/transport/bsdf.hpp"
#include "golden/transport/camera.hpp"
#include "golden/transport/emitters.hpp"
#include "golden/transport/film_filter.hpp"
#include "golden/transport/sampling.hpp"
#include "tests/catch.hpp"
#include "tests/oracles/scenes.hpp"
#include "tests/oracles/statistics.hpp"

using namespace photonloom;
using namespace photonloom::oracle;

namespace {

Light sun_straight_down(double irradiance) {
  Light sun;
  sun.kind = LightKind::kDirectional;
  sun.direction = Vec3(0, 0, -1);
  sun.intensity = Rgb(irradiance);
  return sun;
}

// A water surface at z = 1 over a floor at z = 0, both `edge` wide.
Scene pool(double ior, double edge) {
  Scene s;
  const Vec3 x(edge, 0, 0), y(0, edge, 0), corner(-edge / 2, -edge / 2, 0);
  add_quad(s, add_glass(s, ior), corner + Vec3(0, 0, 1), x, y);
  add_quad(s, add_diffuse(s, Rgb(0.5)), corner, x, y);
  return s;
}

}  // namespace

TEST_CASE("the camera: +x of the local frame to the image's left, +y up, distance along the ray") {
  Scene s;
  add_quad(s, -1, Vec3(-9, -9, 5), Vec3(0, 18, 0), Vec3(18, 0, 0)).radiance = Rgb(1);
  s.film = {40, 20};
  s.camera.fov = 90;
  const Lens lens(s);
  const Vec3 left = lens.through(0, 10).ray.direction, top = lens.through(20, 0).ray.direction;
  CHECK(left.x == Approx(std::sqrt(0.5)));
  CHECK(left.z == Approx(std::sqrt(0.5)));
  CHECK(std::fabs(left.y) < 1e-12);
  CHECK(top.y == Approx(0.5 / std::sqrt(1.25)));
  CHECK(std::fabs(top.x) < 1e-12);
  const Image image = path_image(s, 1, 1);
  const size_t corner = 0;
  const double z = static_cast<double>(image.find("Z")->pixels[corner]);
  CHECK(z > 5 * std::sqrt(1 + 0.95 * 0.95 + 0.45 * 0.45));
  CHECK(z < 5 * std::sqrt(1 + 1.0 + 0.25));
  // Clipping planes count along +z, Z from the camera.
  s.camera.near_clip = 5.5;
  CHECK(channel_mean(path_image(s, 1, 1), "Z") == 0);
  s.camera.near_clip = 4.5;
  CHECK(static_cast<double>(path_image(s, 1, 1).find("Z")->pixels[corner]) == Approx(z));
  s.camera.far_clip = 4.9;
  CHECK(channel_mean(path_image(s, 1, 1), "Z") == 0);
}

TEST_CASE("a film of some pixels of a frame: each as wide as the frame's, in its own part, once") {
  Scene s;
  s.film = {60, 44};
  s.camera.fov = 70;
  s.camera.to_world[3] = {1, 2, 3, 1};
  const Lens whole(s);
  s.film = {7, 5, 60, 44};
  const Lens some(s);
  bool moved = false;
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 7; ++x) {
      // The rays are those of one of the frame's pixels.
      const Vec3 inside = some.through(x + 0.25, y + 0.75).ray.direction;
      Seen seen, some_seen;
      const Vec3 point = Vec3(s.camera.to_world[3]) + 4.0 * inside;
      REQUIRE(whole.project(point, Vec2(0), seen));
      const double px = seen.x, py = seen.y;
      CHECK(px - std::floor(px) == Approx(0.25));
      CHECK(py - std::floor(py) == Approx(0.75));
      CHECK((px >= x * 60 / 7 && px < (x + 1) * 60 / 7));
      CHECK((py >= y * 44 / 5 && py < (y + 1) * 44 / 5));
      moved |= std::floor(px) != x * 60 / 7;
      // What is seen there is in that pixel of the film, with the frame's density.
      REQUIRE(some.project(point, Vec2(0), some_seen));
      CHECK(some_seen.x == Approx(x + 0.25));
      CHECK(some_seen.y == Approx(y + 0.75));
      CHECK(some_seen.density == seen.density);
    }
  CHECK(moved);
  // All other pixels of the frame are not in the film.
  int count = 0;
  for (int y = 0; y < 44; ++y)
    for (int x = 0; x < 60; ++x) {
      Seen seen;
      const Vec3 direction = whole.through(x + 0.5, y + 0.5).ray.direction;
      const Vec3 point = Vec3(s.camera.to_world[3]) + 4.0 * direction;
      count += some.project(point, Vec2(0), seen) ? 1 : 0;
    }
  CHECK(count == 7 * 5);
}

TEST_CASE("what a ray of a camera meets, it sees at that place of the film, with its density") {
  Scene pinhole;
  set_camera(pinhole, Vec3(1, 2, 3), Vec3(2, 4, 1), Vec3(0, 1, 0), 50, 40, 30);
  pinhole.camera.near_clip = 0.5;
  pinhole.camera.offset_x = 0.1;
  Scene thin = pinhole, flat = pinhole;
  thin.camera.kind = CameraKind::kThinLens;
  thin.camera.aperture_radius = 0.3;
  thin.camera.focus_distance = 4;
  flat.camera.kind = CameraKind::kOrthographic;
  flat.camera.offset_x = 0;
  flat.camera.to_world[0] *= 3;  // wider and higher
  flat.camera.to_world[1] *= 2;
  for (const Scene* s : {&pinhole, &thin, &flat}) {
    const Lens lens(*s);
    CHECK(lens.has_aperture() == (s == &thin));
    for (uint64_t i = 0; i < 100; ++i) {
      const Random r(1, Phase::kPath, i);
      const Vec2 u(r.unit(0, 0), r.unit(0, 1));
      const double x = 40 * r.unit(0, 2), y = 30 * r.unit(0, 3), t = 1 + 8 * r.unit(0, 4);
      const CameraRay camera = lens.through(x, y, u);
      const Vec3 point = camera.ray.origin + camera.ray.direction * t;
      Seen seen;
      CAPTURE(i);
      REQUIRE(lens.project(point, u, seen));
      CHECK(seen.x == Approx(x).margin(1e-10));
      CHECK(seen.y == Approx(y).margin(1e-10));
      CHECK(seen.distance == Approx(t - camera.near));
      CHECK(glm::length(seen.to_camera + camera.ray.direction) < 1e-12);
      // Area across the ray of one pixel at the point, by differences.
      const double h = 1e-4;
      const auto moved = [&](double dx, double dy) {
        const Ray ray = lens.through(x + dx, y + dy, u).ray;
        const Vec3 n = camera.ray.direction;
        return ray.origin +
               ray.direction * (glm::dot(point - ray.origin, n) / glm::dot(ray.direction, n));
      };
      const Vec3 along = (moved(h, 0) - moved(-h, 0)) / (2 * h);
      const Vec3 down = (moved(0, h) - moved(0, -h)) / (2 * h);
      CHECK(seen.density * glm::length(glm::cross(along, down)) == Approx(1).epsilon(1e-6));
    }
  }
}

TEST_CASE("a thin lens: sharp in its plane of focus, a disk of r |1 - z / f| elsewhere") {
  Scene s;
  s.film = {40, 30};
  s.camera.kind = CameraKind::kThinLens;
  s.camera.aperture_radius = 0.25;
  s.camera.focus_distance = 3;
  const Lens lens(s);
  s.camera.kind = CameraKind::kPerspective;
  const Lens pinhole(s);
  const Ray middle = pinhole.through(11, 7).ray;
  for (const double z : {0.0, 1.5, 3.0, 12.0}) {
    double furthest = 0, sum = 0;
    const int count = 2000;
    for (uint64_t i = 0; i < count; ++i) {
      const Random r(2, Phase::kPath, i);
      const Ray ray = lens.through(11, 7, Vec2(r.unit(0, 0), r.unit(0, 1))).ray;
      const Vec3 at = ray.origin + ray.direction * ((z - ray.origin.z) / ray.direction.z);
      const double off = glm::length(at - middle.direction * (z / middle.direction.z));
      furthest = std::max(furthest, off);
      sum += off * off;
    }
    const double radius = 0.25 * std::fabs(1 - z / 3);
    CHECK(furthest <= radius + 1e-12);
    // Evenly over the disk: the mean square is half of the radius's.
    CHECK(sum / count == Approx(radius * radius / 2).epsilon(0.05).margin(1e-20));
  }
}

TEST_CASE("an orthographic camera: a lamp of a third of its width covers a third of the film") {
  Scene s;
  const int black = add_diffuse(s, Rgb(0));
  s.film = {30, 20};
  s.camera.kind = CameraKind::kOrthographic;
  s.camera.to_world = Mat4(6);  // shows x from -6 to 6, y from -4 to 4
  s.camera.to_world[3] = {0, 0, -5, 1};
  add_quad(s, black, Vec3(2, -10, 100), Vec3(0, 20, 0), Vec3(4, 0, 0)).radiance = Rgb(2);
  const Image image = path_image(s, 4, 1);
  for (size_t x = 0; x < 30; ++x)
    CHECK(image.find("G")->pixels[10 * 30 + x] == (x < 10 ? 2.0f : 0.0f));  // +x is left
  CHECK(static_cast<double>(image.find("Z")->pixels[0]) == Approx(105));
}

TEST_CASE("area emitters radiate from the normal side only") {
  for (bool front : {true, false}) {
    Scene s;
    Shape& disk = add_sphere(s, -1, Vec3(0), 1);
    disk.kind = ShapeKind::kDisk;
    disk.radiance = Rgb(2);
    add_quad(s, -1, Vec3(-1, 3, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)).radiance = Rgb(2);
    add_sphere(s, -1, Vec3(0, -3, 0), 0.5, !front).radiance = Rgb(2);
    for (const Vec3& target : {Vec3(0, 0, 0), Vec3(-0.3, 3.3, 0), Vec3(0, -3, 0)}) {
      set_camera(s, Vec3(0, 0, front ? 4 : -4), target, Vec3(0, 1, 0), 1e-3, 1, 1);
      CHECK(channel_mean(path_image(s, 1, 1), "R") == (front || target.y < 0 ? front * 2.0 : 0.0));
    }
    const World world(s);
    const PhotonPass none = trace_global_photons(world, *make_double_bvh(world), 1, 1);
    CHECK(none.photons.empty());  // nothing diffuse here
    CHECK(none.short_of_request);
  }
}

TEST_CASE("max_depth: a furnace sums rho^i over the segments that are left, within 0.5 %") {
  for (int depth : {1, 2, 3, 5}) {
    Scene s;
    add_sphere(s, add_diffuse(s, Rgb(0.5)), Vec3(0), 1, true).radiance = Rgb(1);
    set_camera(s, Vec3(0.2, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), 60, 8, 8);
    s.max_depth = depth;
    check_estimate("furnace", 1, image_estimate(path_image(s, 64, 1)), 2 - std::pow(0.5, depth - 1),
                   0.005);
    // The photon mapper's parts: photons of the global map have at most depth - 2 segments, and
    // camera samples ask for them only where a segment is left.
    const World world(s);
    const auto caster = make_double_bvh(world);
    const PhotonPass pass = trace_global_photons(world, *caster, 5000, 1);
    uint32_t most = 0;
    for (const Photon& p : pass.photons) most = std::max(most, p.bounce + 1);
    CHECK(most == static_cast<uint32_t>(std::max(0, depth - 2)));
    const CameraSample c = trace_camera(world, *caster, 4, 4, 0, 1);
    CHECK(c.emission.y == 1);
    CHECK(is_black(c.direct) == (depth < 2));
    CHECK(c.diffuse == (depth > 2));
    if (!c.diffuse) continue;
    const GatherSample g = trace_gather(world, *caster, c.x, c.x.normal, 0, 0, 0, 1);
    CHECK(g.diffuse == (depth > 2));
    CHECK(g.weight.y == Approx(0.5 / kPi));
  }
}

TEST_CASE(
    "under water: photons lose 1 - F within 2 %, radiance seen from above is (1 - F) / n^2 of it "
    "within 1 %") {
  const double n = 1.33, f = (n - 1) * (n - 1) / ((n + 1) * (n + 1));
  for (uint64_t seed : kSeeds) {
    Scene s = pool(n, 2);
    s.lights.push_back(sun_straight_down(3));
    const World world(s);
    const PhotonPass pass = trace_caustic_photons(world, *make_double_bvh(world), 20000, seed);
    check_estimate("caustic power", seed,
                   per_path(pass, [](const Photon& p) { return p.bounce == 1 ? p.power.y : 0; }),
                   3 * 4 * (1 - f), 0.02);
  }
  Scene s = pool(n, 200);
  s.shapes[1].radiance = Rgb(5);
  s.max_depth = 2;  // without reflections at the water's underside
  set_camera(s, Vec3(0, 0, 4), Vec3(0), Vec3(0, 1, 0), 1e-3, 8, 8);
  for (uint64_t seed : kSeeds)
    check_estimate("radiance", seed, image_estimate(path_image(s, 1024, seed), "emission"),
                   5 * (1 - f) / (n * n), 0.01);
}

TEST_CASE("phong: f cos and its density, sampled within 2 % and integrated") {
  // Integrals over the hemisphere by a fine grid against averages over the lobe's samples.
  for (double n : {1.0, 30.0, 500.0})
    for (double angle : {0.0, 0.7, 1.3}) {
      Bsdf b;
      b.kind = BsdfKind::kPhong;
      b.diffuse = Rgb(0.3);
      b.specular = Rgb(0.6);
      b.exponent = n;
      Surface s;
      s.bsdf = &b;
      s.diffuse_lobe = b.diffuse;
      s.glossy_lobe = b.specular;
      s.in = Vec3(std::sin(angle), 0, std::cos(angle));
      s.normal = s.shading_normal = Vec3(0, 0, 1);
      const Vec3 mirror(-s.in.x, 0, s.in.z);
      // The grid is around the mirror direction, fine where the lobe is; u in [0, 1] of the
      // hemisphere around it in equal solid angles of a cone that holds the lobe.
      const double h = std::min(1.0, 30 / (n + 1));
      double density = 0, reflected = 0, below = 0;
      const int steps = 600;
      for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j) {
          const Vec3 d =
              Frame(mirror).to_world(sample_cone({(i + 0.5) / steps, (j + 0.5) / steps}, h));
          const double solid = 2 * kPi * h / (steps * steps);
          density += glossy_pdf(s, d) * solid;
          reflected += glossy_times_cosine(s, d).y * solid;
          // f = rho_s (n + 2) / (2 pi) cos^n(alpha), above the horizon only.
          if (d.z > 0)
            below += 0.6 * (n + 2) / (2 * kPi) * std::pow(glm::dot(d, mirror), n) * d.z * solid;
        }
      CAPTURE(n, angle);
      CHECK(density == Approx(1).epsilon(2e-3));
      CHECK(reflected == Approx(below).epsilon(1e-9));
      Tally albedo;
      for (uint64_t i = 0; i < 60000; ++i) {
        const PixelNumbers numbers(3, Phase::kPath, 0, i);
        const Vec3 d = sample_glossy(s, numbers.pair(1, 0));
        const double pdf = glossy_pdf(s, d);
        albedo.add(pdf > 0 ? glossy_times_cosine(s, d).y / pdf : 0);
      }
      check_estimate("albedo", 3, albedo.estimate(), reflected, 0.02);
      CHECK(diffuse_times_cosine(s, Vec3(0.6, 0, 0.8)).y == Approx(0.3 / kPi * 0.8));
      CHECK(is_black(diffuse_times_cosine(s, Vec3(0.6, 0, -0.8))));
    }
}

TEST_CASE(
    "light samples have the density that light_pdf says, and it integrates to 1, within 4 %") {
  Scene s;
  const int grey = add_diffuse(s, Rgb(0.5));
  add_quad(s, grey, Vec3(-0.5, -0.3, 2), Vec3(0, 1, 0), Vec3(1, 0, 0.2)).radiance = Rgb(1, 2, 3);
  add_sphere(s, grey, Vec3(1, 1, 1), 0.4).radiance = Rgb(5);
  Shape& disk = add_sphere(s, grey, Vec3(-1.5, 0.5, 1), 1);
  disk.kind = ShapeKind::kDisk;
  disk.flip_normals = true;
  disk.radiance = Rgb(1);
  const World world(s);
  const auto caster = make_double_bvh(world);
  const ShadingPoint x{Vec3(0.1, 0.2, 0), Vec3(0, 0, 1)};
  for (uint64_t seed : kSeeds) {
    // Integral over the emitters by uniform directions, and of radiance by both ways.
    Tally density, uniform, sampled;
    for (uint64_t i = 0; i < 200000; ++i) {
      const Random r(seed, Phase::kPath, i);
      const Vec3 d = sample_cone({r.unit(0, 0), r.unit(0, 1)}, 1);  // upper hemisphere
      const Hit hit = caster->closest(Ray{x.position, d}, nullptr);
      const Rgb radiance = hit.valid() ? world.emission(hit, d) : Rgb(0);
      density.add(is_black(radiance) ? 0 : light_pdf(world, x, hit, d) * 2 * kPi);
      uniform.add(radiance.y * 2 * kPi);
      LightSample light;
      if (!sample_light(world, x, r.unit(1, 0), {r.unit(1, 1), r.unit(1, 2)}, light)) {
        sampled.add(0);
        continue;
      }
      const Hit found = caster->closest(Ray{x.position, light.direction}, nullptr);
      if (found.primitive == light.hit.primitive) {
        REQUIRE(light_pdf(world, x, found, light.direction) == Approx(light.pdf).epsilon(1e-9));
        REQUIRE(light.distance == Approx(found.distance).epsilon(1e-9));
      }
      const bool seen =
          !caster->occluded(Ray{x.position, light.direction}, light.distance, nullptr, &light.hit);
      sampled.add(seen ? light.radiance.y : 0);
    }
    check_estimate("density", seed, density.estimate(), 1, 0.04);
    const double error = std::hypot(uniform.estimate().error, sampled.estimate().error);
    check_estimate("radiance", seed, {sampled.estimate().mean, error}, uniform.estimate().mean,
                   0.04);
  }
}

namespace {

// The caustic layer of a floor below a glass ball against photons shot at the same floor, each
// weighed by what the camera sees of it: rho / pi times cosine, in pixels per area, and with a
// filter by what it counts in the pixels around.
void check_caustic_layer(const std::function<void(Scene&)>& change, int spp, uint64_t seed) {
  Scene s;
  add_quad(s, add_diffuse(s, Rgb(0.7)), Vec3(-1, -1, 0), Vec3(2, 0, 0), Vec3(0, 2, 0));
  add_sphere(s, add_glass(s, 1.5), Vec3(0.1, 0, 0.35), 0.15);
  Light light;
  light.position = Vec3(0, 0, 0.8);
  light.intensity = Rgb(1);
  s.lights.push_back(light);
  set_camera(s, Vec3(0, -0.8, 0.15), Vec3(0.15, 0, 0), Vec3(0, 0, 1), 30, 16, 16);
  change(s);
  const World world(s);
  const auto caster = make_double_bvh(world);
  const Lens lens(s);
  const FilterTable filter(s.film.filter);
  const auto counts = [&](double place, int size) {
    const int pixel = static_cast<int>(place);
    double sum = 0;
    for (int i = std::max(0, pixel - filter.reach());
         i <= std::min(size - 1, pixel + filter.reach()); ++i)
      sum += filter.weight(i - pixel, FilterTable::place(place - pixel)) /
             std::ldexp(filter.mean_sum(i, size), FilterTable::kOneBits);
    return sum;
  };
  const PhotonPass pass = trace_caustic_photons(world, *caster, 160000, seed);
  const Estimate photons = per_path(pass, [&](const Photon& p) {
    Seen seen;
    const Random r(seed, Phase::kPath, p.path);
    const Vec2 u(r.unit(p.bounce, 0), r.unit(p.bounce, 1));
    if (!lens.project(p.position, u, seen)) return 0.0;
    const Vec3 eye = p.position + seen.to_camera * seen.distance;
    if (caster->occluded(Ray{eye, -seen.to_camera}, seen.distance * (1 - 1e-9), nullptr, nullptr))
      return 0.0;
    return p.power.y * 0.7 / kPi * seen.to_camera.z * seen.density * counts(seen.x, 16) *
           counts(seen.y, 16) / (16 * 16);
  });
  const Image image = path_image(s, spp, seed);
  const double error = std::hypot(photons.error, image_estimate(image).error);
  check_estimate("caustic", seed, {channel_mean(image, "caustic.G"), error}, photons.mean, 0.04);
  CHECK(photons.mean > 0);
}

}  // namespace

TEST_CASE("the path tracer finds a point light through a glass ball, within 4 %") {
  for (uint64_t seed : kSeeds) check_caustic_layer([](Scene&) {}, 4096, seed);
}

TEST_CASE("so it does through a lens, without perspective and with filters, within 4 %", "[slow]") {
  const auto thin = [](Scene& s) {
    s.camera.kind = CameraKind::kThinLens;
    s.camera.aperture_radius = 0.05;
    s.camera.focus_distance = 0.5;
  };
  const auto flat = [](Scene& s) {
    s.camera.kind = CameraKind::kOrthographic;
    for (int i : {0, 1}) s.camera.to_world[i] *= 0.2;
  };
  for (uint64_t seed : kSeeds) {
    check_caustic_layer(thin, 4096, seed);
    check_caustic_layer(flat, 4096, seed);
    check_caustic_layer(
        [](Scene& s) {
          s.film.filter = {FilterKind::kGaussian, 2, 0.5};
        },
        4096, seed);
    check_caustic_layer(
        [&](Scene& s) {
          thin(s);
          s.film.filter = {FilterKind::kMitchell, 2, 0, 1.0 / 3, 1.0 / 3};
        },
        4096, seed);
  }
}
