// SPDX-License-Identifier: Apache-2.0
#include "golden/image/sheet.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "golden/image/metrics.hpp"
#include "golden/numeric/output_file.hpp"
#include "golden/numeric/vec.hpp"

#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_easy_font.h>
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace photonloom {
namespace {

constexpr int kMargin = 8, kTextHeight = 20;
constexpr uint8_t kPaper = 250, kInk = 20;

// Averages shrink x shrink blocks of value(x, y, c) and codes them.
template <class Value, class Code>
Picture shrunk(int width, int height, int shrink, const std::string& path, Value&& value,
               Code&& code) {
  if (width < shrink || height < shrink)
    throw std::runtime_error(fmt::format("{}: has {}x{} pixels, too few to be shrunk {} times",
                                         path, width, height, shrink));
  Picture p;
  p.width = width / shrink;
  p.height = height / shrink;
  for (int y = 0; y < p.height; ++y)
    for (int x = 0; x < p.width; ++x)
      for (int c = 0; c < 3; ++c) {
        double sum = 0;
        for (int j = 0; j < shrink; ++j)
          for (int i = 0; i < shrink; ++i) sum += value(x * shrink + i, y * shrink + j, c);
        p.rgb.push_back(code(sum / (shrink * shrink)));
      }
  return p;
}

void paste(Picture& sheet, const Picture& picture, int left, int top) {
  for (int y = 0; y < picture.height; ++y)
    std::copy_n(picture.rgb.begin() + y * picture.width * 3, picture.width * 3,
                sheet.rgb.begin() + ((top + y) * sheet.width + left) * 3);
}

// The font has the characters of ASCII; a '?' stands for each byte of others.
void write_text(Picture& sheet, std::string text, int left, int top, int width) {
  for (char& c : text)
    if (c < 32 || c > 126) c = '?';
  std::vector<char> quads(text.size() * 512 + 64);
  const int count =
      stb_easy_font_print(0, 0, text.data(), nullptr, quads.data(), static_cast<int>(quads.size()));
  // A quad is four vertices of x, y, z and a colour, 16 bytes each; the first and third are
  // corners.
  for (int q = 0; q < count; ++q) {
    float from[2], to[2];
    std::copy_n(reinterpret_cast<const float*>(quads.data() + q * 64), 2, from);
    std::copy_n(reinterpret_cast<const float*>(quads.data() + q * 64 + 32), 2, to);
    for (int y = static_cast<int>(from[1]); y < static_cast<int>(to[1]); ++y)
      for (int x = static_cast<int>(from[0]); x < static_cast<int>(to[0]); ++x)
        if (x < width && top + y < sheet.height)
          for (int c = 0; c < 3; ++c)
            sheet.rgb[static_cast<size_t>(((top + y) * sheet.width + left + x) * 3 + c)] = kInk;
  }
}

}  // namespace

Picture picture_of(const Image& image, double exposure, int shrink, const std::string& path) {
  const Planes planes = planes_of(image, "", path);
  const double scale = std::exp2(exposure);
  return shrunk(
      image.width, image.height, shrink, path,
      [&](int x, int y, int c) {
        return scale * planes.c[static_cast<size_t>(c)][static_cast<size_t>(y * image.width + x)];
      },
      [](double v) { return srgb_byte(v); });
}

Picture read_png(const std::string& path, int shrink) {
  const std::string bytes = read_file(path);
  int width = 0, height = 0, channels = 0;
  stbi_uc* data =
      stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()),
                            static_cast<int>(bytes.size()), &width, &height, &channels, 3);
  if (!data) throw std::runtime_error(path + ": cannot be read as PNG: " + stbi_failure_reason());
  Picture p = shrunk(
      width, height, shrink, path,
      [&](int x, int y, int c) { return static_cast<double>(data[(y * width + x) * 3 + c]); },
      [](double v) { return static_cast<uint8_t>(std::lround(v)); });
  stbi_image_free(data);
  return p;
}

double exposure_for(const Image& image, const std::string& path) {
  const Planes planes = planes_of(image, "", path);
  std::vector<double> y;
  for (size_t p = 0; p < planes.c[0].size(); ++p)
    y.push_back(luminance(Vec3(planes.c[0][p], planes.c[1][p], planes.c[2][p])));
  const auto at = y.begin() + static_cast<std::ptrdiff_t>(y.size() * 95 / 100);
  std::nth_element(y.begin(), at, y.end());
  return *at > 0 ? std::log2(0.8 / *at) : 0;
}

Picture contact_sheet(const std::vector<Tile>& tiles, int columns) {
  int width = 0, height = 0;
  for (const Tile& t : tiles) {
    width = std::max(width, t.picture.width);
    height = std::max(height, t.picture.height);
  }
  const int rows = (static_cast<int>(tiles.size()) + columns - 1) / columns;
  const int pitch_x = width + kMargin, pitch_y = height + kTextHeight;
  Picture sheet;
  sheet.width = kMargin + columns * pitch_x;
  sheet.height = kMargin + rows * pitch_y;
  sheet.rgb.assign(static_cast<size_t>(sheet.width) * static_cast<size_t>(sheet.height) * 3,
                   kPaper);
  for (size_t i = 0; i < tiles.size(); ++i) {
    const int left = kMargin + static_cast<int>(i) % columns * pitch_x;
    const int top = kMargin + static_cast<int>(i) / columns * pitch_y;
    paste(sheet, tiles[i].picture, left, top);
    write_text(sheet, tiles[i].label, left, top + height + 4, width);
  }
  return sheet;
}

}  // namespace photonloom
