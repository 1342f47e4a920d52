// SPDX-License-Identifier: Apache-2.0
#include "golden/transport/camera.hpp"

#include <cmath>

#include "golden/numeric/elementary.hpp"
#include "golden/numeric/random.hpp"
#include "golden/transport/sampling.hpp"
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
      camera_(scene.camera),
      width_(is_sparse(film_) ? film_.frame_width : film_.width),
      height_(is_sparse(film_) ? film_.frame_height : film_.height),
      whole_width_(film_.is_window() ? film_.whole_width : width_),
      whole_height_(film_.is_window() ? film_.whole_height : height_) {
  const double aspect = whole_width_ / whole_height_;
  if (is_orthographic()) {
    tan_x_ = 1;
    tan_y_ = 1 / aspect;
    return;
  }
  const Vec2 half = cos_sin_turns(camera_.fov / 720.0);
  const double tangent = half.y / half.x;
  switch (camera_.fov_axis) {
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

CameraRay Lens::through(double x, double y, const Vec2& u) const {
  if (is_sparse(film_)) {
    const auto column = static_cast<int64_t>(x), row = static_cast<int64_t>(y);
    const Place pixel = frame_pixel(film_, column, row);
    x += static_cast<double>(pixel.x - column);
    y += static_cast<double>(pixel.y - row);
  }
  x += film_.left + camera_.offset_x * whole_width_;
  y += film_.top + camera_.offset_y * whole_height_;
  const Mat4& to_world = camera_.to_world;
  const Vec2 plane(tan_x_ * (1 - 2 * x / whole_width_), tan_y_ * (1 - 2 * y / whole_height_));
  CameraRay camera;
  if (is_orthographic()) {
    const double scale = glm::length(Vec3(to_world[2]));
    camera.ray.origin =
        Vec3(to_world[3]) + Vec3(to_world[0]) * plane.x + Vec3(to_world[1]) * plane.y;
    camera.ray.direction = Vec3(to_world[2]) / scale;
    camera.near = camera_.near_clip * scale;
    camera.far = camera_.far_clip * scale;
    return camera;
  }
  camera.ray.origin = Vec3(to_world[3]);
  Vec3 local(plane, 1.0);
  if (has_aperture()) {
    const Vec2 lens = sample_disk(u) * camera_.aperture_radius;
    local = Vec3(plane - lens / camera_.focus_distance, 1.0);
    camera.ray.origin += Vec3(to_world[0]) * lens.x + Vec3(to_world[1]) * lens.y;
  }
  local = glm::normalize(local);
  camera.ray.direction = glm::normalize(Vec3(to_world[0]) * local.x + Vec3(to_world[1]) * local.y +
                                        Vec3(to_world[2]) * local.z);
  camera.near = camera_.near_clip / local.z;
  camera.far = camera_.far_clip / local.z;
  return camera;
}

bool Lens::project(const Vec3& point, const Vec2& u, Seen& seen) const {
  const Mat4& to_world = camera_.to_world;
  const Vec3 d = point - Vec3(to_world[3]);
  Vec3 local = glm::inverse(glm::dmat3(to_world)) * d;
  if (is_orthographic() ? local.z < camera_.near_clip
                        : !(local.z > 0) || local.z < camera_.near_clip)
    return false;
  if (camera_.far_clip > 0 && local.z > camera_.far_clip) return false;
  Vec2 plane(local.x, local.y);
  if (!is_orthographic()) {
    Vec2 lens(0);
    if (has_aperture()) {
      lens = sample_disk(u) * camera_.aperture_radius;
      local -= Vec3(lens, 0);
    }
    plane = Vec2(local.x / local.z, local.y / local.z);
    if (has_aperture()) plane += lens / camera_.focus_distance;
  }
  seen.x = (1 - plane.x / tan_x_) * whole_width_ / 2;
  seen.y = (1 - plane.y / tan_y_) * whole_height_ / 2;
  seen.x -= film_.left + camera_.offset_x * whole_width_;
  seen.y -= film_.top + camera_.offset_y * whole_height_;
  if (!(seen.x >= 0 && seen.x < width_ && seen.y >= 0 && seen.y < height_)) return false;
  if (is_sparse(film_)) {
    const auto column = static_cast<int64_t>(seen.x), row = static_cast<int64_t>(seen.y);
    const Place part{((column + 1) * film_.width - 1) / film_.frame_width,
                     ((row + 1) * film_.height - 1) / film_.frame_height};
    const Place pixel = frame_pixel(film_, part.x, part.y);
    if (pixel.x != column || pixel.y != row) return false;
    seen.x += static_cast<double>(part.x - column);
    seen.y += static_cast<double>(part.y - row);
  }
  const CameraRay camera = through(seen.x, seen.y, u);
  if (is_orthographic()) {
    const Vec3 across = glm::cross(Vec3(to_world[0]), Vec3(to_world[1]));
    seen.to_camera = -camera.ray.direction;
    seen.distance = glm::dot(point - camera.ray.origin, camera.ray.direction) - camera.near;
    seen.density = whole_width_ * whole_height_ /
                   (4 * tan_x_ * tan_y_ * std::fabs(glm::dot(across, camera.ray.direction)));
    return seen.distance > 0;
  }
  // A pixel's area on the plane z = 1 is 4 tan_x tan_y / (width height); the plane's solid angle
  // per area is cos^3.
  const Vec3 back = camera.ray.origin - point;
  const double distance2 = glm::dot(back, back), distance = std::sqrt(distance2);
  const double cosine = local.z / glm::length(local);
  seen.to_camera = back / distance;
  seen.distance = distance - camera.near;
  seen.density =
      whole_width_ * whole_height_ / (4 * tan_x_ * tan_y_ * cosine * cosine * cosine) / distance2;
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
