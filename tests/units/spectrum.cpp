// SPDX-License-Identifier: Apache-2.0
// Spectra: interpolation, colors with known answers, black bodies, files.
#include "golden/scene/spectrum.hpp"

#include <cmath>

#include "tests/catch.hpp"
#include "tests/scene_files.hpp"

using namespace photonloom;

namespace {

// Linear Rec.709 (ITU-R BT.709-6 with D65) to XYZ.
Vec3 xyz(const Rgb& c) {
  return {0.4123908 * c.x + 0.3575843 * c.y + 0.1804808 * c.z,
          0.2126390 * c.x + 0.7151687 * c.y + 0.0721923 * c.z,
          0.0193308 * c.x + 0.1191948 * c.y + 0.9505322 * c.z};
}

std::string spd_error(const std::string& text) {
  const TestFolder folder;
  try {
    read_spd(folder.write("a.spd", text));
  } catch (const SceneError& e) {
    return std::string(e.what()).substr(std::string(folder / "").size());
  }
  return "";
}

}  // namespace

TEST_CASE("a spectrum is linear between its points and nothing outside") {
  const Spectrum s = parse_spectrum("400:0.2, 500:1 600:0.5", "here");
  CHECK(s.at(399.9) == 0);
  CHECK(s.at(400) == 0.2);
  CHECK(s.at(450) == Approx(0.6));
  CHECK(s.at(500) == 1);
  CHECK(s.at(600) == 0.5);
  CHECK(s.at(600.1) == 0);
}

TEST_CASE("a flat spectrum: a grey surface, light of its luminance and the observer's white E") {
  const Spectrum flat = parse_spectrum("100:0.25, 1000:0.25", "here");
  const Rgb surface = spectrum_color(flat, SpectrumOf::kSurface);
  for (int i = 0; i < 3; ++i) CHECK(surface[i] == Approx(0.25).epsilon(1e-12));
  // E has x = y = 1/3.
  const Vec3 light = xyz(spectrum_color(flat, SpectrumOf::kLight));
  CHECK(light.y == Approx(0.25).epsilon(1e-3));
  CHECK(light.x / (light.x + light.y + light.z) == Approx(1.0 / 3).epsilon(0.01));
  CHECK(light.y / (light.x + light.y + light.z) == Approx(1.0 / 3).epsilon(0.01));
  // One color of the rainbow lies outside the gamut; no part of a surface exceeds its spectrum.
  const Rgb red = spectrum_color(parse_spectrum("580:0.8, 800:0.8", "here"), SpectrumOf::kSurface);
  CHECK(red.x == 0.8);
  CHECK(red.z == 0);
}

TEST_CASE("black bodies: Planck's integral is that of Stefan and Boltzmann, 2856 K is white A") {
  constexpr double kPlanck = 6.62607015e-34, kLight = 299792458, kBoltzmann = 1.380649e-23;
  const double pi = std::acos(-1.0);
  const double sigma =
      2 * std::pow(pi, 5) * std::pow(kBoltzmann, 4) / (15 * std::pow(kPlanck, 3) * kLight * kLight);
  for (const double kelvin : {2856.0, 6504.0}) {
    double sum = 0;  // by steps of a thousandth of the wavelength
    for (double nm = 20; nm < 1e7; nm *= 1.001) sum += blackbody_radiance(kelvin, nm) * nm * 0.001;
    CHECK(sum == Approx(sigma * std::pow(kelvin, 4) / pi).epsilon(2e-3));
  }
  // CIE standard illuminant A: x = 0.44757, y = 0.40745. The observer is a fit.
  const Vec3 a = xyz(blackbody_color(2856, 1));
  CHECK(a.x / (a.x + a.y + a.z) == Approx(0.44757).margin(0.004));
  CHECK(a.y / (a.x + a.y + a.z) == Approx(0.40745).margin(0.004));
  CHECK(blackbody_color(2856, 2).y == Approx(2 * blackbody_color(2856, 1).y));
  CHECK(blackbody_color(1, 1) == Rgb(0));
}

