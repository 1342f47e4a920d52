// SPDX-License-Identifier: Apache-2.0
// usage: bench_meshes FILE...: triangles a second that photonloom's readers and assimp take from
// each file, one after the other, the fastest of three; as JSON. Assimp reads without
// post-processing, and as many triangles, or there is an error. bench_meshes --obj IN.ply OUT.obj
// writes the same mesh as an OBJ file.
#include <fmt/core.h>

#include <assimp/scene.h>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "golden/scene/mesh.hpp"

namespace {

size_t by_photonloom(const std::string& file) {
  const auto read = file.ends_with(".obj") ? photonloom::read_obj : photonloom::read_ply_mesh;
  return read(file).mesh.triangles.size();
}

size_t by_assimp(const std::string& file) {
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(file, 0);
  if (!scene) throw std::runtime_error(file + ": " + importer.GetErrorString());
  size_t triangles = 0;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m)
    for (unsigned f = 0; f < scene->mMeshes[m]->mNumFaces; ++f)
      triangles += scene->mMeshes[m]->mFaces[f].mNumIndices - 2;
  return triangles;
}

void write_obj(const photonloom::Mesh& mesh, const std::string& file) {
  std::FILE* out = std::fopen(file.c_str(), "w");
  if (!out) throw std::runtime_error(file + " cannot be written");
  for (const auto& p : mesh.positions) fmt::print(out, "v {:.7g} {:.7g} {:.7g}\n", p.x, p.y, p.z);
  for (const auto& t : mesh.triangles)
    fmt::print(out, "f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  std::fclose(out);
}

// Triangles a CPU second.
template <class Read>
double rate(Read&& read, const std::string& file, size_t& triangles) {
  double best = 0;
  for (int i = 0; i < 3; ++i) {
    const std::clock_t start = std::clock();
    triangles = read(file);
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    best = std::max(best, static_cast<double>(triangles) / seconds);
  }
  return best;
}

}  // namespace

int main(int count, char** files) {
  if (count == 4 && std::string(files[1]) == "--obj") {
    write_obj(photonloom::read_ply_mesh(files[2]).mesh, files[3]);
    return 0;
  }
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  try {
    for (int i = 1; i < count; ++i) {
      size_t ours = 0, theirs = 0;
      const double photonloom = rate(by_photonloom, files[i], ours);
      const double assimp = rate(by_assimp, files[i], theirs);
      if (ours != theirs)
        throw std::runtime_error(
            fmt::format("{}: {} triangles by photonloom, {} by assimp", files[i], ours, theirs));
      out.push_back({{"file", std::filesystem::path(files[i]).filename()},
                     {"bytes", std::filesystem::file_size(files[i])},
                     {"triangles", ours},
                     {"photonloom", photonloom},
                     {"assimp", assimp}});
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_meshes: {}\n", error.what());
    return 1;
  }
  fmt::print("{}\n", out.dump(2));
}
