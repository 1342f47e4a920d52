// SPDX-License-Identifier: Apache-2.0
#include "golden/scene/spectrum.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "golden/numeric/elementary.hpp"
#include "golden/numeric/output_file.hpp"
#include "golden/numeric/text.hpp"
#include "golden/scene/scene.hpp"

namespace photonloom {
namespace {

constexpr size_t kMostPoints = 1 << 16;
constexpr double kLargest = 1e30;

double to_the(double x) { return exp2_exact(x * 1.4426950408889634); }  // e^x; log2(e)

double gauss(double nm, double centre, double below, double above) {
  const double t = (nm - centre) * (nm < centre ? below : above);
  return to_the(-0.5 * t * t);
}

Vec3 observer(double nm) {
  return {0.362 * gauss(nm, 442.0, 0.0624, 0.0374) + 1.056 * gauss(nm, 599.8, 0.0264, 0.0323) -
              0.065 * gauss(nm, 501.1, 0.0490, 0.0382),
          0.821 * gauss(nm, 568.8, 0.0213, 0.0247) + 0.286 * gauss(nm, 530.9, 0.0613, 0.0322),
          1.217 * gauss(nm, 437.0, 0.0845, 0.0278) + 0.681 * gauss(nm, 459.0, 0.0385, 0.0725)};
}

template <class F>
Rgb color_of(F&& spectrum) {
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

void add_point(Spectrum& s, std::string_view wavelength, std::string_view value,
               const std::string& place) {
  const auto nm = parse_double(wavelength), v = parse_double(value);
  if (!nm || !v || !std::isfinite(*nm) || !std::isfinite(*v))
    throw SceneError(
        fmt::format("{}: '{}' and '{}' are no wavelength and value, expected two "
                    "finite numbers",
                    place, wavelength.substr(0, 40), value.substr(0, 40)));
  if (!(*v >= 0 && *v <= kLargest))
    throw SceneError(
        fmt::format("{}: the value at {} nm is {}, expected 0 to {:g}", place, *nm, *v, kLargest));
  if (!(*nm > (s.nm.empty() ? 0 : s.nm.back())))
    throw SceneError(fmt::format("{}: {} nm does not lie above {} nm, expected growing wavelengths",
                                 place, *nm, s.nm.empty() ? 0 : s.nm.back()));
  if (s.nm.size() >= kMostPoints)
    throw SceneError(fmt::format("{}: more than {} wavelengths", place, kMostPoints));
  s.nm.push_back(*nm);
  s.value.push_back(*v);
}

}  // namespace

double Spectrum::at(double wavelength) const {
  if (nm.empty() || wavelength < nm.front() || wavelength > nm.back()) return 0;
  const auto above = std::upper_bound(nm.begin(), nm.end(), wavelength);
  if (above == nm.end()) return value.back();
  const auto i = static_cast<size_t>(above - nm.begin());
  const double part = (wavelength - nm[i - 1]) / (nm[i] - nm[i - 1]);
  return value[i - 1] + (value[i] - value[i - 1]) * part;
}

Rgb spectrum_color(const Spectrum& spectrum, SpectrumOf of) {
  Rgb color = color_of([&](double nm) { return spectrum.at(nm); });
  if (of == SpectrumOf::kSurface) {
    color /= color_of([](double) { return 1.0; });
    color = glm::min(color, Rgb(*std::max_element(spectrum.value.begin(), spectrum.value.end())));
  }
  return glm::max(color, Rgb(0));
}

Spectrum parse_spectrum(std::string_view text, const std::string& place) {
  Spectrum s;
  for (const std::string_view word : split(text, ", \t\r\n")) {
    const size_t colon = word.find(':');
    if (colon == std::string_view::npos)
      throw SceneError(fmt::format("{}: '{}' is no point of a spectrum, expected nm:value", place,
                                   word.substr(0, 40)));
    add_point(s, word.substr(0, colon), word.substr(colon + 1), place);
  }
  if (s.nm.empty()) throw SceneError(fmt::format("{}: the spectrum has no points", place));
  return s;
}

Spectrum read_spd(const std::string& path) {
  const std::string bytes = read_file(path);
  Spectrum s;
  const std::string_view text(bytes);
  size_t number = 0;
  for (size_t at = 0; at < text.size();) {
    ++number;
    const size_t end = std::min(text.find('\n', at), text.size());
    std::string_view line = text.substr(at, end - at);
    at = end + 1;
    line = line.substr(0, line.find('#'));
    const auto words = split(line, " \t\r,");
    if (words.empty()) continue;
    const std::string place = fmt::format("{}:{}", path, number);
    if (words.size() != 2)
      throw SceneError(fmt::format("{}: the line has {} words, expected wavelength and value",
                                   place, words.size()));
    add_point(s, words[0], words[1], place);
  }
  if (s.nm.empty()) throw SceneError(fmt::format("{}: the spectrum has no points", path));
  return s;
}

double blackbody_radiance(double kelvin, double nm) {
  // The SI's exact constants.
  constexpr double kPlanck = 6.62607015e-34, kLight = 299792458, kBoltzmann = 1.380649e-23;
  const double m = nm * 1e-9, m5 = m * m * m * m * m;
  const double x = kPlanck * kLight / (m * kBoltzmann * kelvin);
  if (x > 700) return 0;
  return 2e-9 * kPlanck * kLight * kLight / (m5 * (to_the(x) - 1));
}

Rgb blackbody_color(double kelvin, double scale) {
  const Rgb color = color_of([&](double nm) { return blackbody_radiance(kelvin, nm) * scale; });
  return glm::max(color, Rgb(0));
}

}  // namespace photonloom
