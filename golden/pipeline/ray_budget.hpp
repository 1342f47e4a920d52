// SPDX-License-Identifier: Apache-2.0
// How many final gather rays each sample gets in the second pass (docs/sampling.md).
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "golden/numeric/vec.hpp"
#include "golden/plan/plan.hpp"

namespace photonloom {

// What a first pass showed of a sample: all its light, and its even rays' light less its odd ones'.
struct FirstPass {
  bool diffuse = false;  // it casts rays
  Rgb light{0}, difference{0};
};

// Rays of the second pass, by sample. The pixels of a tile are two halves, as a chessboard; what
// one half gets is decided by the noise that the other showed in the first pass, so that a
// sample's rays and their number are independent. A fixed order of sums makes it the same
// everywhere. `pixels` are those of the batch, tile by tile, of which each begins at tile_begins.
std::vector<uint32_t> second_rays(const Plan& plan, std::span<const uint32_t> pixels,
                                  std::span<const size_t> tile_begins,
                                  const std::function<FirstPass(size_t sample)>& first_pass);

}  // namespace photonloom