TEST_CASE("spectra in scenes: lists, files and black bodies, on surfaces and lamps") {
  const TestFolder folder;
  folder.write("a.spd", "# nm value\n400 0.5\n\n800 0.5 # the end\n");
  const Scene s = load_scene(folder.write(
      "scene.xml",
      scene_text(std::string("<shape type=\"cube\"><bsdf type=\"diffuse\"><spectrum "
                             "name=\"reflectance\" filename=\"a.spd\"/></bsdf></shape><shape "
                             "type=\"sphere\"><emitter type=\"area\"><blackbody name=\"radiance\" "
                             "temperature=\"5000K\" scale=\"0.001\"/></emitter></shape><emitter "
                             "type=\"point\"><spectrum name=\"intensity\" value=\"300:2, "
                             "900:2\"/></emitter>") +
                 kSensor)));
  for (int i = 0; i < 3; ++i) CHECK(s.bsdfs[0].diffuse[i] == Approx(0.5).epsilon(0.01));
  CHECK(*s.shapes[1].radiance == blackbody_color(5000, 0.001));
  CHECK(s.lights[0].intensity ==
        spectrum_color(parse_spectrum("300:2 900:2", "here"), SpectrumOf::kLight));
  CHECK_THAT(body_error("<emitter type=\"point\"><blackbody name=\"intensity\" "
                        "temperature=\"hot\"/></emitter>"),
             ContainsSubstring("scene.xml:2") && ContainsSubstring("expected kelvins like 5000K"));
  CHECK_THAT(body_error("<bsdf type=\"diffuse\"><spectrum name=\"reflectance\" "
                        "filename=\"none.spd\"/></bsdf>"),
             ContainsSubstring("none.spd"));
}

TEST_CASE("the spectrum plugins of 3.x") {
  const auto intensity = [](const std::string& type, const std::string& inside) {
    return load_body("<emitter type=\"point\"><spectrum name=\"intensity\" type=\"" + type + "\">" +
                         inside + "</spectrum></emitter>",
                     "3.0.0")
        .lights[0]
        .intensity;
  };
  CHECK(intensity("blackbody", "<float name=\"temperature\" value=\"3000\"/>") ==
        blackbody_color(3000, 1));
  CHECK(intensity("uniform", "<float name=\"value\" value=\"0.5\"/>") == Rgb(0.5));
  CHECK(intensity("d65", "<float name=\"scale\" value=\"2\"/>") == Rgb(2));
  CHECK(intensity("rgb", "<rgb name=\"color\" value=\"1 2 3\"/>") == Rgb(1, 2, 3));
  const Rgb expected =
      spectrum_color(parse_spectrum("400:1 500:3 600:2", "here"), SpectrumOf::kLight);
  CHECK(intensity("irregular",
                  "<string name=\"wavelengths\" value=\"400, 500, 600\"/><string name=\"values\" "
                  "value=\"1 3 2\"/>") == expected);
  CHECK(intensity("regular",
                  "<float name=\"wavelength_min\" value=\"400\"/><float name=\"wavelength_max\" "
                  "value=\"600\"/><string name=\"values\" value=\"1 3 2\"/>") == expected);
  const auto error = [](const std::string& type, const std::string& inside) {
    return body_error("<emitter type=\"point\"><spectrum name=\"intensity\" type=\"" + type +
                          "\">" + inside + "</spectrum></emitter>",
                      "3.0.0");
  };
  CHECK_THAT(error("irregular", "<string name=\"values\" value=\"1 3 2\"/>"),
             ContainsSubstring("has 0 wavelengths and 3 values"));
  CHECK_THAT(error("laser", ""),
             ContainsSubstring("scene.xml:2") && ContainsSubstring("blackbody"));
  CHECK_THAT(error("uniform", "<float name=\"glow\" value=\"1\"/>"), ContainsSubstring("glow"));
  CHECK_THAT(error("uniform", "<float name=\"value\" value=\"-1\"/>"),
             ContainsSubstring("negative"));
}

TEST_CASE(".spd files that are none") {
  CHECK(spd_error("400 1\n500 2") == "");
  CHECK_THAT(spd_error("# nothing\n"), ContainsSubstring("a.spd: the spectrum has no points"));
  CHECK_THAT(spd_error("400 1\n500\n"),
             ContainsSubstring("a.spd:2: the line has 1 words, expected wavelength and value"));
  CHECK_THAT(spd_error("400 1\n500 nan\n"), ContainsSubstring("a.spd:2: '500' and 'nan'"));
  CHECK_THAT(spd_error("400 1\n300 1\n"),
             ContainsSubstring("a.spd:2: 300 nm does not lie above 400"));
  CHECK_THAT(spd_error("400 -1\n"), ContainsSubstring("is -1, expected 0 to"));
  CHECK_THAT(spd_error("0 1\n"), ContainsSubstring("expected growing wavelengths"));
}
