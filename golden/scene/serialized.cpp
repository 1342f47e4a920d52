// SPDX-License-Identifier: Apache-2.0
// Format: Mitsuba 0.6 documentation, section "Serialized mesh loader". Little-endian. A mesh is the
// 16-bit words 0x041C and version (3 or 4), then a zlib stream of: 32-bit flags; version 4: a name
// up to its zero byte; 64-bit counts of vertices and triangles; positions, then as the flags say
// normals, texture coordinates and colors, in single or double precision; triangles as three
// numbers of vertices. The file ends with the offset of each mesh (version 4: 64 bits, 3: 32 bits)
// and their 32-bit number.
#include "golden/scene/serialized.hpp"

#include <fmt/core.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <vector>

#include "golden/numeric/output_file.hpp"

namespace photonloom {
namespace {

constexpr uint16_t kMagic = 0x041C;
constexpr uint32_t kHasNormals = 0x0001, kHasCoordinates = 0x0002, kHasColors = 0x0008,
                   kFaceNormals = 0x0010, kSingle = 0x1000, kDouble = 0x2000;
// zlib's best is 1032 bytes out of one.
constexpr uint64_t kMostExpansion = 1040;

static_assert(std::endian::native == std::endian::little);

template <class T>
T word_at(const std::string& bytes, size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

// A zlib stream, inflated as far as asked.
class Inflated {
 public:
  Inflated(std::string path, std::string_view bytes) : path_(std::move(path)) {
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    rest_ = bytes.size();
    if (inflateInit(&stream_) != Z_OK) fail("zlib cannot start");
  }
  ~Inflated() { inflateEnd(&stream_); }
  Inflated(const Inflated&) = delete;
  Inflated& operator=(const Inflated&) = delete;

  [[noreturn]] void fail(const std::string& what) const {
    throw SceneError(fmt::format("{}: {}", path_, what));
  }

  void read(void* to, size_t size) {
    auto* out = static_cast<Bytef*>(to);
    while (size > 0) {
      constexpr size_t kMost = size_t{1} << 30;
      const size_t in = std::min(rest_, kMost), room = std::min(size, kMost);
      stream_.avail_in = static_cast<uInt>(in);
      stream_.next_out = out;
      stream_.avail_out = static_cast<uInt>(room);
      const int result = inflate(&stream_, Z_NO_FLUSH);
      rest_ -= in - stream_.avail_in;
      const size_t made = room - stream_.avail_out;
      out += made;
      size -= made;
      if (result == Z_OK && (made > 0 || in > stream_.avail_in)) continue;
      if (result == Z_STREAM_END && size == 0) break;
      fail(result == Z_DATA_ERROR ? "the compressed data are damaged"
                                  : "the data end within the mesh");
    }
  }
  template <class T>
  T word() {
    T value;
    read(&value, sizeof value);
    return value;
  }

 private:
  std::string path_;
  z_stream stream_{};
  size_t rest_ = 0;
};

class SerializedReader {
 public:
  SerializedReader(const std::string& path, std::string_view bytes, int version, int64_t index)
      : in_(path, bytes), bytes_(bytes.size()), version_(version), index_(index) {}

  MeshFile read() {
    const auto flags = in_.word<uint32_t>();
    if (version_ >= 4) skip_name();
    const bool single = flags & kSingle;
    if (single == ((flags & kDouble) != 0))
      in_.fail(fmt::format("mesh {} has the flags {:#x}, expected single or double precision",
                           index_, flags));
    const auto vertices = in_.word<uint64_t>(), triangles = in_.word<uint64_t>();
    if (triangles == 0) in_.fail(fmt::format("mesh {} has no triangles", index_));
    const uint64_t most = kMostExpansion * bytes_;
    if (vertices > most / 12 || triangles > most / 12 || vertices > ~uint32_t{0})
      in_.fail(
          fmt::format("mesh {} claims {} vertices and {} triangles, more than its {} bytes hold",
                      index_, vertices, triangles, bytes_));
    MeshFile out;
    Mesh& mesh = out.mesh;
    out.faceted = flags & kFaceNormals;
    const auto triples = [&](const char* what) {
      return single ? values<float, 3>(vertices, what) : values<double, 3>(vertices, what);
    };
    mesh.positions = triples("position");
    if (flags & kHasNormals) mesh.normals = triples("normal");
    if (flags & kHasCoordinates) {
      for (const Vec3& t : single ? values<float, 2>(vertices, "texture coordinate")
                                  : values<double, 2>(vertices, "texture coordinate"))
        mesh.uvs.emplace_back(t.x, t.y);
    }
    if (flags & kHasColors) {
      mesh.colors = triples("color");
      for (const Rgb& c : mesh.colors)
        for (int i = 0; i < 3; ++i)
          if (c[i] < 0) in_.fail(fmt::format("mesh {} has a negative color", index_));
    }
    std::vector<std::array<uint32_t, 3>> corners(std::min<uint64_t>(triangles, uint64_t{1} << 16));
    for (uint64_t first = 0; first < triangles; first += corners.size()) {
      const uint64_t count = std::min<uint64_t>(corners.size(), triangles - first);
      in_.read(corners.data(), count * sizeof corners[0]);
      for (uint64_t i = 0; i < count; ++i) {
        for (const uint32_t v : corners[i])
          if (v >= vertices)
            in_.fail(fmt::format("triangle {} of mesh {} has the vertex {}, expected 0 to {}",
                                 first + i, index_, v, vertices - 1));
        const auto& c = corners[i];
        if (no_area(mesh.positions[c[0]], mesh.positions[c[1]], mesh.positions[c[2]]))
          in_.fail(fmt::format("triangle {} of mesh {} has no area, expected a proper triangle",
                               first + i, index_));
        mesh.triangles.push_back(c);
      }
    }
    return out;
  }

 private:
  void skip_name() {
    for (int i = 0; i < 1 << 16; ++i)
      if (in_.word<char>() == 0) return;
    in_.fail(fmt::format("the name of mesh {} does not end", index_));
  }

  // In blocks, so that memory follows what the file really holds.
  template <class T, size_t kCount>
  std::vector<Vec3> values(uint64_t count, const char* what) {
    std::vector<Vec3> out;
    std::vector<std::array<T, kCount>> block(std::min<uint64_t>(count, uint64_t{1} << 16));
    for (uint64_t first = 0; first < count; first += block.size()) {
      const uint64_t n = std::min<uint64_t>(block.size(), count - first);
      in_.read(block.data(), n * sizeof block[0]);
      for (uint64_t i = 0; i < n; ++i) {
        Vec3 v(0);
        for (size_t c = 0; c < kCount; ++c) {
          v[static_cast<int>(c)] = static_cast<double>(block[i][c]);
          if (!std::isfinite(block[i][c]))
            in_.fail(fmt::format("{} {} of mesh {} is not finite", what, first + i, index_));
        }
        out.push_back(v);
      }
    }
    return out;
  }

  Inflated in_;
  uint64_t bytes_;
  int version_;
  int64_t index_;
};

}  // namespace

MeshFile read_serialized(const std::string& path, int64_t index) {
  const std::string bytes = read_file(path);
  const auto fail = [&](const std::string& what) {
    throw SceneError(fmt::format("{}: {}", path, what));
  };
  if (bytes.size() < 8 || word_at<uint16_t>(bytes, 0) != kMagic)
    fail("the file does not begin with 0x041C, expected a serialized mesh of Mitsuba 0.6");
  const int version = word_at<uint16_t>(bytes, 2);
  if (version != 3 && version != 4)
    fail(fmt::format("the file has the version {}, expected 3 or 4", version));
  const size_t word = version == 4 ? 8 : 4;
  const uint64_t count = word_at<uint32_t>(bytes, bytes.size() - 4);
  if (count == 0 || count > (bytes.size() - 8) / word)
    fail(fmt::format("the file says that it has {} meshes, more than its {} bytes hold", count,
                     bytes.size()));
  if (index < 0 || static_cast<uint64_t>(index) >= count)
    fail(fmt::format("mesh {} does not exist, expected a shapeIndex from 0 to {}", index,
                     count - 1));
  const size_t table = bytes.size() - 4 - count * word;
  const auto offset = [&](uint64_t i) -> uint64_t {
    const size_t at = table + i * word;
    return version == 4 ? word_at<uint64_t>(bytes, at) : word_at<uint32_t>(bytes, at);
  };
  const uint64_t begin = offset(static_cast<uint64_t>(index));
  if (begin > table || table - begin < 4)
    fail(fmt::format("mesh {} stands at byte {}, outside of the file's {}", index, begin,
                     bytes.size()));
  if (word_at<uint16_t>(bytes, begin) != kMagic || word_at<uint16_t>(bytes, begin + 2) != version)
    fail(fmt::format("mesh {} at byte {} does not begin with 0x041C and the file's version", index,
                     begin));
  return SerializedReader(path, std::string_view(bytes).substr(begin + 4, table - begin - 4),
                          version, index)
      .read();
}

}  // namespace photonloom
