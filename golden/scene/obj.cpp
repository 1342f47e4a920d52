// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <bit>
#include <cmath>

#include "golden/numeric/output_file.hpp"
#include "golden/numeric/random.hpp"
#include "golden/numeric/text.hpp"
#include "golden/scene/mesh.hpp"
#include "golden/scene/polygon.hpp"

namespace photonloom {
namespace {

// The vertices of an OBJ file: those that differ in nothing are one.
class ObjVertices {
 public:
  // The number of this vertex in the mesh, to which it is added where it is new.
  uint32_t number(Mesh& mesh, uint32_t group, const Vec3& p, const Vec3& n, const Vec2& t) {
    if (2 * groups_.size() >= slots_.size()) grow(mesh);
    size_t slot = hash(group, p, n, t) & (slots_.size() - 1);
    for (; slots_[slot] != kFree; slot = (slot + 1) & (slots_.size() - 1)) {
      const uint32_t v = slots_[slot];
      if (mesh.positions[v] == p && mesh.normals[v] == n && mesh.uvs[v] == t && groups_[v] == group)
        return v;
    }
    const auto added = static_cast<uint32_t>(groups_.size());
    slots_[slot] = added;
    groups_.push_back(group);
    mesh.positions.push_back(p);
    mesh.normals.push_back(n);
    mesh.uvs.push_back(t);
    return added;
  }

 private:
  static constexpr uint32_t kFree = ~0u;

  static uint64_t hash(uint32_t group, const Vec3& p, const Vec3& n, const Vec2& t) {
    uint64_t h = group;
    for (const double x : {p.x, p.y, p.z, n.x, n.y, n.z, t.x, t.y}) {
      // 0 and -0 are equal.
      const auto bits = std::bit_cast<uint64_t>(x + 0.0);
      h = (std::rotl(h, 29) ^ bits) * 0x9e3779b97f4a7c15ull;
    }
    return mix64(h);
  }

  void grow(const Mesh& mesh) {
    slots_.assign(std::max<size_t>(1024, 4 * slots_.size()), kFree);
    for (uint32_t v = 0; v < groups_.size(); ++v) {
      size_t slot =
          hash(groups_[v], mesh.positions[v], mesh.normals[v], mesh.uvs[v]) & (slots_.size() - 1);
      while (slots_[slot] != kFree) slot = (slot + 1) & (slots_.size() - 1);
      slots_[slot] = v;
    }
  }

  std::vector<uint32_t> slots_;   // open addressing: numbers of vertices; a power of two of them
  std::vector<uint32_t> groups_;  // of each vertex
};

// Words between blanks up to a comment, into a list whose room is used again.
void split_at_blanks(std::string_view line, std::vector<std::string_view>& words) {
  const auto blank = [](char c) { return c == ' ' || c == '\t'; };
  words.clear();
  for (const char *at = line.data(), *const end = at + line.size();;) {
    while (at != end && blank(*at)) ++at;
    if (at == end || *at == '#') return;
    const char* const begin = at;
    while (at != end && !blank(*at)) ++at;
    words.emplace_back(begin, static_cast<size_t>(at - begin));
  }
}

// OBJ, line by line.
class ObjReader {
 public:
  ObjReader(const std::string& path, const std::string& bytes)
      : path_(path), bytes_(bytes), at_(bytes.starts_with("\xEF\xBB\xBF") ? 3 : 0) {}

  MeshFile read() {
    std::string joined;
    std::string_view line;
    std::vector<std::string_view> words;
    while (next_line(line, joined)) {
      split_at_blanks(line, words);
      if (!words.empty()) statement(words);
    }
    if (out_.mesh.triangles.empty())
      throw SceneError(fmt::format("{}: the file has no faces, expected at least one", path_));
    if (!any_normal_) out_.mesh.normals.clear();
    if (coordinates_.empty()) out_.mesh.uvs.clear();
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw SceneError(fmt::format("{}:{}: {}", path_, line_, what));
  }

  // The next line without its end; a backslash at the end joins the one after it.
  bool next_line(std::string_view& line, std::string& joined) {
    if (at_ >= bytes_.size()) return false;
    joined.clear();
    for (;;) {
      ++line_;
      const size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
      line = std::string_view(bytes_).substr(at_, end - at_);
      at_ = end + 1;
      if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
      if (line.empty() || line.back() != '\\' || at_ >= bytes_.size()) break;
      joined.append(line.substr(0, line.size() - 1)) += ' ';
    }
    if (!joined.empty()) line = joined.append(line);
    return true;
  }

