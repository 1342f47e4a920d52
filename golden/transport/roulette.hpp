// SPDX-License-Identifier: Apache-2.0
// Russian roulette.
#pragma once
#include <algorithm>
#include <cstdint>

#include "golden/numeric/vec.hpp"

namespace photonloom {

// From segment rr_depth on a path goes on with the probability of its largest throughput, at most
// 0.95 so that paths between perfect mirrors end too. Divides the throughput by it. `scale` takes
// factors out of the choice that do not stand for lost light (ior^2 of radiance in glass).
inline bool survives(Rgb& throughput, uint64_t segment, int rr_depth, double u,
                     double scale = 1.0) {
  if (rr_depth < 0 || segment < static_cast<uint64_t>(rr_depth)) return true;
  const double p = std::min(0.95, max_component(throughput) * scale);
  if (!(u < p)) return false;
  throughput /= p;
  return true;
}

}  // namespace photonloom
