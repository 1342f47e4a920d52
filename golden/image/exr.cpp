// SPDX-License-Identifier: Apache-2.0
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfVersion.h>
#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <stdexcept>

#include "golden/image/image.hpp"
#include "golden/numeric/output_file.hpp"
#include "golden/numeric/text.hpp"

namespace photonloom {
namespace {

constexpr int64_t kMaxPixels = int64_t{1} << 28;

// The library writes to memory, so that each error of the file system is seen by OutputFile.
class MemoryOutput final : public Imf::OStream {
 public:
  MemoryOutput() : Imf::OStream("image") {}
  void write(const char c[], int n) override {
    const size_t end = position_ + static_cast<size_t>(n);
    if (end > bytes.size()) bytes.resize(end);
    std::memcpy(bytes.data() + position_, c, static_cast<size_t>(n));
    position_ = end;
  }
  uint64_t tellp() override { return position_; }
  void seekp(uint64_t position) override { position_ = static_cast<size_t>(position); }
  std::string bytes;

 private:
  size_t position_ = 0;
};

class MemoryInput final : public Imf::IStream {
 public:
  explicit MemoryInput(const std::string& bytes) : Imf::IStream("image"), bytes_(bytes) {}
  bool read(char c[], int n) override {
    if (n < 0 || position_ > bytes_.size() || static_cast<size_t>(n) > bytes_.size() - position_)
      throw std::runtime_error("the file ends too early");
    std::memcpy(c, bytes_.data() + position_, static_cast<size_t>(n));
    position_ += static_cast<size_t>(n);
    return position_ < bytes_.size();
  }
  uint64_t tellg() override { return position_; }
  void seekg(uint64_t position) override { position_ = static_cast<size_t>(position); }

