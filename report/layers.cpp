// SPDX-License-Identifier: Apache-2.0
#include "report/layers.hpp"

#include <Imath/half.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>

namespace photonloom {
namespace {

using Json = nlohmann::ordered_json;

// Of differences: further down they are 0 to any eye.
constexpr int kLeastExponent = -100;

struct Layer {
  std::string name;
  std::vector<const Channel*> channels;
};

// Where a channel stands in its layer: R, G, B and X, Y, Z in this order.
size_t rank(const std::string& name) {
  constexpr std::string_view kOrder = "RXGYBZ";
  return name.empty() ? 0 : kOrder.find(name.back());
}

std::vector<Layer> layers_of(const Image& image) {
  std::vector<Layer> layers = {{"", {}}};
  for (const Channel& c : image.channels) {
    const size_t dot = c.name.rfind('.');
    const bool color = c.name == "R" || c.name == "G" || c.name == "B";
    const std::string name = dot != std::string::npos ? c.name.substr(0, dot) : color ? "" : c.name;
    auto at =
        std::find_if(layers.begin(), layers.end(), [&](const Layer& l) { return l.name == name; });
    if (at == layers.end()) at = layers.insert(at, {name, {}});
    at->channels.push_back(&c);
  }
  if (layers[0].channels.empty()) layers.erase(layers.begin());
  for (Layer& l : layers)
    std::sort(l.channels.begin(), l.channels.end(),
              [](const Channel* a, const Channel* b) { return rank(a->name) < rank(b->name); });
  return layers;
}

// The smallest exponent, not below `least`, with which no finite value reaches 2^15.
int scale_exponent(const std::vector<float>& pixels, int least) {
  float most = 0;
  for (const float v : pixels)
    if (std::isfinite(v)) most = std::max(most, std::fabs(v));
  int exponent = 0;
  std::frexp(most, &exponent);
  return most == 0 ? 0 : std::max(least, exponent - 15);
}

// Rounded once to so many mantissa bits, half up in magnitude; a carry into the exponent is right.
uint16_t half_bits(float value, int mantissa) {
  if (std::isfinite(value) && mantissa < 10) {
    const uint32_t step = 1u << (23 - mantissa);
    value = std::bit_cast<float>((std::bit_cast<uint32_t>(value) + step / 2) & ~(step - 1));
  }
  return Imath::half(value).bits();
}

// What is left of each value when its neighbour is known.
template <class T>
std::vector<T> differences(const std::vector<T>& values, size_t width) {
  std::vector<T> out(values.size());
  for (size_t i = 0; i < values.size(); ++i) {
    const T before = i % width ? values[i - 1] : i ? values[i - width] : T{0};
    out[i] = static_cast<T>(values[i] - before);
  }
  return out;
}

// Halves as bytes. Chained, a channel is first taken less the one before it: a half's bits are
// nearly a logarithm, and noise changes all colours of a pixel by about one factor.
std::string coded(const std::vector<std::vector<uint16_t>>& channels, int width, bool chained) {
  std::string bytes;
  for (size_t c = 0; c < channels.size(); ++c) {
    std::vector<uint16_t> values = channels[c];
    for (size_t i = 0; chained && c > 0 && i < values.size(); ++i)
      values[i] = static_cast<uint16_t>(values[i] - channels[c - 1][i]);
    const auto left = differences(values, static_cast<size_t>(width));
    for (const int shift : {0, 8})
      for (const uint16_t d : left) bytes += static_cast<char>(d >> shift & 0xff);
  }
  return bytes;
}

}  // namespace

Json packed_layers(const Image& image, int mantissa, Payloads& payloads, const Image* base) {
  Json layers = Json::array();
  for (const Layer& layer : layers_of(image)) {
    Json names = Json::array(), exponents = Json::array();
    std::vector<std::vector<uint16_t>> channels;
    const bool difference =
        base && std::all_of(layer.channels.begin(), layer.channels.end(),
                            [&](const Channel* c) { return base->find(c->name); });
    for (const Channel* c : layer.channels) {
      std::vector<float> pixels = c->pixels;
      if (difference)
        std::transform(pixels.begin(), pixels.end(), base->find(c->name)->pixels.begin(),
                       pixels.begin(), std::minus<float>());
      const int exponent = scale_exponent(pixels, difference ? kLeastExponent : 0);
      channels.emplace_back(pixels.size());
      std::transform(pixels.begin(), pixels.end(), channels.back().begin(),
                     [&](float v) { return half_bits(std::ldexp(v, -exponent), mantissa); });
      names.push_back(c->name);
      exponents.push_back(exponent);
    }
    const std::string alone =
                          packed_text(coded(channels, image.width, false), Content::kDifferences),
                      chained =
                          packed_text(coded(channels, image.width, true), Content::kDifferences);
    const bool is_chained = chained.size() < alone.size();
    layers.push_back({{"name", layer.name},
                      {"channels", names},
                      {"exponents", exponents},
                      {"difference", difference},
                      {"chained", is_chained},
                      {"payload", payloads.add_packed(is_chained ? chained : alone)}});
  }
  return layers;
}

size_t packed_map(const std::vector<double>& map, int width, Payloads& payloads) {
  std::vector<uint8_t> bytes(map.size());
  std::transform(map.begin(), map.end(), bytes.begin(), [](double v) {
    return static_cast<uint8_t>(std::lround(255 * std::clamp(v, 0.0, 1.0)));
  });
  const auto left = differences(bytes, static_cast<size_t>(width));
  return payloads.add(std::string(left.begin(), left.end()));
}

}  // namespace photonloom
