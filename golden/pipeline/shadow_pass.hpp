// SPDX-License-Identifier: Apache-2.0
// Shadow rays of a batch where samples have several, or as many as their noise asks for
// (docs/sampling.md).
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "golden/pipeline/batch.hpp"
#include "golden/pipeline/ray_budget.hpp"
#include "golden/transport/shadow_rays.hpp"

namespace photonloom {

class ShadowPass {
 public:
  explicit ShadowPass(const FrameInput& in) : in_(in), plan_(in.plan) {}

  // Whether the frame casts the shadow rays, and not the camera's walks.
  bool casts() const { return plan_.shadow_rays > 1; }
  bool has_two() const { return casts() && plan_.first_shadow_rays > 0; }

  void begin(const BatchSamples& batch, size_t entries);
  // Casts the rays of an entry's first pass. Entries are independent: threads may share them.
  void cast_first(size_t entry, const CameraSample& walk);
  // How many rays of the second pass each entry gets, by all the light that it is known to have.
  void plan_second(std::span<const uint32_t> pixels, std::span<const size_t> tile_begins,
                   const std::function<Rgb(size_t entry)>& light);
  // Casts them; as cast_first.
  void cast_second(size_t entry);
  // Direct light of an entry, by the rays cast so far.
  Rgb direct(size_t entry) const;
  // Rays that were asked for, and those of them that had a place to go to.
  void count(FrameCounts& counts) const;

 private:
  // A sample's rays of one kind.
  struct Rays {
    Rgb even{0}, odd{0};  // light of the first pass
    Rgb second{0};
    uint32_t count = 0;  // of both passes
    uint64_t next = 0;   // of the second, the number of its first one in the pixel
    uint32_t cast = 0;   // of `count`, those that were not known to be dark before
  };
  struct Entry {
    LitHit lit;
    Rgb found{0};  // direct light that the walk itself came upon
    std::array<Rays, kShadowRays> rays;
  };

  PixelNumbers numbers_of(size_t entry, uint64_t ray) const;

  const FrameInput& in_;
  const Plan& plan_;
  const BatchSamples* batch_ = nullptr;
  std::vector<Entry> entries_;
};

}  // namespace photonloom
