// SPDX-License-Identifier: Apache-2.0
// Light from infinitely far away: one radiance, or a map of them by longitude and latitude.
#pragma once
#include <vector>

#include "golden/scene/scene.hpp"

namespace photonloom {

class Environment {
 public:
  explicit Environment(const Light& light);

  // From where the unit vector points to. A map is bilinear between the centres of its texels, in
  // longitude all the way round.
  Rgb radiance(const Vec3& direction) const;

  // Directions in proportion to what their texel shows on average, evenly within it; without a map
  // evenly. Density per solid angle.
  Vec3 sample(const Vec2& u, double& pdf) const;
  double pdf(const Vec3& direction) const;

  // Over all directions, and the largest component; of a map, of its texels.
  const Rgb& integral() const { return integral_; }
  double brightest() const { return brightest_; }

 private:
  Vec3 to_local(const Vec3& d) const;
  size_t width() const { return static_cast<size_t>(light_.map->width); }

  Light light_;
  Texture map_;
  Vec3 axis_[3];                       // of the map's frame, unit
  std::vector<double> cosines_;        // of the polar angles between rows, from 1 to -1
  std::vector<double> rows_, texels_;  // running sums of weights: of rows; of each row's texels
  Rgb integral_{0};
  double brightest_ = 0;
};

}  // namespace photonloom
