// SPDX-License-Identifier: Apache-2.0
// The boxes of all shapes with a delta BSDF. A photon that meets none of them never becomes a
// caustic photon and need not be traced.
#pragma once
#include <utility>
#include <vector>

#include "golden/transport/world.hpp"

namespace photonloom {

class DeltaBoxes {
 public:
  explicit DeltaBoxes(const World& world);
  // False only where the ray passes all boxes by.
  bool met_by(const Ray& ray) const;

 private:
  std::vector<std::pair<Vec3, Vec3>> boxes_;
};

}  // namespace photonloom