 private:
  const std::string& bytes_;
  size_t position_ = 0;
};

[[noreturn]] void fail(const std::string& path, const std::string& reason) {
  throw std::runtime_error(path + ": " + reason);
}

// What a file that is no EXR looks like, for the error message.
std::string described(const std::string& bytes) {
  if (bytes.empty()) return "is empty";
  if (bytes.compare(0, 4, "\x89PNG") == 0) return "is a PNG";
  if (bytes.compare(0, 2, "\xff\xd8") == 0) return "is a JPEG";
  if (bytes.compare(0, 2, "#?") == 0) return "is a Radiance HDR file";
  if (bytes.compare(0, 2, "PF") == 0 || bytes.compare(0, 2, "Pf") == 0) return "is a PFM";
  return "begins otherwise";
}

uint32_t little_endian(const std::string& bytes, size_t at) {
  uint32_t value = 0;
  for (size_t i = 0; i < 4; ++i) value |= uint32_t{static_cast<uint8_t>(bytes[at + i])} << (8 * i);
  return value;
}

// Bytes of an attribute of a type that has always as many.
std::optional<uint32_t> size_of_type(const std::string& type) {
  constexpr std::pair<const char*, uint32_t> kSizes[] = {
      {"box2f", 16},      {"box2i", 16},   {"chromaticities", 32},
      {"compression", 1}, {"double", 8},   {"envmap", 1},
      {"float", 4},       {"int", 4},      {"keycode", 28},
      {"lineOrder", 1},   {"m33d", 72},    {"m33f", 36},
      {"m44d", 128},      {"m44f", 64},    {"rational", 8},
      {"tiledesc", 9},    {"timecode", 8}, {"v2d", 16},
      {"v2f", 8},         {"v2i", 8},      {"v3d", 24},
      {"v3f", 12},        {"v3i", 12},     {"deepImageState", 1}};
  for (const auto& [name, size] : kSizes)
    if (type == name) return size;
  return std::nullopt;
}

// The library makes room for what a header claims before it reads it, so what goes beyond the file
// is refused first, also of a header that is cut short. A file of several parts has a header each.
void check_headers(const std::string& bytes, const std::string& path) {
  const bool parts = bytes.size() > 5 && (bytes[5] & 0x10);
  const auto behind_text = [&](size_t at) {
    const size_t end = bytes.find('\0', at);
    return end == std::string::npos ? bytes.size() : end + 1;
  };
  int64_t width = 0, height = 0, channels = 1;
  const auto check = [&] {
    if (width <= 0 || height <= 0) return;
    if (width > kMaxPixels / height)
      fail(path, fmt::format("has {} x {} pixels, expected at most 2^28", width, height));
    // No compression makes so much of so little.
    if (width * height > (int64_t{1} << 14) * static_cast<int64_t>(bytes.size()) / channels)
      fail(path, fmt::format("has {} x {} pixels in {} channels, more than its {} bytes can hold",
                             width, height, channels, bytes.size()));
  };
  for (size_t at = 8; at < bytes.size();) {
    if (bytes[at] == '\0') {  // the end of a header
      check();
      ++at;
      if (!parts || at >= bytes.size() || bytes[at] == '\0') return;
      continue;
    }
    const size_t type = behind_text(at), size_at = behind_text(type), data = size_at + 4;
    if (bytes.size() < data) break;
    const std::string name = bytes.substr(at, type - at - 1), named = shown(name);
    const uint32_t size = little_endian(bytes, size_at);
    if (size > bytes.size() - data)
      fail(path,
           fmt::format("attribute {} of a header claims {} bytes, expected at most the {} that "
                       "follow",
                       named, size, bytes.size() - data));
    // The library reads what a type takes, whatever size stands there, and would go on elsewhere.
    const std::string kind = bytes.substr(type, size_at - type - 1);
    if (const auto fixed = size_of_type(kind); fixed && *fixed != size)
      fail(path, fmt::format("attribute {} of a header claims {} bytes, expected the {} of type {}",
                             named, size, *fixed, kind));
    if (kind == "chlist") {
      size_t c = data;
      while (c < data + size && bytes[c] != '\0') c = behind_text(c) + 16;
      if (c + 1 != data + size)
        fail(path, fmt::format("attribute {} of a header claims {} bytes, expected the end of its "
                               "list of channels there",
                               named, size));
    }
    if (name == "dataWindow" && size == 16) {
      const auto corner = [&](size_t i) {
        return static_cast<int64_t>(static_cast<int32_t>(little_endian(bytes, data + 4 * i)));
      };
      width = corner(2) - corner(0) + 1;
      height = corner(3) - corner(1) + 1;
    } else if (name == "channels") {  // a name and 16 bytes each
      channels = 0;
      for (size_t c = data; c < data + size && bytes[c] != '\0'; c = behind_text(c) + 16)
        ++channels;
      channels = std::max<int64_t>(channels, 1);
    }
    at = data + size;
  }
  check();
}

// The library addresses pixel (x, y) of the data window as base + 4 x + stride y. The base of a
// window far from 0 lies outside of memory, so it is counted as a number, where wrapping is
// defined.
char* base_of(std::vector<float>& pixels, int64_t min_x, int64_t min_y, int64_t stride) {
  const auto to_first = static_cast<uint64_t>(min_x * int64_t{sizeof(float)} + min_y * stride);
  return reinterpret_cast<char*>(reinterpret_cast<uintptr_t>(pixels.data()) - to_first);
}

}  // namespace

void write_exr(const Image& image, const std::string& path) {
  OutputFile file(path);  // first, so that an unwritable path is refused before any work
  Imf::Header header(image.width, image.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::addChromaticities(header, Imf::Chromaticities());  // Rec.709
  for (const auto& [name, text] : image.metadata) header.insert(name, Imf::StringAttribute(text));
  Imf::FrameBuffer frame;
  for (const Channel& c : image.channels) {
    if (c.pixels.size() != static_cast<size_t>(image.width) * static_cast<size_t>(image.height))
      fail(path, fmt::format("channel {} has {} pixels, expected {} x {}", c.name, c.pixels.size(),
                             image.width, image.height));
    header.channels().insert(c.name, Imf::Channel(Imf::FLOAT));
    frame.insert(
        c.name,
        Imf::Slice(Imf::FLOAT, const_cast<char*>(reinterpret_cast<const char*>(c.pixels.data())),
                   sizeof(float), sizeof(float) * static_cast<size_t>(image.width)));
  }
  MemoryOutput output;
  try {
    Imf::OutputFile exr(output, header);
    exr.setFrameBuffer(frame);
    exr.writePixels(image.height);
  } catch (const std::exception& error) {
    fail(path, fmt::format("cannot be written as EXR: {}", error.what()));
  }
  file.write(output.bytes);
  file.commit();
}

Image read_exr(const std::string& path) {
  const std::string bytes = read_file(path);
  if (bytes.size() < 4 || !Imf::isImfMagic(bytes.data()))
    fail(path, fmt::format("is not an OpenEXR file: it {}", described(bytes)));
  check_headers(bytes, path);
  Image image;
  try {
    MemoryInput input(bytes);
    Imf::InputFile exr(input);
    const Imf::Header& header = exr.header();
    const Imath::Box2i window = header.dataWindow();
    const int64_t width = int64_t{window.max.x} - window.min.x + 1;
    const int64_t height = int64_t{window.max.y} - window.min.y + 1;
    if (width <= 0 || height <= 0 || width > kMaxPixels / height)
      fail(path, fmt::format("has {} x {} pixels, expected at most 2^28", width, height));
    image.width = static_cast<int>(width);
    image.height = static_cast<int>(height);
    const int64_t stride = width * static_cast<int64_t>(sizeof(float));
    Imf::FrameBuffer frame;
    size_t count = 0;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) ++count;
    image.channels.reserve(count);  // slices point into it
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
      if (c.channel().xSampling != 1 || c.channel().ySampling != 1)
        fail(path, fmt::format("channel {} is subsampled, expected one value per pixel", c.name()));
      frame.insert(c.name(), Imf::Slice(Imf::FLOAT,
                                        base_of(image.add(c.name()).pixels, window.min.x,
                                                window.min.y, stride),
                                        sizeof(float), static_cast<size_t>(stride)));
    }
    exr.setFrameBuffer(frame);
    exr.readPixels(window.min.y, window.max.y);
    for (auto a = header.begin(); a != header.end(); ++a)
      if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute()))
        image.metadata[a.name()] = text->value();
  } catch (const std::exception& error) {
    const std::string what = error.what();
    if (what.compare(0, path.size() + 1, path + ":") == 0) throw;
    fail(path, fmt::format("cannot be read as EXR: {}", what));
  }
  return image;
}

}  // namespace photonloom
