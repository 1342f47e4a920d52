// SPDX-License-Identifier: Apache-2.0
// Textures: a color for each point of a surface. Meaning: Mitsuba's, see docs/materials.md.
#pragma once
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "golden/numeric/vec.hpp"

namespace photonloom {

// Linear texels, row by row; v = 0 is the upper edge of the first row.
struct Bitmap {
  int width = 0, height = 0;
  int channels = 3;  // 1 or 3
  std::vector<float> texels;
  Rgb at(int x, int y) const {
    const size_t i =
        (static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)) *
        static_cast<size_t>(channels);
    if (channels == 1) return Rgb(static_cast<double>(texels[i]));
    return Rgb(static_cast<double>(texels[i]), static_cast<double>(texels[i + 1]),
               static_cast<double>(texels[i + 2]));
  }
};

enum class TextureKind { kBitmap, kCheckerboard, kVertexColor };
// Outside of [0, 1]: tiled, mirrored, the edge's texel, black, white.
enum class Wrap { kRepeat, kMirror, kClamp, kZero, kOne };

struct Texture {
  TextureKind kind = TextureKind::kBitmap;
  std::shared_ptr<const Bitmap> bitmap;
  bool nearest = false;  // else bilinear between texel centres
  Wrap wrap_u = Wrap::kRepeat, wrap_v = Wrap::kRepeat;
  std::array<std::array<double, 3>, 2> to_uv{{{1, 0, 0}, {0, 1, 0}}};  // of (u, v, 1)
  Rgb color[2] = {Rgb(0.4), Rgb(0.2)};  // checkerboard: where the halves of u and v agree; else
  Rgb scale{1};
};

// Bitmaps and checkerboards; a vertex color is the surface's.
Rgb texture_value(const Texture& texture, const Vec2& uv);

// Mean over the unit square of its own coordinates, and the largest component anywhere. Of vertex
// colors, whose mesh is not known here: scale / 2 and scale.
Rgb texture_mean(const Texture& texture);
double texture_max(const Texture& texture);

// How a bitmap's file becomes linear texels.
struct Decoding {
  bool raw = false;     // values as they stand
  double gamma = 0;     // 0: sRGB for integers, linear for floats; -1: sRGB; else the exponent
  std::string channel;  // "", or one of r, g, b, a alone
};

// Throws std::runtime_error "PATH: why".
Bitmap load_bitmap(const std::string& path, const Decoding& decoding);

// IEC 61966-2-1.
double srgb_to_linear(double coded);

}  // namespace photonloom
