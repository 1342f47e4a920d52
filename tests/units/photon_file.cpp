// SPDX-License-Identifier: Apache-2.0
#include "golden/unit/photon_file.hpp"

#include <bit>
#include <filesystem>

#include "golden/numeric/output_file.hpp"
#include "golden/plan/quantiser.hpp"
#include "golden/scene/scene.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"

using namespace photonloom;
using photonloom::test::Scratch;

namespace {

bool same_bits(const Vec3& a, const Vec3& b) {
  for (int c = 0; c < 3; ++c)
    if (std::bit_cast<uint64_t>(a[c]) != std::bit_cast<uint64_t>(b[c])) return false;
  return true;
}

std::string ascii(const std::string& properties, const std::string& rows, int count,
                  const std::string& comments = "") {
  return "ply\nformat ascii 1.0\n" + comments + "element vertex " + std::to_string(count) + "\n" +
         properties + "end_header\n" + rows;
}

const std::string kPhotonProperties =
    "property float x\nproperty float y\nproperty float z\nproperty double dx\nproperty double "
    "dy\nproperty double dz\nproperty float power_r\nproperty float power_g\nproperty float "
    "power_b\n";
const std::string kQueryProperties =
    "property float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float "
    "ny\nproperty float nz\n";

}  // namespace

TEST_CASE("a photon file read back is the same to the bit") {
  const Scratch s;
  PhotonFile file;
  for (uint64_t i = 0; i < 1000; ++i) {
    const Random r(3, Phase::kPath, i);
    file.photons.push_back({Vec3(r.unit(0, 0), -r.unit(0, 1) * 1e-300, r.unit(0, 2) * 1e12),
                            Vec3(r.unit(1, 0) - 0.5, -0.0, 1 / 3.0),
                            Rgb(r.unit(2, 0) * 1e-9, 0, 0.1), (uint64_t{1} << 53) - 1 - i,
                            static_cast<uint32_t>(i % 7), static_cast<double>(i % 5) / 3});
  }
  file.kind = "caustic";
  file.scene = "a scene\nof two lines";
  file.scene_hash = 0xfedcba9876543210ull;
  file.seed = ~0ull;
  file.paths = 12345678901234ull;
  file.requested = 1000;
  file.cube = Cube{Vec3(1 / 3.0, -0.1, 1e-7), 1 / 7.0};
  write_photon_file(file, s / "map.ply");
  const PhotonFile back = read_photon_file(s / "map.ply");
  REQUIRE(back.photons.size() == file.photons.size());
  for (size_t i = 0; i < file.photons.size(); ++i) {
    REQUIRE(same_bits(back.photons[i].position, file.photons[i].position));
    REQUIRE(same_bits(back.photons[i].direction, file.photons[i].direction));
    REQUIRE(same_bits(back.photons[i].power, file.photons[i].power));
    REQUIRE(back.photons[i].path == file.photons[i].path);
    REQUIRE(back.photons[i].bounce == file.photons[i].bounce);
    REQUIRE(back.photons[i].flight == file.photons[i].flight);
  }
  REQUIRE(back.kind == "caustic");
  REQUIRE(back.scene == "a scene of two lines");
  REQUIRE(back.scene_hash == file.scene_hash);
  REQUIRE(back.seed == file.seed);
  REQUIRE(back.paths == file.paths);
  REQUIRE(back.requested == file.requested);
  REQUIRE(same_bits(back.cube->origin, file.cube->origin));
  REQUIRE(back.cube->extent == file.cube->extent);
}

TEST_CASE("photons and queries written by other tools are read") {
  const Scratch s;
  write_file(s / "p.ply", ascii(kPhotonProperties, "1 2 3 0 0 2 4 5 6\n7 8 9 1 0 0 0 0 0\n", 2));
  const PhotonFile file = read_photon_file(s / "p.ply");
  REQUIRE(file.photons.size() == 2);
  REQUIRE(file.photons[0].position == Vec3(1, 2, 3));
  REQUIRE(file.photons[0].direction == Vec3(0, 0, 2));
  REQUIRE(file.photons[0].power == Rgb(4, 5, 6));
  REQUIRE(file.photons[1].path == 1);
  REQUIRE(file.photons[1].bounce == 0);
  REQUIRE(file.kind.empty());
  REQUIRE_FALSE(file.scene_hash.has_value());
  REQUIRE_FALSE(file.cube.has_value());

  write_file(s / "q.ply", ascii(kQueryProperties, "1 2 3 0 0 -1\n", 1));
  const auto queries = read_query_file(s / "q.ply");
  REQUIRE(queries.size() == 1);
  REQUIRE(queries[0].normal == Vec3(0, 0, -1));
}

