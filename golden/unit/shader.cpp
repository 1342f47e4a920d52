// SPDX-License-Identifier: Apache-2.0
#include "golden/unit/shader.hpp"

#include <algorithm>
#include <cmath>

#include "golden/numeric/elementary.hpp"
#include "golden/numeric/reciprocal.hpp"

namespace photonloom {
namespace {

// floor(m * 2^e + 1/2) of an integer m < 2^127. A plan that passed its checks keeps m * 2^e below
// 2^127; only a faulty unit's packet asks for more.
UInt128 scaled(UInt128 m, int e) {
  if (e > 127) return 0;
  if (e >= 0) return m << e;
  if (e < -127) return 0;
  return (m + (UInt128{1} << (-e - 1))) >> -e;
}

// floor(light * f * 2^e + 1/2), f < 2^38, e < 0. A plan that passed its checks keeps it below
// 2^128.
UInt128 scaled_light(UInt128 light, uint64_t f, int e) {
  if (e < -165) return 0;
  const auto low = static_cast<uint64_t>(light);
  const UInt128 bottom = UInt128{low} * f;
  UInt128 top = (light >> 64) * f + (bottom >> 64);  // above 64 bits
  uint64_t rest = static_cast<uint64_t>(bottom);
  const int half = -e - 1;
  if (half < 64) {
    const uint64_t sum = rest + (uint64_t{1} << half);
    top += sum < rest;
    rest = sum;
  } else {
    top += UInt128{1} << (half - 64);
  }
  if (-e >= 64) return top >> (-e - 64);
  return top << (64 + e) | rest >> -e;
}

// Bits of a record's part that its division by the total keeps beside the share's own.
constexpr int kPartBits = 12;

}  // namespace

Shader::Shader(const Plan& plan)
    : plan_(plan),
      bits_(plan.shader_bits()),
      full_(static_cast<uint32_t>(((uint64_t{2} * static_cast<uint64_t>(plan.k - 1) << bits_) +
                                   static_cast<uint64_t>(plan.k)) /
                                  (2 * static_cast<uint64_t>(plan.k)))),
      exponent_max_(plan.weight_exponent_max()),
      inverse_area_(1 / (kPi * (plan.position_unit() * plan.position_unit()))) {}

Weight Shader::weight(const Rgb& weight, bool is_caustic, ShaderCounts& counts) const {
  const int scale = plan_.fraction_bits + plan_.map(is_caustic).power_exponent;
  Weight result;
  for (size_t c = 0; c < 3; ++c) {
    double value = weight[static_cast<int>(c)] * inverse_area_;
    if (plan_.channels == 1) value *= plan_.channel_color[c];
    if (!std::isfinite(value)) ++counts.not_finite;
    if (!(value > 0) || !std::isfinite(value)) continue;
    int exponent;
    const double fraction = std::frexp(value, &exponent);  // [0.5, 1)
    auto mantissa =
        static_cast<uint64_t>(std::floor(std::ldexp(fraction, plan_.weight_bits) + 0.5));
    exponent += scale - plan_.weight_bits;
    if (mantissa >> plan_.weight_bits) {  // a carry moves the exponent
      mantissa >>= 1;
      ++exponent;
    }
    if (exponent > exponent_max_) {
      mantissa = ones(plan_.weight_bits);
      exponent = exponent_max_;
      ++counts.weights;
    }
    result.mantissa[c] = static_cast<uint32_t>(mantissa);
    result.exponent[c] = exponent;
  }
  return result;
}

Weight Shader::share(const Rgb& weight, ShaderCounts& counts) const {
  Weight result;
  for (size_t c = 0; c < 3; ++c) {
    const double value = weight[static_cast<int>(c)];
    if (!std::isfinite(value)) ++counts.not_finite;
    if (!(value > 0) || !std::isfinite(value)) continue;
    int exponent;
    const double fraction = std::frexp(value, &exponent);  // [0.5, 1)
    auto mantissa =
        static_cast<uint64_t>(std::floor(std::ldexp(fraction, plan_.weight_bits) + 0.5));
    exponent -= plan_.weight_bits;
    if (mantissa >> plan_.weight_bits) {  // a carry moves the exponent
      mantissa >>= 1;
      ++exponent;
    }
    if (exponent > kShareBits - plan_.weight_bits) {
      mantissa = ones(plan_.weight_bits);
      exponent = kShareBits - plan_.weight_bits;
      ++counts.weights;
    }
    result.mantissa[c] = static_cast<uint32_t>(mantissa);
    result.exponent[c] = exponent;
  }
  return result;
}

PixelValue Shader::interpolated(const PixelValue& light, uint32_t weight, uint32_t total,
                                const Weight& share) const {
  PixelValue value{};
  for (size_t c = 0; c < 3; ++c) {
    const uint64_t whole = uint64_t{share.mantissa[c]} * weight << kPartBits;
    const uint64_t part = (2 * whole + total) / (2 * uint64_t{total});
    value[c] = scaled_light(light[c], part, share.exponent[c] - kPartBits);
  }
  return value;
}

PixelValue Shader::contribution(const GatherResult& result, const Weight& weight) const {
  const Reciprocal r = plan_.reciprocal_bits
                           ? Reciprocal{result.reciprocal, result.reciprocal_exponent}
                           : reciprocal(std::max(result.r2, plan_.r2_floor), bits_);
  const uint64_t c = result.full ? full_ : uint64_t{1} << bits_;
  const UInt128 factor = UInt128{r.mantissa} * c;
  PixelValue value{};
  for (size_t i = 0; i < 3; ++i) {
    const uint64_t flux = result.flux[plan_.channels == 1 ? 0 : i];
    if (flux == 0 || weight.mantissa[i] == 0) continue;
    value[i] = scaled(UInt128{flux} * weight.mantissa[i] * factor,
                      weight.exponent[i] - 2 * bits_ - static_cast<int>(r.exponent));
  }
  return value;
}

PixelValue Shader::pixel(const Rgb& radiance, ShaderCounts& counts) const {
  PixelValue value{};
  for (size_t c = 0; c < 3; ++c) {
    const double x = radiance[static_cast<int>(c)];
    if (!std::isfinite(x)) ++counts.not_finite;
    if (!(x > 0) || !std::isfinite(x)) continue;
    int exponent;
    const double fraction = std::frexp(x, &exponent);
    // Below 2^(I+F), half a unit for the rounding included.
    if (exponent > plan_.integer_bits - 1) {
      value[c] = (UInt128{1} << (plan_.pixel_contribution_bits() - 1));
      ++counts.direct;
      continue;
    }
    value[c] = scaled(static_cast<uint64_t>(std::ldexp(fraction, 53)),
                      exponent - 53 + plan_.fraction_bits);
  }
  return value;
}

double Shader::radiance(UInt128 value) const {
  return std::ldexp(static_cast<double>(value), -plan_.fraction_bits);
}

double Shader::photon_density(const GatherResult& result) const {
  const double r2 = static_cast<double>(std::max(result.r2, plan_.r2_floor));
  const double c = result.full ? static_cast<double>(plan_.k - 1) / plan_.k : 1.0;
  return static_cast<double>(result.count) * c / r2 * inverse_area_;
}

}  // namespace photonloom
