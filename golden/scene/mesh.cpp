// SPDX-License-Identifier: Apache-2.0
#include "golden/scene/mesh.hpp"

#include <fmt/core.h>

#include <cmath>
#include <limits>

#include "golden/numeric/elementary.hpp"
#include "golden/scene/polygon.hpp"

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
