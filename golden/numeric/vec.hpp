// SPDX-License-Identifier: Apache-2.0
// Vectors of doubles. GLM without its SIMD types computes in the order written, so results are the
// same everywhere.
#pragma once
#include <array>
#include <cstdint>
#include <glm/glm.hpp>

namespace photonloom {

using Vec2 = glm::dvec2;
using Vec3 = glm::dvec3;
using Rgb = glm::dvec3;  // linear Rec.709
using IVec3 = std::array<int32_t, 3>;
using UVec3 = std::array<uint32_t, 3>;

inline double max_component(const Vec3& v) {
  return v.x > v.y ? (v.x > v.z ? v.x : v.z) : (v.y > v.z ? v.y : v.z);
}
inline double luminance(const Rgb& c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }
inline bool is_black(const Rgb& c) { return c.x == 0 && c.y == 0 && c.z == 0; }

// Orthonormal frame around a unit normal (Duff et al. 2017, "Building an Orthonormal Basis,
// Revisited").
struct Frame {
  Vec3 s, t, n;
  explicit Frame(const Vec3& normal) : n(normal) {
    const double sign = n.z >= 0 ? 1.0 : -1.0;
    const double a = -1.0 / (sign + n.z);
    const double b = n.x * n.y * a;
    s = Vec3(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x);
    t = Vec3(b, sign + n.y * n.y * a, -n.y);
  }
  Vec3 to_world(const Vec3& v) const { return s * v.x + t * v.y + n * v.z; }
  Vec3 to_local(const Vec3& v) const {
    return Vec3(glm::dot(v, s), glm::dot(v, t), glm::dot(v, n));
  }
};

}  // namespace photonloom
