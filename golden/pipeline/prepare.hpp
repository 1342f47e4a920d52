// SPDX-License-Identifier: Apache-2.0
// Everything that stands before a frame's first packet: scene, photons, plan, photon maps. The same
// for every command that renders, plans or generates.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "golden/numeric/progress.hpp"
#include "golden/pipeline/frame.hpp"
#include "golden/planner/planner.hpp"
#include "golden/scene/scene.hpp"
#include "golden/unit/pack_photons.hpp"

namespace photonloom {

// What the user asked for; what is not given follows from the scene, or from the plan file.
struct FrameRequest {
  std::string scene_file;
  Parameters parameters;
  Unsupported unsupported = Unsupported::kRefuse;  // what happens to elements that are
  std::optional<std::pair<int, int>> size;         // of the film
  std::optional<int> spp, gather_rays, k;
  std::optional<uint64_t> photons, caustic_photons;
  std::optional<double> radius, format_error;
  std::vector<std::string> set;  // lines of the plan
  std::string plan_file;         // empty: the planner's
  std::optional<Plan> plan;      // that of plan_file, where it has been read: a pipe is read once
  std::string load_photons, load_caustics;  // photon files; empty: traced
  std::vector<std::string> outputs;         // files to write: none that the scene is made of
  uint64_t seed = 1;
};

// spp: as asked for, else the scene's sampleCount, else 16.
int samples_per_pixel(const FrameRequest& request, const Scene& scene);
// Final gather rays of a sample: as asked for, else so many that a pixel has 256.
int gather_rays_per_sample(const FrameRequest& request, int spp);

// The scene with the film of the request. Throws SceneError.
std::unique_ptr<World> load_world(const FrameRequest& request);

struct PreparedFrame {
  std::unique_ptr<World> world;
  std::unique_ptr<RayCaster> caster;
  PhotonPass global_pass, caustic_pass;
  Plan plan;
  PlanReasons reasons;  // empty for a plan from a file
  PackCounts global_counts, caustic_counts;
  PhotonMap global, caustic;
  std::unique_ptr<ReferenceGather> reference_global, reference_caustic;
  uint64_t seed = 1;
  std::vector<std::string> warnings;

  // Good for render_frame as long as this lives.
  FrameInput input(Arithmetic arithmetic) const;
};

// Traces or loads the photons, plans, packs and builds the maps; those in double only for
// Arithmetic::kReference. `only_plan`: stops after the plan, or with compressed lines after the
// maps. PlanError where these need more further lines than the plan has.
PreparedFrame prepare_frame(const FrameRequest& request, Arithmetic arithmetic, Progress* progress,
                            bool only_plan = false);

// The same for a world that is there already; scene_file, parameters and size of the request do not
// count.
PreparedFrame prepare_frame(std::unique_ptr<World> world, const FrameRequest& request,
                            Arithmetic arithmetic, Progress* progress, bool only_plan = false);

}  // namespace photonloom
