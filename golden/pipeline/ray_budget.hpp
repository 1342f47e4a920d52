// SPDX-License-Identifier: Apache-2.0
// How many rays each sample gets in the second of two passes (docs/sampling.md): final gather rays,
// and shadow rays.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "golden/numeric/vec.hpp"
#include "golden/plan/plan.hpp"

namespace photonloom {

// The rule of two passes; numbers of rays are those of a sample, of each kind.
struct TwoPasses {
  size_t kinds = 1;           // of rays, that share one budget
  int first = 0;              // rays of the first pass
  int mean = 0;               // of both
  int most = 0;               // of both
  int edge = 1;               // in pixels, of the squares of a tile that have a noise of their own
  bool without_noise = true;  // rays are cast where the first pass showed no noise at all
};
TwoPasses gather_passes(const Plan& plan);
TwoPasses shadow_passes(const Plan& plan);

// What a first pass showed of a sample: all its light, and its even rays' light less its odd ones'.
struct FirstPass {
  bool casts = false;  // it has rays of this kind
  Rgb light{0}, difference{0};
};

// Rays of the second pass, of sample s and kind k at s * kinds + k. The pixels of a square are two
// halves, as a chessboard; what one half gets is decided by the noise that the other showed in the
// first pass, so that a sample's rays and their number are independent. A fixed order of sums makes
// it the same everywhere. `pixels` are those of the batch, tile by tile, of which each begins at
// tile_begins.
std::vector<uint32_t> second_rays(
    const Plan& plan, const TwoPasses& passes, std::span<const uint32_t> pixels,
    std::span<const size_t> tile_begins,
    const std::function<FirstPass(size_t sample, size_t kind)>& first_pass);

}  // namespace photonloom
