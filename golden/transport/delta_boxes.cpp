// SPDX-License-Identifier: Apache-2.0
#include "golden/transport/delta_boxes.hpp"

#include <algorithm>
#include <cmath>

#include "golden/transport/intersect.hpp"

namespace photonloom {
namespace {

// More boxes than this are merged into one: testing them would cost as much as tracing.
constexpr size_t kMostBoxes = 16;

bool meets(const Ray& ray, const Vec3& lower, const Vec3& upper) {
  double near = 0, far = HUGE_VAL;
  for (int axis = 0; axis < 3; ++axis) {
    const double d = ray.direction[axis], o = ray.origin[axis];
    if (d == 0) {
      if (o < lower[axis] || o > upper[axis]) return false;
      continue;
    }
    const double a = (lower[axis] - o) / d, b = (upper[axis] - o) / d;
    near = std::max(near, std::min(a, b));
    far = std::min(far, std::max(a, b));
  }
  return near <= far * (1 + 0x1p-40);
}

// What the face that is seen of the two across each axis covers across a direction.
Vec3 faces_across(const std::pair<Vec3, Vec3>& box, const Vec3& direction) {
  const Vec3 edge = box.second - box.first;
  return Vec3(edge.y * edge.z, edge.z * edge.x, edge.x * edge.y) * glm::abs(direction);
}

double total(const Vec3& v) { return v.x + v.y + v.z; }

}  // namespace

DeltaBoxes::DeltaBoxes(const World& world) : centre_(world.centre()), radius_(world.radius()) {
  uint32_t last_shape = ~0u;
  const World::Range own = world.world_primitives();
  for (uint32_t i = own.begin; i < own.end; ++i) {
    const Primitive& p = world.primitives()[i];
    if (!has_delta_part(world.scene(), world.bsdf(p.shape, true)) &&
        !has_delta_part(world.scene(), world.bsdf(p.shape, false)))
      continue;
    Vec3 lower, upper;
    primitive_bounds(p, lower, upper);
    if (p.shape != last_shape) boxes_.push_back({lower, upper});
    boxes_.back().first = glm::min(boxes_.back().first, lower);
    boxes_.back().second = glm::max(boxes_.back().second, upper);
    last_shape = p.shape;
  }
  std::vector<bool> groups(world.groups().size(), false);
  for (uint32_t s = 0; s < world.scene().shapes.size(); ++s) {
    const int group = world.scene().shapes[s].group;
    if (group >= 0 && (has_delta_part(world.scene(), world.bsdf(s, true)) ||
                       has_delta_part(world.scene(), world.bsdf(s, false))))
      groups[static_cast<size_t>(group)] = true;
  }
  for (const PlacedGroup& g : world.instances())
    if (groups[g.group]) boxes_.push_back({g.lower, g.upper});
  // Flat boxes get some thickness, far above rounding and far below anything seen.
  const Vec3 margin(world.cube_extent() * 0x1p-30);
  for (auto& b : boxes_) b = {b.first - margin, b.second + margin};
  if (boxes_.size() <= kMostBoxes) return;
  for (const auto& b : boxes_) {
    boxes_[0].first = glm::min(boxes_[0].first, b.first);
    boxes_[0].second = glm::max(boxes_[0].second, b.second);
  }
  boxes_.resize(1);
}

double DeltaBoxes::area_across(const Vec3& direction) const {
  double area = 0;
  for (const auto& b : boxes_) area += total(faces_across(b, direction));
  return area;
}

double DeltaBoxes::mean_area_across() const {
  // Cauchy: a quarter of a convex body's surface; the mean of a component of a direction is a half.
  return area_across(Vec3(0.5));
}

Ray DeltaBoxes::aim(const Vec3& direction, double choice, const Vec2& u, double& density) const {
  const double area = area_across(direction);
  // The face through which the ray enters.
  size_t chosen = 0;
  int axis = 0;
  double rest = choice * area;
  for (size_t i = 0; i < boxes_.size(); ++i) {
    const Vec3 faces = faces_across(boxes_[i], direction);
    for (int a = 0; a < 3; ++a) {
      if (!(faces[a] > 0) || rest < 0) continue;
      chosen = i;
      axis = a;
      rest -= faces[a];
    }
  }
  const auto& [lower, upper] = boxes_[chosen];
  const int second = (axis + 1) % 3, third = (axis + 2) % 3;
  Vec3 point;
  point[axis] = direction[axis] > 0 ? lower[axis] : upper[axis];
  point[second] = lower[second] + (upper[second] - lower[second]) * u.x;
  point[third] = lower[third] + (upper[third] - lower[third]) * u.y;
  const Ray ray{point - direction * (glm::dot(point - centre_, direction) + 2 * radius_),
                direction};
  // The chosen box it meets, whatever rounding at an edge says.
  int met = 1;
  for (size_t i = 0; i < boxes_.size(); ++i)
    met += i != chosen && meets(ray, boxes_[i].first, boxes_[i].second);
  density = met / area;
  return ray;
}

bool DeltaBoxes::met_by(const Ray& ray) const {
  for (const auto& b : boxes_)
    if (meets(ray, b.first, b.second)) return true;
  return false;
}

}  // namespace photonloom
