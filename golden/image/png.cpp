// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "golden/image/image.hpp"
#include "golden/numeric/output_file.hpp"

#define STBI_WRITE_NO_STDIO
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace photonloom {

uint8_t srgb_byte(double linear) {
  // IEC 61966-2-1; a value that is no number is shown black.
  const double c = linear > 0 ? std::min(linear, 1.0) : 0.0;
  const double coded = c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
  return static_cast<uint8_t>(std::lround(coded * 255));
}

void write_png(const std::vector<uint8_t>& rgb, int width, int height, const std::string& path) {
  OutputFile file(path);
  if (rgb.size() != static_cast<size_t>(width) * static_cast<size_t>(height) * 3)
    throw std::runtime_error(path + ": the bytes given are not width x height x 3");
  const auto sink = [](void* to, void* data, int size) {
    static_cast<std::string*>(to)->append(static_cast<const char*>(data),
                                          static_cast<size_t>(size));
  };
  std::string bytes;
  if (!stbi_write_png_to_func(sink, &bytes, width, height, 3, rgb.data(), width * 3))
    throw std::runtime_error(path + ": cannot be written as PNG: out of memory");
  file.write(bytes);
  file.commit();
}

void write_png(const Image& image, const std::string& path, double exposure) {
  const Channel* planes[3] = {image.find("R"), image.find("G"), image.find("B")};
  if (!planes[0] || !planes[1] || !planes[2])
    throw std::runtime_error(path + ": the image has no channels R, G, B to show");
  const double scale = std::exp2(exposure);
  std::vector<uint8_t> rgb(planes[0]->pixels.size() * 3);
  for (size_t i = 0; i < planes[0]->pixels.size(); ++i)
    for (size_t c = 0; c < 3; ++c)
      rgb[3 * i + c] = srgb_byte(scale * static_cast<double>(planes[c]->pixels[i]));
  write_png(rgb, image.width, image.height, path);
}

}  // namespace photonloom
