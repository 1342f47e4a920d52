// SPDX-License-Identifier: Apache-2.0
#include "golden/unit/photon_file.hpp"

#include <fmt/core.h>

#include <charconv>
#include <cmath>
#include <set>
#include <sstream>

#include "golden/scene/ply.hpp"

namespace photonloom {
namespace {

constexpr double kPadding = 1 + 0x1p-16;
constexpr double kMostPower = 1e100;  // W: sums of as many photons as there can be stay finite

// Three columns of a file's vertices.
class Columns {
 public:
  Columns(const PlyElement& element, const std::array<const char*, 3>& names,
          const std::string& path, const char* what)
      : names_(names), path_(path) {
    for (size_t c = 0; c < 3; ++c) {
      if (!element.find(names[c]))
        throw SceneError(
            fmt::format("{}: the vertices have no property {}, expected {} as {}, {}, {}", path,
                        names[c], what, names[0], names[1], names[2]));
      values_[c] = &element.scalar(names[c], path);
    }
  }

  Vec3 at(size_t row) const {
    Vec3 v;
    for (int c = 0; c < 3; ++c) {
      v[c] = (*values_[static_cast<size_t>(c)])[row];
      if (!std::isfinite(v[c])) refuse(row, c, v[c], "a finite number");
    }
    return v;
  }
  Vec3 not_negative(size_t row, double most) const {
    const Vec3 v = at(row);
    for (int c = 0; c < 3; ++c) {
      if (v[c] < 0) refuse(row, c, v[c], "no negative number");
      if (v[c] > most) refuse(row, c, v[c], fmt::format("at most {}", most));
    }
    return v;
  }
  Vec3 not_zero(size_t row) const {
    const Vec3 v = at(row);
    if (v == Vec3(0))
      throw SceneError(fmt::format("{}: vertex {}: {}, {}, {} are all 0, expected a direction",
                                   path_, row, names_[0], names_[1], names_[2]));
    // Sums and squares of components stay finite and normal.
    const double largest = max_component(glm::abs(v));
    return largest < 0x1p-300 || largest > 0x1p300 ? v / largest : v;
  }

