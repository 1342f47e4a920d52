// SPDX-License-Identifier: Apache-2.0
#include "golden/pipeline/light_gradient.hpp"

#include <algorithm>

namespace photonloom {
namespace {

// A number that is none becomes 0 and counts too.
std::array<int32_t, 3> as_integers(const Vec3& v, int bits, ClampCounts& counts) {
  constexpr double kMost = 2147483647.0;
  std::array<int32_t, 3> result{};
  for (int axis = 0; axis < 3; ++axis) {
    const double scaled = std::floor(std::ldexp(v[axis], bits) + 0.5);
    counts.gradients += !(std::fabs(scaled) <= kMost);
    if (std::isfinite(scaled))
      result[static_cast<size_t>(axis)] = static_cast<int32_t>(std::clamp(scaled, -kMost, kMost));
  }
  return result;
}

}  // namespace

RayGradient ray_gradient(const Plan& plan, const DiffuseHit& x, const Vec3& direction,
                         const DiffuseHit* y, ClampCounts& counts) {
  RayGradient result;
  const Vec3& n = x.shading_normal;
  const auto wants = [&](CacheGradients which) {
    return plan.cache_gradients == which || plan.cache_gradients == CacheGradients::kBoth;
  };
  // A ray counts with its cosine: n . direction.
  if (wants(CacheGradients::kRotation))
    result.turn = as_integers(direction / glm::dot(n, direction), RayGradient::kTurnBits, counts);
  if (!y || !wants(CacheGradients::kTranslation)) return result;
  // y keeps its place and its light while x moves along the surface: what it sends to x goes with
  // cos cos / r^2, whose two cosines have x's way in them.
  const Vec3 to_y = y->position - x.position;
  const double r = std::sqrt(glm::dot(to_y, to_y)), facing = glm::dot(y->normal, direction);
  if (!(r > 0) || !(facing < 0)) return result;
  const Vec3 by_way = (direction * 4.0 - y->normal / facing) * (plan.extent / r);
  result.way = as_integers(by_way - n * glm::dot(n, by_way), RayGradient::kWayBits, counts);
  return result;
}

}  // namespace photonloom
