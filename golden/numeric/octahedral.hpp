// SPDX-License-Identifier: Apache-2.0
// Directions as two b-bit codes on the octahedron (Meyer et al. 2010). A code names a cell, its
// centre is the decoded direction; all centres have odd coordinates, so no sign is ever ambiguous.
// The top a bits of a b-bit code are the a-bit code of the same direction.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "golden/numeric/vec.hpp"

namespace photonloom {

struct OctCode {
  uint32_t u = 0, v = 0;
  bool operator==(const OctCode&) const = default;
};

// Unnormalised integer decode: |x| + |y| + |z| = 2^b, each in [-2^b, 2^b] (b + 2 bits signed).
constexpr IVec3 oct_decode(OctCode c, int b) {
  const int32_t m = int32_t{1} << b;
  int32_t x = static_cast<int32_t>(2 * c.u + 1) - m;
  int32_t y = static_cast<int32_t>(2 * c.v + 1) - m;
  const int32_t ax = x < 0 ? -x : x, ay = y < 0 ? -y : y;
  const int32_t z = m - ax - ay;
  if (z < 0) {
    x = x < 0 ? -(m - ay) : m - ay;
    y = y < 0 ? -(m - ax) : m - ax;
  }
  return {x, y, z};
}

// Point (s, t) of [-1,1]^2 on the unfolded octahedron -> direction, not normalised (|x|+|y|+|z| =
// 1).
inline Vec3 oct_unfold(double s, double t) {
  const double as = std::fabs(s), at = std::fabs(t);
  const double z = 1.0 - as - at;
  if (z >= 0) return Vec3(s, t, z);
  return Vec3(s < 0 ? -(1.0 - at) : 1.0 - at, t < 0 ? -(1.0 - as) : 1.0 - as, z);
}

// Any direction but zero -> the point of [-1,1]^2.
inline Vec2 oct_fold(const Vec3& d) {
  const double inv = 1.0 / (std::fabs(d.x) + std::fabs(d.y) + std::fabs(d.z));
  const double x = d.x * inv, y = d.y * inv;
  if (d.z >= 0) return Vec2(x, y);
  return Vec2(x < 0 ? -(1.0 - std::fabs(y)) : 1.0 - std::fabs(y),
              y < 0 ? -(1.0 - std::fabs(x)) : 1.0 - std::fabs(x));
}

// The named conversion direction -> code: the cell that holds it.
inline OctCode oct_encode(const Vec3& d, int b) {
  const Vec2 p = oct_fold(d);
  const double cells = static_cast<double>(uint32_t{1} << b);
  const auto code = [&](double x) {
    const double c = std::floor((x + 1.0) * 0.5 * cells);
    return static_cast<uint32_t>(std::clamp(c, 0.0, cells - 1.0));
  };
  return {code(p.x), code(p.y)};
}

// Solid angle per unit area of [-1,1]^2 at p = oct_unfold(s, t): 1 / |p|^3.
inline double oct_jacobian(const Vec3& unfolded) {
  const double r2 = glm::dot(unfolded, unfolded);
  return 1.0 / (r2 * std::sqrt(r2));
}

// o(a) . o(b), exact: at most 2^(ba+bb) in magnitude.
constexpr int64_t oct_dot(const IVec3& a, const IVec3& b) {
  return int64_t{a[0]} * b[0] + int64_t{a[1]} * b[1] + int64_t{a[2]} * b[2];
}

}  // namespace photonloom
