// SPDX-License-Identifier: Apache-2.0
// Contact sheets: pictures in a grid, a line of text under each.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "golden/image/image.hpp"

namespace photonloom {

// 8-bit sRGB, row by row from the top left.
struct Picture {
  int width = 0, height = 0;
  std::vector<uint8_t> rgb;
};

struct Tile {
  Picture picture;
  std::string label;
};

// R, G, B times 2^exposure, averaged over shrink x shrink pixels before the sRGB curve; pixels that
// fill no whole block at the right and bottom are left out.
Picture picture_of(const Image& image, double exposure, int shrink, const std::string& path);

// A PNG, averaged likewise (of its bytes). Throws std::runtime_error naming it.
Picture read_png(const std::string& path, int shrink);

// The exposure at which 95 % of the pixels are below 0.8 in luminance; 0 for a black image.
double exposure_for(const Image& image, const std::string& path);

Picture contact_sheet(const std::vector<Tile>& tiles, int columns);

}  // namespace photonloom
