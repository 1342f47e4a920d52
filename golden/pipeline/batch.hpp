// SPDX-License-Identifier: Apache-2.0
// The camera samples of a batch: who they are, and what they wait for.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "golden/numeric/random.hpp"
#include "golden/pipeline/frame.hpp"

namespace photonloom {

// A camera sample that waits for its estimates.
struct WaitingSample {
  bool diffuse = false;  // x exists
  bool first = false;    // no glossy lobe before x
  DiffuseHit x;
  Rgb weight{0};
};

// Sample s of pixels[p] is entry p * spp + s.
struct BatchSamples {
  const std::vector<uint32_t>& pixels;  // numbers of the film's pixels, tile by tile
  size_t spp;
  uint32_t pixel_of(size_t entry) const { return pixels[entry / spp]; }
  uint32_t sample_of(size_t entry) const { return static_cast<uint32_t>(entry % spp); }
  // The random numbers of an entry's final gather rays.
  Random random_of(const FrameInput& in, size_t entry) const {
    return Random(in.ray_seed.value_or(in.seed), Phase::kSampler,
                  (uint64_t{pixel_of(entry)} << 20) | sample_of(entry));
  }
};

}  // namespace photonloom
