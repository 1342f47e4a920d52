// SPDX-License-Identifier: Apache-2.0
// Photon maps and gather queries as PLY files; docs/photon_map.md describes them for whoever writes
// or reads one with other tools.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "golden/transport/world.hpp"

namespace photonloom {

// Where a map's photons lie: the cube of its plan.
struct Cube {
  Vec3 origin{0};
  double extent = 1;
};

// The photons of one pass and where they came from. A file written by other tools may say nothing
// but the photons.
struct PhotonFile {
  std::vector<Photon> photons;
  std::string kind;                    // "global" or "caustic"; empty: not said
  std::string scene;                   // its name, for people
  std::optional<uint64_t> scene_hash;  // of the scene that was traced
  std::optional<uint64_t> seed;
  std::optional<uint64_t> paths;      // emitted
  std::optional<uint64_t> requested;  // photons asked for
  std::optional<Cube> cube;
};

// Binary PLY, little endian; all that matters to the image is written as doubles, so that a map
// read back is the same map to the bit. The file appears whole or not at all.
void write_photon_file(const PhotonFile& file, const std::string& path);

// Element `vertex` with x, y, z, dx, dy, dz (to where the light came from, any length but 0),
// power_r, power_g, power_b (W, not negative), of any numeric type; path, bounce and flight may be
// missing: each photon is then a path of its own, and no flight is known. Throws SceneError naming
// file, property, and photon.
PhotonFile read_photon_file(const std::string& path);

// A point that asks, and the surface normal there.
struct QueryPoint {
  Vec3 position, normal;
};

// Element `vertex` with x, y, z and nx, ny, nz (any length but 0). Throws SceneError likewise.
std::vector<QueryPoint> read_query_file(const std::string& path);

// The smallest cube that holds all points, its edge longer by 2^-16, as a scene's.
Cube cube_around(const std::vector<Photon>& photons, const std::vector<QueryPoint>& queries);

// Whether a point is in the cube: quantise_position does not clamp it.
bool holds(const Cube& cube, const Vec3& point);

}  // namespace photonloom
