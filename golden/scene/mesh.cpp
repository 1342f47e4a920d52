// SPDX-License-Identifier: Apache-2.0
#include "golden/scene/mesh.hpp"

#include <fmt/core.h>

#include <bit>
#include <cmath>
#include <limits>

#include "golden/numeric/elementary.hpp"
#include "golden/numeric/output_file.hpp"
#include "golden/numeric/random.hpp"
#include "golden/scene/ply.hpp"
#include "golden/scene/text.hpp"

namespace photonloom {
// |cross| within the error of a cross product of edges whose ends are rounded coordinates.
bool no_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = b - a, v = c - a;
  const double edge = std::sqrt(std::max(glm::dot(u, u), glm::dot(v, v)));
  const double coordinate =
      max_component(glm::max(glm::max(glm::abs(a), glm::abs(b)), glm::abs(c)));
  const double error = 8 * std::numeric_limits<double>::epsilon() * coordinate * edge;
  return !(glm::length(glm::cross(u, v)) > error);
}

namespace {

bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// Splits a polygon into a fan. A corner that lies on an edge of a larger polygon gives a triangle
// without area, which is left out; a polygon without any area is refused. `place()` says where it
// stands.
template <class Place>
void add_polygon(Mesh& mesh, const std::vector<uint32_t>& corners, Place&& place) {
  bool any = false;
  for (size_t i = 2; i < corners.size(); ++i) {
    const std::array<uint32_t, 3> t = {corners[0], corners[i - 1], corners[i]};
    if (no_area(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]])) continue;
    mesh.triangles.push_back(t);
    any = true;
  }
  if (!any)
    throw SceneError(fmt::format("{}: the face has no area, expected a proper triangle", place()));
}

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

// Words between blanks, into a list whose room is used again.
void split_at_blanks(std::string_view line, std::vector<std::string_view>& words) {
  const auto blank = [](char c) { return c == ' ' || c == '\t'; };
  words.clear();
  for (const char *at = line.data(), *const end = at + line.size();;) {
    while (at != end && blank(*at)) ++at;
    if (at == end) return;
    const char* const begin = at;
    while (at != end && !blank(*at)) ++at;
    words.emplace_back(begin, static_cast<size_t>(at - begin));
  }
}

// OBJ, line by line.
class ObjReader {
 public:
  ObjReader(const std::string& path, const std::string& bytes) : path_(path), bytes_(bytes) {}

  MeshFile read() {
    std::string joined;
    std::string_view line;
    std::vector<std::string_view> words;
    while (next_line(line, joined)) {
      split_at_blanks(line, words);
      if (!words.empty() && words[0][0] != '#') statement(words);
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
        fail(fmt::format("'{}' is not a finite number", std::string(words[i + 1].substr(0, 40))));
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
      fail(fmt::format("'{}' is not supported in an OBJ file", std::string(key.substr(0, 40))));
    }
  }

  // A one-based or negative (from the end) index.
  uint32_t index(std::string_view text, size_t count, const char* what) const {
    const auto i = parse_integer(text);
    const int64_t n = static_cast<int64_t>(count);
    if (!i || *i == 0 || *i > n || *i < -n)
      fail(fmt::format("'{}' is not the number of a {}, expected 1 to {}",
                       std::string(text.substr(0, 40)), what, count));
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
                           std::string(words[w].substr(0, 40))));
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
  size_t at_ = 0, line_ = 0;
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

Mesh rectangle_mesh() {
  Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  return mesh;
}