TEST_CASE("what is wrong with a photon or query file is said in one sentence") {
  const Scratch s;
  const std::string path = s / "bad.ply";
  const auto message = [&](const std::string& text, bool photons = true) -> std::string {
    write_file(path, text);
    try {
      if (photons) {
        read_photon_file(path);
      } else {
        read_query_file(path);
      }
    } catch (const SceneError& error) {
      const std::string what = error.what();
      REQUIRE(what.rfind(path + ": ", 0) == 0);
      return what.substr(path.size() + 2);
    }
    return "nothing";
  };
  const std::string good = "1 2 3 0 0 1 4 5 6\n";
  CHECK(message(ascii(kPhotonProperties, good, 1)) == "nothing");
  CHECK(message(ascii(kQueryProperties, "1 2 3 0 0 1\n", 1)) ==
        "the vertices have no property dx, expected the direction to where the light came from as "
        "dx, dy, dz");
  CHECK(message(ascii(kPhotonProperties, good, 1), false) ==
        "the vertices have no property nx, expected the surface normal as nx, ny, nz");
  CHECK(message(ascii(kPhotonProperties, good + "1 2 nan 0 0 1 4 5 6\n", 2)) ==
        "vertex 1: z is nan, expected a finite number");
  CHECK(message(ascii(kPhotonProperties, "1 2 3 0 0 0 4 5 6\n", 1)) ==
        "vertex 0: dx, dy, dz are all 0, expected a direction");
  CHECK(message(ascii(kPhotonProperties, "1 2 3 0 0 1 4 -5 6\n", 1)) ==
        "vertex 0: power_g is -5, expected no negative number");
  CHECK(message(ascii(kPhotonProperties + "property double path\n", "1 2 3 0 0 1 4 5 6 1.5\n", 1))
            .rfind("vertex 0: path is 1.5, expected a whole number from 0 to ", 0) == 0);
  CHECK(message(ascii(kPhotonProperties, good, 1, "comment photonloom seed x\n")) ==
        "comment \"photonloom seed x\": expected an unsigned decimal number of at most 64 bits at "
        "its end");
  CHECK(message(ascii(kPhotonProperties, good, 1, "comment photonloom cube 0 0 0 -1\n")) ==
        "comment \"photonloom cube 0 0 0 -1\": expected the cube's lower corner and its edge, four "
        "numbers");
  std::string doubles = kPhotonProperties;
  for (size_t at; (at = doubles.find("float")) != std::string::npos;)
    doubles.replace(at, 5, "double");
  CHECK(message(ascii(doubles, "1 2 3 0 0 1 4 5 1e100\n", 1)) == "nothing");
  CHECK(message(ascii(doubles, "1 2 3 0 0 1 4 5 2e100\n", 1)) ==
        "vertex 0: power_b is 2e+100, expected at most 1e+100");
  CHECK(message(ascii(kPhotonProperties, good, 1,
                      "comment photonloom cube 0 0 0 8\ncomment photonloom cube 0 0 0 9\n")) ==
        "comment \"photonloom cube 0 0 0 9\": photonloom cube stands twice, expected once");
  CHECK(message(ascii(kPhotonProperties, good, 1, "comment photonloom kind other\n")) ==
        "comment \"photonloom kind other\": expected global or caustic");
  CHECK(message("ply\nformat ascii 1.0\nelement face 0\nend_header\n") ==
        "there is no element vertex, expected the points there");
}

TEST_CASE("the cube around points holds them all, at every scale") {
  for (double scale : {1e-9, 1.0, 1e9}) {
    std::vector<Photon> photons;
    std::vector<QueryPoint> queries;
    const auto check = [&] {
      const Cube cube = cube_around(photons, queries);
      for (const Photon& p : photons) REQUIRE(holds(cube, p.position));
      for (const QueryPoint& q : queries) REQUIRE(holds(cube, q.position));
    };
    check();
    photons.push_back({Vec3(scale, -3 * scale, 0), Vec3(1, 0, 0), Rgb(1), 0, 0});
    check();
    queries.push_back({Vec3(7 * scale, 2 * scale, -scale), Vec3(1, 0, 0)});
    check();
    REQUIRE_FALSE(holds(cube_around(photons, queries), Vec3(8 * scale, 0, 0)));
  }
}