 private:
  [[noreturn]] void refuse(size_t row, int c, double value, const std::string& expected) const {
    throw SceneError(fmt::format("{}: vertex {}: {} is {}, expected {}", path_, row,
                                 names_[static_cast<size_t>(c)], value, expected));
  }
  std::array<const char*, 3> names_;
  const std::string& path_;
  std::array<const std::vector<double>*, 3> values_{};
};

const PlyElement& vertices(const PlyTable& table, const std::string& path) {
  const PlyElement* const element = table.find("vertex");
  if (!element) throw SceneError(path + ": there is no element vertex, expected the points there");
  return *element;
}

// A whole number from 0 to `top`.
uint64_t whole(const std::vector<double>& values, size_t row, double top, const char* name,
               const std::string& path) {
  const double v = values[row];
  if (!(v >= 0 && v <= top) || v != std::floor(v))
    throw SceneError(fmt::format("{}: vertex {}: {} is {}, expected a whole number from 0 to {}",
                                 path, row, name, v, top));
  return static_cast<uint64_t>(v);
}

// What follows `key` and a blank in a comment that starts with it.
std::optional<std::string> text_after(const std::string& comment, const std::string& key) {
  if (comment.size() > key.size() && comment.compare(0, key.size(), key) == 0 &&
      comment[key.size()] == ' ')
    return comment.substr(key.size() + 1);
  return std::nullopt;
}

uint64_t parse_number(const std::string& text, int base, const std::string& comment,
                      const std::string& path) {
  uint64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value, base);
  if (error != std::errc{} || stop != end)
    throw SceneError(
        fmt::format("{}: comment \"{}\": expected a{} number of at most 64 bits at its end", path,
                    comment, base == 16 ? " hexadecimal" : "n unsigned decimal"));
  return value;
}

Cube parse_cube(const std::string& text, const std::string& comment, const std::string& path) {
  Cube cube;
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  std::string rest;
  if (!(in >> cube.origin.x >> cube.origin.y >> cube.origin.z >> cube.extent) || in >> rest ||
      !std::isfinite(cube.extent) || !(cube.extent > 0))
    throw SceneError(fmt::format(
        "{}: comment \"{}\": expected the cube's lower corner and its edge, four numbers", path,
        comment));
  return cube;
}

void parse_comments(const PlyTable& table, const std::string& path, PhotonFile& file) {
  std::set<std::string> seen;
  for (const std::string& comment : table.comments) {
    const auto after = [&](const std::string& text, const char* key) {
      const auto value = text_after(text, key);
      if (value && !seen.insert(key).second)
        throw SceneError(
            fmt::format("{}: comment \"{}\": {} stands twice, expected once", path, text, key));
      return value;
    };
    if (const auto text = after(comment, "photonloom kind")) {
      if (*text != "global" && *text != "caustic")
        throw SceneError(
            fmt::format("{}: comment \"{}\": expected global or caustic", path, comment));
      file.kind = *text;
    } else if (const auto name = after(comment, "photonloom scene")) {
      file.scene = *name;
    } else if (const auto hash = after(comment, "photonloom scene_hash")) {
      file.scene_hash = parse_number(*hash, 16, comment, path);
    } else if (const auto seed = after(comment, "photonloom seed")) {
      file.seed = parse_number(*seed, 10, comment, path);
    } else if (const auto paths = after(comment, "photonloom paths_emitted")) {
      file.paths = parse_number(*paths, 10, comment, path);
    } else if (const auto requested = after(comment, "photonloom photons_requested")) {
      file.requested = parse_number(*requested, 10, comment, path);
    } else if (const auto cube = after(comment, "photonloom cube")) {
      file.cube = parse_cube(*cube, comment, path);
    }
  }
}

// A scene's name is for people; a comment is one line of printable text.
std::string one_line(const std::string& text) {
  std::string line = text;
  for (char& c : line)
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  return line;
}

}  // namespace

void write_photon_file(const PhotonFile& file, const std::string& path) {
  PlyTable table;
  table.format = PlyFormat::kLittleEndian;
  auto& comments = table.comments;
  comments.push_back(
      "photonloom photon map: x y z in scene units, dx dy dz to where the light came from,");
  comments.push_back("power in W, already divided by the paths emitted");
  if (!file.kind.empty()) comments.push_back("photonloom kind " + file.kind);
  if (!file.scene.empty()) comments.push_back("photonloom scene " + one_line(file.scene));
  if (file.scene_hash)
    comments.push_back(fmt::format("photonloom scene_hash {:016x}", *file.scene_hash));
  if (file.seed) comments.push_back(fmt::format("photonloom seed {}", *file.seed));
  if (file.paths) comments.push_back(fmt::format("photonloom paths_emitted {}", *file.paths));
  if (file.requested)
    comments.push_back(fmt::format("photonloom photons_requested {}", *file.requested));
  if (file.cube)
    comments.push_back(fmt::format("photonloom cube {} {} {} {}", file.cube->origin.x,
                                   file.cube->origin.y, file.cube->origin.z, file.cube->extent));
  PlyElement vertex;
  vertex.name = "vertex";
  vertex.rows = file.photons.size();
  const auto add = [&](const char* name, PlyType type, auto&& value) {
    PlyColumn& column = vertex.add(name, type);
    column.values.reserve(file.photons.size());
    for (const Photon& photon : file.photons) column.values.push_back(value(photon));
  };
  const char* const xyz[] = {"x", "y", "z"};
  const char* const direction[] = {"dx", "dy", "dz"};
  const char* const power[] = {"power_r", "power_g", "power_b"};
  for (int c = 0; c < 3; ++c)
    add(xyz[c], PlyType::kDouble, [c](const Photon& p) { return p.position[c]; });
  for (int c = 0; c < 3; ++c)
    add(direction[c], PlyType::kDouble, [c](const Photon& p) { return p.direction[c]; });
  for (int c = 0; c < 3; ++c)
    add(power[c], PlyType::kDouble, [c](const Photon& p) { return p.power[c]; });
  // PLY has no integers of 64 bits; a double holds the number of any path there will be.
  add("path", PlyType::kDouble, [](const Photon& p) { return static_cast<double>(p.path); });
  add("bounce", PlyType::kUint32, [](const Photon& p) { return static_cast<double>(p.bounce); });
  add("flight", PlyType::kDouble, [](const Photon& p) { return p.flight; });
  table.elements.push_back(std::move(vertex));
  write_ply(table, path);
}

