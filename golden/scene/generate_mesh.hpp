// SPDX-License-Identifier: Apache-2.0
// The large meshes of the scenes that come with Photonloom: made, not stored. Lengths are in scene
// units. The same arguments give the same mesh on every machine.
#pragma once
#include "golden/scene/scene.hpp"

namespace photonloom {

// A two-storey colonnade of six round arches on each long side of a court 15 long (x) and 6 wide
// (z), 8.8 high, floor at y = 0, with galleries behind. At most `triangles`, and as many as the
// tessellation allows; at least 2,000.
Mesh atrium_mesh(int triangles);

// A square ring of radius `inner` to `outer` around the y axis, from y = 0 to `height`, with
// `segments` around; exact normals on the two cylinders.
Mesh ring_mesh(double inner, double outer, double height, int segments);

// Waves over [-1, 1]^2 in x and z about y = 0, cells x cells squares, exact normals, upwards.
Mesh water_mesh(int cells);

// As a binary PLY file with normals, coordinates in single precision.
void write_mesh(const Mesh& mesh, const std::string& path);

}  // namespace photonloom
