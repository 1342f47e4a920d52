// SPDX-License-Identifier: Apache-2.0
// libFuzzer target: an OBJ file of arbitrary bytes is a mesh whose triangles name vertices that are
// there, or one SceneError.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "golden/scene/mesh.hpp"
#include "tests/fuzz/folder.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const photonloom::fuzz::Folder folder;
  const std::string path = folder.write("mesh.obj", {reinterpret_cast<const char*>(data), size});
  try {
    photonloom::MeshFile file = photonloom::read_obj(path);
    const photonloom::Mesh& mesh = file.mesh;
    for (const auto& triangle : mesh.triangles)
      for (const uint32_t v : triangle)
        if (v >= mesh.positions.size()) std::abort();
    for (const auto& p : mesh.positions)
      if (!std::isfinite(p.x + p.y + p.z)) std::abort();
    if (!mesh.normals.empty() && mesh.normals.size() != mesh.positions.size()) std::abort();
    photonloom::MeshPlacement placement;
    placement.flip = size % 2;
    photonloom::place_mesh(file.mesh, placement, "mesh.obj");
  } catch (const photonloom::SceneError& error) {
    if (std::string(error.what()).empty()) std::abort();
  }
  return 0;
}
