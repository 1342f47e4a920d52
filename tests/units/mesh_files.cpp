// SPDX-License-Identifier: Apache-2.0
// PLY tables keep every value in every format; OBJ files read the same as by an independent reader.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#define TINYOBJLOADER_IMPLEMENTATION
#define TINYOBJLOADER_USE_DOUBLE
#include <tiny_obj_loader.h>

#include "golden/scene/mesh.hpp"
#include "golden/scene/ply.hpp"
#include "tests/catch.hpp"
#include "tests/scene_files.hpp"

using namespace photonloom;

TEST_CASE("PLY tables survive all three formats") {
  PlyTable table;
  table.comments = {"scale 1e-3", "  two  blanks"};
  PlyElement a;
  a.name = "photon";
  a.rows = 3;
  a.add("x", PlyType::kDouble).values = {0.1, -1e300, std::numeric_limits<double>::denorm_min()};
  a.add("f", PlyType::kFloat).values = {0.5, static_cast<double>(1e-30f), -0.0};
  a.add("i8", PlyType::kInt8).values = {-128, 127, 0};
  a.add("u8", PlyType::kUint8).values = {0, 255, 7};
  a.add("i16", PlyType::kInt16).values = {-32768, 32767, 1};
  a.add("u16", PlyType::kUint16).values = {0, 65535, 1};
  a.add("i32", PlyType::kInt32).values = {-2147483648.0, 2147483647.0, 1};
  a.add("u32", PlyType::kUint32).values = {0, 4294967295.0, 1};
  PlyElement b;
  b.name = "face";
  b.rows = 2;
  PlyColumn& list = b.add("vertex_indices", PlyType::kInt32);
  list.is_list = true;
  list.values = {5, 6, 7, -1};
  list.starts = {0, 4, 4};
  table.elements = {a, b};
  const TestFolder folder;
  for (const PlyFormat format :
       {PlyFormat::kAscii, PlyFormat::kLittleEndian, PlyFormat::kBigEndian}) {
    table.format = format;
    write_ply(table, folder / "t.ply");
    const PlyTable back = read_ply(folder / "t.ply");
    CHECK(back.format == format);
    CHECK(back.comments == table.comments);
    REQUIRE(back.elements.size() == 2);
    for (size_t e = 0; e < 2; ++e) {
      CHECK(back.elements[e].rows == table.elements[e].rows);
      for (size_t c = 0; c < table.elements[e].columns.size(); ++c) {
        const PlyColumn &got = back.elements[e].columns[c], &want = table.elements[e].columns[c];
        CHECK(got.name == want.name);
        CHECK(got.type == want.type);
        CHECK(got.values == want.values);
        CHECK(got.starts == want.starts);
      }
    }
  }
  table.elements[0].columns[3].values[0] = 256;
  CHECK_THROWS_WITH(write_ply(table, folder / "u.ply"), ContainsSubstring("does not fit"));
  CHECK(!std::filesystem::exists(folder / "u.ply"));
  CHECK_THROWS_WITH(write_ply(table, folder / "none/t.ply"), ContainsSubstring("none/t.ply"));
}

TEST_CASE(
    "what is wrong with a PLY file names the line, and rows beyond the header's count are none to "
    "lose") {
  const TestFolder folder;
  const std::string header = "element vertex 2\nproperty uchar x\nend_header\n";
  const auto read = [&](const std::string& format, const std::string& body) {
    return read_ply(folder.write("t.ply", "ply\nformat " + format + " 1.0\n" + header + body));
  };
  CHECK(read("ascii", "1\n2").elements[0].columns[0].values == std::vector<double>{1, 2});
  CHECK(read("ascii", "1\n2\n \r\n\n").elements[0].rows == 2);
  CHECK(read("binary_little_endian", "12").elements[0].rows == 2);
  CHECK_THROWS_WITH(read("ascii", "x\n2\n"), ContainsSubstring("t.ply:6: 'x' in property 'x'"));
  CHECK_THROWS_WITH(read("ascii", "1\n\n300\n"), ContainsSubstring("t.ply:8: '300'"));
  CHECK_THROWS_WITH(read("ascii", std::string("1\0 2\n", 5)), ContainsSubstring("t.ply:6: '1"));
  CHECK_THROWS_WITH(
      read("ascii", "1\n2\n3 4\n"),
      ContainsSubstring("t.ply:8: expected the file's end after the last element's last "
                        "row; bytes left: 4"));
  CHECK_THROWS_WITH(read("binary_big_endian", "12\n"), ContainsSubstring("row; bytes left: 1"));
}

