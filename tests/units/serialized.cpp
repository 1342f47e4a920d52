// SPDX-License-Identifier: Apache-2.0
// Serialized meshes: written here by the format's definition, read back; and everything that may be
// wrong with one.
#include "golden/scene/serialized.hpp"

#include <zlib.h>

#include <cstring>
#include <limits>

#include "tests/catch.hpp"
#include "tests/scene_files.hpp"

using namespace photonloom;

namespace {

template <class T>
void put(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

struct Parts {
  bool normals = false, uvs = false, colors = false, faceted = false, single = true;
  int version = 4;
  double x = 1;            // of the second vertex
  uint32_t corner = 2;     // of the first triangle
  uint64_t triangles = 2;  // as claimed
};

// A square of two triangles.
std::string mesh_bytes(const Parts& p) {
  std::string raw;
  put<uint32_t>(raw, (p.normals ? 1u : 0u) | (p.uvs ? 2u : 0u) | (p.colors ? 8u : 0u) |
                         (p.faceted ? 16u : 0u) | (p.single ? 0x1000u : 0x2000u));
  if (p.version == 4) raw += std::string("square\0", 7);
  put<uint64_t>(raw, 4);
  put<uint64_t>(raw, p.triangles);
  const auto number = [&](double x) { p.single ? put(raw, static_cast<float>(x)) : put(raw, x); };
  for (const Vec3& v : {Vec3(0, 0, 0.5), Vec3(p.x, 0, 0.5), Vec3(1, 1, 0.5), Vec3(0, 1, 0.5)})
    for (int i = 0; i < 3; ++i) number(v[i]);
  if (p.normals)
    for (int v = 0; v < 4; ++v)
      for (const double c : {0.0, 0.0, 1.0}) number(c);
  if (p.uvs)
    for (int v = 0; v < 4; ++v)
      for (const double c : {0.25 * v, 1.0}) number(c);
  if (p.colors)
    for (int v = 0; v < 4; ++v)
      for (const double c : {1.0, 0.5, 0.25}) number(c);
  for (const uint32_t corner : {0u, 1u, p.corner, 0u, 2u, 3u}) put(raw, corner);
  std::string packed(compressBound(raw.size()), '\0');
  uLongf size = packed.size();
  REQUIRE(compress(reinterpret_cast<Bytef*>(packed.data()), &size,
                   reinterpret_cast<const Bytef*>(raw.data()), raw.size()) == Z_OK);
  packed.resize(size);
  std::string out;
  put<uint16_t>(out, 0x041C);
  put<uint16_t>(out, static_cast<uint16_t>(p.version));
  return out + packed;
}

std::string file_bytes(const std::vector<std::string>& meshes, int version = 4) {
  std::string out;
  std::vector<uint64_t> offsets;
  for (const std::string& m : meshes) {
    offsets.push_back(out.size());
    out += m;
  }
  for (const uint64_t o : offsets) version == 4 ? put(out, o) : put(out, static_cast<uint32_t>(o));
  put(out, static_cast<uint32_t>(meshes.size()));
  return out;
}

std::string mesh_error(const std::string& bytes, int64_t index = 0) {
  const TestFolder folder;
  try {
    read_serialized(folder.write("a.serialized", bytes), index);
  } catch (const SceneError& e) {
    return e.what();
  }
  return "";
}

}  // namespace

TEST_CASE("serialized meshes: both versions and precisions, all parts, several in a file") {
  const TestFolder folder;
  for (const int version : {3, 4})
    for (const bool single : {true, false}) {
      Parts all;
      all.normals = all.uvs = all.colors = true;
      all.single = single;
      all.version = version;
      Parts plain;
      plain.version = version;
      plain.faceted = true;
      const std::string file =
          folder.write("a.serialized", file_bytes({mesh_bytes(plain), mesh_bytes(all)}, version));
      const MeshFile first = read_serialized(file, 0), second = read_serialized(file, 1);
      CHECK(first.faceted);
      CHECK(first.mesh.normals.empty());
      CHECK(first.mesh.positions[2] == Vec3(1, 1, 0.5));
      CHECK(first.mesh.triangles[1] == std::array<uint32_t, 3>{0, 2, 3});
      CHECK_FALSE(second.faceted);
      CHECK(second.mesh.normals[3] == Vec3(0, 0, 1));
      CHECK(second.mesh.uvs[3] == Vec2(0.75, 1));
      CHECK(second.mesh.colors[0] == Rgb(1, 0.5, 0.25));
    }
  folder.write("a.serialized", file_bytes({mesh_bytes({}), mesh_bytes({})}));
  const Scene s = load_scene(folder.write(
      "scene.xml", scene_text(std::string("<shape type=\"serialized\"><string name=\"filename\" "
                                          "value=\"a.serialized\"/><integer name=\"shapeIndex\" "
                                          "value=\"1\"/></shape>") +
                              kSensor + kLamp)));
  CHECK(s.shapes[0].mesh.triangles.size() == 2);
}

TEST_CASE("serialized meshes that are none") {
  const std::string good = file_bytes({mesh_bytes({})});
  CHECK(mesh_error(good) == "");
  CHECK_THAT(mesh_error(""),
             ContainsSubstring("a.serialized: the file does not begin with 0x041C"));
  CHECK_THAT(mesh_error(good, 1), ContainsSubstring("mesh 1 does not exist, expected a shapeIndex "
                                                    "from 0 to 0"));
  CHECK_THAT(mesh_error(good, -1), ContainsSubstring("mesh -1 does not exist"));
  std::string version = good;
  version[2] = 9;
  CHECK_THAT(mesh_error(version), ContainsSubstring("version 9, expected 3 or 4"));
  std::string many = good;
  for (size_t i = 1; i <= 4; ++i) many[many.size() - i] = '\xff';
  CHECK_THAT(mesh_error(many), ContainsSubstring("more than its"));
  std::string outside = good;
  outside[outside.size() - 9] = 1;
  CHECK_THAT(mesh_error(outside), ContainsSubstring("outside of the file's"));
  std::string damaged = good;
  damaged[6] = '\x7f';
  damaged[7] = '\x7f';
  CHECK(mesh_error(damaged) != "");
  CHECK_THAT(mesh_error(file_bytes({mesh_bytes({}).substr(0, 30)})), ContainsSubstring("end"));
  Parts p;
  p.triangles = 0;
  CHECK_THAT(mesh_error(file_bytes({mesh_bytes(p)})), ContainsSubstring("has no triangles"));
  p.triangles = 3;
  CHECK_THAT(mesh_error(file_bytes({mesh_bytes(p)})), ContainsSubstring("data end within"));
  p.triangles = uint64_t{1} << 40;  // a bomb's claim
  CHECK_THAT(mesh_error(file_bytes({mesh_bytes(p)})), ContainsSubstring("claims"));
  p = {};
  p.corner = 4;
  CHECK_THAT(mesh_error(file_bytes({mesh_bytes(p)})),
             ContainsSubstring("triangle 0 of mesh 0 has the vertex 4, expected 0 to 3"));
  p.corner = 1;
  CHECK_THAT(mesh_error(file_bytes({mesh_bytes(p)})), ContainsSubstring("no area"));
  p = {};
  p.x = std::numeric_limits<double>::infinity();
  CHECK_THAT(mesh_error(file_bytes({mesh_bytes(p)})),
             ContainsSubstring("position 1 of mesh 0 is not finite"));
}
