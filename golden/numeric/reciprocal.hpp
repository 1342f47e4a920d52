// SPDX-License-Identifier: Apache-2.0
// The named operation reciprocal(x) of an exact integer, with W bits. The definition is the
// division; hardware may get there as it likes.
#pragma once
#include <cstdint>

#include "golden/numeric/bits.hpp"

namespace photonloom {

// 1/x = mantissa * 2^-(W + exponent), mantissa in [2^(W-1), 2^W].
struct Reciprocal {
  uint32_t mantissa;
  uint32_t exponent;
  bool operator==(const Reciprocal&) const = default;
};

// R = floor(2^(2W) / m) for a normalised divisor m in [2^W, 2^(W+1)).
constexpr uint32_t reciprocal_mantissa(uint32_t m, int w) {
  return static_cast<uint32_t>((uint64_t{1} << (2 * w)) / m);
}

// x > 0, W in [8, 24]. x is rounded half up to W+1 significant bits, then R = floor(2^(2W) / m).
constexpr Reciprocal reciprocal(uint64_t x, int w) {
  int e = msb(x);
  UInt128 m;
  if (e <= w) {
    m = UInt128{x} << (w - e);
  } else {
    m = (UInt128{x} + (UInt128{1} << (e - w - 1))) >> (e - w);
    if (m >> (w + 1)) {  // a carry moves the exponent
      m >>= 1;
      ++e;
    }
  }
  return {reciprocal_mantissa(static_cast<uint32_t>(m), w), static_cast<uint32_t>(e)};
}

}  // namespace photonloom
