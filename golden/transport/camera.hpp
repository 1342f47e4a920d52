// SPDX-License-Identifier: Apache-2.0
// The perspective camera: looks along local +z, +y up, +x to the image's left; pixel (0, 0) top
// left.
#pragma once
#include "golden/transport/world.hpp"

namespace photonloom {

// A camera ray cut to the clipping planes: surfaces count from `near` to `far` along it.
struct CameraRay {
  Ray ray;
  double near = 0, far = 0;  // far 0: no limit
};

class Lens {
 public:
  explicit Lens(const Scene& scene);
  // Through the film position (x, y) in pixels.
  CameraRay through(double x, double y) const;
  // Where a point is seen: film position in pixels, and pixels per solid angle there. False:
  // outside the film or the clipping planes.
  bool project(const Vec3& point, double& x, double& y, double& density) const;

 private:
  Film film_;
  Mat4 to_world_;
  double width_, height_;  // of the frame
  double tan_x_, tan_y_;   // of half the field of view
  double near_, far_;
};

// The first hit within the camera's clipping planes, past open surfaces (visibility.hpp); its
// distance is counted from the camera.
Hit first_hit(const World& world, const RayCaster& caster, const CameraRay& camera, double u);

}  // namespace photonloom
