// SPDX-License-Identifier: Apache-2.0
// libFuzzer target: a texture's file of arbitrary bytes becomes as many finite texels as it says,
// or one error that names it. The first byte says how its values are decoded, the rest is the file.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "golden/scene/texture.hpp"
#include "tests/fuzz/folder.hpp"

using namespace photonloom;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const photonloom::fuzz::Folder folder;
  if (size == 0) return -1;
  const std::string path =
      folder.write("texture.png", {reinterpret_cast<const char*>(data) + 1, size - 1});
  constexpr const char* kChannels[] = {"", "r", "g", "b", "a", "", "", ""};
  Decoding decoding;
  decoding.channel = kChannels[data[0] & 7];
  decoding.raw = data[0] & 8;
  decoding.gamma = data[0] & 16 ? 2.2 : data[0] & 32 ? -1 : 0;
  Texture texture;
  try {
    texture.bitmap = std::make_shared<const Bitmap>(load_bitmap(path, decoding));
  } catch (const std::runtime_error& error) {
    if (std::string(error.what()).find("texture.png") == std::string::npos) std::abort();
    return 0;
  }
  const Bitmap& b = *texture.bitmap;
  if (b.width < 1 || b.height < 1 ||
      b.texels.size() != static_cast<size_t>(b.width) * static_cast<size_t>(b.height) *
                             static_cast<size_t>(b.channels))
    std::abort();
  for (const float t : b.texels)
    if (!(t >= 0) || std::isinf(t)) std::abort();
  const Rgb value = texture_value(texture, Vec2(0.3, -7.9));
  if (!(value.x >= 0) || !(max_component(value) <= texture_max(texture) * (1 + 1e-6))) std::abort();
  return 0;
}
