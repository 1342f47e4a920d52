// SPDX-License-Identifier: Apache-2.0
// Caustic photons of light from infinitely far away: they are emitted into the boxes of mirrors and
// glass, however small these are in the scene, and bring what all emission would.
#include "golden/numeric/elementary.hpp"
#include "golden/transport/caustic_emission.hpp"
#include "golden/transport/sampling.hpp"
#include "tests/catch.hpp"
#include "tests/oracles/photon_mapper.hpp"

using namespace photonloom;
using namespace photonloom::oracle;

namespace {

Light even_sky(const Rgb& radiance) {
  Light light;
  light.kind = LightKind::kEnvironment;
  light.intensity = radiance;
  return light;
}

// Far away specks make the scene wide, and hide nothing.
void widen(Scene& s, double reach) {
  const int black = add_diffuse(s, Rgb(0));
  for (const Vec3& at : {Vec3(reach, 0, 0), Vec3(0, -reach, 0), Vec3(-reach, reach, reach)})
    add_sphere(s, black, at, 1e-3);
}

// Radius r, centre c: whether a ray meets it.
bool meets_ball(const Ray& ray, const Vec3& c, double r) {
  const Vec3 d = c - ray.origin;
  const double along = glm::dot(d, ray.direction);
  return glm::dot(d, d) - along * along < r * r;
}

// Balls that overlap, one apart, one in an instance, and a flat mirror.
Scene casters() {
  Scene s;
  const int glass = add_glass(s, 1.5);
  add_sphere(s, glass, Vec3(0), 1);
  add_sphere(s, glass, Vec3(0.9, 0.3, 0), 0.7);
  add_sphere(s, glass, Vec3(0, 6, 1), 0.5);
  add_quad(s, add_mirror(s), Vec3(-3, -1, -2), Vec3(2, 0, 0), Vec3(0, 0.5, 0));
  add_quad(s, glass, Vec3(0), Vec3(0.2, 0, 0.1), Vec3(0, 0.2, 0)).group = 0;
  for (const Vec3& at : {Vec3(4, 1, 1), Vec3(4.1, 1.1, 1)}) {
    Instance i;
    i.group = 0;
    i.to_world = Mat4(1);
    i.to_world[3] = glm::dvec4(at, 1);
    s.instances.push_back(i);
  }
  widen(s, 30);
  return s;
}

}  // namespace

TEST_CASE("rays into the boxes of casters: every ball is met with its area, within 4 %") {
  Scene s = casters();
  s.lights = {even_sky(Rgb(1))};
  const World world(s);
  const DeltaBoxes boxes(world);
  const std::pair<Vec3, double> balls[] = {
      {Vec3(0), 1}, {Vec3(0.9, 0.3, 0), 0.7}, {Vec3(0, 6, 1), 0.5}};
  for (const uint64_t seed : kSeeds) {
    const Vec3 d = sample_sphere({to_unit(mix64(seed)), to_unit(mix64(seed + 1))});
    Tally areas[3];
    bool all_met = true, all_outside = true;
    for (uint64_t i = 0; i < 400000; ++i) {
      const Random r(seed, Phase::kCausticPhoton, i);
      double density;
      const Ray ray = boxes.aim(d, r.unit(0, 0), {r.unit(0, 1), r.unit(0, 2)}, density);
      all_met = all_met && boxes.met_by(ray);
      all_outside = all_outside && glm::length(ray.origin - world.centre()) > world.radius();
      for (size_t b = 0; b < 3; ++b)
        areas[b].add(meets_ball(ray, balls[b].first, balls[b].second) ? 1 / density : 0);
    }
    CHECK(all_met);
    CHECK(all_outside);
    for (size_t b = 0; b < 3; ++b) {
      const double r = balls[b].second;
      check_estimate("ball", seed, areas[b].estimate(), kPi * r * r, 0.04);
    }
  }
}

