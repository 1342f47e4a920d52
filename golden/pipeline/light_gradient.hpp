// SPDX-License-Identifier: Apache-2.0
// How the light of a record changes over its reach: to first order in the turn of the normal and
// in the way along the surface (docs/irradiance_cache.md, "Gradients"; after Ward and Heckbert,
// Irradiance Gradients, 1992, for rays that stand for a point of the surface that they hit).
#pragma once
#include <array>
#include <cmath>
#include <cstdint>

#include "golden/numeric/vec.hpp"
#include "golden/pipeline/light.hpp"
#include "golden/plan/clamp_counts.hpp"
#include "golden/plan/plan.hpp"
#include "golden/transport/world.hpp"

namespace photonloom {

// The logarithmic derivatives of what a ray brings, as integers: by the normal in units of
// 2^-kTurnBits, by the way in units of 2^-kWayBits over scene.extent. 0 where the plan asks for
// none. Within 2^31.
struct RayGradient {
  static constexpr int kTurnBits = 16, kWayBits = 12;
  std::array<int32_t, 3> turn{}, way{};
};

// Of a ray from x towards `direction` (unit length, above x's shading normal), which hit y; y is
// null for what came otherwise than straight from a diffuse surface, and has no derivative by the
// way then. `counts` counts what does not fit.
RayGradient ray_gradient(const Plan& plan, const DiffuseHit& x, const Vec3& direction,
                         const DiffuseHit* y, ClampCounts& counts);

// The derivatives of a record's light, added up over its rays: exact where light is.
template <Arithmetic kArithmetic>
class RecordGradient {
  using Value = typename LightValues<kArithmetic>::Value;

 public:
  void add(const Value& light, const RayGradient& ray) {
    for (size_t axis = 0; axis < 3; ++axis) {
      turn_[axis].add(light, ray.turn[axis]);
      way_[axis].add(light, ray.way[axis]);
    }
  }

  // What the record's light is multiplied with at a point whose normal is `turn` further and which
  // lies `way` (scene.extent) off, in colour c of which the record has `light`. From 0 to 2, so
  // that no light turns negative, which `counts` counts; 1 where there is none.
  double factor(size_t c, double light, const Vec3& turn, const Vec3& way,
                ClampCounts& counts) const {
    if (!(light > 0)) return 1;
    double turned = 0, moved = 0;
    for (int axis = 0; axis < 3; ++axis) {
      turned += turn[axis] * turn_[static_cast<size_t>(axis)][c];
      moved += way[axis] * way_[static_cast<size_t>(axis)][c];
    }
    const double change =
        (std::ldexp(turned, -RayGradient::kTurnBits) + std::ldexp(moved, -RayGradient::kWayBits)) /
        light;
    counts.changes += !(std::fabs(change) <= 1);
    return 1 + std::fmin(std::fmax(change, -1.0), 1.0);
  }

 private:
  std::array<typename LightValues<kArithmetic>::FilmSum, 3> turn_{}, way_{};
};

}  // namespace photonloom
