// SPDX-License-Identifier: Apache-2.0
// An image in memory: named float channels of one size, and its metadata.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace photonloom {

struct Channel {
  std::string name;           // "R", "direct.G", "Z", "photonDensity.Y", ...
  std::vector<float> pixels;  // row by row from the top left
};

struct Image {
  int width = 0, height = 0;
  std::vector<Channel> channels;
  std::map<std::string, std::string> metadata;  // EXR string attributes

  const Channel* find(const std::string& name) const {
    for (const Channel& c : channels)
      if (c.name == name) return &c;
    return nullptr;
  }
  Channel& add(const std::string& name) {
    channels.push_back(
        {name, std::vector<float>(static_cast<size_t>(width) * static_cast<size_t>(height), 0.0f)});
    return channels.back();
  }
};

// One-part scanline EXR, 32-bit float, ZIP, Rec.709 chromaticities, no dates. Whole or not at all:
// written beside the target and renamed. Both throw std::runtime_error with file and reason.
void write_exr(const Image& image, const std::string& path);
Image read_exr(const std::string& path);

// The same for 8-bit RGB, row by row from the top left; srgb_byte codes a linear value, 1 is white.
void write_png(const std::vector<uint8_t>& rgb, int width, int height, const std::string& path);
uint8_t srgb_byte(double linear);

// sRGB PNG of R, G, B times 2^exposure, clipped at white.
void write_png(const Image& image, const std::string& path, double exposure = 0);

}  // namespace photonloom
