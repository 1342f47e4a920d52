// SPDX-License-Identifier: Apache-2.0
#include "golden/transport/camera.hpp"

#include <cmath>

#include "golden/numeric/elementary.hpp"
#include "golden/numeric/random.hpp"
#include "golden/transport/visibility.hpp"

namespace photonloom {
namespace {

bool is_sparse(const Film& film) { return film.frame_width > 0; }

struct Place {
  int64_t x, y;
};
// The pixel of the frame that stands in the film's pixel (x, y).
Place frame_pixel(const Film& film, int64_t x, int64_t y) {
  const uint64_t lot = hash_bits(0, static_cast<uint64_t>(y * film.width + x), 0, 0);
  const auto pick = [](int64_t part, int64_t parts, int64_t edge, uint64_t bits) {
    const int64_t from = part * edge / parts, to = (part + 1) * edge / parts;
    return from + static_cast<int64_t>(bits % static_cast<uint64_t>(to - from));
  };
  return {pick(x, film.width, film.frame_width, lot & 0xffffffff),
          pick(y, film.height, film.frame_height, lot >> 32)};
}

}  // namespace

Lens::Lens(const Scene& scene)
    : film_(scene.film),
      to_world_(scene.camera.to_world),
      width_(is_sparse(film_) ? film_.frame_width : film_.width),
      height_(is_sparse(film_) ? film_.frame_height : film_.height),
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
  if (is_sparse(film_)) {
    const auto column = static_cast<int64_t>(x), row = static_cast<int64_t>(y);
    const Place pixel = frame_pixel(film_, column, row);
    x += static_cast<double>(pixel.x - column);
    y += static_cast<double>(pixel.y - row);
  }
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
  if (is_sparse(film_)) {
    const auto column = static_cast<int64_t>(x), row = static_cast<int64_t>(y);
    const Place part{((column + 1) * film_.width - 1) / film_.frame_width,
                     ((row + 1) * film_.height - 1) / film_.frame_height};
    const Place pixel = frame_pixel(film_, part.x, part.y);
    if (pixel.x != column || pixel.y != row) return false;
    x += static_cast<double>(part.x - column);
    y += static_cast<double>(part.y - row);
  }
  // A pixel's area on the plane z = 1 is 4 tan_x tan_y / (width height); the plane's solid angle
  // per area is cos^3.
  const double cosine = local.z / glm::length(local);
  density = width_ * height_ / (4 * tan_x_ * tan_y_ * cosine * cosine * cosine);
  return true;
}

Hit first_hit(const World& world, const RayCaster& caster, const CameraRay& camera, double u) {
  Ray ray = camera.ray;
  ray.origin += ray.direction * camera.near;
  Hit hit = pass_openings(world, caster, ray, caster.closest(ray, nullptr), u);
  hit.distance += camera.near;
  if (camera.far > 0 && hit.distance > camera.far) return Hit();
  return hit;
}

}  // namespace photonloom
