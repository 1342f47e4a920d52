// SPDX-License-Identifier: Apache-2.0
// The colors in scenes/cornell.xml follow from the measured spectra of the Cornell box.
//
// Spectra: Cornell University Program of Computer Graphics, "Cornell Box Data" (reflectances at 400
// to 700 nm in steps of 4 nm, emission at 400, 500, 600, 700 nm), linear between samples, zero
// outside. Observer: the analytic fit of Wyman, Sloan and Shirley, "Simple Analytic Approximations
// to the CIE XYZ Color Matching Functions", JCGT 2(2), 2013. To linear Rec.709 (D65). Emission is
// the color itself; reflectances are divided, channel by channel, by the color of a spectrum that
// is 1 everywhere, so that a grey surface has three equal numbers.
#include <cmath>
#include <cstdlib>
#include <functional>

#include "golden/scene/scene.hpp"
#include "tests/catch.hpp"

using namespace photonloom;

namespace {

constexpr double kWhite[76] = {
    0.343, 0.445, 0.551, 0.624, 0.665, 0.687, 0.708, 0.723, 0.715, 0.71,  0.745, 0.758, 0.739,
    0.767, 0.777, 0.765, 0.751, 0.745, 0.748, 0.729, 0.745, 0.757, 0.753, 0.75,  0.746, 0.747,
    0.735, 0.732, 0.739, 0.734, 0.725, 0.721, 0.733, 0.725, 0.732, 0.743, 0.744, 0.748, 0.728,
    0.716, 0.733, 0.726, 0.713, 0.74,  0.754, 0.764, 0.752, 0.736, 0.734, 0.741, 0.74,  0.732,
    0.745, 0.755, 0.751, 0.744, 0.731, 0.733, 0.744, 0.731, 0.712, 0.708, 0.729, 0.73,  0.727,
    0.707, 0.703, 0.729, 0.75,  0.76,  0.751, 0.739, 0.724, 0.73,  0.74,  0.737};
constexpr double kRed[76] = {
    0.04,  0.046, 0.048, 0.053, 0.049, 0.05,  0.053, 0.055, 0.057, 0.056, 0.059, 0.057, 0.061,
    0.061, 0.06,  0.062, 0.062, 0.062, 0.061, 0.062, 0.06,  0.059, 0.057, 0.058, 0.058, 0.058,
    0.056, 0.055, 0.056, 0.059, 0.057, 0.055, 0.059, 0.059, 0.058, 0.059, 0.061, 0.061, 0.063,
    0.063, 0.067, 0.068, 0.072, 0.08,  0.09,  0.099, 0.124, 0.154, 0.192, 0.255, 0.287, 0.349,
    0.402, 0.443, 0.487, 0.513, 0.558, 0.584, 0.62,  0.606, 0.609, 0.651, 0.612, 0.61,  0.65,
    0.638, 0.627, 0.62,  0.63,  0.628, 0.642, 0.639, 0.657, 0.639, 0.635, 0.642};
constexpr double kGreen[76] = {
    0.092, 0.096, 0.098, 0.097, 0.098, 0.095, 0.095, 0.097, 0.095, 0.094, 0.097, 0.098, 0.096,
    0.101, 0.103, 0.104, 0.107, 0.109, 0.112, 0.115, 0.125, 0.14,  0.16,  0.187, 0.229, 0.285,
    0.343, 0.39,  0.435, 0.464, 0.472, 0.476, 0.481, 0.462, 0.447, 0.441, 0.426, 0.406, 0.373,
    0.347, 0.337, 0.314, 0.285, 0.277, 0.266, 0.25,  0.23,  0.207, 0.186, 0.171, 0.16,  0.148,
    0.141, 0.136, 0.13,  0.126, 0.123, 0.121, 0.122, 0.119, 0.114, 0.115, 0.117, 0.117, 0.118,
    0.12,  0.122, 0.128, 0.132, 0.139, 0.144, 0.146, 0.15,  0.152, 0.157, 0.159};

double lobe(double x, double center, double below, double above) {
  const double t = (x - center) * (x < center ? below : above);
  return std::exp(-0.5 * t * t);
}

Vec3 observer(double nm) {
  return {0.362 * lobe(nm, 442.0, 0.0624, 0.0374) + 1.056 * lobe(nm, 599.8, 0.0264, 0.0323) -
              0.065 * lobe(nm, 501.1, 0.0490, 0.0382),
          0.821 * lobe(nm, 568.8, 0.0213, 0.0247) + 0.286 * lobe(nm, 530.9, 0.0613, 0.0322),
          1.217 * lobe(nm, 437.0, 0.0845, 0.0278) + 0.681 * lobe(nm, 459.0, 0.0385, 0.0725)};
}

// XYZ with Y = 1 for a spectrum that is 1 everywhere, to linear Rec.709.
Rgb color(const std::function<double(double)>& spectrum) {
  Vec3 xyz(0);
  double norm = 0;
  for (int nm = 360; nm <= 830; ++nm) {
    const Vec3 c = observer(nm);
    xyz += c * spectrum(nm);
    norm += c.y;
  }
  xyz /= norm;
  return {3.240479 * xyz.x - 1.537150 * xyz.y - 0.498535 * xyz.z,
          -0.969256 * xyz.x + 1.875991 * xyz.y + 0.041556 * xyz.z,
          0.055648 * xyz.x - 0.204043 * xyz.y + 1.057311 * xyz.z};
}

double between(const double* samples, int count, double step, double nm) {
  const double at = (nm - 400) / step;
  if (at < 0 || at > count - 1) return 0;
  const int i = std::min(static_cast<int>(at), count - 2);
  return samples[i] + (samples[i + 1] - samples[i]) * (at - i);
}

void check(const Rgb& in_file, const Rgb& derived, double unit) {
  for (int i = 0; i < 3; ++i) CHECK(std::fabs(in_file[i] - derived[i]) <= unit * 0.51);
}

}  // namespace

TEST_CASE("cornell's colors are those of the measured spectra") {
  const Scene scene =
      load_scene(std::string(std::getenv("PHOTONLOOM_SOURCE")) + "/scenes/cornell.xml");
  const Rgb flat = color([](double) { return 1.0; });
  const auto reflectance = [&](const double* samples) {
    return color([&](double nm) { return between(samples, 76, 4, nm); }) / flat;
  };
  const auto bsdf = [&](const std::string& id) {
    for (const Bsdf& b : scene.bsdfs)
      if (b.id == id) return b.diffuse;
    FAIL("no BSDF " << id);
    return Rgb(0);
  };
  check(bsdf("white"), reflectance(kWhite), 1e-4);
  check(bsdf("red"), reflectance(kRed), 1e-4);
  check(bsdf("green"), reflectance(kGreen), 1e-4);
  constexpr double kLight[] = {0, 8, 15.6, 18.4};
  for (const Shape& s : scene.shapes)
    if (s.radiance)
      check(*s.radiance, color([&](double nm) { return between(kLight, 4, 100, nm); }), 1e-3);
}
