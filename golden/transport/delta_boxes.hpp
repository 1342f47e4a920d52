// SPDX-License-Identifier: Apache-2.0
// The boxes of all shapes with a delta BSDF. A photon that meets none of them never becomes a
// caustic photon and need not be traced; light from infinitely far away is emitted into them.
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

  // What the boxes cover across a direction, each on its own; and the mean over all directions.
  double area_across(const Vec3& direction) const;
  double mean_area_across() const;

  // A ray of this direction from outside the scene into one of the boxes, of which there must be
  // one. Rays are chosen in proportion to how many boxes they meet; `density` is per area across
  // the direction.
  Ray aim(const Vec3& direction, double choice, const Vec2& u, double& density) const;

 private:
  Vec3 centre_;  // of the scene
  double radius_;
  std::vector<std::pair<Vec3, Vec3>> boxes_;
};

}  // namespace photonloom
