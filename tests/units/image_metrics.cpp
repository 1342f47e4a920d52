// SPDX-License-Identifier: Apache-2.0
// Each metric against numbers worked out by hand in the comment above them.
#include <cmath>
#include <limits>

#include "golden/image/metrics.hpp"
#include "tests/catch.hpp"

using namespace photonloom;

namespace {

Planes constant(double r, double g, double b, int width = 24, int height = 20) {
  Planes p;
  p.width = width;
  p.height = height;
  const double v[3] = {r, g, b};
  for (size_t c = 0; c < 3; ++c) p.c[c].assign(static_cast<size_t>(width * height), v[c]);
  return p;
}

// Two pixels; a = (1, 2, 3), (0.5, 0, 4); b = (1, 1, 2), (0, 0, 8).
Planes two(std::array<double, 3> left, std::array<double, 3> right) {
  Planes p;
  p.width = 2;
  p.height = 1;
  for (size_t c = 0; c < 3; ++c) p.c[c] = {left[c], right[c]};
  return p;
}

}  // namespace

TEST_CASE("metrics of two pixels, by hand") {
  const Metrics m = compare_planes(two({1, 2, 3}, {0.5, 0, 4}), two({1, 1, 2}, {0, 0, 8}));
  // Differences 0, 1, 1, 0.5, 0, -4; squares 0, 1, 1, 0.25, 0, 16: sum 18.25.
  REQUIRE(m.rmse == Approx(std::sqrt(18.25 / 6)).epsilon(1e-14));
  // 1/1.01 + 1/4.01 + 0.25/0.01 + 16/64.01
  REQUIRE(m.relmse == Approx((1 / 1.01 + 1 / 4.01 + 25 + 16 / 64.01) / 6).epsilon(1e-14));
  // 1/1.01 + 1/2.01 + 0.5/0.01 + 4/8.01
  REQUIRE(m.mape == Approx((1 / 1.01 + 1 / 2.01 + 50 + 4 / 8.01) / 6).epsilon(1e-14));
  REQUIRE(m.mean_ratio == Approx(10.5 / 12).epsilon(1e-14));
  REQUIRE(m.mean_ratio_rgb[0] == Approx(1.5).epsilon(1e-14));
  REQUIRE(m.mean_ratio_rgb[1] == Approx(2).epsilon(1e-14));
  REQUIRE(m.mean_ratio_rgb[2] == Approx(0.7).epsilon(1e-14));
  REQUIRE(m.psnr == Approx(20 * std::log10(8 / std::sqrt(18.25 / 6))).epsilon(1e-14));
  REQUIRE_FALSE(m.identical);
}

TEST_CASE("an image against itself") {
  const Planes a = two({1, 2, 3}, {0.5, 0, 4});
  const Metrics m = compare_planes(a, a);
  REQUIRE(m.rmse == 0);
  REQUIRE(m.relmse == 0);
  REQUIRE(m.mape == 0);
  REQUIRE(m.mean_ratio == 1);
  REQUIRE(m.flip == 0);
  REQUIRE(m.psnr == std::numeric_limits<double>::infinity());
  REQUIRE(m.identical);
  const Planes black = constant(0, 0, 0);
  REQUIRE(compare_planes(black, black).mean_ratio == 1);
  REQUIRE(std::isinf(compare_planes(a, two({0, 0, 0}, {0, 0, 0})).mean_ratio));
}

