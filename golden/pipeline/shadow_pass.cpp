// SPDX-License-Identifier: Apache-2.0
#include "golden/pipeline/shadow_pass.hpp"

namespace photonloom {

void ShadowPass::begin(const BatchSamples& batch, size_t entries) {
  batch_ = &batch;
  entries_.assign(casts() ? entries : 0, {});
}

PixelNumbers ShadowPass::numbers_of(size_t entry, uint64_t ray) const {
  return PixelNumbers(in_.ray_seed.value_or(in_.seed), Phase::kShadow, batch_->pixel_of(entry),
                      ray);
}

void ShadowPass::cast_first(size_t entry, const CameraSample& walk) {
  Entry& e = entries_[entry];
  e.lit = walk.lit;
  e.found = walk.direct;
  if (!e.lit.exists) return;
  const HitShadows shadows(in_.world, in_.caster, e.lit);
  const auto n = static_cast<uint32_t>(has_two() ? plan_.first_shadow_rays : plan_.shadow_rays);
  for (size_t kind = 0; kind < kShadowRays; ++kind) {
    Rays& rays = e.rays[kind];
    rays.count = n;
    for (uint32_t i = 0; i < n; ++i)
      rays.cast += shadows.add(static_cast<ShadowRay>(kind),
                               numbers_of(entry, uint64_t{batch_->sample_of(entry)} * n + i),
                               i % 2 == 0 ? rays.even : rays.odd);
  }
}

void ShadowPass::plan_second(std::span<const uint32_t> pixels, std::span<const size_t> tile_begins,
                             const std::function<Rgb(size_t entry)>& light) {
  const std::vector<uint32_t> counts =
      second_rays(plan_, shadow_passes(plan_), pixels, tile_begins, [&](size_t entry, size_t kind) {
        const Entry& e = entries_[entry];
        const double n = plan_.first_shadow_rays;
        return FirstPass{.casts = e.lit.exists,
                         .light = light(entry) + direct(entry),
                         .difference = (e.rays[kind].even - e.rays[kind].odd) / n};
      });
  for (size_t kind = 0; kind < kShadowRays; ++kind) {
    // They go on where the first pass ended. Each number is uniform on its own, and n2 knows
    // nothing of this pixel's.
    const uint64_t first = uint64_t{batch_->spp} * static_cast<uint64_t>(plan_.first_shadow_rays);
    uint64_t next = first;
    for (size_t entry = 0; entry < entries_.size(); ++entry) {
      if (batch_->sample_of(entry) == 0) next = first;
      entries_[entry].rays[kind].next = next;
      next += counts[entry * kShadowRays + kind];
      entries_[entry].rays[kind].count += counts[entry * kShadowRays + kind];
    }
  }
}

void ShadowPass::cast_second(size_t entry) {
  Entry& e = entries_[entry];
  if (!e.lit.exists) return;
  const auto first = static_cast<uint32_t>(plan_.first_shadow_rays);
  const HitShadows shadows(in_.world, in_.caster, e.lit);
  for (size_t kind = 0; kind < kShadowRays; ++kind) {
    Rays& rays = e.rays[kind];
    for (uint32_t i = 0; i < rays.count - first; ++i)
      rays.cast +=
          shadows.add(static_cast<ShadowRay>(kind), numbers_of(entry, rays.next + i), rays.second);
  }
}

Rgb ShadowPass::direct(size_t entry) const {
  const Entry& e = entries_[entry];
  Rgb sum = e.found;
  if (e.lit.exists)
    for (const Rays& rays : e.rays)
      sum += (rays.even + rays.odd + rays.second) / static_cast<double>(rays.count);
  return sum;
}

void ShadowPass::count(FrameCounts& counts) const {
  for (const Entry& e : entries_)
    for (size_t kind = 0; kind < kShadowRays; ++kind) {
      counts.shadow_rays += e.rays[kind].count;
      (static_cast<ShadowRay>(kind) == ShadowRay::kLight ? counts.emitter_rays_cast
                                                         : counts.cosine_rays_cast) +=
          e.rays[kind].cast;
    }
}

}  // namespace photonloom
