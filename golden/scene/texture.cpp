// SPDX-License-Identifier: Apache-2.0
#include "golden/scene/texture.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <stdexcept>

#include "golden/image/picture.hpp"
#include "golden/numeric/elementary.hpp"

namespace photonloom {
namespace {

// Beyond this a coordinate is no place on a texture any more.
constexpr double kFarthest = 0x1p40;

// The texel of a coordinate, or -1 (black), -2 (white).
int wrapped(int64_t i, int size, Wrap wrap) {
  if (i >= 0 && i < size) return static_cast<int>(i);
  switch (wrap) {
    case Wrap::kRepeat: {
      const int64_t m = i % size;
      return static_cast<int>(m < 0 ? m + size : m);
    }
    case Wrap::kMirror: {
      int64_t m = i % (2 * int64_t{size});
      if (m < 0) m += 2 * int64_t{size};
      return static_cast<int>(m < size ? m : 2 * int64_t{size} - 1 - m);
    }
    case Wrap::kClamp:
      return i < 0 ? 0 : size - 1;
    case Wrap::kZero:
      return -1;
    default:
      return -2;
  }
}

Rgb texel(const Texture& t, int64_t x, int64_t y) {
  const Bitmap& b = *t.bitmap;
  const int i = wrapped(x, b.width, t.wrap_u), j = wrapped(y, b.height, t.wrap_v);
  if (i == -1 || j == -1) return Rgb(0);
  if (i == -2 || j == -2) return Rgb(1);
  return b.at(i, j);
}

double floor_of(double x) { return std::floor(std::clamp(x, -kFarthest, kFarthest)); }

Rgb bitmap_value(const Texture& t, double u, double v) {
  const double x = u * t.bitmap->width, y = v * t.bitmap->height;
  if (t.nearest)
    return texel(t, static_cast<int64_t>(floor_of(x)), static_cast<int64_t>(floor_of(y)));
  const double left = floor_of(x - 0.5), top = floor_of(y - 0.5);
  const double right_share = std::clamp(x - 0.5 - left, 0.0, 1.0),
               lower_share = std::clamp(y - 0.5 - top, 0.0, 1.0);
  const int64_t i = static_cast<int64_t>(left), j = static_cast<int64_t>(top);
  const Rgb upper = texel(t, i, j) * (1 - right_share) + texel(t, i + 1, j) * right_share;
  const Rgb lower = texel(t, i, j + 1) * (1 - right_share) + texel(t, i + 1, j + 1) * right_share;
  return upper * (1 - lower_share) + lower * lower_share;
}

}  // namespace

double srgb_to_linear(double coded) {
  return coded <= 0.04045 ? coded / 12.92 : pow_exact((coded + 0.055) / 1.055, 2.4);
}

Rgb texture_value(const Texture& t, const Vec2& uv) {
  const double u = t.to_uv[0][0] * uv.x + t.to_uv[0][1] * uv.y + t.to_uv[0][2];
  const double v = t.to_uv[1][0] * uv.x + t.to_uv[1][1] * uv.y + t.to_uv[1][2];
  if (t.kind == TextureKind::kBitmap) return bitmap_value(t, u, v) * t.scale;
  const bool second_u = u - floor_of(u) > 0.5, second_v = v - floor_of(v) > 0.5;
  return t.color[second_u == second_v ? 0 : 1] * t.scale;
}

Rgb texture_mean(const Texture& t) {
  switch (t.kind) {
    case TextureKind::kBitmap: {
      Rgb sum(0);
      for (int y = 0; y < t.bitmap->height; ++y)
        for (int x = 0; x < t.bitmap->width; ++x) sum += t.bitmap->at(x, y);
      return sum * t.scale /
             (static_cast<double>(t.bitmap->width) * static_cast<double>(t.bitmap->height));
    }
    case TextureKind::kCheckerboard:
      return (t.color[0] + t.color[1]) * 0.5 * t.scale;
    default:
      return t.scale * 0.5;
  }
}

double texture_max(const Texture& t) {
  switch (t.kind) {
    case TextureKind::kBitmap: {
      Rgb most(t.wrap_u == Wrap::kOne || t.wrap_v == Wrap::kOne ? 1.0 : 0.0);
      for (int y = 0; y < t.bitmap->height; ++y)
        for (int x = 0; x < t.bitmap->width; ++x) most = glm::max(most, t.bitmap->at(x, y));
      return max_component(most * t.scale);
    }
    case TextureKind::kCheckerboard:
      return max_component(glm::max(t.color[0], t.color[1]) * t.scale);
    default:
      return max_component(t.scale);
  }
}

Bitmap load_bitmap(const std::string& path, const Decoding& decoding) {
  const Picture picture = read_picture(path);
  const int colors = picture.channels <= 2 ? 1 : 3;
  const bool has_alpha = picture.channels == 2 || picture.channels == 4;
  int first = 0;
  Bitmap out;
  out.channels = colors;
  bool alpha = false;
  if (!decoding.channel.empty()) {
    constexpr const char* kNames = "rgb";
    out.channels = 1;
    alpha = decoding.channel == "a";
    first =
        alpha ? picture.channels - 1 : static_cast<int>(std::string(kNames).find(decoding.channel));
    if (alpha && !has_alpha)
      throw std::runtime_error(path + ": has no alpha channel, expected one for channel \"a\"");
    if (!alpha && first >= colors) first = 0;  // grey: all channels are the same
  }
  out.width = picture.width;
  out.height = picture.height;
  const bool srgb =
      !decoding.raw && !alpha && (decoding.gamma == 0 ? picture.integers : decoding.gamma == -1);
  const bool power = !decoding.raw && !alpha && decoding.gamma > 0 && decoding.gamma != 1;
  std::map<float, float> decoded;  // integers have few values
  const auto linear = [&](float value) {
    if (!srgb && !power) return value;
    const auto compute = [&] {
      const double coded = std::max(0.0, static_cast<double>(value));
      return static_cast<float>(srgb ? srgb_to_linear(coded) : pow_exact(coded, decoding.gamma));
    };
    if (!picture.integers) return compute();
    const auto at = decoded.find(value);
    return at != decoded.end() ? at->second : decoded.emplace(value, compute()).first->second;
  };
  const size_t pixels = static_cast<size_t>(out.width) * static_cast<size_t>(out.height);
  out.texels.reserve(pixels * static_cast<size_t>(out.channels));
  for (size_t i = 0; i < pixels; ++i)
    for (int c = 0; c < out.channels; ++c) {
      const float coded =
          picture
              .values[i * static_cast<size_t>(picture.channels) + static_cast<size_t>(first + c)];
      // Decoding takes what is negative to 0, and a large number beyond floats.
      const float value = std::isfinite(coded) ? linear(coded) : coded;
      if (!std::isfinite(value) || value < 0)
        throw std::runtime_error(fmt::format(
            "{}: texel ({}, {}) is {}, expected finite numbers of at least 0", path,
            i % static_cast<size_t>(out.width), i / static_cast<size_t>(out.width), value));
      out.texels.push_back(value);
    }
  return out;
}

}  // namespace photonloom
