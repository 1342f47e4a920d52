// SPDX-License-Identifier: Apache-2.0
// What paths find, by the layers of an image (path.hpp).
#pragma once
#include "golden/numeric/vec.hpp"

namespace photonloom {

// One camera path's light.
struct PathSample {
  Rgb emission{0}, direct{0}, caustic{0}, indirect{0};
  Vec2 place{0};  // within its pixel
  Rgb albedo{0};
  Vec3 normal{0};
  double depth = 0;
};

// What a light path adds to the pixel that it is seen in.
struct Splat {
  double x = 0, y = 0;  // on the film, pixels
  Rgb direct{0}, caustic{0}, indirect{0};
};

}  // namespace photonloom
