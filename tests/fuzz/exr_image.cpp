// SPDX-License-Identifier: Apache-2.0
// libFuzzer target: an EXR file of arbitrary bytes is an image with as many values as it says, that
// can be written and read again; or one error.
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "golden/image/image.hpp"
#include "golden/image/pixel_sum.hpp"
#include "tests/fuzz/folder.hpp"

using namespace photonloom;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const photonloom::fuzz::Folder folder;
  const std::string path = folder.write("image.exr", {reinterpret_cast<const char*>(data), size});
  Image image;
  try {
    image = read_exr(path);
  } catch (const std::runtime_error& error) {
    if (std::string(error.what()).find("image.exr") == std::string::npos) std::abort();
    return 0;
  }
  for (const Channel& c : image.channels)
    if (c.pixels.size() != static_cast<size_t>(image.width) * static_cast<size_t>(image.height))
      std::abort();
  if (image.width > 256 || image.height > 256 || image.channels.empty()) return 0;
  image.metadata.clear();
  write_exr(image, (folder.path / "copy.exr").string());
  if (pixel_sha256(read_exr((folder.path / "copy.exr").string())) != pixel_sha256(image))
    std::abort();
  return 0;
}
