// SPDX-License-Identifier: Apache-2.0
// What a bounded search (epsilon, leaf limit) leaves out, beside the exact search of the same
// queries, and whether an estimate that knows of the bound mends it.
#pragma once
#include <span>

#include "golden/packet/packet.hpp"
#include "golden/plan/plan.hpp"
#include "golden/unit/photon_map.hpp"

namespace photonloom {

// Sums over queries; an estimate is flux over r^2, the three channels added up.
struct BoundedSearch {
  double recall = 1;  // part of the exact search's photons that the bounded one finds
  double light = 0;   // sum of its estimates over the exact ones', minus 1
  double spread = 0;  // root of the mean squared difference, over the exact ones' root mean square
  // The same estimates times the one factor that makes `light` 0.
  double spread_scaled = 0;
  // The estimate within what was searched whole: the radius ends at the nearest subtree left out,
  // the photons within it count. Where they are fewer than four, the ordinary estimate.
  double light_known = 0, spread_known = 0;
};

// Of an exact plan the default, at no cost.
BoundedSearch bounded_search(const Plan& plan, const PhotonMap& global, const PhotonMap& caustic,
                             std::span<const GatherQuery> queries);

}  // namespace photonloom
