// SPDX-License-Identifier: Apache-2.0
// The camera: looks along local +z, +y up, +x to the image's left; pixel (0, 0) top left. Mitsuba's
// perspective, thinlens and orthographic.
#pragma once
#include "golden/transport/world.hpp"

namespace photonloom {

// A camera ray cut to the clipping planes: surfaces count from `near` to `far` along it.
struct CameraRay {
  Ray ray;
  double near = 0, far = 0;  // far 0: no limit
};

// A point as one point of the lens sees it.
struct Seen {
  double x = 0, y = 0;  // film position, pixels
  Vec3 to_camera{0};    // unit
  double distance = 0;  // up to the near clipping plane
  double density = 0;   // pixels per area across the line of sight, at the point
};

class Lens {
 public:
  explicit Lens(const Scene& scene);
  // Through the film position (x, y) in pixels, and the point of the lens for u, evenly spread;
  // u counts where has_aperture().
  CameraRay through(double x, double y, const Vec2& u = Vec2(0)) const;
  bool has_aperture() const { return camera_.kind == CameraKind::kThinLens; }
  // False: outside the film or the clipping planes.
  bool project(const Vec3& point, const Vec2& u, Seen& seen) const;

 private:
  CameraRay orthographic(double x, double y) const;
  bool is_orthographic() const { return camera_.kind == CameraKind::kOrthographic; }

  Film film_;
  Camera camera_;
  double width_, height_;              // of the frame
  double whole_width_, whole_height_;  // of the film that the frame is a window of
  double tan_x_, tan_y_;  // of half the field of view; orthographic: half the local edges
};

// The first hit within the camera's clipping planes, past open surfaces (visibility.hpp); its
// distance is counted from the camera.
Hit first_hit(const World& world, const RayCaster& caster, const CameraRay& camera, double u);

}  // namespace photonloom
