// SPDX-License-Identifier: Apache-2.0
// Photons and queries as a photon mapper makes them: a closed room with two blocks, lit by a lamp
// in its ceiling, all surfaces diffuse.
#pragma once
#include <cstdint>
#include <vector>

#include "golden/numeric/vec.hpp"

namespace photonloom::bench {

inline constexpr int kPositionBits = 16;

// Where photons land, in the order in which they were traced.
std::vector<UVec3> trace_photons(size_t n, uint64_t seed);

// What a camera in the room sees, row by row from the top left: n hits.
std::vector<UVec3> camera_hits(size_t n);

// Hits of `rays` diffuse directions from each of n / rays camera hits, in the camera's order.
std::vector<UVec3> gather_hits(size_t n, size_t rays, uint64_t seed);

// Area of all surfaces, position units squared.
double surface_area();

}  // namespace photonloom::bench