TEST_CASE("LDR-FLIP of constant images") {
  // No edges or points in a constant image, so FLIP is the redistributed colour difference. Black
  // and white: Hunt-adjusted L*a*b* (0,0,0) and (100,0,0), so HyAB is 100.
  // Largest difference: green and blue. For sRGB primaries under D65 in CIE L*a*b*: green
  // (87.7347, -86.1827, 83.1793), blue (32.2970, 79.1875, -107.8602); Hunt: a, b times L/100:
  // (87.7347, -75.612, 72.977), (32.297, 25.575, -34.836): 55.438 + |(101.187, 107.813)| = 203.30.
  // c_max = 203.30^0.7 = 41.28, knee 0.4 c_max = 16.51; 100^0.7 = 25.12 is above it:
  // 0.95 + 0.05 (25.12 - 16.51) / (41.28 - 16.51) = 0.9674.
  for (const double f : ldr_flip(constant(0, 0, 0), constant(1, 1, 1)))
    REQUIRE(f == Approx(0.9674).margin(5e-4));
  // Greys Y = 0.2 and 0.22: L* = 116 Y^(1/3) - 16 differs by 116 (0.603681 - 0.584804) = 2.1898;
  // 2.1898^0.7 = 1.7310, times 0.95 / 16.51: 0.0996.
  for (const double f : ldr_flip(constant(0.2, 0.2, 0.2), constant(0.22, 0.22, 0.22)))
    REQUIRE(f == Approx(0.0996).margin(5e-4));
  // The farthest pair is at the end of the scale.
  for (const double f : ldr_flip(constant(0, 1, 0), constant(0, 0, 1)))
    REQUIRE(f == Approx(1).margin(1e-9));
}

TEST_CASE("HDR-FLIP takes the exposure at which the reference reaches 0.85") {
  // The curve at its target: 0.9036 x^2 + 0.018 x = 0.85 (0.8748 x^2 + 0.354 x + 0.14).
  const double c = 0.9036 - 0.85 * 0.8748, b = 0.018 - 0.85 * 0.354, a = -0.85 * 0.14;
  const double x = (-b + std::sqrt(b * b - 4 * c * a)) / (2 * c);
  REQUIRE(aces_curve(x) == Approx(0.85).epsilon(1e-12));
  REQUIRE(aces_curve(0) == 0);
  REQUIRE(aces_curve(-1) == 0);
  REQUIRE(aces_curve(1e300) == 1);
  // A constant reference has one exposure, whatever its brightness: FLIP does not depend on scale.
  const double expected =
      ldr_flip(constant(aces_curve(1.1 * x), aces_curve(1.1 * x), aces_curve(1.1 * x)),
               constant(0.85, 0.85, 0.85))[0];
  for (const double scale : {1e-3, 1.0, 1e5}) {
    const double v = 1.1 * scale;
    const std::vector<double> flip = hdr_flip(constant(v, v, v), constant(scale, scale, scale));
    for (const double f : flip) REQUIRE(f == Approx(expected).epsilon(1e-9));
  }
  REQUIRE(expected > 0.01);
  REQUIRE(hdr_flip(constant(0, 0, 0), constant(0, 0, 0))[0] == 0);
}

TEST_CASE("images of different sizes are not compared") {
  const Planes small = constant(1, 1, 1, 8, 8), wide = constant(1, 1, 1, 16, 8);
  for (const auto& [a, b] : {std::pair(&small, &wide), std::pair(&wide, &small)}) {
    REQUIRE_THROWS_WITH(hdr_flip(*a, *b), Catch::Matchers::StartsWith("the images differ in size"));
    REQUIRE_THROWS_WITH(compare_planes(*a, *b),
                        Catch::Matchers::StartsWith("the images differ in size"));
  }
}

