// SPDX-License-Identifier: Apache-2.0
#include "golden/transport/world.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "golden/numeric/elementary.hpp"
#include "golden/transport/emitters.hpp"

namespace photonloom {
namespace {

Vec3 column(const Mat4& m, int i) { return Vec3(m[i]); }

bool has_diffuse(const Bsdf* b) { return b && !is_black(b->diffuse) && !b->is_delta(); }

Primitive disk_primitive(const Shape& s) {
  Primitive p;
  p.kind = PrimitiveKind::kDisk;
  p.a = column(s.to_world, 3);
  p.b = column(s.to_world, 0);
  p.c = column(s.to_world, 1);
  const Vec3 n = glm::cross(p.b, p.c);
  p.area = kPi * glm::length(n);
  // The normal +z is carried by the inverse transpose: cross(x, y) times the determinant's sign.
  const bool mirrored = glm::dot(n, column(s.to_world, 2)) < 0;
  p.normal = glm::normalize(n) * (mirrored != s.flip_normals ? -1.0 : 1.0);
  return p;
}

Primitive sphere_primitive(const Shape& s) {
  Primitive p;
  p.kind = PrimitiveKind::kSphere;
  p.a = column(s.to_world, 3);
  p.b = Vec3(glm::length(column(s.to_world, 0)), 0, 0);
  p.area = 4 * kPi * p.b.x * p.b.x;
  p.inward = s.flip_normals;
  return p;
}

// Half the extent of a disk along each axis.
Vec3 disk_reach(const Primitive& p) {
  return Vec3(std::sqrt(p.b.x * p.b.x + p.c.x * p.c.x), std::sqrt(p.b.y * p.b.y + p.c.y * p.c.y),
              std::sqrt(p.b.z * p.b.z + p.c.z * p.c.z));
}

}  // namespace

void primitive_bounds(const Primitive& p, Vec3& lower, Vec3& upper) {
  switch (p.kind) {
    case PrimitiveKind::kTriangle:
      lower = glm::min(p.a, glm::min(p.b, p.c));
      upper = glm::max(p.a, glm::max(p.b, p.c));
      return;
    case PrimitiveKind::kSphere:
      lower = p.a - Vec3(p.b.x);
      upper = p.a + Vec3(p.b.x);
      return;
    case PrimitiveKind::kDisk:
      lower = p.a - disk_reach(p);
      upper = p.a + disk_reach(p);
      return;
  }
}

World::World(Scene scene) : scene_(std::move(scene)) {
  add_primitives();
  add_emitters();
}

void World::add_primitives() {
  for (uint32_t s = 0; s < scene_.shapes.size(); ++s) {
    const Shape& shape = scene_.shapes[s];
    const Bsdf* front = shape.bsdf < 0 ? nullptr : &scene_.bsdfs[static_cast<size_t>(shape.bsdf)];
    const bool both = front && (front->two_sided || front->kind == BsdfKind::kDielectric);
    side_bsdf_.push_back(shape.bsdf);
    side_bsdf_.push_back(shape.back_bsdf >= 0 ? shape.back_bsdf : both ? shape.bsdf : -1);
    const size_t first = primitives_.size();
    if (shape.kind == ShapeKind::kSphere) {
      primitives_.push_back(sphere_primitive(shape));
    } else if (shape.kind == ShapeKind::kDisk) {
      primitives_.push_back(disk_primitive(shape));
    } else {
      for (uint32_t t = 0; t < shape.mesh.triangles.size(); ++t) {
        const auto& v = shape.mesh.triangles[t];
        Primitive p;
        p.index = t;
        p.a = shape.mesh.positions[v[0]];
        p.b = shape.mesh.positions[v[1]];
        p.c = shape.mesh.positions[v[2]];
        const Vec3 n = glm::cross(p.b - p.a, p.c - p.a);
        const double length = glm::length(n);
        if (!(length > 0)) continue;  // no area: nothing can meet it
        p.normal = n / length;
        p.area = length / 2;
        primitives_.push_back(p);
      }
    }
    for (size_t i = first; i < primitives_.size(); ++i) {
      primitives_[i].shape = s;
      surface_area_ += primitives_[i].area;
      for (bool side : {true, false})
        if (has_diffuse(bsdf(s, side))) diffuse_area_ += primitives_[i].area;
    }
    for (bool side : {true, false}) {
      const Bsdf* b = bsdf(s, side);
      has_delta_ = has_delta_ || (b && b->is_delta());
      has_glossy_ = has_glossy_ || (b && b->kind == BsdfKind::kPhong && !is_black(b->specular));
    }
  }
  if (primitives_.empty()) throw SceneError(scene_.name + ": the scene has no shapes with area");
  lower_ = Vec3(HUGE_VAL);
  upper_ = Vec3(-HUGE_VAL);
  for (const Primitive& p : primitives_) {
    Vec3 lo, hi;
    primitive_bounds(p, lo, hi);
    lower_ = glm::min(lower_, lo);
    upper_ = glm::max(upper_, hi);
  }
  // Squares and products of lengths, some in single precision, stay far from its limits.
  constexpr double kSmallest = 1e-12, kLargest = 1e12;
  const double across = max_component(upper_ - lower_);
  if (!(across >= kSmallest && across <= kLargest))
    throw SceneError(fmt::format("{}: the scene is {:g} units across, expected {:g} to {:g}",
                                 scene_.name, across, kSmallest, kLargest));
  centre_ = (lower_ + upper_) * 0.5;
  for (const Primitive& p : primitives_) {
    if (p.kind == PrimitiveKind::kTriangle) {
      for (const Vec3& v : {p.a, p.b, p.c}) radius_ = std::max(radius_, glm::length(v - centre_));
    } else {
      const double reach = p.kind == PrimitiveKind::kSphere
                               ? p.b.x
                               : std::max(glm::length(p.b), glm::length(p.c)) * std::sqrt(2.0);
      radius_ = std::max(radius_, glm::length(p.a - centre_) + reach);
    }
  }
  radius_ = std::min(radius_, glm::length(upper_ - lower_) * 0.5);
  cube_extent_ = max_component(upper_ - lower_) * (1 + 0x1p-16);
  cube_origin_ = centre_ - Vec3(cube_extent_ * 0.5);
}

void World::add_emitters() {
  for (size_t i = 0; i < primitives_.size(); ++i) {
    Primitive& p = primitives_[i];
    const std::optional<Rgb>& radiance = scene_.shapes[p.shape].radiance;
    if (!radiance || is_black(*radiance)) continue;
    p.emitter = static_cast<int32_t>(emitters_.size());
    Emitter e;
    e.primitive = static_cast<int32_t>(i);
    e.radiance = *radiance;
    e.power = *radiance * (kPi * p.area);
    emitters_.push_back(e);
  }
  for (size_t i = 0; i < scene_.lights.size(); ++i) {
    Emitter e;
    e.light = static_cast<int32_t>(i);
    e.power = light_power(scene_.lights[i], radius_);
    if (!is_black(e.power)) emitters_.push_back(e);
  }
  if (emitters_.empty()) throw SceneError(scene_.name + ": the scene has no light");
  for (const Emitter& e : emitters_) emitted_power_ += e.power;
  const double total = mean(emitted_power_);
  double sum = 0;
  for (Emitter& e : emitters_) {
    e.pmf = mean(e.power) / total;
    sum += e.pmf;
    emitter_cdf_.push_back(sum);
  }
}

uint32_t World::choose_emitter(double u) const {
  const auto at =
      std::upper_bound(emitter_cdf_.begin(), emitter_cdf_.end(), u * emitter_cdf_.back());
  return static_cast<uint32_t>(
      std::min<size_t>(static_cast<size_t>(at - emitter_cdf_.begin()), emitters_.size() - 1));
}

}  // namespace photonloom
