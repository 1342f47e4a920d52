// SPDX-License-Identifier: Apache-2.0
#include "golden/transport/camera.hpp"

#include <cmath>

#include "golden/numeric/elementary.hpp"

namespace photonloom {

Lens::Lens(const Scene& scene)
    : to_world_(scene.camera.to_world),
      width_(scene.film.width),
      height_(scene.film.height),
      near_(scene.camera.near_clip),
      far_(scene.camera.far_clip) {
  const Vec2 half = cos_sin_turns(scene.camera.fov / 720.0);
  const double tangent = half.y / half.x, aspect = width_ / height_;
  switch (scene.camera.fov_axis) {
    case FovAxis::kX:
      tan_x_ = tangent;
      break;
    case FovAxis::kY:
      tan_x_ = tangent * aspect;
      break;
    case FovAxis::kSmaller:
      tan_x_ = aspect > 1 ? tangent * aspect : tangent;
      break;
    case FovAxis::kLarger:
      tan_x_ = aspect > 1 ? tangent : tangent * aspect;
      break;
    default:
      tan_x_ = tangent / std::sqrt(1 + 1 / (aspect * aspect));
  }
  tan_y_ = tan_x_ / aspect;
}

CameraRay Lens::through(double x, double y) const {
  const Vec3 local =
      glm::normalize(Vec3(tan_x_ * (1 - 2 * x / width_), tan_y_ * (1 - 2 * y / height_), 1.0));
  CameraRay camera;
  camera.ray.origin = Vec3(to_world_[3]);
  camera.ray.direction = glm::normalize(
      Vec3(to_world_[0]) * local.x + Vec3(to_world_[1]) * local.y + Vec3(to_world_[2]) * local.z);
  camera.near = near_ / local.z;
  camera.far = far_ / local.z;
  return camera;
}

bool Lens::project(const Vec3& point, double& x, double& y, double& density) const {
  const Vec3 d = point - Vec3(to_world_[3]);
  const Vec3 local = glm::inverse(glm::dmat3(to_world_)) * d;
  if (!(local.z > 0) || local.z < near_ || (far_ > 0 && local.z > far_)) return false;
  x = (1 - local.x / (local.z * tan_x_)) * width_ / 2;
  y = (1 - local.y / (local.z * tan_y_)) * height_ / 2;
  if (!(x >= 0 && x < width_ && y >= 0 && y < height_)) return false;
  // A pixel's area on the plane z = 1 is 4 tan_x tan_y / (width height); the plane's solid angle
  // per area is cos^3.
  const double cosine = local.z / glm::length(local);
  density = width_ * height_ / (4 * tan_x_ * tan_y_ * cosine * cosine * cosine);
  return true;
}

Hit first_hit(const RayCaster& caster, const CameraRay& camera) {
  Ray ray = camera.ray;
  ray.origin += ray.direction * camera.near;
  Hit hit = caster.closest(ray, nullptr);
  hit.distance += camera.near;
  if (camera.far > 0 && hit.distance > camera.far) return Hit();
  return hit;
}

}  // namespace photonloom