  Vec3 numbers(const std::vector<std::string_view>& words, size_t count) const {
    if (words.size() < count + 1)
      fail(fmt::format("'{}' has {} numbers, expected {}", words[0], words.size() - 1, count));
    Vec3 v(0);
    for (size_t i = 0; i < count; ++i) {
      const auto value = parse_double(words[i + 1]);
      if (!value || !std::isfinite(*value))
        fail(fmt::format("'{}' is not a finite number", shown(words[i + 1])));
      v[static_cast<int>(i)] = *value;
    }
    return v;
  }

  void statement(const std::vector<std::string_view>& words) {
    const std::string_view key = words[0];
    if (key == "v") {
      positions_.push_back(numbers(words, 3));
    } else if (key == "vn") {
      normals_.push_back(numbers(words, 3));
    } else if (key == "vt") {
      const Vec3 t = numbers(words, words.size() > 2 ? 2 : 1);
      coordinates_.push_back({t.x, t.y});
    } else if (key == "f") {
      face(words);
    } else if (key == "g" || key == "o") {
      ++group_;
    } else if (key == "usemtl") {
      out_.names_materials = true;
    } else if (key != "mtllib" && key != "s" && key != "l" && key != "p" && key != "vp" &&
               key != "mg" && key != "lod" && key != "usemap" && key != "maplib" &&
               key != "bevel" && key != "c_interp" && key != "d_interp") {
      // What stands in this list has no surface; free-form surfaces do.
      fail(fmt::format("'{}' is not supported in an OBJ file", shown(key)));
    }
  }

  // A one-based or negative (from the end) index.
  uint32_t index(std::string_view text, size_t count, const char* what) const {
    const auto i = parse_integer(text);
    const int64_t n = static_cast<int64_t>(count);
    if (i && n == 0)
      fail(fmt::format("'{}' is the number of a {}, but there is none above this line", shown(text),
                       what));
    if (!i || *i == 0 || *i > n || *i < -n)
      fail(fmt::format("'{}' is not the number of a {}, expected 1 to {}", shown(text), what,
                       count));
    return static_cast<uint32_t>(*i > 0 ? *i - 1 : n + *i);
  }

  void face(const std::vector<std::string_view>& words) {
    if (words.size() < 4)
      fail(fmt::format("the face has {} vertices, expected at least 3", words.size() - 1));
    corners_.clear();
    for (size_t w = 1; w < words.size(); ++w) {
      // v, v/t, v//n or v/t/n
      std::string_view part[3];
      std::string_view rest = words[w];
      for (int i = 0; i < 3; ++i) {
        const size_t slash = rest.find('/');
        part[i] = rest.substr(0, slash);
        rest = slash == std::string_view::npos ? std::string_view() : rest.substr(slash + 1);
        if (i == 2 && slash != std::string_view::npos)
          fail(fmt::format("'{}' is not a face vertex, expected v, v/t, v//n or v/t/n",
                           shown(words[w])));
      }
      const uint32_t v = index(part[0], positions_.size(), "vertex");
      Corner c{.group = group_};
      if (!part[1].empty()) c.t = index(part[1], coordinates_.size(), "texture vertex");
      if (!part[2].empty()) c.n = index(part[2], normals_.size(), "normal");
      corners_.push_back(number(v, c));
    }
    add_polygon(out_.mesh, corners_, [&] { return fmt::format("{}:{}", path_, line_); });
  }

  // Of a face vertex: all but the position.
  static constexpr uint32_t kNone = ~0u;
  struct Corner {
    uint32_t t = kNone, n = kNone, group = kNone;
    bool operator==(const Corner&) const = default;
  };
  struct Last {
    Corner corner;
    uint32_t vertex = kNone;
  };

  // The vertex of the mesh. Mostly it is the one that this position was last.
  uint32_t number(uint32_t v, const Corner& c) {
    last_.resize(positions_.size());
    auto& [corner, vertex] = last_[v];
    if (vertex != kNone && corner == c) return vertex;
    const Vec3 n = c.n == kNone ? Vec3(0) : normals_[c.n];
    any_normal_ = any_normal_ || n != Vec3(0);
    corner = c;
    return vertex = vertices_.number(out_.mesh, group_, positions_[v], n,
                                     c.t == kNone ? Vec2(0) : coordinates_[c.t]);
  }

  const std::string& path_;
  const std::string& bytes_;
  size_t at_;  // behind the mark that some editors write in front
  size_t line_ = 0;
  std::vector<Vec3> positions_, normals_;
  std::vector<Vec2> coordinates_;
  ObjVertices vertices_;
  std::vector<Last> last_;         // of each position
  std::vector<uint32_t> corners_;  // of the face that is read
  uint32_t group_ = 0;
  bool any_normal_ = false;
  MeshFile out_;
};

}  // namespace

MeshFile read_obj(const std::string& path) { return ObjReader(path, read_file(path)).read(); }

}  // namespace photonloom
