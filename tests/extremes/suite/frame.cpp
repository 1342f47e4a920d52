// SPDX-License-Identifier: Apache-2.0
// Whole frames at the ends of scenes, powers, counts and sizes.
#include <fmt/core.h>

#include <cmath>

#include "golden/image/pixel_sum.hpp"
#include "golden/numeric/random.hpp"
#include "golden/transport/sampling.hpp"
#include "tests/extremes/suite/suite.hpp"
#include "tests/oracles/scenes.hpp"
#include "tests/scene_files.hpp"

namespace photonloom::extremes {
namespace {

using namespace oracle;

// A closed grey room that shines everywhere: L = Le / (1 - rho) in each pixel.
Scene furnace(double rho = 0.5, double scale = 1, double radiance = 1, const Vec3& shift = Vec3(0),
              int width = 6, int height = 6) {
  Scene s;
  s.name = "furnace";
  add_room(s, add_diffuse(s, Rgb(rho)), shift, shift + Vec3(1, 2, 3) * scale).radiance =
      Rgb(radiance);
  set_camera(s, shift + Vec3(0.3, 0.4, 0.5) * scale, shift + Vec3(1, 1, 1) * scale, Vec3(0, 1, 0),
             90, width, height);
  return s;
}

FrameRequest request(uint64_t photons = 40000, int k = 50, int spp = 4, int rays = 8) {
  FrameRequest r;
  r.photons = r.caustic_photons = photons;
  r.k = k;
  r.spp = spp;
  r.gather_rays = rays;
  return r;
}

// What goes through the RTL: few photons and pixels, and one model of each unit for all frames
// whose plans have the same widths.
constexpr int kSmallWidth = 5, kSmallHeight = 3;
FrameRequest small_request() { return request(2000, 16, 2, 4); }
constexpr bool kRtl = true;

double green(const Image& image, const std::string& layer = "") {
  return channel_mean(image, layer.empty() ? "G" : layer + ".G");
}

bool finite(const Image& image) {
  for (const Channel& c : image.channels)
    for (const float x : c.pixels)
      if (!std::isfinite(x)) return false;
  return true;
}

// What no frame may show: saturations, numbers that are none, packets lost.
void clean(Run& run, const Run::Rendered& r) {
  run.exact("saturated weights", 0, r.counts.shader.weights);
  run.exact("saturated light", 0, r.counts.shader.direct);
  run.exact("not finite", 0, r.counts.shader.not_finite);
  run.exact("saturated photons", 0, r.packed.saturated);
  run.exact("photons outside", 0, r.packed.outside);
  run.exact("positions outside", 0, r.counts.clamps.positions);
  run.exact("unmatched and unanswered", 0, r.counts.unmatched + r.counts.unanswered);
  run.holds("finite", finite(r.image));
}

Case furnace_case(const std::string& name, const std::string& why, double scale, double radiance,
                  const Vec3& shift = Vec3(0)) {
  return {name, Known::kClosedForm,
          "L = Le / (1 - 0.5) to within 4 % (noise of 40,000 photons)" + why, [=](Run& run) {
            const Run::Rendered r = run.frame(furnace(0.5, scale, radiance, shift), request());
            run.near("L / Le", 2, green(r.image) / radiance, 0.08);
            clean(run, r);
            clean(run, run.frame(furnace(0.5, scale, radiance, shift, kSmallWidth, kSmallHeight),
                                 small_request(), kRtl));
          }};
}

// Scales by powers of two are exact in double, so all that follows is too.
Case same_case(const std::string& name, const std::string& right, double scale, double radiance) {
  return {name, Known::kClosedForm, right, [=](Run& run) {
            const auto frame = [&](double size, double light) {
              return run.frame(furnace(0.5, size, light, Vec3(0), kSmallWidth, kSmallHeight),
                               small_request(), kRtl);
            };
            const Run::Rendered one = frame(1, 1), other = frame(scale, radiance);
            const auto& a = one.image.find("G")->pixels;
            std::vector<double> due, got;
            for (const float x : a) due.push_back(static_cast<double>(x) * radiance);
            for (const float x : other.image.find("G")->pixels) got.push_back(x);
            run.same("pixels", due, got);
            clean(run, other);
          }};
}

Case size_case(const std::string& name, int width, int height, int tile) {
  return {name, Known::kClosedForm,
          fmt::format("tiles of {0}x{0} give the bytes that one tile gives", tile), [=](Run& run) {
            const Scene s = furnace(0.5, 1, 1, Vec3(0), width, height);
            FrameRequest r = small_request();
            r.set = {fmt::format("frame.tile={}", tile)};
            const Run::Rendered small = run.frame(s, r, kRtl);
            r.set = {"frame.tile=1024", "reorder.packets=7"};
            const Run::Rendered whole = run.frame(s, r);
            run.holds("the same image", pixel_sha256(small.image) == pixel_sha256(whole.image));
            run.exact("pixels", width * height, small.image.find("G")->pixels.size());
            clean(run, small);
          }};
}

// A ball that takes no light in a furnace: every ray still ends on a surface of radiance Le / (1 -
// rho).
Case ball_case(const std::string& name, double ior) {
  return {name, Known::kClosedForm,
          "a ball that loses no light leaves a furnace at Le / (1 - rho), to within 5 %",
          [ior](Run& run) {
            Scene s = furnace();
            add_sphere(s, ior > 0 ? add_glass(s, ior) : add_mirror(s), Vec3(0.6, 1.2, 1.6), 0.25);
            const Run::Rendered r = run.frame(s, request(30000, 50, 16, 4));
            run.near("L", 2, green(r.image), 0.1);
            clean(run, r);
            s.film.width = kSmallWidth;
            s.film.height = kSmallHeight;
            clean(run, run.frame(s, small_request(), kRtl));
          }};
}

// A plane lit by a point light at this height over its middle, seen at a distance d from its foot.
Case plane_case(const std::string& name, double height, double d) {
  return {name, Known::kClosedForm, "L = rho / pi * I * h / (h^2 + d^2)^(3/2), no photon needed",
          [=](Run& run) {
            Scene s;
            add_quad(s, add_diffuse(s, Rgb(0.6)), Vec3(-5, -5, 0), Vec3(10, 0, 0), Vec3(0, 10, 0));
            Light light;
            light.position = Vec3(0, 0, height);
            light.intensity = Rgb(1e6);
            s.lights.push_back(light);
            set_camera(s, Vec3(d, 0, 3), Vec3(d, 0, 0), Vec3(0, 1, 0), 1e-4, 2, 2);
            const Run::Rendered r = run.frame(s, request(500, 10, 1, 1), kRtl);
            const double due = 0.6 / kPi * 1e6 * height / std::pow(height * height + d * d, 1.5);
            run.near("L", due, green(r.image, "direct"), 1e-5 * due);
            clean(run, r);
          }};
}

// A lamp in the shape of one thin triangle over a plane far away: E = Le A cos^2 / d^2.
Scene needle(double length, double width) {
  Scene s;
  Shape lamp;
  lamp.bsdf = -1;
  lamp.mesh.positions = {Vec3(-length / 2, 0, 10), Vec3(length / 2, 0, 10), Vec3(0, -width, 10)};
  lamp.mesh.triangles = {{0, 1, 2}};  // normal -z
  lamp.radiance = Rgb(1e9);
  add_quad(s, add_diffuse(s, Rgb(0.5)), Vec3(-5, -5, 0), Vec3(10, 0, 0), Vec3(0, 10, 0));
  s.shapes.push_back(lamp);
  set_camera(s, Vec3(0, 0, 5), Vec3(0, 0, 0), Vec3(0, 1, 0), 1e-3, 2, 2);
  return s;
}

}  // namespace

Group frame_cases() {
  std::vector<Case> cases{
      furnace_case("a scene 1e-6 units across", "", 1e-6 / 3, 1),
      furnace_case("a scene 1e6 units across", "", 1e6 / 3, 1),
      furnace_case("a scene 1e-12 units across", ", the least size that is taken", 1.0001e-12 / 3,
                   1),
      furnace_case("a scene 1e12 units across", ", the greatest size that is taken", 0.9999e12 / 3,
                   1),
      furnace_case("a room 1e6 units from the origin", "", 1, 1, Vec3(1e6, -1e6, 1e6)),
      furnace_case("a room 1e9 units from the origin", "", 1, 1, Vec3(1e9, -1e9, 1e9)),
      furnace_case("radiance 1e-20", "", 1, 1e-20),
      furnace_case("radiance 1e10", "", 1, 1e10),
      {"radiance 1e-30", Known::kRefusal,
       "no pixel of 96 fraction bits can hold it, and the error says so",
       [](Run& run) {
         run.refused("expected brighter lamps",
                     [&] { run.frame(furnace(0.5, 1, 1e-30), request()); });
       }},
      {"radiance 1e30", Known::kRefusal,
       "no pixel of 96 integer bits can hold it, and the error says so",
       [](Run& run) {
         run.refused("expected dimmer lamps", [&] { run.frame(furnace(0.5, 1, 1e30), request()); });
       }},
      same_case("a scene 2^20 times smaller", "the same image to the bit: no absolute epsilon",
                0x1p-20, 1),
      same_case("a scene 2^20 times larger", "the same image to the bit: no absolute epsilon",
                0x1p20, 1),
      same_case("light 2^50 times weaker", "each pixel 2^-50 times as bright, to the bit", 1,
                0x1p-50),
      same_case("light 2^30 times stronger", "each pixel 2^30 times as bright, to the bit", 1,
                0x1p30),
      {"radiance 1e308", Known::kRefusal, "the power of the lamps is no number",
       [](Run& run) {
         run.refused("expected dimmer lamps, of at most 1e+120 W",
                     [&] { run.frame(furnace(0.5, 1, 1e308), request()); });
       }},
      {"a room 1e10 times its size from the origin", Known::kRefusal,
       "a coordinate does not hold the place within the room",
       [](Run& run) {
         run.refused("times its size",
                     [&] { run.frame(furnace(0.5, 1, 1, Vec3(0, 3e10, 0)), request()); });
       }},
      {"a sensor 1e19 units away", Known::kRefusal,
       "the scene is less than a rounding of the distance",
       [](Run& run) {
         Scene scene = furnace();
         set_camera(scene, Vec3(0, 0, 1e19), Vec3(0), Vec3(0, 1, 0), 60, 4, 4);
         run.refused("the sensor is 1e+19 units from a scene",
                     [&] { run.frame(scene, request()); });
       }},
      {"no light", Known::kRefusal, "nothing to render",
       [](Run& run) {
         run.refused("no light", [&] { run.frame(furnace(0.5, 1, 0), request()); });
       }},
      {"a scene 1e-13 units across", Known::kRefusal, "below the least size",
       [](Run& run) {
         run.refused("units across, expected 1e-12 to 1e+12",
                     [&] { run.frame(furnace(0.5, 1e-13), request()); });
       }},
      {"1 photon", Known::kDefinition,
       "the path that fills the map is kept whole; every query finds at most what there is, all is "
       "finite",
       [](Run& run) {
         const Run::Rendered r = run.frame(furnace(), request(1, 50, 1, 4), kRtl);
         run.holds("1 photon and more", r.photons >= 1);
         run.exact("full gathers", 0, r.counts.full);
         clean(run, r);
       }},
      {"k above the number of photons", Known::kClosedForm,
       "without a radius every gather finds all: none is full, and none has a radius to divide by "
       "but r2_max",
       [](Run& run) {
         FrameRequest f = request(20, 200, 1, 4);
         f.radius = 0;
         const Run::Rendered r = run.frame(furnace(), f, kRtl);
         run.exact("full gathers", 0, r.counts.full);
         run.holds("gathers", r.counts.final_gathers > 0);
         clean(run, r);
       }},
      {"1,000,000 photons", Known::kClosedForm, "L = Le / (1 - 0.5) to within 1 %",
       [](Run& run) {
         const Run::Rendered r = run.frame(furnace(), request(1000000, 50, 16, 16));
         run.near("L", 2, green(r.image), 0.02);
         clean(run, r);
       },
       true, "photon_gatherer has cases of as many photons"},
      {"k = 1", Known::kRefusal, "c = (k - 1) / k = 0: no image without a full radius",
       [](Run& run) { run.refused("k", [&] { run.frame(furnace(), request(1000, 1)); }); }},
      {"k = 2 and k = 256", Known::kClosedForm, "L = Le / (1 - 0.5) to within 8 % and 4 %",
       [](Run& run) {
         run.near("k = 2", 2, green(run.frame(furnace(), request(40000, 2, 8, 16)).image), 0.16);
         run.near("k = 256", 2, green(run.frame(furnace(), request(40000, 256)).image), 0.08);
         for (const int k : {2, 256})
           clean(run, run.frame(furnace(0.5, 1, 1, Vec3(0), 2, 2), request(2000, k, 1, 2), kRtl));
       }},
      {"albedo 0", Known::kClosedForm, "L = Le exactly, direct and indirect light exactly 0",
       [](Run& run) {
         const Run::Rendered r =
             run.frame(furnace(0, 1, 1, Vec3(0), kSmallWidth, kSmallHeight), small_request(), kRtl);
         run.near("L", 1, green(r.image), 0);
         run.near("indirect", 0, green(r.image, "indirect"), 0);
         run.near("direct", 0, green(r.image, "direct"), 0);
       }},
      {"albedo 1, three segments", Known::kClosedForm,
       "each segment adds Le: L = 3 Le, to within 3 %",
       [](Run& run) {
         Scene s = furnace(1);
         s.max_depth = 3;
         const Run::Rendered r = run.frame(s, request(40000, 50, 8, 16));
         run.near("L", 3, green(r.image), 0.09);
         clean(run, r);
         s.film.width = kSmallWidth;
         s.film.height = kSmallHeight;
         clean(run, run.frame(s, small_request(), kRtl));
       }},
      size_case("an image of 1x1", 1, 1, 1),
      size_case("an image of 1x23", 1, 23, 5),
      size_case("an image of 23x1", 23, 1, 16),
      size_case("an image of 11x7 in tiles of 3", 11, 7, 3),
      size_case("an image of 17x17 in tiles of 16", 17, 17, 16),
      {"an image of 5x3 through the RTL of all units", Known::kClosedForm,
       "the image is golden's to the bit",
       [](Run& run) {
         clean(run, run.frame(furnace(0.5, 1, 1, Vec3(0), kSmallWidth, kSmallHeight),
                              small_request(), kRtl));
       }},
      {"10,000 rays in one pixel", Known::kClosedForm,
       "L = Le / (1 - 0.5) to within 4 %; 10,000 directions of one table, in one pixel's sum",
       [](Run& run) {
         const Run::Rendered r =
             run.frame(furnace(0.5, 1, 1, Vec3(0), 1, 1), request(40000, 50, 1, 10000));
         run.exact("directions", 10000, r.counts.directions);
         run.near("L", 2, green(r.image), 0.08);
         clean(run, r);
       },
       false, "cdf_sampler has a case of as many requests to one table"},
      {"65,535 rays in one pixel", Known::kClosedForm,
       "the greatest number of rays: as with 10,000",
       [](Run& run) {
         const Run::Rendered r =
             run.frame(furnace(0.5, 1, 1, Vec3(0), 1, 1), request(40000, 50, 1, 65535));
         run.exact("directions", 65535, r.counts.directions);
         run.near("L", 2, green(r.image), 0.08);
         clean(run, r);
       },
       true, "cdf_sampler has a case of 10,000 requests to one table"},
      {"no final gather rays", Known::kClosedForm, "direct light and emission only: indirect is 0",
       [](Run& run) {
         const Run::Rendered r = run.frame(furnace(), request(1000, 10, 16, 0), kRtl);
         run.near("indirect", 0, green(r.image, "indirect"), 0);
         run.near("L", 1.5, green(r.image), 0.06);
       }},
      ball_case("a ball of index 1 in a furnace", 1),
      ball_case("a ball of index 1.5 in a furnace", 1.5),
      ball_case("a ball of index 1000 in a furnace", 1000),
      ball_case("a mirror ball in a furnace", 0),
      {"index 1 before a lamp", Known::kClosedForm,
       "no glass at all: the lamp's own radiance, exactly",
       [](Run& run) {
         Scene s;
         const int glass = add_glass(s, 1);
         add_quad(s, glass, Vec3(-5, -5, 1), Vec3(10, 0, 0), Vec3(0, 10, 0));
         add_quad(s, -1, Vec3(-9, -9, 0), Vec3(18, 0, 0), Vec3(0, 18, 0)).radiance = Rgb(4);
         set_camera(s, Vec3(0, 0, 2), Vec3(0.1, 0.2, 0), Vec3(0, 1, 0), 40, 4, 4);
         run.near("L", 4, green(run.frame(s, request(100, 10, 4, 1)).image), 0);
       }},
      plane_case("light head on", 2, 0),
      plane_case("grazing light, cosine 1e-3", 1e-3, 1),
      plane_case("grazing light, cosine 1e-6", 1e-6, 1),
      {"a wall of no thickness, lit from one side", Known::kClosedForm,
       "its dark side is 0 in every pixel: no direct light, no photon through it",
       [](Run& run) {
         Scene s;
         const int grey = add_diffuse(s, Rgb(0.8), true);
         add_quad(s, grey, Vec3(0, -1, -1), Vec3(0, 2, 0), Vec3(0, 0, 2));
         s.shapes.back().back_bsdf = grey;
         add_quad(s, grey, Vec3(3, -1, -1), Vec3(0, 2, 0), Vec3(0, 0, 2));  // sends light back
         s.shapes.back().back_bsdf = grey;
         Light light;
         light.position = Vec3(1, 0, 0);
         light.intensity = Rgb(100);
         s.lights.push_back(light);
         set_camera(s, Vec3(-2, 0, 0), Vec3(0, 0, 0), Vec3(0, 1, 0), 40, 6, 6);
         const Run::Rendered dark = run.frame(s, request(20000, 50, 4, 16));
         s.film.width = kSmallWidth;
         s.film.height = kSmallHeight;
         const Run::Rendered small = run.frame(s, small_request(), kRtl);
         for (const float x : small.image.find("G")->pixels) run.near("L", 0, x, 0);
         for (const float x : dark.image.find("G")->pixels) run.near("L", 0, x, 0);
         set_camera(s, Vec3(2, 0, 0), Vec3(0, 0, 0), Vec3(0, 1, 0), 40, 6, 6);
         run.holds("the lit side is lit", green(run.frame(s, request(20000, 50, 4, 16)).image) > 1);
       }},
      {"a lamp in the plane of a wall", Known::kClosedForm,
       "the cosine at the wall is 0: no light reaches it, no pixel is NaN",
       [](Run& run) {
         Scene s;
         const int grey = add_diffuse(s, Rgb(0.8));
         add_quad(s, grey, Vec3(2, -1, 0), Vec3(2, 0, 0), Vec3(0, 2, 0));
         add_quad(s, -1, Vec3(-1, -1, 0), Vec3(2, 0, 0), Vec3(0, 2, 0)).radiance = Rgb(5);
         set_camera(s, Vec3(3, 0, 3), Vec3(3, 0, 0), Vec3(0, 1, 0), 20, 6, 6);
         const Run::Rendered r = run.frame(s, request(100, 10, 16, 4), kRtl);
         for (const float x : r.image.find("G")->pixels) run.near("L", 0, x, 0);
         clean(run, r);
       }},
      {"a lamp on the wall that it lies in", Known::kClosedForm,
       "wall and lamp in one place: finite, and beside the lamp dark",
       [](Run& run) {
         Scene s;
         const int grey = add_diffuse(s, Rgb(0.8));
         add_quad(s, grey, Vec3(-4, -4, 0), Vec3(8, 0, 0), Vec3(0, 8, 0));
         add_quad(s, -1, Vec3(-1, -1, 0), Vec3(2, 0, 0), Vec3(0, 2, 0)).radiance = Rgb(5);
         set_camera(s, Vec3(3, 0, 3), Vec3(3, 0, 0), Vec3(0, 1, 0), 20, 6, 6);
         const Run::Rendered r = run.frame(s, request(100, 10, 16, 4), kRtl);
         for (const float x : r.image.find("G")->pixels) run.near("L", 0, x, 0);
         clean(run, r);
       }},
      {"triangles without area", Known::kDefinition,
       "points and lines among the triangles change no byte of the image",
       [](Run& run) {
         const Scene whole = furnace(0.5, 1, 1, Vec3(0), kSmallWidth, kSmallHeight);
         Scene more = whole;
         Mesh& mesh = more.shapes[0].mesh;
         const auto n = static_cast<uint32_t>(mesh.positions.size());
         mesh.positions.push_back(mesh.positions[0]);
         mesh.positions.push_back((mesh.positions[0] + mesh.positions[1]) * 0.5);
         mesh.triangles.push_back({0, 0, 1});
         mesh.triangles.push_back({0, n, n});
         mesh.triangles.push_back({0, 1, n + 1});
         const Run::Rendered a = run.frame(whole, small_request(), kRtl);
         const Run::Rendered b = run.frame(more, small_request(), kRtl);
         run.holds("the same image", pixel_sha256(a.image) == pixel_sha256(b.image));
       }},
      {"a lamp in the shape of a needle, 1 : 1e6", Known::kClosedForm,
       "E = Le A / d^2 head on: L = rho / pi E, to within 1 %",
       [](Run& run) {
         const double length = 0.1, width = 1e-7;
         const Run::Rendered r = run.frame(needle(length, width), request(500, 10, 16, 1), kRtl);
         const double due = 0.5 / kPi * 1e9 * (length * width / 2) / 100;
         run.near("L", due, green(r.image, "direct"), 0.01 * due);
         clean(run, r);
       }},
      {"rays through shared edges and vertices", Known::kClosedForm,
       "a grid of 20 x 20 quads has no holes: 100,000 rays at its edges and vertices meet it",
       [](Run& run) {
         Scene s;
         Shape grid;
         grid.bsdf = add_diffuse(s, Rgb(0.5));
         grid.radiance = Rgb(1);
         const uint32_t n = 21;
         for (uint32_t y = 0; y < n; ++y)
           for (uint32_t x = 0; x < n; ++x)
             grid.mesh.positions.push_back(
                 Vec3(0.1 * x, 0.1 * y, 0.03 * to_unit(hash_bits(1, x, y, 0))));
         for (uint32_t y = 0; y + 1 < n; ++y)
           for (uint32_t x = 0; x + 1 < n; ++x) {
             const uint32_t i = y * n + x;
             grid.mesh.triangles.push_back({i, i + 1, i + n + 1});
             grid.mesh.triangles.push_back({i, i + n + 1, i + n});
           }
         s.shapes.push_back(grid);
         const World world(s);
         const auto bvh = make_double_bvh(world);
         uint64_t missed = 0;
         for (uint64_t i = 0; i < 100000; ++i) {
           const Random r(7, Phase::kPath, i);
           // A vertex inside of the grid, or a point of one of its edges.
           const auto inside = [&](uint64_t d) {
             return 1 + static_cast<uint32_t>(r.bits(1, d) % (n - 2));
           };
           const uint32_t at = inside(0) * n + inside(1);
           const uint32_t to[] = {at, at + 1, at + n, at + n + 1};
           const double w = i % 3 ? r.unit(0, 3) : 0;
           const auto& p = s.shapes[0].mesh.positions;
           const Vec3 target = p[at] * (1 - w) + p[to[i % 4]] * w;
           const Vec3 origin(r.unit(0, 0) * 2, r.unit(0, 1) * 2, 1 + r.unit(0, 2));
           missed += !bvh->closest(Ray{origin, glm::normalize(target - origin)}, nullptr).valid();
         }
         run.exact("missed", 0, missed);
       }},
      {"rays along a wall", Known::kClosedForm,
       "of 20,000 walks of grazing bounces in a room none leaves it",
       [](Run& run) {
         const Scene s = furnace();
         const World world(s);
         const auto bvh = make_double_bvh(world);
         uint64_t lost = 0;
         for (uint64_t path = 0; path < 20000; ++path) {
           const Random r(5, Phase::kPath, path);
           Hit hit = bvh->closest({Vec3(0.5, 1, 1.5), sample_sphere({r.unit(0, 0), r.unit(0, 1)})},
                                  nullptr);
           for (uint64_t bounce = 1; bounce < 8 && hit.valid(); ++bounce) {
             const Vec3 d =
                 Frame(hit.normal)
                     .to_world(sample_cosine({1 - 1e-12 * r.unit(bounce, 0), r.unit(bounce, 1)}));
             const Hit from = hit;
             hit = bvh->closest({from.position, d}, &from);
           }
           lost += !hit.valid();
         }
         run.exact("lost", 0, lost);
       }},
      {"r2_floor above every r2", Known::kSaturation,
       "every gather's r2 is below the floor: `clamped` counts them all",
       [](Run& run) {
         FrameRequest f = small_request();
         f.set = {"gather.r2_floor=17179869183"};
         const Run::Rendered r =
             run.frame(furnace(0.5, 1, 1, Vec3(0), kSmallWidth, kSmallHeight), f, kRtl);
         run.counted("clamped", r.counts.table_gathers + r.counts.final_gathers, r.counts.clamped);
         run.holds("finite", finite(r.image));
       }},
      {"integer bits too few for the light", Known::kSaturation,
       "weights and light that do not fit are taken as the largest and counted; nothing wraps: no "
       "pixel is brighter than without",
       [](Run& run) {
         FrameRequest f = small_request();
         const Scene bright = furnace(0.5, 1, 1000, Vec3(0), kSmallWidth, kSmallHeight);
         const Run::Rendered all = run.frame(bright, f);
         clean(run, all);
         f.set = {"pixel.integer_bits=6"};
         const Run::Rendered few = run.frame(bright, f, kRtl);
         run.counted_some("saturated weights and light",
                          few.counts.shader.direct + few.counts.shader.weights);
         for (size_t i = 0; i < all.image.find("G")->pixels.size(); ++i)
           run.holds("no brighter",
                     few.image.find("G")->pixels[i] <= all.image.find("G")->pixels[i]);
       }},
      {"a tile with room for one record", Known::kSaturation,
       "all samples but those of the record are told that the tile is full and gather all the "
       "same: "
       "`cache_full`, and each reach below a position unit is counted in `clamped_reaches`",
       [](Run& run) {
         FrameRequest f = small_request();
         f.set = {"cache.present=true", "cache.records=1", "cache.accuracy=0"};
         const Run::Rendered r =
             run.frame(furnace(0.5, 1, 1, Vec3(0), kSmallWidth, kSmallHeight), f, kRtl);
         run.counted("full", r.counts.cache_samples - 1 - r.counts.cache_hits, r.counts.cache_full);
         run.counted("clamped reaches", r.counts.cache_samples, r.counts.clamps.reaches);
         clean(run, r);
       }},
      {"records with gradients in a room", Known::kDefinition,
       "no number of a gradient is beyond 31 bits, and none is counted",
       [](Run& run) {
         FrameRequest f = small_request();
         f.set = {"cache.present=true", "cache.gradients=both"};
         const Run::Rendered r =
             run.frame(furnace(0.5, 1, 1, Vec3(0), kSmallWidth, kSmallHeight), f, kRtl);
         run.holds("records", r.counts.cache_records > 0);
         run.counted("saturated gradients", 0, r.counts.clamps.gradients);
         clean(run, r);
       }},
      {"records with gradients in a gap of 2^-22", Known::kSaturation,
       "a wall 2^-22 of the scene away gives gradients beyond 31 bits: taken as the largest, "
       "counted "
       "in `saturated_gradients`; the image is finite",
       [](Run& run) {
         Scene s;
         const int grey = add_diffuse(s, Rgb(0.5));
         const double gap = 0x1p-22;
         add_quad(s, grey, Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)).radiance = Rgb(1);
         add_quad(s, grey, Vec3(0, 0, gap), Vec3(0, 1, 0), Vec3(1, 0, 0)).radiance = Rgb(1);
         set_camera(s, Vec3(0.5, 0.5, gap / 2), Vec3(0.5, 0.5, 0), Vec3(0, 1, 0), 40, kSmallWidth,
                    kSmallHeight);
         FrameRequest f = small_request();
         f.set = {"cache.present=true", "cache.gradients=translation"};
         const Run::Rendered r = run.frame(s, f, kRtl);
         run.counted_some("saturated gradients", r.counts.clamps.gradients);
         clean(run, r);
       }},
  };
  return {
      "frame",
      "Scenes made by hand: closed grey rooms that shine everywhere, planes, walls, balls; 40,000 "
      "photons a map, k = 50 and 4 samples of 8 rays where nothing else is said. Through the RTL "
      "of "
      "all units the plan has: the same at 5x3 pixels with 2,000 photons and k = 16 where the "
      "frame is larger, its image and "
      "counts golden's.",
      std::move(cases)};
}

}  // namespace photonloom::extremes
