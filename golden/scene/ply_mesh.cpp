// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <cmath>

#include "golden/scene/mesh.hpp"
#include "golden/scene/ply.hpp"
#include "golden/scene/polygon.hpp"

namespace photonloom {
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

}  // namespace photonloom
