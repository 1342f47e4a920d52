// SPDX-License-Identifier: Apache-2.0
#include "golden/image/picture.hpp"

#include <fmt/core.h>
#include <turbojpeg.h>

#include <algorithm>
#include <climits>
#include <cstdint>
#include <memory>
#include <stdexcept>

#include "golden/image/image.hpp"
#include "golden/numeric/output_file.hpp"

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_NO_STDIO
#define STBI_NO_SIMD
#define STBI_NO_JPEG
#define STBI_NO_PSD
#define STBI_NO_GIF
#define STBI_NO_PIC
#define STBI_NO_PNM
#define STBI_MAX_DIMENSIONS (1 << 20)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wsign-compare"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace photonloom {
namespace {

constexpr int64_t kMaxPicturePixels = int64_t{1} << 26;

[[noreturn]] void fail_picture(const std::string& path, const std::string& why) {
  throw std::runtime_error(path + ": " + why);
}

void check_size(const std::string& path, int64_t width, int64_t height) {
  if (width < 1 || height < 1)
    fail_picture(path, fmt::format("has {} x {} pixels, expected at least 1 x 1", width, height));
  if (width > kMaxPicturePixels / height)
    fail_picture(path, fmt::format("has {} x {} pixels, expected at most 2^26", width, height));
}

[[noreturn]] void fail_library(const std::string& path, const char* what) {
  const char* reason = stbi_failure_reason();
  fail_picture(path, fmt::format("{}: {}", what, reason ? reason : "unknown format"));
}

struct Free {
  void operator()(void* p) const { stbi_image_free(p); }
};

// Values of the library, owned by it, over their largest.
template <class Value>
void take(Picture& out, Value* data, double largest) {
  const std::unique_ptr<Value, Free> owner(data);
  const size_t count = static_cast<size_t>(out.width) * static_cast<size_t>(out.height) *
                       static_cast<size_t>(out.channels);
  out.values.resize(count);
  for (size_t i = 0; i < count; ++i)
    out.values[i] = static_cast<float>(static_cast<double>(data[i]) / largest);
}

Picture from_exr(const std::string& path) {
  const Image image = read_exr(path);
  check_size(path, image.width, image.height);
  std::vector<const Channel*> planes;
  for (const char* name : {"R", "G", "B"})
    if (const Channel* c = image.find(name)) planes.push_back(c);
  if (planes.size() != 3) {
    planes.clear();
    if (const Channel* y = image.find("Y")) planes.push_back(y);
  }
  if (planes.empty())
    fail_picture(path, "has neither channels R, G, B nor Y, expected a color image");
  if (const Channel* a = image.find("A")) planes.push_back(a);
  Picture out;
  out.width = image.width;
  out.height = image.height;
  out.channels = static_cast<int>(planes.size());
  out.values.resize(planes.size() * planes[0]->pixels.size());
  for (size_t c = 0; c < planes.size(); ++c)
    for (size_t i = 0; i < planes[c]->pixels.size(); ++i)
      out.values[i * planes.size() + c] = planes[c]->pixels[i];
  return out;
}

// No compression makes so much of so little, and room is made before the rest is looked at.
void check_bytes(const std::string& path, const Picture& picture, size_t bytes) {
  if (int64_t{picture.width} * picture.height > static_cast<int64_t>(bytes) << 14)
    fail_picture(path, fmt::format("has {} x {} pixels, more than its {} bytes can hold",
                                   picture.width, picture.height, bytes));
}

// Its accurate transform gives the same texels on every machine, with SIMD and without.
Picture from_jpeg(const std::string& path, const std::string& bytes) {
  const std::unique_ptr<void, int (*)(tjhandle)> reader(tjInitDecompress(), tjDestroy);
  if (!reader) fail_picture(path, "cannot be read as JPEG: no memory");
  // Bytes that stand between markers are warned of and skipped, as by other readers.
  const auto check = [&](int status) {
    const std::string why = status == 0 ? "" : tjGetErrorStr2(reader.get());
    if (status != 0 && (tjGetErrorCode(reader.get()) != TJERR_WARNING ||
                        why.find("Premature") != std::string::npos))
      fail_picture(path, "cannot be read as JPEG: " + why);
  };
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  Picture out;
  int sampling = 0, space = 0;
  check(tjDecompressHeader3(reader.get(), data, bytes.size(), &out.width, &out.height, &sampling,
                            &space));
  check_size(path, out.width, out.height);
  check_bytes(path, out, bytes.size());
  const bool inks = space == TJCS_CMYK || space == TJCS_YCCK;
  const int format = space == TJCS_GRAY ? TJPF_GRAY : inks ? TJPF_CMYK : TJPF_RGB;
  const size_t read = static_cast<size_t>(tjPixelSize[format]);
  std::vector<unsigned char> texels(static_cast<size_t>(out.width) *
                                    static_cast<size_t>(out.height) * read);
  check(tjDecompress2(reader.get(), data, bytes.size(), texels.data(), out.width, 0, out.height,
                      format, TJFLAG_ACCURATEDCT | TJFLAG_LIMITSCANS));
  out.integers = true;
  out.channels = inks ? 3 : static_cast<int>(read);
  const auto channels = static_cast<size_t>(out.channels);
  out.values.resize(texels.size() / read * channels);
  for (size_t i = 0; i < out.values.size(); ++i) {
    const unsigned char* texel = &texels[i / channels * read];
    // Inks stand in files as their complements, as Adobe's programs write them.
    const double value = inks ? texel[i % channels] * (texel[3] / 255.0) : texel[i % channels];
    out.values[i] = static_cast<float>(value / 255);
  }
  return out;
}

// Bytes that end. The library asks for runs again and again where it finds none, so behind the end
// it gets bytes that bring it to its own, and the picture is not taken.
struct EndingBytes {
  const std::string& bytes;
  size_t at = 0;
  bool beyond = false;
};

int read_some(void* user, char* to, int size) {
  auto* from = static_cast<EndingBytes*>(user);
  if (from->at == from->bytes.size()) {
    from->beyond = true;
    std::fill_n(to, size, '\1');
    return size;
  }
  const size_t n = std::min(static_cast<size_t>(size), from->bytes.size() - from->at);
  from->bytes.copy(to, n, from->at);
  from->at += n;
  return static_cast<int>(n);
}

void skip_some(void* user, int size) {
  auto* from = static_cast<EndingBytes*>(user);
  from->at = std::min(from->at + static_cast<size_t>(size), from->bytes.size());
}

int at_end(void* user) {
  const auto* from = static_cast<const EndingBytes*>(user);
  return from->at == from->bytes.size();
}

Picture from_hdr(const std::string& path, const std::string& bytes) {
  const stbi_io_callbacks calls{read_some, skip_some, at_end};
  EndingBytes from{bytes};
  Picture out;
  const std::unique_ptr<float, Free> values(
      stbi_loadf_from_callbacks(&calls, &from, &out.width, &out.height, &out.channels, 0));
  if (from.beyond) fail_picture(path, "ends before its last pixel");
  if (!values) fail_library(path, "cannot be read as HDR");
  out.values.assign(values.get(), values.get() + static_cast<size_t>(out.width) *
                                                     static_cast<size_t>(out.height) *
                                                     static_cast<size_t>(out.channels));
  return out;
}

int64_t big_endian(const std::string& bytes, size_t at) {
  int64_t n = 0;
  for (size_t i = at; i < at + 4; ++i) n = n << 8 | static_cast<unsigned char>(bytes[i]);
  return n;
}

// A PNG without its chunks of no data: they may stand anywhere, and the library has no room to copy
// the first one to.
std::string without_empty_data(const std::string& bytes) {
  constexpr size_t kSignature = 8, kAround = 12;  // of a chunk: length, name, CRC
  std::string out = bytes.substr(0, kSignature);
  size_t at = kSignature;
  while (bytes.size() - at >= kAround) {
    const auto length = static_cast<uint64_t>(big_endian(bytes, at));
    if (length > bytes.size() - at - kAround) break;
    const size_t end = at + kAround + static_cast<size_t>(length);
    if (length > 0 || bytes.compare(at + 4, 4, "IDAT") != 0) out.append(bytes, at, end - at);
    at = end;
  }
  return out.append(bytes, at);
}

bool is_png(const std::string& bytes) { return bytes.compare(0, 8, "\x89PNG\r\n\x1a\n") == 0; }

}  // namespace