PhotonFile read_photon_file(const std::string& path) {
  const PlyTable table = read_ply(path);
  const PlyElement& element = vertices(table, path);
  PhotonFile file;
  parse_comments(table, path, file);
  const Columns position(element, {"x", "y", "z"}, path, "position");
  const Columns direction(element, {"dx", "dy", "dz"}, path,
                          "the direction to where the light came from");
  const Columns power(element, {"power_r", "power_g", "power_b"}, path, "power in W");
  const auto* const paths = element.find("path") ? &element.scalar("path", path) : nullptr;
  const auto* const bounces = element.find("bounce") ? &element.scalar("bounce", path) : nullptr;
  const auto* const flights = element.find("flight") ? &element.scalar("flight", path) : nullptr;
  file.photons.resize(element.rows);
  for (size_t i = 0; i < element.rows; ++i) {
    const double flight = flights ? (*flights)[i] : 0;
    if (!(flight >= 0) || !std::isfinite(flight))
      throw SceneError(
          fmt::format("{}: vertex {}: flight is {}, expected a length", path, i, flight));
    file.photons[i] = {
        position.at(i),
        direction.not_zero(i),
        power.not_negative(i, kMostPower),
        paths ? whole(*paths, i, 0x1p53, "path", path) : i,
        bounces ? static_cast<uint32_t>(whole(*bounces, i, 0x1p32 - 1, "bounce", path)) : 0,
        flight};
  }
  return file;
}

std::vector<QueryPoint> read_query_file(const std::string& path) {
  const PlyTable table = read_ply(path);
  const PlyElement& element = vertices(table, path);
  const Columns position(element, {"x", "y", "z"}, path, "position");
  const Columns normal(element, {"nx", "ny", "nz"}, path, "the surface normal");
  std::vector<QueryPoint> queries(element.rows);
  for (size_t i = 0; i < element.rows; ++i) queries[i] = {position.at(i), normal.not_zero(i)};
  return queries;
}

Cube cube_around(const std::vector<Photon>& photons, const std::vector<QueryPoint>& queries) {
  Vec3 low(INFINITY), high(-INFINITY);
  const auto take = [&](const Vec3& x) {
    low = glm::min(low, x);
    high = glm::max(high, x);
  };
  for (const Photon& photon : photons) take(photon.position);
  for (const QueryPoint& query : queries) take(query.position);
  if (!(low.x <= high.x)) return {};
  double edge = max_component(high - low);
  // Points that all coincide still need a cube, at their own scale.
  if (edge == 0) edge = max_component(glm::max(glm::abs(low), glm::abs(high)));
  if (edge == 0) edge = 1;
  edge *= kPadding;
  return {(low + high) * 0.5 - Vec3(edge * 0.5), edge};
}

bool holds(const Cube& cube, const Vec3& point) {
  for (int c = 0; c < 3; ++c) {
    const double at = (point[c] - cube.origin[c]) / cube.extent;
    if (!(at >= 0 && at < 1)) return false;
  }
  return true;
}

}  // namespace photonloom
