// SPDX-License-Identifier: Apache-2.0
// Pictures as textures come: PNG, JPEG, TGA, BMP, Radiance HDR and OpenEXR, told apart by their
// bytes, not by their names.
#pragma once
#include <string>
#include <vector>

namespace photonloom {

// Values as they stand in the file: integers of 8 or 16 bits over their largest (0 to 1), floats as
// they are. Nothing is decoded from sRGB.
struct Picture {
  int width = 0, height = 0;
  int channels = 0;           // 1 grey, 2 grey and alpha, 3 RGB, 4 RGB and alpha
  bool integers = false;      // of a format whose integers are sRGB by convention
  std::vector<float> values;  // row by row from the top left, channels interleaved
};

// At most 2^26 pixels, counted before anything is decoded. Throws std::runtime_error "PATH: why".
Picture read_picture(const std::string& path);

}  // namespace photonloom