TEST_CASE("light into casters has the power of all light, emitter by emitter, within 8 %") {
  Scene s = casters();
  s.lights = {even_sky(Rgb(0.5, 1, 2)), Light(), Light(), Light()};
  s.lights[1].kind = LightKind::kDirectional;
  s.lights[1].direction = glm::normalize(Vec3(1, -2, 0.5));
  s.lights[1].intensity = Rgb(3);
  s.lights[2].position = Vec3(0.9, 1.4, 0.4);
  s.lights[2].intensity = Rgb(5);
  s.lights[3].kind = LightKind::kCollimated;
  s.lights[3].position = Vec3(0, 0, 20);
  s.lights[3].direction = Vec3(0, 0, -1);
  s.lights[3].intensity = Rgb(4);
  const World world(s);
  const DeltaBoxes boxes(world);
  const CausticEmission emission(world, boxes);
  const Vec3 centre(0.9, 0.3, 0);
  const double r = 0.7;
  // Into the second ball, as if the others were not there.
  const Vec3 to_point = centre - s.lights[2].position;
  const double distance2 = glm::dot(to_point, to_point);
  const double expected[] = {4 * kPi * kPi * r * r, 3 * kPi * r * r,
                             5 * 2 * kPi * (1 - std::sqrt(1 - r * r / distance2))};
  for (const uint64_t seed : kSeeds) {
    Tally met[4], beam;
    for (uint64_t i = 0; i < 600000; ++i) {
      uint32_t emitter;
      const Emission e = emission.emit(Random(seed, Phase::kCausticPhoton, i), emitter);
      const bool meets =
          meets_ball(e.ray, centre, r) && glm::dot(centre - e.ray.origin, e.ray.direction) > 0;
      for (uint32_t k = 0; k < 3; ++k) met[k].add(k == emitter && meets ? e.power.y : 0);
      beam.add(emitter == 3 ? e.power.y : 0);
    }
    for (size_t k = 0; k < 3; ++k)
      check_estimate("met", seed, met[k].estimate(), expected[k], 0.08);
    check_estimate("beam", seed, beam.estimate(), 4, 0.08);
  }
}

TEST_CASE("without light from far away caustic photons start as all photons do, to the bit") {
  Scene s = room(true);
  add_sphere(s, add_glass(s, 1.5), Vec3(0.7, 0.2, 0.35), 0.2);
  Light light;
  light.position = Vec3(0.4, 0.7, 0.3);
  s.lights = {light};
  const World world(s);
  const DeltaBoxes boxes(world);
  const CausticEmission emission(world, boxes);
  bool same = true;
  for (uint64_t i = 0; i < 1000; ++i) {
    const Random random(3, Phase::kCausticPhoton, i);
    uint32_t a, b;
    const Emission here = emission.emit(random, a), there = emit_photon(world, random, b);
    same = same && a == b && here.ray.origin == there.ray.origin &&
           here.ray.direction == there.ray.direction && here.power == there.power;
  }
  CHECK(same);
}

TEST_CASE(
    "a small mirror ball in a wide scene under a sky: a disk gets 2 pi^2 r^2 L (1 - 1 / sqrt(1 + "
    "(a / h)^2)) by it, within 3 %") {
  // An ideal mirror under an even sky shows the sky all over: it shines on the disk as a lamp of
  // the radiance L. Where it shows the disk itself nothing comes; that part is counted backwards.
  const double r = 0.5, h = 3, a = 2, radiance = 2;
  Scene s;
  add_sphere(s, add_mirror(s), Vec3(0), r);
  Shape& disk = add_sphere(s, add_diffuse(s, Rgb(0.5)), Vec3(0, 0, -h), a);
  disk.kind = ShapeKind::kDisk;
  widen(s, 100);
  s.lights = {even_sky(Rgb(radiance))};
  const World world(s);
  const auto caster = make_double_bvh(world);
  const auto on_disk = [&](const Vec3& from, const Vec3& d) {
    if (d.z >= 0) return false;
    const Vec3 at = from + d * ((-h - from.z) / d.z);
    return at.x * at.x + at.y * at.y < a * a;
  };
  uint64_t seen = 0, itself = 0;
  for (uint64_t i = 0; i < 500000; ++i) {
    const Random u(9, Phase::kPath, i);
    const Vec3 n = sample_sphere({u.unit(0, 0), u.unit(0, 1)});
    const Vec3 d = Frame(n).to_world(sample_cosine({u.unit(0, 2), u.unit(0, 3)}));
    if (!on_disk(n * r, d)) continue;
    ++seen;
    itself += on_disk(n * r, n * (2 * glm::dot(n, d)) - d);
  }
  const double kept = 1 - static_cast<double>(itself) / static_cast<double>(seen);
  const double power = 2 * kPi * kPi * r * r * radiance * (1 - 1 / std::sqrt(1 + a * a / (h * h)));
  for (const uint64_t seed : kSeeds) {
    const PhotonPass pass = trace_caustic_photons(world, *caster, 20000, seed);
    CHECK(pass.photons.size() == 20000);
    CHECK(pass.paths < 64 * pass.photons.size());
    check_estimate("disk", seed, per_path(pass, [](const Photon& p) { return p.power.y; }),
                   power * kept, 0.03);
  }
}

