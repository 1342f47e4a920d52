// SPDX-License-Identifier: Apache-2.0
// libFuzzer target: whole, or one SceneError. The first byte says what the others are: f a
// serialized mesh file; 3 or 4 what stands compressed in one of that version; else a spectrum file.
#include <zlib.h>

#include <cstdint>
#include <cstdlib>
#include <string>

#include "golden/scene/serialized.hpp"
#include "golden/scene/spectrum.hpp"
#include "tests/fuzz/folder.hpp"

namespace {

std::string as_file(const std::string& content, char version) {
  std::string packed(compressBound(content.size()), '\0');
  uLongf size = packed.size();
  if (compress(reinterpret_cast<Bytef*>(packed.data()), &size,
               reinterpret_cast<const Bytef*>(content.data()), content.size()) != Z_OK)
    std::abort();
  packed.resize(size);
  const size_t offset_bytes = version == 4 ? 8 : 4;
  return std::string("\x1c\x04", 2) + version + '\0' + packed + std::string(offset_bytes, '\0') +
         std::string("\1\0\0\0", 4);
}

void expect_whole(const std::string& path) {
  const photonloom::Mesh mesh = photonloom::read_serialized(path, 0).mesh;
  if (mesh.triangles.empty()) std::abort();
  for (const auto& triangle : mesh.triangles)
    for (const uint32_t v : triangle)
      if (v >= mesh.positions.size()) std::abort();
}

void expect_spectrum(const std::string& path) {
  const photonloom::Spectrum s = photonloom::read_spd(path);
  for (size_t i = 1; i < s.nm.size(); ++i)
    if (!(s.nm[i] > s.nm[i - 1])) std::abort();
  for (const auto of : {photonloom::SpectrumOf::kLight, photonloom::SpectrumOf::kSurface}) {
    const photonloom::Rgb color = photonloom::spectrum_color(s, of);
    for (int i = 0; i < 3; ++i)
      if (!(color[i] >= 0)) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const photonloom::fuzz::Folder folder;
  if (size == 0) return 0;
  const std::string rest(reinterpret_cast<const char*>(data) + 1, size - 1);
  const char kind = static_cast<char>(data[0]);
  const bool packed = kind == '3' || kind == '4';
  const std::string path =
      folder.write("file", packed ? as_file(rest, static_cast<char>(kind - '0')) : rest);
  try {
    packed || kind == 'f' ? expect_whole(path) : expect_spectrum(path);
  } catch (const photonloom::SceneError& error) {
    if (std::string(error.what()).empty()) std::abort();
  }
  return 0;
}
