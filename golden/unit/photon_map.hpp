// SPDX-License-Identifier: Apache-2.0
// The photon map as the hardware sees it: a complete binary kd-tree over full leaf lines.
//
// N photons fill L = ceil(N / bucket) lines. Tree nodes are numbered as in a heap: node 1 is the
// root, node i has the children 2i and 2i+1, nodes 1 .. L-1 are inner, nodes L .. 2L-1 are leaves;
// the leaf i is line i - L. Every line is full but the last (node 2L-1), which has N - (L-1) *
// bucket photons; its unused slots hold invalid_power.
//
// An inner node splits its photons along the axis in which their bounding box is longest (lowest
// axis on a tie), in the total order (coordinate on the axis, the next axis's, the one after,
// direction u, v, power mantissas, exponent, number in the input); the left child gets as many as
// its leaves hold. `split` is the coordinate of the first photon on the right: left coordinates are
// <= split, right ones >= split. Within a line photons stand in the order of their input numbers.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "golden/numeric/octahedral.hpp"
#include "golden/numeric/shared_exponent.hpp"
#include "golden/numeric/vec.hpp"
#include "golden/plan/plan.hpp"

namespace photonloom {

// A photon in the plan's formats.
struct PackedPhoton {
  UVec3 position;     // position units
  PowerCode power;    // power units
  OctCode direction;  // to where the light came from
  double flight = 0;  // Photon::flight, scene units; no part of a line, whoever asks has the index
  // Its path had left a photon before: another surface sent it. Known where the map is made, no
  // part of the photon that hardware stores.
  bool indirect = false;
};

struct MapNode {
  uint32_t axis = 0;   // 0, 1, 2
  uint32_t split = 0;  // position units
};

// Immutable once built. photon(i) for i < lines * bucket; `source[i]` is the number that photon i
// had in the input.
struct PhotonMap {
  uint64_t count = 0;  // N
  uint32_t lines = 0;  // L, 0 for an empty map
  int bucket = 8;
  std::vector<MapNode> nodes;       // [0] unused, 1 .. L-1
  std::vector<PackedPhoton> slots;  // lines * bucket, by index
  std::vector<uint32_t> source;     // by index; unused slots hold ~0

  bool valid(uint64_t index) const { return index < count; }
};

// Leaves under node i of a complete tree with L leaves (heap numbers 1 .. 2L-1).
uint32_t leaves_below(uint32_t node, uint32_t lines);

// Deterministic in the input. Uses threads.
PhotonMap build_photon_map(std::span<const PackedPhoton> photons, const Plan& plan);

}  // namespace photonloom
