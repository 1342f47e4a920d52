// SPDX-License-Identifier: Apache-2.0
// The irradiance cache's arithmetic: reach of a record, its weight at a point; all defined in
// docs/irradiance_cache.md.
#pragma once
#include <cstdint>

#include "golden/numeric/reciprocal.hpp"
#include "golden/numeric/vec.hpp"
#include "golden/plan/clamp_counts.hpp"
#include "golden/plan/plan.hpp"

namespace photonloom {

// The named conversion of a unit normal: each coordinate plus 1, in units of 2^(1 - normal_bits),
// rounded down and clamped.
UVec3 quantise_normal(const Plan& plan, const Vec3& normal);

// The named conversion of a split-sphere radius (scene units): it is kept within the plan's
// smallest and largest, times cache.accuracy it is the reach; the reciprocal of the reach's square
// in squared position units, at least 1 and rounded down. `counts` counts both limits.
Reciprocal cache_falloff(const Plan& plan, double radius, ClampCounts* counts = nullptr);

// What a record keeps.
struct CacheRecord {
  UVec3 position;
  UVec3 normal;
  Reciprocal falloff;
};

// 2^B (1 - d^2 / reach^2 - (distance of the normals)^2 / 2^angle_bits), its two quotients rounded
// down; 0 where that is not positive. B is cache.weight_bits.
uint32_t cache_weight(const Plan& plan, const CacheRecord& record, const UVec3& position,
                      const UVec3& normal);

}  // namespace photonloom