Mesh cube_mesh() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.positions.push_back({i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1});
  // Per face four corners, counter-clockwise from outside.
  constexpr uint32_t kFaces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                     {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  // Mitsuba's coordinates of each face's corners, in the order of kFaces.
  const Vec2 at[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  constexpr size_t kCoordinates[6][4] = {{1, 0, 3, 2}, {0, 3, 2, 1}, {0, 3, 2, 1},
                                         {2, 1, 0, 3}, {0, 3, 2, 1}, {3, 2, 1, 0}};
  for (size_t i = 0; i < 6; ++i) {
    const auto& f = kFaces[i];
    const auto& c = kCoordinates[i];
    mesh.triangles.push_back({f[0], f[1], f[2]});
    mesh.triangles.push_back({f[0], f[2], f[3]});
    mesh.corner_uvs.push_back({at[c[0]], at[c[1]], at[c[2]]});
    mesh.corner_uvs.push_back({at[c[0]], at[c[2]], at[c[3]]});
  }
  return mesh;
}

MeshFile read_obj(const std::string& path) { return ObjReader(path, read_file(path)).read(); }

namespace {

// u, v or s, t, as exporters spell them.
void read_ply_coordinates(const PlyElement& vertex, const std::string& path, Mesh& mesh) {
  for (const auto& [u, v] :
       {std::pair("u", "v"), std::pair("s", "t"), std::pair("texture_u", "texture_v")}) {
    if (!vertex.find(u) || !vertex.find(v)) continue;
    const auto &x = vertex.scalar(u, path), &y = vertex.scalar(v, path);
    for (size_t i = 0; i < vertex.rows; ++i) {
      mesh.uvs.emplace_back(x[i], y[i]);
      if (!std::isfinite(x[i]) || !std::isfinite(y[i]))
        throw SceneError(fmt::format(
            "{}: texture coordinates of vertex {} are not finite, expected finite ones", path, i));
    }
    return;
  }
}

// red, green, blue or r, g, b; integers over their largest.
void read_ply_colors(const PlyElement& vertex, const std::string& path, Mesh& mesh) {
  constexpr const char* kNames[][3] = {
      {"red", "green", "blue"}, {"diffuse_red", "diffuse_green", "diffuse_blue"}, {"r", "g", "b"}};
  for (const auto& names : kNames) {
    const PlyColumn* column = vertex.find(names[0]);
    if (!column || column->is_list || !vertex.find(names[1]) || !vertex.find(names[2])) continue;
    const double largest = column->type == PlyType::kUint8    ? 255
                           : column->type == PlyType::kUint16 ? 65535
                                                              : 1;
    mesh.colors.resize(vertex.rows);
    for (int c = 0; c < 3; ++c) {
      const auto& values = vertex.scalar(names[c], path);
      for (size_t i = 0; i < vertex.rows; ++i) {
        mesh.colors[i][c] = values[i] / largest;
        if (!(values[i] >= 0) || !std::isfinite(values[i]))
          throw SceneError(
              fmt::format("{}: color {} of vertex {} is {}, expected a finite number of at least 0",
                          path, names[c], i, values[i]));
      }
    }
    return;
  }
}

}  // namespace

MeshFile read_ply_mesh(const std::string& path) {
  const PlyTable table = read_ply(path);
  const PlyElement* vertex = table.find("vertex");
  const PlyElement* face = table.find("face");
  if (!vertex || !face || face->rows == 0)
    throw SceneError(fmt::format("{}: no {}, expected a mesh with elements 'vertex' and 'face'",
                                 path, vertex ? "faces" : "element 'vertex'"));
  MeshFile out;
  const auto& x = vertex->scalar("x", path);
  const auto& y = vertex->scalar("y", path);
  const auto& z = vertex->scalar("z", path);
  const bool has_normals = vertex->find("nx") || vertex->find("ny") || vertex->find("nz");
  const std::vector<double>* n[3] = {};
  const char* const names[] = {"nx", "ny", "nz"};
  for (int i = 0; i < 3 && has_normals; ++i) n[i] = &vertex->scalar(names[i], path);
  for (size_t i = 0; i < vertex->rows; ++i) {
    out.mesh.positions.emplace_back(x[i], y[i], z[i]);
    if (has_normals) out.mesh.normals.emplace_back((*n[0])[i], (*n[1])[i], (*n[2])[i]);
    if (!is_finite(out.mesh.positions.back()) ||
        (has_normals && !is_finite(out.mesh.normals.back())))
      throw SceneError(
          fmt::format("{}: vertex {} is not finite, expected finite coordinates", path, i));
  }
  read_ply_coordinates(*vertex, path, out.mesh);
  read_ply_colors(*vertex, path, out.mesh);
  const PlyColumn* corners = face->find("vertex_indices");
  if (!corners) corners = face->find("vertex_index");
  if (!corners || !corners->is_list)
    throw SceneError(fmt::format("{}: element 'face' has no property list 'vertex_indices'", path));
  std::vector<uint32_t> polygon;
  for (uint64_t f = 0; f < face->rows; ++f) {
    const auto place = [&] { return fmt::format("{}: face {}", path, f); };
    polygon.clear();
    for (uint64_t i = corners->starts[f]; i < corners->starts[f + 1]; ++i) {
      const double v = corners->values[i];
      if (!(v >= 0 && v < static_cast<double>(vertex->rows)) || v != std::floor(v))
        throw SceneError(fmt::format("{}: vertex number {} does not exist, expected 0 to {}",
                                     place(), v, static_cast<int64_t>(vertex->rows) - 1));
      polygon.push_back(static_cast<uint32_t>(v));
    }
    if (polygon.size() < 3)
      throw SceneError(fmt::format("{}: the face has {} vertices, expected at least 3", place(),
                                   polygon.size()));
    add_polygon(out.mesh, polygon, place);
  }
  return out;
}

void add_smooth_normals(Mesh& mesh) {
  std::vector<Vec3> smooth(mesh.positions.size(), Vec3(0));
  for (const auto& t : mesh.triangles) {
    const Vec3 p[3] = {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
    const Vec3 normal = glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0]));
    for (size_t i = 0; i < 3; ++i) {
      const Vec3 a = p[(i + 1) % 3] - p[i], b = p[(i + 2) % 3] - p[i];
      smooth[t[i]] += normal * angle_of(glm::dot(a, b), glm::length(glm::cross(a, b)));
    }
  }
  const bool none = mesh.normals.empty();
  if (none) mesh.normals.resize(mesh.positions.size(), Vec3(0));
  for (size_t i = 0; i < smooth.size(); ++i) {
    if (mesh.normals[i] != Vec3(0)) continue;
    const double length = glm::length(smooth[i]);
    // Vertices of no triangle and perfectly opposed faces have no normal of their own.
    mesh.normals[i] = length > 0 ? smooth[i] / length : Vec3(0, 0, 1);
  }
}

