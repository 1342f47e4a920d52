// SPDX-License-Identifier: Apache-2.0
// The scenes in scenes/ and the meshes made for them.
#include <cmath>
#include <cstdlib>

#include "golden/scene/generate_mesh.hpp"
#include "golden/scene/mesh.hpp"
#include "tests/catch.hpp"
#include "tests/scene_files.hpp"

using namespace photonloom;

namespace {

Scene shipped(const std::string& name, const Parameters& parameters = {}) {
  const char* source = std::getenv("PHOTONLOOM_SOURCE");
  REQUIRE(source);
  return load_scene(std::string(source) + "/scenes/" + name + ".xml", parameters);
}

const Shape& find(const Scene& scene, const std::string& id) {
  for (const Shape& s : scene.shapes)
    if (s.id == id) return s;
  FAIL("no shape " << id);
  return scene.shapes[0];
}

// Six times the signed volume under the triangles.
double volume_under(const Mesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles)
    sum += glm::dot(mesh.positions[t[0]], glm::cross(mesh.positions[t[1]], mesh.positions[t[2]]));
  return sum;
}

Vec3 cross(const Mesh& mesh, size_t triangle) {
  const auto& t = mesh.triangles[triangle];
  return glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                    mesh.positions[t[2]] - mesh.positions[t[0]]);
}

// Every triangle has area and stands as its three normals say.
void check_sides(const Mesh& mesh) {
  size_t bad = 0;
  for (size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const uint32_t v : mesh.triangles[i]) {
      if (!(std::fabs(glm::length(mesh.normals[v]) - 1) < 1e-12)) ++bad;
      if (!(glm::dot(cross(mesh, i), mesh.normals[v]) > 0)) ++bad;
    }
  CHECK(bad == 0);
}

}  // namespace

TEST_CASE("all ten scenes load without warnings, at 256 x 256") {
  for (const char* name : {"cornell", "cornell_balls", "cornell_glossy", "doorway", "caustic_ring",
                           "water_pool", "atrium", "table", "sunroom", "lampshade"}) {
    INFO(name);
    const Scene s = shipped(name);
    CHECK(s.warnings.empty());
    CHECK(s.name == name);
    CHECK(s.film.width == 256);
    CHECK(s.film.height == 256);
    CHECK(s.sample_count == 16);
  }
}

TEST_CASE("cornell: walls face the room, blocks face out, the lamp fills the ceiling's hole") {
  const Scene s = shipped("cornell");
  const Vec3 middle(278, 274, 280);
  double ceiling = 0, lamp = 0;
  for (const char* id : {"floor", "ceiling", "back", "right", "left", "light"}) {
    INFO(id);
    const Mesh& mesh = find(s, id).mesh;
    for (size_t i = 0; i < mesh.triangles.size(); ++i) {
      CHECK(glm::dot(cross(mesh, i), middle - mesh.positions[mesh.triangles[i][0]]) > 0);
      if (std::string(id) == "ceiling") ceiling += glm::length(cross(mesh, i)) / 2;
      if (std::string(id) == "light") lamp += glm::length(cross(mesh, i)) / 2;
    }
  }
  CHECK(lamp == Approx(130 * 105));
  CHECK(ceiling + lamp == Approx(556 * 559.2));
  // The blocks have no bottom; measured from a corner on the floor it adds nothing.
  for (const auto& [id, height] : {std::pair("short", 165.0), std::pair("tall", 330.0)}) {
    INFO(id);
    Mesh mesh = find(s, id).mesh;
    for (Vec3& p : mesh.positions) p -= Vec3(185, 0, 170);
    // A square of 165 up to the measurement's accuracy.
    CHECK(volume_under(mesh) / 6 == Approx(165 * 165 * height).epsilon(0.03));
  }
}

TEST_CASE("the atrium has as many triangles as asked for, the right way round") {
  for (const int wanted : {2000, 20000, 77777, 300000}) {
    INFO(wanted);
    const Mesh mesh = atrium_mesh(wanted);
    CHECK(static_cast<int>(mesh.triangles.size()) <= wanted);
    CHECK(mesh.triangles.size() >= 0.85 * wanted);
    check_sides(mesh);
  }
  CHECK_THROWS_AS(atrium_mesh(1000), SceneError);
  CHECK(shipped("atrium").shapes[0].mesh.triangles.size() == atrium_mesh(20000).triangles.size());
  CHECK(shipped("atrium", {{"triangles", "300000"}}).shapes[0].mesh.triangles.size() > 250000);
}

TEST_CASE("the ring is closed and its normals are those of cylinders") {
  const int segments = 256;
  const Mesh mesh = ring_mesh(1, 1.06, 0.5, segments);
  check_sides(mesh);
  // Area between the two regular polygons, times the height.
  const double angle = 2 * 3.14159265358979323846 / segments;
  const double area = segments * std::sin(angle) / 2 * (1.06 * 1.06 - 1);
  CHECK(volume_under(mesh) / 6 == Approx(area * 0.5).epsilon(1e-12));
}

TEST_CASE("water: normals are the gradient's, upwards") {
  const Mesh mesh = water_mesh(50);
  CHECK(mesh.triangles.size() == 5000);
  check_sides(mesh);
  // Against central differences along both axes of the grid.
  const uint32_t row = 51, at = 20 * row + 30;
  const Vec3 along_z = mesh.positions[at + 1] - mesh.positions[at - 1];
  const Vec3 along_x = mesh.positions[at + row] - mesh.positions[at - row];
  const Vec3 normal = glm::normalize(glm::cross(along_z, along_x));
  CHECK(glm::length(normal - mesh.normals[at]) < 0.01);
}

TEST_CASE("a written mesh is read back, in single precision") {
  const TestFolder folder;
  const Mesh mesh = atrium_mesh(3000);
  write_mesh(mesh, folder / "a.ply");
  const MeshFile back = read_ply_mesh(folder / "a.ply");
  CHECK(back.mesh.triangles == mesh.triangles);
  REQUIRE(back.mesh.positions.size() == mesh.positions.size());
  for (size_t i = 0; i < mesh.positions.size(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      CHECK(back.mesh.positions[i][axis] == static_cast<float>(mesh.positions[i][axis]));
}
