// SPDX-License-Identifier: Apache-2.0
#include "golden/image/metrics.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

namespace photonloom {
namespace {

constexpr double kStabiliser = 0.01;  // of relmse and mape, in the image's own units

std::string layers_of(const Image& image) {
  std::set<std::string> names;
  for (const Channel& c : image.channels) {
    const size_t dot = c.name.rfind('.');
    if (dot != std::string::npos)
      names.insert(c.name.substr(0, dot));
    else if (c.name != "R" && c.name != "G" && c.name != "B")
      names.insert(c.name);
  }
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list.empty() ? "none" : list;
}

}  // namespace

Planes planes_of(const Image& image, const std::string& layer, const std::string& path) {
  const std::string prefix = layer.empty() ? "" : layer + ".";
  std::array<const Channel*, 3> found{};
  for (const char* letters : {"RGB", "XYZ"}) {
    for (size_t i = 0; i < 3; ++i) found[i] = image.find(prefix + letters[i]);
    if ((found[0] && found[1] && found[2]) || layer.empty()) break;
  }
  if (!layer.empty() && !(found[0] && found[1] && found[2])) {
    const Channel* one = image.find(layer);
    if (!one) one = image.find(prefix + "Y");
    found = {one, one, one};
  }
  if (!found[0] || !found[1] || !found[2])
    throw std::runtime_error(
        layer.empty()
            ? fmt::format("{}: has no channels R, G, B; its layers are: {}", path, layers_of(image))
            : fmt::format("{}: has no layer {}; its layers are: {}", path, layer,
                          layers_of(image)));
  Planes planes;
  planes.width = image.width;
  planes.height = image.height;
  for (size_t i = 0; i < 3; ++i) {
    const std::vector<float>& pixels = found[i]->pixels;
    planes.c[i].assign(pixels.begin(), pixels.end());
    for (size_t p = 0; p < pixels.size(); ++p)
      if (!std::isfinite(pixels[p]))
        throw std::runtime_error(fmt::format(
            "{}: channel {} is {} at pixel ({}, {}), expected a finite number", path,
            found[i]->name, std::isnan(pixels[p]) ? "not a number" : "infinite",
            p % static_cast<size_t>(image.width), p / static_cast<size_t>(image.width)));
  }
  return planes;
}

void require_same_size(const Planes& a, const Planes& b) {
  if (a.width != b.width || a.height != b.height)
    throw std::runtime_error(fmt::format("the images differ in size: {}x{} and {}x{}", a.width,
                                         a.height, b.width, b.height));
}

Metrics compare_planes(const Planes& a, const Planes& b, std::vector<double>* flip_map) {
  require_same_size(a, b);
  const size_t pixels = a.c[0].size();
  if (pixels == 0) throw std::runtime_error("the images have no pixels");
  Metrics m;
  m.identical = a.c == b.c;
  double square = 0, relative_square = 0, relative = 0, largest = 0;
  std::array<double, 3> sum_a{}, sum_b{};
  for (size_t c = 0; c < 3; ++c)
    for (size_t p = 0; p < pixels; ++p) {
      const double va = a.c[c][p], vb = b.c[c][p], d = va - vb;
      square += d * d;
      relative_square += d * d / (vb * vb + kStabiliser);
      relative += std::fabs(d) / (std::fabs(vb) + kStabiliser);
      largest = std::max(largest, vb);
      sum_a[c] += va;
      sum_b[c] += vb;
    }
  const auto ratio = [](double x, double y) {
    return y != 0 ? x / y : x == 0 ? 1.0 : std::numeric_limits<double>::infinity();
  };
  const double n = 3.0 * static_cast<double>(pixels);
  m.rmse = std::sqrt(square / n);
  m.relmse = relative_square / n;
  m.mape = relative / n;
  m.mean_ratio = ratio(sum_a[0] + sum_a[1] + sum_a[2], sum_b[0] + sum_b[1] + sum_b[2]);
  for (size_t c = 0; c < 3; ++c) m.mean_ratio_rgb[c] = ratio(sum_a[c], sum_b[c]);
  m.psnr =
      m.rmse == 0 ? std::numeric_limits<double>::infinity() : 20 * std::log10(largest / m.rmse);
  const std::vector<double> flip = hdr_flip(a, b);
  for (const double f : flip) m.flip += f;
  m.flip /= static_cast<double>(pixels);
  if (flip_map) *flip_map = flip;
  return m;
}

}  // namespace photonloom
