// SPDX-License-Identifier: Apache-2.0
// The shader: turns gather results into contributions to a pixel, in exact integers. A pixel counts
// 2^-F W/(m^2 sr), F = plan.fraction_bits, in up to 128 bits; see docs/frame.md.
#pragma once
#include <array>
#include <cstdint>

#include "golden/numeric/bits.hpp"
#include "golden/numeric/vec.hpp"
#include "golden/packet/packet.hpp"
#include "golden/plan/plan.hpp"

namespace photonloom {

// What a query's flux over r^2 is multiplied with, a channel each: mantissa * 2^exponent, in
// pixel units * position_unit^2 / power unit. A normalised mantissa has plan.weight_bits bits; 0 is
// 0 * 2^0.
struct Weight {
  std::array<uint32_t, 3> mantissa{};
  std::array<int32_t, 3> exponent{};
  bool operator==(const Weight&) const = default;
};

// A share of a record's light is at most 2^this: the largest throughput that a plan has room for.
inline constexpr int kShareBits = 8;

using PixelValue = std::array<UInt128, 3>;  // R, G, B

// Values that did not fit a pixel's integer bits and were taken as the largest that does. A plan
// from the planner leaves room for every scene it was made for, so these are reported when not 0.
struct ShaderCounts {
  uint64_t weights = 0;  // channels of weights
  uint64_t direct = 0;   // channels of direct light, emission, glossy light
  // Channels that were no finite number and count as 0: a fault of the walks.
  uint64_t not_finite = 0;
};

class Shader {
 public:
  explicit Shader(const Plan& plan);

  // The named conversion of a query: `weight` is what irradiance is multiplied with on its way to
  // the pixel (throughput, rho / pi, cosine, 1 / pdf, 1 / final gather rays), >= 0, 1/sr. Folds in
  // 1/pi, the power unit of the query's map, the position unit and F; the mantissa is rounded half
  // up.
  Weight weight(const Rgb& weight, bool is_caustic, ShaderCounts& counts) const;

  // Round half up of flux * R * c * weight: R the result's reciprocal of max(r2, r2_floor), or the
  // shader's own where results carry none; c = (k-1)/k as a W-bit constant, rounded half up, when
  // the result is full, else 1.
  PixelValue contribution(const GatherResult& result, const Weight& weight) const;

  // The named conversion of direct light, emission and glossy light (W/(m^2 sr), >= 0): round half
  // up.
  PixelValue pixel(const Rgb& radiance, ShaderCounts& counts) const;

  // The named conversion of what a record's light is multiplied with (throughput, rho), >= 0: as a
  // query's weight, in pixel units a pixel unit; at most 2^kShareBits.
  Weight share(const Rgb& weight, ShaderCounts& counts) const;

  // A record's part in a pixel: round half up of light * f * 2^(e - 12), f the round half up of
  // m * 2^12 * weight / total, m * 2^e the share.
  PixelValue interpolated(const PixelValue& light, uint32_t weight, uint32_t total,
                          const Weight& share) const;

  // A sum of contributions as radiance.
  double radiance(UInt128 value) const;

  // Photons per m^2 of surface at a result, in double; shown beside the image, not part of it.
  double photon_density(const GatherResult& result) const;

 private:
  Plan plan_;
  int bits_;             // W
  uint32_t full_;        // c of a full result, in 2^-W
  int exponent_max_;     // of a weight
  double inverse_area_;  // 1 / (pi position_unit^2), 1/m^2
};

}  // namespace photonloom
