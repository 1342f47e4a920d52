// SPDX-License-Identifier: Apache-2.0
// Films: filters as tables of integers, exact sums, splats against their definition, windows.
#include <oneapi/tbb/global_control.h>

#include <cmath>
#include <functional>

#include "golden/numeric/wide_sum.hpp"
#include "golden/pipeline/prepare.hpp"
#include "golden/transport/camera.hpp"
#include "golden/transport/film_filter.hpp"
#include "tests/catch.hpp"
#include "tests/oracles/scenes.hpp"

using namespace photonloom;
using namespace photonloom::oracle;

namespace {

const Filter kMitchell = {FilterKind::kMitchell, 2, 0, 1.0 / 3, 1.0 / 3};
const Filter kCatmullRom = {FilterKind::kMitchell, 2, 0, 0, 0.5};
const Filter kFilters[] = {
    {FilterKind::kBox, 0.5},
    {FilterKind::kBox, 1.25},
    {FilterKind::kTent, 1},
    {FilterKind::kGaussian, 2, 0.5},
    kMitchell,
    kCatmullRom,
    {FilterKind::kLanczos, 3},
};

// The definitions once more, by the library's functions.
double defined(const Filter& f, double x) {
  const auto sinc = [](double v) { return v == 0 ? 1 : std::sin(M_PI * v) / (M_PI * v); };
  const double d = std::fabs(x);
  if (d > f.radius) return 0;
  switch (f.kind) {
    case FilterKind::kTent:
      return 1 - d / f.radius;
    case FilterKind::kGaussian:
      return std::exp(-d * d / (2 * f.stddev * f.stddev)) - std::exp(-8.0);
    case FilterKind::kMitchell:
      return (d < 1 ? (12 - 9 * f.b - 6 * f.c) * std::pow(d, 3) +
                          (-18 + 12 * f.b + 6 * f.c) * d * d + 6 - 2 * f.b
                    : (-f.b - 6 * f.c) * std::pow(d, 3) + (6 * f.b + 30 * f.c) * d * d +
                          (-12 * f.b - 48 * f.c) * d + 8 * f.b + 24 * f.c) /
             6;
    case FilterKind::kLanczos:
      return sinc(d) * sinc(d / f.radius);
    default:
      return 1;
  }
}

// A film of lamps behind each other's edges, so that emission alone makes the image.
Scene lamps(const Filter& filter) {
  Scene s;
  const int black = add_diffuse(s, Rgb(0));
  const auto lamp = [&](const Vec3& corner, const Vec3& u, const Vec3& v, const Rgb& radiance) {
    add_quad(s, black, corner, u, v).radiance = radiance;
  };
  lamp({-3, -3, 4}, {0, 6, 0}, {3.1, 0, 0}, Rgb(1, 2, 4));
  lamp({0.2, -0.4, 3}, {0, 2, 0}, {1, 1, 0}, Rgb(9, 0.5, 0));
  set_camera(s, Vec3(0), Vec3(0, 0, 1), Vec3(0, 1, 0), 60, 13, 9);
  s.film.filter = filter;
  return s;
}

FrameRequest film_request(int spp) {
  FrameRequest r;
  r.photons = 4000;
  r.k = 10;
  r.spp = spp;
  r.gather_rays = 2;
  return r;
}

Image frame_image(const Scene& scene, const FrameRequest& request,
                  Arithmetic arithmetic = Arithmetic::kGolden) {
  const PreparedFrame frame =
      prepare_frame(std::make_unique<World>(scene), request, arithmetic, nullptr);
  FrameUnits units = make_golden_units(frame.plan);
  FrameCounts counts;
  return render_frame(frame.input(arithmetic), units, counts);
}

}  // namespace

TEST_CASE("a filter's table is its definition, rounded once, and symmetric") {
  for (const Filter& f : kFilters) {
    const FilterTable table(f);
    INFO(static_cast<int>(f.kind) << " of radius " << f.radius);
    const int reach = table.reach();
    CHECK(reach == static_cast<int>(std::ceil(f.radius - 0.5)));
    CHECK(table.is_plain_box() == (&f == &kFilters[0]));
    double sum = 0;
    for (int offset = -reach; offset <= reach; ++offset)
      for (int place = 0; place < FilterTable::kPlaces; ++place) {
        const double d = offset + 0.5 - (place + 0.5) / FilterTable::kPlaces;
        const int32_t w = table.weight(offset, place);
        REQUIRE(w == std::lround(defined(f, d) * 16384));
        REQUIRE(w == table.weight(-offset, FilterTable::kPlaces - 1 - place));
        sum += w;
      }
    // The integral, which is 1 for the cubics and nearly so for lanczos.
    const double integral = sum / FilterTable::kPlaces / 16384;
    CHECK(table.mean_sum(100, 200) == Approx(integral));
    if (f.kind == FilterKind::kMitchell) CHECK(integral == Approx(1).epsilon(1e-3));
    if (f.kind == FilterKind::kLanczos) CHECK(integral == Approx(0.9970).epsilon(1e-3));
  }
  CHECK(FilterTable(kMitchell).weight(2, FilterTable::kPlaces - 1) < 0);
}