TEST_CASE("a caustic pass that finds nothing ends after 32 paths towards casters for each photon") {
  // Glass in a closed room, the light outside of it.
  Scene s;
  add_room(s, add_diffuse(s, Rgb(0.5), true), Vec3(-1), Vec3(1));
  add_sphere(s, add_glass(s, 1.5), Vec3(0.2), 0.3);
  widen(s, 20);
  s.lights = {even_sky(Rgb(1))};
  const World world(s);
  const auto caster = make_double_bvh(world);
  constexpr uint64_t kPhotons = 10000, kRound = 65536;
  const PhotonPass pass = trace_caustic_photons(world, *caster, kPhotons, 1);
  CHECK(pass.photons.empty());
  CHECK(pass.short_of_request);
  CHECK(pass.paths >= 32 * kPhotons);
  CHECK(pass.paths < 32 * kPhotons + 2 * kRound);
}

TEST_CASE("the photons of a map are the first of any larger one, whole paths of them") {
  Scene s;
  add_quad(s, add_diffuse(s, Rgb(0.6, 0.5, 0.4)), Vec3(-1.5, 0, 1.5), Vec3(3, 0, 0),
           Vec3(0, 0, -3));
  add_sphere(s, add_glass(s, 1.5), Vec3(0.6, 0.3, 0.2), 0.3);
  s.lights = {even_sky(Rgb(1))};
  const World world(s);
  const auto caster = make_double_bvh(world);
  for (const bool caustic : {false, true}) {
    const auto trace = [&](uint64_t photons) {
      return caustic ? trace_caustic_photons(world, *caster, photons, 5)
                     : trace_global_photons(world, *caster, photons, 5);
    };
    constexpr uint64_t kMost = 70000;  // more than one round of paths has
    const PhotonPass all = trace(kMost);
    REQUIRE(all.photons.size() >= kMost);
    for (const uint64_t few : {1, 2, 63, 1000, 5000, 65000}) {
      CAPTURE(caustic, few);
      const PhotonPass pass = trace(few);
      REQUIRE(pass.photons.size() >= few);
      CHECK(pass.photons[few - 1].path == pass.photons.back().path);
      CHECK(pass.photons.back().path != all.photons[pass.photons.size()].path);
      CHECK(pass.paths == pass.photons.back().path + 1);
      uint64_t others = 0;
      for (size_t i = 0; i < pass.photons.size(); ++i) {
        const Photon &a = pass.photons[i], &b = all.photons[i];
        others += a.position != b.position || a.direction != b.direction || a.path != b.path ||
                  a.bounce != b.bounce || a.flight != b.flight;
      }
      CHECK(others == 0);
    }
  }
}

TEST_CASE("layers agree: a small plastic under a wide sky and sun, caustic within 3 %", "[slow]") {
  Scene s;
  add_quad(s, add_diffuse(s, Rgb(0.6, 0.5, 0.4)), Vec3(-1.5, 0, 1.5), Vec3(3, 0, 0),
           Vec3(0, 0, -3));
  Bsdf plastic;
  plastic.kind = BsdfKind::kPlastic;
  plastic.diffuse = Rgb(0.2, 0.5, 0.7);
  plastic.specular = Rgb(1);
  plastic.ior = 1.6;
  add_sphere(s, add_bsdf(s, plastic), Vec3(-0.5, 0.4, 0), 0.4);
  add_sphere(s, add_glass(s, 1.5), Vec3(0.6, 0.3, 0.2), 0.3);
  Light sun;
  sun.kind = LightKind::kDirectional;
  sun.direction = glm::normalize(Vec3(0.4, -1, -0.3));
  sun.intensity = Rgb(2, 1.8, 1.5);
  s.lights = {even_sky(Rgb(0.4, 0.5, 0.7)), sun};
  widen(s, 20);
  set_camera(s, Vec3(0, 2.5, 3), Vec3(0, 0, 0), Vec3(0, 1, 0), 45, kSize, kSize);
  check_layers("plastic under a sky", s, 2048, 8, 0.03, 8);
}