TEST_CASE("HDR-FLIP of two flat fields, 16 to 1, is the largest over four exposures") {
  // b is 1 on the left three quarters and 16 on the right, a 1.25 times as much: the exposures run
  // from the one at which 16 is mapped to 0.85 to the one at which 1 is, 4 stops and so 4
  // exposures, 4/3 stops apart. The curve takes x to 0.85 at 0.16002 x^2 - 0.2829 x - 0.119 = 0,
  // which has the root (0.2829 + sqrt(0.08003 + 0.07617)) / 0.32004 = 2.1189.
  constexpr double kTarget = 2.1189;
  // Greys: L* = 116 Y^(1/3) - 16, and 41.28, 16.51 as above.
  const auto flip_of_greys = [](double a, double b) {
    const double e = std::pow(116 * std::fabs(std::cbrt(a) - std::cbrt(b)), 0.7);
    return e < 16.51 ? 0.95 / 16.51 * e : 0.95 + 0.05 * (e - 16.51) / (41.28 - 16.51);
  };
  const int width = 96, height = 24;
  Planes a = constant(1.25, 1.25, 1.25, width, height), b = constant(1, 1, 1, width, height);
  for (size_t c = 0; c < 3; ++c)
    for (size_t p = 0; p < a.c[c].size(); ++p)
      if (p % 96 >= 72) a.c[c][p] = 20, b.c[c][p] = 16;
  double left = 0, right = 0;
  for (int i = 0; i < 4; ++i) {
    const double scale = kTarget * std::exp2(4.0 * i / 3 - 4);
    left = std::max(left, flip_of_greys(aces_curve(1.25 * scale), aces_curve(scale)));
    right = std::max(right, flip_of_greys(aces_curve(20 * scale), aces_curve(16 * scale)));
  }
  // Farther from the border than the filters reach.
  const std::vector<double> flip = hdr_flip(a, b);
  REQUIRE(flip[12 * width + 30] == Approx(left).margin(5e-4));
  REQUIRE(flip[12 * width + 90] == Approx(right).margin(5e-4));
  // The largest on the left is neither at the first nor at the last exposure, but between.
  REQUIRE(left > flip_of_greys(aces_curve(1.25 * kTarget / 16), aces_curve(kTarget / 16)) + 5e-4);
}

TEST_CASE("FLIP sees an edge that a constant shift of the same size does not have") {
  Planes step = constant(0.5, 0.5, 0.5, 40, 40), shifted = constant(0.5, 0.5, 0.5, 40, 40);
  const Planes flat = constant(0.5, 0.5, 0.5, 40, 40);
  for (size_t c = 0; c < 3; ++c)
    for (size_t p = 0; p < 1600; ++p) {
      if (p % 40 >= 20) step.c[c][p] = 0.4;
      shifted.c[c][p] = 0.4;
    }
  // On the dark side near the edge the colour differs less, but the edge adds to it.
  const double at_edge = ldr_flip(step, flat)[20 * 40 + 21];
  const double plain = ldr_flip(shifted, flat)[20 * 40 + 21];
  REQUIRE(at_edge > plain);
  // Far from the edge on the unchanged side nothing is seen: the filters end within 10 pixels.
  REQUIRE(ldr_flip(step, flat)[20 * 40 + 5] < 1e-6);
}

TEST_CASE("layers, sizes and pixels that are not finite") {
  Image image;
  image.width = 3;
  image.height = 2;
  for (const char* name : {"R", "G", "B", "direct.R", "direct.G", "direct.B", "N.X", "N.Y", "N.Z",
                           "Z", "photonDensity.Y"})
    image.add(name);
  for (size_t i = 0; i < image.channels.size(); ++i)
    image.channels[i].pixels.assign(6, static_cast<float>(i));
  REQUIRE(planes_of(image, "", "a.exr").c[1][0] == 1);
  REQUIRE(planes_of(image, "direct", "a.exr").c[2][5] == 5);
  REQUIRE(planes_of(image, "N", "a.exr").c[0][5] == 6);
  REQUIRE(planes_of(image, "Z", "a.exr").c[0][5] == 9);
  REQUIRE(planes_of(image, "photonDensity", "a.exr").c[2][0] == 10);
  REQUIRE_THROWS_WITH(planes_of(image, "caustic", "a.exr"),
                      "a.exr: has no layer caustic; its layers are: N, Z, direct, photonDensity");
  image.channels[1].pixels[4] = std::numeric_limits<float>::quiet_NaN();
  REQUIRE_THROWS_WITH(planes_of(image, "", "a.exr"),
                      "a.exr: channel G is not a number at pixel (1, 1), expected a finite number");
  image.channels[1].pixels[4] = std::numeric_limits<float>::infinity();
  REQUIRE_THROWS_WITH(planes_of(image, "", "a.exr"),
                      "a.exr: channel G is infinite at pixel (1, 1), expected a finite number");
  REQUIRE_THROWS_WITH(compare_planes(constant(1, 1, 1, 3, 4), constant(1, 1, 1, 4, 3)),
                      "the images differ in size: 3x4 and 4x3");
}
