// SPDX-License-Identifier: Apache-2.0
// libFuzzer target: a PLY file of arbitrary bytes is a table, that is read back as it was when it
// is written, and perhaps a mesh and photons, which are the same when they are written and read
// again; or one SceneError.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>

#include "golden/scene/mesh.hpp"
#include "golden/scene/ply.hpp"
#include "golden/unit/photon_file.hpp"
#include "tests/fuzz/folder.hpp"

namespace {

bool same(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0 || (a != a && b != b); }

void expect_same(const photonloom::PlyTable& a, const photonloom::PlyTable& b) {
  if (a.elements.size() != b.elements.size()) std::abort();
  for (size_t e = 0; e < a.elements.size(); ++e) {
    if (a.elements[e].rows != b.elements[e].rows ||
        a.elements[e].columns.size() != b.elements[e].columns.size())
      std::abort();
    for (size_t c = 0; c < a.elements[e].columns.size(); ++c) {
      const auto& x = a.elements[e].columns[c].values;
      const auto& y = b.elements[e].columns[c].values;
      if (x.size() != y.size()) std::abort();
      for (size_t i = 0; i < x.size(); ++i)
        if (!same(x[i], y[i])) std::abort();
    }
  }
}

void expect_same(const photonloom::PhotonFile& a, const photonloom::PhotonFile& b) {
  if (a.photons.size() != b.photons.size() || a.kind != b.kind || a.seed != b.seed ||
      a.scene_hash != b.scene_hash || a.paths != b.paths || a.requested != b.requested ||
      a.cube.has_value() != b.cube.has_value())
    std::abort();
  for (size_t i = 0; i < a.photons.size(); ++i) {
    const photonloom::Photon &p = a.photons[i], &q = b.photons[i];
    if (p.position != q.position || p.direction != q.direction || p.power != q.power ||
        p.path != q.path || p.bounce != q.bounce || p.flight != q.flight)
      std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const photonloom::fuzz::Folder folder;
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  try {
    photonloom::PlyTable table = photonloom::parse_ply(bytes, "mesh.ply");
    if (table.format == photonloom::PlyFormat::kLittleEndian) {
      const std::string copy = (folder.path / "copy.ply").string();
      photonloom::write_ply(table, copy);
      expect_same(table, photonloom::read_ply(copy));
    }
  } catch (const photonloom::SceneError& error) {
    if (std::string(error.what()).empty()) std::abort();
  }
  const std::string path = folder.write("mesh.ply", bytes);
  try {
    const photonloom::Mesh mesh = photonloom::read_ply_mesh(path).mesh;
    for (const auto& triangle : mesh.triangles)
      for (const uint32_t v : triangle)
        if (v >= mesh.positions.size()) std::abort();
  } catch (const photonloom::SceneError&) {
  }
  try {
    const photonloom::PhotonFile file = photonloom::read_photon_file(path);
    const std::string copy = (folder.path / "copy.ply").string();
    photonloom::write_photon_file(file, copy);
    expect_same(file, photonloom::read_photon_file(copy));
    const photonloom::Cube cube = photonloom::cube_around(file.photons, {});
    for (const photonloom::Photon& photon : file.photons)
      if (std::isfinite(cube.extent) && !photonloom::holds(cube, photon.position)) std::abort();
  } catch (const photonloom::SceneError&) {
  }
  try {
    photonloom::read_query_file(path);
  } catch (const photonloom::SceneError&) {
  }
  return 0;
}