TEST_CASE("a wide sum is exact, whatever the order and the signs") {
  const Random random(1, Phase::kPath, 7);
  for (int round = 0; round < 200; ++round) {
    WideSum forward, backward;
    __extension__ typedef __int128 Int128;
    Int128 small = 0;
    std::vector<std::pair<UInt128, int32_t>> terms;
    for (uint64_t i = 0; i < 50; ++i) {
      const auto n = static_cast<uint64_t>(round);
      const int bits = round % 2 ? 128 : 80;
      const UInt128 value =
          ((UInt128{random.bits(n, 3 * i)} << 64) | random.bits(n, 3 * i + 1)) >> (128 - bits);
      terms.emplace_back(value, static_cast<int32_t>(random.bits(n, 3 * i + 2)) >> 3);
    }
    for (const auto& [value, weight] : terms) forward.add(value, weight);
    for (auto at = terms.rbegin(); at != terms.rend(); ++at) backward.add(at->first, at->second);
    CHECK(forward == backward);
    if (round % 2 == 0) {
      for (const auto& [value, weight] : terms) small += static_cast<Int128>(value) * weight;
      CHECK(forward.value() == static_cast<double>(small));
    }
    // What is taken away again leaves nothing.
    for (const auto& [value, weight] : terms) forward.add(value, -weight);
    CHECK(forward == WideSum());
    CHECK(forward.value() == 0);
  }
  // 2^159 + 2^106 + 1 lies above the middle of two doubles, 2^159 + 2^106 on it.
  WideSum sum;
  sum.add(UInt128{1} << 127, 1 << 30);
  sum.add(UInt128{1} << 127, 1 << 30);
  for (int i = 0; i < 2; ++i) sum.add(UInt128{1} << 127, 1 << 30);
  CHECK(sum.value() == 0x1p159);
  sum.add(UInt128{1} << 106, 1);
  CHECK(sum.value() == 0x1p159);
  sum.add(1, 1);
  CHECK(sum.value() == 0x1p159 + 0x1p107);
}

TEST_CASE("a filtered pixel is the weighted mean of the samples around it") {
  for (const Filter& f : kFilters) {
    INFO(static_cast<int>(f.kind) << " of radius " << f.radius);
    const Scene s = lamps(f);
    const int spp = 3;
    const World world(s);
    const auto caster = make_double_bvh(world);
    const Image image = frame_image(s, film_request(spp));
    const auto place = [](double x) {
      return (std::floor(x * FilterTable::kPlaces) + 0.5) / FilterTable::kPlaces;
    };
    for (int y = 0; y < s.film.height; ++y)
      for (int x = 0; x < s.film.width; ++x) {
        Rgb sum(0);
        double whole = 0;
        for (int v = 0; v < s.film.height; ++v)
          for (int u = 0; u < s.film.width; ++u)
            for (uint64_t i = 0; i < static_cast<uint64_t>(spp); ++i) {
              const CameraSample sample = trace_camera(world, *caster, u, v, i, 1);
              const double w = defined(f, x + 0.5 - (u + place(sample.place.x))) *
                               defined(f, y + 0.5 - (v + place(sample.place.y)));
              sum += sample.emission * w;
              whole += w;
            }
        const auto pixel = static_cast<size_t>(y * s.film.width + x);
        for (const auto& [name, c] : {std::pair("R", 0), std::pair("G", 1), std::pair("B", 2)}) {
          const auto value = static_cast<double>(image.find(name)->pixels[pixel]);
          REQUIRE(std::fabs(value - sum[c] / whole) < 2e-3);
        }
      }
  }
}

TEST_CASE("filtered: the same bytes with any threads, tiles, batches and orders; near reference") {
  Scene s = lamps(kMitchell);
  add_quad(s, add_diffuse(s, Rgb(0.7)), Vec3(-3, -1, 0), Vec3(0, 0, 6), Vec3(6, 0, 0));
  const FrameRequest request = film_request(4);
  const auto image_of = [&](const std::vector<std::string>& set) {
    FrameRequest r = request;
    r.set = set;
    return frame_image(s, r);
  };
  const Image one = image_of({});
  const auto same = [&](const Image& other) {
    for (size_t c = 0; c < one.channels.size(); ++c)
      if (one.channels[c].pixels != other.channels[c].pixels) return false;
    return true;
  };
  {
    const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
    CHECK(same(image_of({})));
  }
  CHECK(same(image_of({"frame.batch_tiles=1", "frame.tile=4"})));
  CHECK(same(image_of({"frame.batch_tiles=3", "frame.tile=3", "frame.order=pixel"})));
  CHECK_FALSE(same(frame_image(lamps(kCatmullRom), request)));
  const Image exact = frame_image(s, request, Arithmetic::kReference);
  CHECK(channel_mean(one, "G") == Approx(channel_mean(exact, "G")).epsilon(0.01));
  // Layers add up.
  for (size_t i = 0; i < one.find("G")->pixels.size(); ++i) {
    double sum = 0;
    for (const char* layer : {"direct.G", "caustic.G", "indirect.G", "emission.G"})
      sum += static_cast<double>(one.find(layer)->pixels[i]);
    REQUIRE(sum == Approx(static_cast<double>(one.find("G")->pixels[i])).margin(1e-6));
  }
}

