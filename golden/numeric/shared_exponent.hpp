// SPDX-License-Identifier: Apache-2.0
// Power of a photon: up to three mantissas with one exponent (RGB9E5 is m = 9, e = 5), in units of
// the map's power unit.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>

#include "golden/numeric/bits.hpp"

namespace photonloom {

struct PowerCode {
  std::array<uint32_t, 3> mantissa{};  // channels that the plan does not have are 0
  uint32_t exponent = 0;
  bool operator==(const PowerCode&) const = default;
};

// An encoded power with exponent > 0 has its top mantissa bit set, so this code never arises: it
// marks an unused slot.
constexpr PowerCode invalid_power(int exponent_bits) {
  return {{0, 0, 0}, static_cast<uint32_t>(ones(exponent_bits))};
}

constexpr uint64_t power_value(const PowerCode& p, int channel) {
  return uint64_t{p.mantissa[static_cast<size_t>(channel)]} << p.exponent;
}

// Largest value a code can hold, in units.
constexpr uint64_t power_max(int mantissa_bits, int exponent_bits) {
  return ones(mantissa_bits) << ones(exponent_bits);
}

// The named conversion power -> code, `value` in units (>= 0). The smallest exponent at which the
// largest channel, rounded half up, fits; *saturated is set where none does and the largest code is
// taken instead.
inline PowerCode encode_power(const std::array<double, 3>& value, int channels, int mantissa_bits,
                              int exponent_bits, bool* saturated) {
  const double top = static_cast<double>(ones(mantissa_bits));
  const uint32_t last = static_cast<uint32_t>(ones(exponent_bits));
  double largest = 0;
  for (int c = 0; c < channels; ++c) largest = value[c] > largest ? value[c] : largest;
  PowerCode code;
  while (code.exponent < last &&
         std::floor(std::ldexp(largest, -static_cast<int>(code.exponent)) + 0.5) > top)
    ++code.exponent;
  for (int c = 0; c < channels; ++c) {
    double m = std::floor(std::ldexp(value[c], -static_cast<int>(code.exponent)) + 0.5);
    if (m > top) {
      m = top;
      if (saturated) *saturated = true;
    }
    code.mantissa[static_cast<size_t>(c)] = static_cast<uint32_t>(m);
  }
  return code;
}

}  // namespace photonloom
