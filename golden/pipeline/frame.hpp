// SPDX-License-Identifier: Apache-2.0
// The frame: camera walks, caustic queries and table gathers, sampled directions, final gather
// rays, reordering, gathers, shading. One pipeline for every backend; see docs/frame.md.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>

#include "golden/image/image.hpp"
#include "golden/numeric/progress.hpp"
#include "golden/plan/clamp_counts.hpp"
#include "golden/transport/world.hpp"
#include "golden/unit/backend.hpp"
#include "golden/unit/photon_map.hpp"
#include "golden/unit/reference_gather.hpp"
#include "golden/unit/shader.hpp"

namespace photonloom {

// kGolden: estimates are what the units answer. kReference: the same photons, queries and
// directions (the table still comes from the units), all values in double.
enum class Arithmetic { kGolden, kReference };

// The units of a frame, golden or anything else behind the same interface. The gatherer is loaded
// by render_frame.
struct FrameUnits {
  // units.NAME for each unit, and units.of(type) for what is the same for all.
#define PHOTONLOOM_FRAME_UNIT(Interface, name, ...) \
  std::unique_ptr<Interface> name;                  \
  std::unique_ptr<Interface>& of(std::type_identity<Interface>) { return name; }
  PHOTONLOOM_UNITS(PHOTONLOOM_FRAME_UNIT)
#undef PHOTONLOOM_FRAME_UNIT
};
FrameUnits make_golden_units(const Plan& plan);

struct FrameInput {
  const World& world;
  const RayCaster& caster;
  const Plan& plan;  // width and height are the film's
  const PhotonMap& global;
  const PhotonMap& caustic;
  // The same photons in double, in map order; only kReference reads them.
  const ReferenceGather* reference_global = nullptr;
  const ReferenceGather* reference_caustic = nullptr;
  uint64_t seed = 1;
  // Of the final gather rays alone; not given: seed.
  std::optional<uint64_t> ray_seed = std::nullopt;
  Arithmetic arithmetic = Arithmetic::kGolden;
};

// What happened in a frame, in packets. Results that answer nothing that was asked, and questions
// without an answer, are 0 unless a unit is faulty; such a frame goes on without them.
struct FrameCounts {
  uint64_t camera_samples = 0;
  uint64_t table_gathers = 0, caustic_queries = 0;
  uint64_t directions = 0;     // sampled: final gather rays, of both passes
  uint64_t below_horizon = 0;  // of them, which contribute nothing
  uint64_t final_gathers = 0;
  uint64_t clamped = 0;  // gathers with r2 < r2_floor
  uint64_t full = 0;     // gathers that found k
  // Of an irradiance cache: samples that looked up; of them those that became records, that found a
  // tile full, and so gathered all the same, and that share others' light.
  uint64_t cache_samples = 0, cache_records = 0, cache_full = 0, cache_hits = 0;
  uint64_t cache_most_records = 0;  // of a tile
  uint64_t probe_rays = 0;
  // At first hits of a frame whose plan asks for more than one: as asked for, of both kinds; and
  // without those that were known to meet no light before, by kind.
  uint64_t shadow_rays = 0, emitter_rays_cast = 0, cosine_rays_cast = 0;
  uint64_t unmatched = 0, unanswered = 0;
  ShaderCounts shader;
  ClampCounts clamps;
};

// The image with all its layers; no metadata. Uses threads; the bytes depend neither on them nor on
// how packets are cut into calls.
Image render_frame(const FrameInput& in, FrameUnits& units, FrameCounts& counts,
                   Progress* progress = nullptr);

}  // namespace photonloom