TEST_CASE("even light stays even under every filter, to the film's edges") {
  for (const Filter& f : kFilters) {
    Scene s;
    add_sphere(s, add_diffuse(s, Rgb(0)), Vec3(0), 2, true).radiance = Rgb(0.25, 0.5, 1);
    set_camera(s, Vec3(0), Vec3(0, 0, 1), Vec3(0, 1, 0), 60, 9, 7);
    s.film.filter = f;
    for (const Image& image : {frame_image(s, film_request(16)), path_image(s, 16, 1)})
      for (const float p : image.find("G")->pixels)
        REQUIRE(static_cast<double>(p) == Approx(0.5).epsilon(1e-6));
  }
}

TEST_CASE("a lamp's edge: the filter's step response, with its overshoot") {
  // Lit left of a column's middle; the columns' means over the rows.
  for (const Filter& f : kFilters) {
    INFO(static_cast<int>(f.kind) << " of radius " << f.radius);
    Scene s;
    const int black = add_diffuse(s, Rgb(0));
    const int width = 17, height = 33;
    // Along x the film spans 2 tan(30) at distance 1; +x is left. The edge is at 8.5 pixels.
    add_quad(s, black, Vec3(0, -2, 1), Vec3(0, 4, 0), Vec3(2, 0, 0)).radiance = Rgb(1);
    set_camera(s, Vec3(0), Vec3(0, 0, 1), Vec3(0, 1, 0), 60, width, height);
    s.film.filter = f;
    const Image image = path_image(s, 128, 3);
    double lowest = 1;
    for (int x = 5; x < 12; ++x) {
      double lit = 0, whole = 0;
      constexpr int kSteps = 4000;
      for (int i = 0; i < kSteps; ++i) {
        const double at = -f.radius + (i + 0.5) * 2 * f.radius / kSteps;
        whole += defined(f, at);
        if (x + 0.5 + at < 8.5) lit += defined(f, at);
      }
      double mean = 0;
      for (int y = 8; y < height - 8; ++y)
        mean += static_cast<double>(image.find("G")->pixels[static_cast<size_t>(y * width + x)]);
      mean /= height - 16;
      lowest = std::min(lowest, mean);
      CHECK(mean == Approx(lit / whole).margin(0.016));
    }
    if (f.kind == FilterKind::kMitchell || f.kind == FilterKind::kLanczos) CHECK(lowest < -0.01);
  }
}

TEST_CASE("a window shows its part of the film, also resized") {
  Scene s = lamps(Filter());
  s.camera.offset_x = 0.125;
  const Lens whole(s);
  s.film.whole_width = s.film.width;
  s.film.whole_height = s.film.height;
  s.film.left = 4;
  s.film.top = 2;
  s.film.width = 6;
  s.film.height = 5;
  const Lens window(s);
  s.film.resize(12, 10);
  const Lens resized(s);
  for (const auto& [x, y] : {std::pair(0.25, 0.5), std::pair(5.75, 4.5), std::pair(3.0, 1.0)}) {
    const Ray ray = whole.through(x + 4, y + 2).ray;
    CHECK(window.through(x, y).ray.direction == ray.direction);
    CHECK(glm::length(resized.through(2 * x, 2 * y).ray.direction - ray.direction) < 1e-15);
    Seen seen;
    REQUIRE(window.project(ray.origin + ray.direction * 3.0, Vec2(0), seen));
    CHECK(seen.x == Approx(x).margin(1e-12));
    CHECK(seen.y == Approx(y).margin(1e-12));
  }
  Seen seen;
  const Ray outside = whole.through(3.5, 4).ray;
  CHECK_FALSE(window.project(outside.origin + outside.direction, Vec2(0), seen));
  // A pixel shows what stood to its right by the offset.
  Scene plain = lamps(Filter());
  CHECK(glm::length(Lens(plain).through(2 + 0.125 * 13, 3).ray.direction -
                    whole.through(2, 3).ray.direction) < 1e-15);
}
