// SPDX-License-Identifier: Apache-2.0
// Triangle meshes: read from OBJ and PLY files, made for rectangles and cubes, put into the world.
#pragma once
#include <string>

#include "golden/scene/scene.hpp"

namespace photonloom {

// As they stand in object space: [-1,1]^2 in z = 0 with normal +z; [-1,1]^3, normals outward.
Mesh rectangle_mesh();
Mesh cube_mesh();

// A mesh as its file gives it. Vertices that differ in position, normal, texture coordinate or OBJ
// group are different vertices.
struct MeshFile {
  Mesh mesh;                     // normals: empty, or one per vertex, zero where the file has none
  bool names_materials = false;  // OBJ with usemtl
  bool faceted = false;          // a serialized mesh that says so
};

// Polygons are split into fans. Throw SceneError with file and line (PLY: face number) on anything
// malformed: numbers that are not finite, indices out of range, faces with fewer than three
// vertices, zero-area triangles, no faces at all.
MeshFile read_obj(const std::string& path);
MeshFile read_ply_mesh(const std::string& path);

// World space. The winding is turned where a reflection in `to_world` or the normals of the file
// demand it, so that a triangle's counter-clockwise side is the side its normals show:
// - a mesh with normals (unless faceted): the side of its vertex normals, which go by the inverse
//   transpose;
// - rectangles and cubes (`outward`): the image of the side they have in object space;
// - else: the winding of the vertices in world space.
// `flip` turns the result round. Throws SceneError where a triangle collapses.
struct MeshPlacement {
  Mat4 to_world{1};
  bool flip = false;
  bool outward = false;
  bool faceted = false;  // no vertex normals
};
void place_mesh(Mesh& mesh, const MeshPlacement& placement, const std::string& what);

// A unit normal through the inverse transpose of a transform, a unit vector again.
Vec3 carried_normal(const glm::dmat3& inverse_transpose, const Vec3& normal);

// No area that rounding of the vertices could not have made.
bool no_area(const Vec3& a, const Vec3& b, const Vec3& c);

// Angle-weighted vertex normals (Thuermer and Wuethrich 1998) where there are none or zero ones.
void add_smooth_normals(Mesh& mesh);

}  // namespace photonloom