Vec3 carried_normal(const glm::dmat3& inverse_transpose, const Vec3& normal) {
  Vec3 n = inverse_transpose * normal;
  // Scaled by the largest component first: lengths must neither underflow nor overflow.
  n /= max_component(glm::abs(n));
  return n / glm::length(n);
}

void place_mesh(Mesh& mesh, const MeshPlacement& placement, const std::string& what) {
  const glm::dmat3 linear(placement.to_world);
  for (Vec3& p : mesh.positions) {
    p = Vec3(placement.to_world * glm::dvec4(p, 1));
    if (!is_finite(p))
      throw SceneError(fmt::format("{}: a vertex in the world is not finite", what));
  }
  if (placement.faceted) mesh.normals.clear();
  const glm::dmat3 inverse_transpose = glm::transpose(glm::inverse(linear));
  for (Vec3& n : mesh.normals) {
    if (n != Vec3(0)) n = carried_normal(inverse_transpose, n);
  }
  const bool mirrored = glm::determinant(linear) < 0;
  const auto turn_round = [&](size_t i) {
    std::swap(mesh.triangles[i][1], mesh.triangles[i][2]);
    if (!mesh.corner_uvs.empty()) std::swap(mesh.corner_uvs[i][1], mesh.corner_uvs[i][2]);
  };
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    const Vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    const Vec3 normal = glm::cross(b - a, c - a);
    if (!(glm::length(normal) > 0)) throw SceneError(fmt::format("{}: a triangle collapses", what));
    bool turn = placement.outward && mirrored;
    if (!mesh.normals.empty()) {
      const Vec3 sum = mesh.normals[t[0]] + mesh.normals[t[1]] + mesh.normals[t[2]];
      turn = glm::dot(normal, sum) < 0;
    }
    if (turn) turn_round(i);
  }
  if (!placement.faceted) add_smooth_normals(mesh);
  if (placement.flip) {
    for (size_t i = 0; i < mesh.triangles.size(); ++i) turn_round(i);
    for (Vec3& n : mesh.normals) n = -n;
  }
}

}  // namespace photonloom