Picture read_picture(const std::string& path) {
  std::string bytes = read_file(path);
  if (is_png(bytes)) bytes = without_empty_data(bytes);
  if (bytes.compare(0, 4, "\x76\x2f\x31\x01") == 0) return from_exr(path);
  if (bytes.compare(0, 2, "\xff\xd8") == 0) return from_jpeg(path, bytes);
  if (bytes.size() > INT_MAX) fail_picture(path, "is larger than 2 GiB");
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(bytes.size());
  // The library's own limit has no message of its own.
  if (bytes.size() >= 24 && is_png(bytes))
    check_size(path, big_endian(bytes, 16), big_endian(bytes, 20));
  Picture out;
  if (!stbi_info_from_memory(data, size, &out.width, &out.height, &out.channels))
    fail_library(path, "cannot be read as PNG, JPEG, TGA, BMP, HDR or EXR");
  check_size(path, out.width, out.height);
  check_bytes(path, out, bytes.size());
  int width = 0, height = 0;
  if (stbi_is_hdr_from_memory(data, size)) return from_hdr(path, bytes);
  if (stbi_is_16_bit_from_memory(data, size)) {
    stbi_us* values = stbi_load_16_from_memory(data, size, &width, &height, &out.channels, 0);
    if (!values) fail_library(path, "cannot be read");
    out.integers = true;
    take(out, values, 65535);
  } else {
    stbi_uc* values = stbi_load_from_memory(data, size, &width, &height, &out.channels, 0);
    if (!values) fail_library(path, "cannot be read");
    out.integers = true;
    take(out, values, 255);
  }
  return out;
}

}  // namespace photonloom