TEST_CASE("OBJ files read as tinyobjloader reads them") {
  for (const unsigned seed : {1u, 2u, 3u}) {
    INFO("seed " << seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> coordinate(-10, 10);
    std::string text = "# random\nmtllib none.mtl\no thing\ns off\n";
    const int vertices = 40;
    for (int i = 0; i < vertices; ++i)
      text += "v " + std::to_string(coordinate(random)) + " \t" +
              std::to_string(coordinate(random)) + " " + std::to_string(coordinate(random)) +
              "\r\n";
    for (int i = 0; i < vertices; ++i)
      text += "vn " + std::to_string(coordinate(random)) + " " +
              std::to_string(coordinate(random)) + " " + std::to_string(coordinate(random)) +
              "\nvt 0.5 " + std::to_string(i) + "\n";
    for (int f = 0; f < 60; ++f) {
      const int corners = 3 + static_cast<int>(random() % 3);
      text += "f";
      const int first = static_cast<int>(random() % vertices);
      for (int c = 0; c < corners; ++c) {
        const int v = (first + 7 * c) % vertices;
        const std::string index = std::to_string(f % 2 ? v + 1 : v - vertices);
        text += (c == 1 ? " \\\n " : " ") + index +
                (f % 3 == 0   ? ""
                 : f % 3 == 1 ? "//" + index
                              : "/" + index + "/" + index);
      }
      text += "\n";
    }
    const TestFolder folder;
    const MeshFile mesh = read_obj(folder.write("a.obj", text));

    // tinyobjloader does not join lines at backslashes.
    std::string joined = text;
    for (size_t at; (at = joined.find("\\\n")) != std::string::npos;) joined.replace(at, 2, " ");
    std::istringstream stream(joined);
    tinyobj::attrib_t attributes;
    std::vector<tinyobj::shape_t> shapes;
    std::vector<tinyobj::material_t> materials;
    std::string warning, error;
    REQUIRE(tinyobj::LoadObj(&attributes, &shapes, &materials, &warning, &error, &stream, nullptr,
                             false));
    size_t triangle = 0;
    for (const tinyobj::shape_t& shape : shapes) {
      size_t offset = 0;
      for (const unsigned corners : shape.mesh.num_face_vertices) {
        for (unsigned c = 2; c < corners; ++c, ++triangle) {
          REQUIRE(triangle < mesh.mesh.triangles.size());
          const unsigned which[] = {0, c - 1, c};
          for (size_t k = 0; k < 3; ++k) {
            const tinyobj::index_t& index = shape.mesh.indices[offset + which[k]];
            const uint32_t v = mesh.mesh.triangles[triangle][k];
            for (int axis = 0; axis < 3; ++axis) {
              const size_t a = static_cast<size_t>(3 * index.vertex_index + axis);
              CHECK(mesh.mesh.positions[v][axis] == Approx(attributes.vertices[a]).epsilon(1e-14));
              const double n =
                  index.normal_index < 0
                      ? 0
                      : attributes.normals[static_cast<size_t>(3 * index.normal_index + axis)];
              CHECK(mesh.mesh.normals[v][axis] == Approx(n).epsilon(1e-14));
            }
          }
        }
        offset += corners;
      }
    }
    CHECK(triangle == mesh.mesh.triangles.size());
  }
}

TEST_CASE("equal vertices of an OBJ file are one, numbered as they are first used") {
  const TestFolder folder;
  std::mt19937 random(7);
  const auto below = [&](size_t n) { return static_cast<int>(random() % n); };
  // Few values, 0 with both signs among them, so that equal ones have several indices.
  const auto number = [&] { return std::array{"0", "-0", "1"}[random() % 3]; };
  std::string text;
  std::vector<Vec3> positions, normals;
  std::vector<Vec2> coordinates;
  const auto parsed = [](const std::string& s) { return std::stod(s); };
  struct Vertex {
    int group;
    Vec3 p, n;
    Vec2 t;
    bool operator==(const Vertex&) const = default;
  };
  std::vector<Vertex> expected;
  std::vector<size_t> used;
  int group = 0;
  for (int line = 0; line < 3000; ++line) {
    const std::string x = number(), y = number(), z = number();
    if (line < 30 || line % 5 == 0) {
      text += "v " + x + " " + y + " " + z + "\n";
      positions.emplace_back(parsed(x), parsed(y), parsed(z));
      text += "vn " + z + " " + x + " " + y + "\nvt " + y + " " + z + "\n";
      normals.emplace_back(parsed(z), parsed(x), parsed(y));
      coordinates.emplace_back(parsed(y), parsed(z));
      continue;
    }
    if (line % 997 == 0) {
      text += "g other\n";
      ++group;
    }
    std::string face = "f";
    std::vector<Vertex> corners;
    for (int c = 0; c < 3; ++c) {
      const int n = static_cast<int>(positions.size()), p = below(positions.size());
      const int t = below(3) ? below(positions.size()) : -1, m = below(3) ? t : -1;
      face += " " + std::to_string(below(2) ? p + 1 : p - n) + "/";
      if (t >= 0) face += std::to_string(t + 1);
      face += "/";
      if (m >= 0) face += std::to_string(m + 1);
      const auto at = [](const auto& list, int i) {
        return i < 0 ? std::decay_t<decltype(list[0])>(0) : list[static_cast<size_t>(i)];
      };
      corners.push_back({group, at(positions, p), at(normals, m), at(coordinates, t)});
    }
    if (no_area(corners[0].p, corners[1].p, corners[2].p)) continue;
    text += face + "\n";
    for (const Vertex& v : corners) {
      const auto found = std::find(expected.begin(), expected.end(), v);
      used.push_back(static_cast<size_t>(found - expected.begin()));
      if (found == expected.end()) expected.push_back(v);
    }
  }
  const Mesh mesh = read_obj(folder.write("a.obj", text)).mesh;
  REQUIRE(mesh.positions.size() == expected.size());
  REQUIRE(mesh.triangles.size() == used.size() / 3);
  CHECK(used.size() > 2 * expected.size());
  bool same = true;
  for (size_t v = 0; v < expected.size(); ++v)
    same = same && mesh.positions[v] == expected[v].p && mesh.normals[v] == expected[v].n &&
           mesh.uvs[v] == expected[v].t;
  for (size_t i = 0; i < used.size(); ++i) same = same && mesh.triangles[i / 3][i % 3] == used[i];
  CHECK(same);
}

TEST_CASE("coordinates are rounded exactly") {
  const TestFolder folder;
  const MeshFile mesh = read_obj(
      folder.write("a.obj", "v 0.1 1e-3 123456789.123456789\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
  CHECK(mesh.mesh.positions[0] == Vec3(0.1, 1e-3, 123456789.123456789));
}

TEST_CASE("OBJ groups and texture coordinates keep vertices apart, equal ones are merged") {
  const TestFolder folder;
  const std::string v = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0\nv 1 0 0\nv 0 0 1\n";
  CHECK(read_obj(folder.write("a.obj", v + "f 1 2 3\nf 4 6 5\n")).mesh.positions.size() == 4);
  CHECK(read_obj(folder.write("b.obj", v + "f 1 2 3\ng other\nf 4 6 5\n")).mesh.positions.size() ==
        6);
}
