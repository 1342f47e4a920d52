// SPDX-License-Identifier: Apache-2.0
#include "golden/scene/generate_texture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "golden/image/image.hpp"
#include "golden/numeric/elementary.hpp"
#include "golden/numeric/random.hpp"
#include "golden/numeric/vec.hpp"

namespace photonloom {
namespace {

constexpr int kEdge = 256;

// A number in [0, 1) for a place.
double grain(uint64_t what, int x, int y) {
  return to_unit(hash_bits(what, static_cast<uint64_t>(x), static_cast<uint64_t>(y), 0));
}

// Of sRGB codes from 0 to 1, so that no curve is rounded.
template <class Color>
void write_tile(const std::string& path, Color&& color) {
  std::vector<uint8_t> rgb;
  for (int y = 0; y < kEdge; ++y)
    for (int x = 0; x < kEdge; ++x) {
      const Rgb c = color(x, y);
      for (int i = 0; i < 3; ++i)
        rgb.push_back(static_cast<uint8_t>(std::clamp(c[i], 0.0, 1.0) * 255 + 0.5));
    }
  write_png(rgb, kEdge, kEdge, path);
}

}  // namespace

void write_planks(const std::string& path) {
  constexpr int kPlanks = 4, kWidth = kEdge / kPlanks;
  write_tile(path, [](int x, int y) {
    const int plank = x / kWidth;
    // Where boards meet.
    const int end = static_cast<int>(grain(1, plank, 0) * kEdge);
    const bool gap = x % kWidth == 0 || y == end;
    // Fibres along v, a few of them dark, on a tone of the board's own.
    const double tone = 0.85 + 0.3 * grain(2, plank, y > end ? 1 : 0);
    const double fibre = grain(3, x, y / 32);
    const double streak = fibre < 0.12 ? 0.82 : 1 + 0.12 * (fibre - 0.5);
    return Rgb(0.62, 0.46, 0.33) * (gap ? 0.4 : tone * streak * (0.97 + 0.06 * grain(4, x, y)));
  });
}

void write_bricks(const std::string& path) {
  constexpr int kRows = 8, kHeight = kEdge / kRows, kLength = kEdge / 4, kMortar = 3;
  write_tile(path, [](int x, int y) {
    const int row = y / kHeight, shifted = (x + (row % 2) * kLength / 2) % kEdge;
    const double rough = 0.95 + 0.1 * grain(5, x, y);
    if (y % kHeight < kMortar || shifted % kLength < kMortar) return Rgb(0.78, 0.76, 0.72) * rough;
    const double tone = 0.8 + 0.35 * grain(6, shifted / kLength, row);
    return Rgb(0.66, 0.46, 0.39) * (tone * rough);
  });
}

void write_sky(const std::string& path) {
  Image image;
  image.width = 128;
  image.height = 64;
  for (const char* c : {"R", "G", "B"}) image.add(c);
  const Vec3 to_sun = glm::normalize(Vec3(-1, 0.62, 0.12));
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      // Towards +y at the upper edge; to -z at u = 0, growing towards +x.
      const Vec2 turn = cos_sin_turns((x + 0.5) / image.width);
      const Vec2 fall = cos_sin_turns((y + 0.5) / image.height / 2);
      const Vec3 d(fall.y * turn.y, fall.x, -fall.y * turn.x);
      const double up = std::max(0.0, d.y);
      Rgb c =
          d.y > 0 ? Rgb(0.9, 1, 1.1) * (1 - up) + Rgb(0.25, 0.5, 1.1) * up : Rgb(0.2, 0.18, 0.15);
      // cos^n of the angle to the sun, about 6 degrees wide.
      const double towards = std::max(0.0, glm::dot(d, to_sun));
      c += Rgb(160, 135, 100) * pow_exact(towards, 250);
      for (size_t i = 0; i < 3; ++i)
        image.channels[i].pixels[static_cast<size_t>(y * image.width + x)] =
            static_cast<float>(c[static_cast<int>(i)]);
    }
  write_exr(image, path);
}

}  // namespace photonloom
