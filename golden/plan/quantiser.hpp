// SPDX-License-Identifier: Apache-2.0
// Named conversions from scene units to the plan's integers.
#pragma once
#include <algorithm>
#include <cmath>

#include "golden/numeric/vec.hpp"
#include "golden/plan/clamp_counts.hpp"
#include "golden/plan/plan.hpp"

namespace photonloom {

// Position in the scene's cube -> position units, rounded down (a unit is a half-open cell),
// clamped to the cube, which `counts` counts.
inline UVec3 quantise_position(const Plan& plan, const Vec3& x, ClampCounts* counts = nullptr) {
  const double scale = static_cast<double>(uint64_t{1} << plan.position_bits) / plan.extent;
  const double top = static_cast<double>(ones(plan.position_bits));
  UVec3 q;
  bool outside = false;
  for (int i = 0; i < 3; ++i) {
    const double c = std::floor((x[i] - plan.origin[static_cast<size_t>(i)]) * scale);
    q[static_cast<size_t>(i)] = static_cast<uint32_t>(std::clamp(c, 0.0, top));
    outside |= !(c >= 0 && c <= top);
  }
  if (counts) counts->positions += outside;
  return q;
}

// Radius in scene units -> r2_max: floor((radius / unit)^2), quotient and square each rounded to
// double (docs/plan.md); radius 0 means none.
inline uint64_t radius_to_r2_max(const Plan& plan, double radius) {
  if (radius <= 0) return plan.r2_limit();
  const double r = radius / plan.position_unit();
  const double r2 = std::floor(r * r);
  return r2 >= static_cast<double>(plan.r2_limit()) ? plan.r2_limit() : static_cast<uint64_t>(r2);
}

}  // namespace photonloom
