// SPDX-License-Identifier: Apache-2.0
// Hilbert index in three dimensions (Skilling 2004, "Programming the Hilbert curve"), on b-bit
// coordinates.
#pragma once
#include <cstdint>

#include "golden/numeric/vec.hpp"

namespace photonloom {

// 3b bits, b <= 21; the first 3j bits depend only on the first j bits of each coordinate.
constexpr uint64_t hilbert_index(UVec3 x, int b) {
  // Inverse undo of the excess work, from the top level down.
  for (uint32_t q = uint32_t{1} << (b - 1); q > 1; q >>= 1) {
    const uint32_t p = q - 1;
    for (size_t i = 0; i < 3; ++i) {
      if (x[i] & q) {
        x[0] ^= p;
      } else {
        const uint32_t t = (x[0] ^ x[i]) & p;
        x[0] ^= t;
        x[i] ^= t;
      }
    }
  }
  // Gray encode.
  x[1] ^= x[0];
  x[2] ^= x[1];
  uint32_t t = 0;
  for (uint32_t q = uint32_t{1} << (b - 1); q > 1; q >>= 1)
    if (x[2] & q) t ^= q - 1;
  for (size_t i = 0; i < 3; ++i) x[i] ^= t;
  uint64_t index = 0;
  for (int level = b - 1; level >= 0; --level)
    for (size_t i = 0; i < 3; ++i) index = (index << 1) | ((x[i] >> level) & 1);
  return index;
}

}  // namespace photonloom
