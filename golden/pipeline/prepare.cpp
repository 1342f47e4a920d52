// SPDX-License-Identifier: Apache-2.0
#include "golden/pipeline/prepare.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "golden/numeric/output_file.hpp"
#include "golden/planner/plan_fit.hpp"
#include "golden/unit/photon_file.hpp"
#include "golden/unit/photon_lines.hpp"

namespace photonloom {
namespace {

// spp x final gather rays unless asked for otherwise.
constexpr int kRaysPerPixel = 256;

PhotonPass photons_of(const World& world, const RayCaster& caster, bool is_caustic, uint64_t stored,
                      uint64_t seed, Progress* progress) {
  return is_caustic ? trace_caustic_photons(world, caster, stored, seed, progress)
                    : trace_global_photons(world, caster, stored, seed, progress);
}

// `asked` is what was asked for beside the file: as many as it holds, or as its maker asked for.
PhotonPass loaded_photons(const std::string& path, bool is_caustic, const World& world,
                          std::optional<uint64_t> asked, Progress* progress) {
  const ProgressPhase phase(progress, is_caustic ? "load caustics" : "load photons", 0, "");
  PhotonFile file = read_photon_file(path);
  const std::string kind = is_caustic ? "caustic" : "global";
  if (!file.kind.empty() && file.kind != kind)
    throw SceneError(
        fmt::format("{}: holds {} photons, expected {} photons", path, file.kind, kind));
  if (file.scene_hash && *file.scene_hash != world.scene().hash)
    throw SceneError(
        fmt::format("{}: was traced in another scene (hash {:016x}), expected {:016x}, that of {}",
                    path, *file.scene_hash, world.scene().hash, world.scene().name));
  if (asked && *asked != file.photons.size() && *asked != file.requested)
    throw SceneError(fmt::format("{}: holds {} photons, expected {}, as {} asks", path,
                                 file.photons.size(), *asked,
                                 is_caustic ? "--caustic-photons" : "--photons"));
  const Cube cube{world.cube_origin(), world.cube_extent()};
  for (size_t i = 0; i < file.photons.size(); ++i)
    if (!holds(cube, file.photons[i].position))
      throw SceneError(fmt::format("{}: photon {} lies outside of the scene", path, i));
  PhotonPass pass;
  pass.photons = std::move(file.photons);
  pass.paths = file.paths.value_or(0);
  return pass;
}

Plan plan_from_file(const FrameRequest& request) {
  Plan plan = request.plan ? *request.plan : read_plan(request.plan_file);
  for (const std::string& line : request.set) set_plan_line(plan, line);
  check_plan(plan, request.plan_file, request.set);
  return plan;
}

// A plan from a file must fit the scene that it is used for, and so must lines that are set by
// hand.
void check_plan_fits(const PreparedFrame& frame, const std::string& file) {
  const Plan& plan = frame.plan;
  if (const std::string why =
          plan_misfit(plan, *frame.world, frame.global_pass, frame.caustic_pass);
      !why.empty())
    throw PlanError(fmt::format("{}: {}", file, why));
  for (const bool is_caustic : {false, true}) {
    const PhotonPass& pass = is_caustic ? frame.caustic_pass : frame.global_pass;
    const uint64_t room = plan.room(plan.map(is_caustic));
    if (pass.photons.size() > room)
      throw PlanError(
          fmt::format("{}: {}.photons is {}, expected at least {}: so many are stored of this "
                      "scene and seed, the path that fills the map whole, and the plan's "
                      "lines hold {}",
                      file, is_caustic ? "caustic" : "global", plan.map(is_caustic).photons,
                      pass.photons.size(), room));
  }
}

}  // namespace

int samples_per_pixel(const FrameRequest& request, const Scene& scene) {
  if (request.spp) return *request.spp;
  return scene.sample_count > 0 ? scene.sample_count : 16;
}

int gather_rays_per_sample(const FrameRequest& request, int spp) {
  return request.gather_rays.value_or(
      std::max(1, static_cast<int>(std::lround(static_cast<double>(kRaysPerPixel) / spp))));
}

std::unique_ptr<World> load_world(const FrameRequest& request) {
  Scene scene = load_scene(request.scene_file, request.parameters, request.unsupported);
  check_outputs(request.outputs, scene.files);
  if (request.size) scene.film.resize(request.size->first, request.size->second);
  return std::make_unique<World>(std::move(scene));
}

FrameInput PreparedFrame::input(Arithmetic arithmetic) const {
  return {.world = *world,
          .caster = *caster,
          .plan = plan,
          .global = global,
          .caustic = caustic,
          .reference_global = reference_global.get(),
          .reference_caustic = reference_caustic.get(),
          .seed = seed,
          .arithmetic = arithmetic};
}

PreparedFrame prepare_frame(const FrameRequest& request, Arithmetic arithmetic, Progress* progress,
                            bool only_plan) {
  FrameRequest sized = request;
  if (!request.plan_file.empty()) {
    if (!sized.plan) sized.plan = read_plan(request.plan_file);
    const Plan plan = plan_from_file(sized);
    sized.size = {plan.width, plan.height};
  }
  std::unique_ptr<World> world;
  {
    const ProgressPhase phase(progress, "scene", 0, "");
    world = load_world(sized);
  }
  return prepare_frame(std::move(world), sized, arithmetic, progress, only_plan);
}

PreparedFrame prepare_frame(std::unique_ptr<World> world, const FrameRequest& request,
                            Arithmetic arithmetic, Progress* progress, bool only_plan) {
  PreparedFrame frame;
  const bool from_file = !request.plan_file.empty();
  if (from_file) frame.plan = plan_from_file(request);
  frame.seed = request.seed;
  frame.world = std::move(world);
  frame.caster = make_double_bvh(*frame.world);
  const Scene& scene = frame.world->scene();
  frame.warnings = scene.warnings;

  PlanRequest plan_request;
  plan_request.spp = samples_per_pixel(request, scene);
  plan_request.gather_rays = gather_rays_per_sample(request, plan_request.spp);
  plan_request.photons = request.photons.value_or(plan_request.photons);
  plan_request.caustic_photons = request.caustic_photons.value_or(plan_request.caustic_photons);
  plan_request.k = request.k.value_or(plan_request.k);
  plan_request.radius = request.radius;
  plan_request.format_error = request.format_error;
  plan_request.set = request.set;
  plan_request.photon_file = request.load_photons;
  plan_request.caustic_file = request.load_caustics;

  // With a plan from a file its maps decide; the photons are counted as stored, so that the same
  // seed gives the same paths.
  const MapsNeeded needed = maps_needed(*frame.world, plan_request.gather_rays);
  for (const bool is_caustic : {false, true}) {
    PhotonPass& pass = is_caustic ? frame.caustic_pass : frame.global_pass;
    const bool wanted = from_file ? frame.plan.map(is_caustic).present
                                  : (is_caustic ? needed.caustic : needed.global);
    const uint64_t stored =
        from_file ? frame.plan.map(is_caustic).photons
                  : (is_caustic ? plan_request.caustic_photons : plan_request.photons);
    const std::string& file = is_caustic ? request.load_caustics : request.load_photons;
    if (!file.empty()) {
      if (!wanted)
        throw std::runtime_error(fmt::format(
            "{}: the image asks no {} photons: {}", file, is_caustic ? "caustic" : "global",
            from_file ? "the plan has no such map"
                      : (is_caustic ? needed.caustic_reason : needed.global_reason)));
      pass = loaded_photons(file, is_caustic, *frame.world,
                            is_caustic ? request.caustic_photons : request.photons, progress);
      continue;
    }
    if (!wanted || stored == 0) continue;
    pass = photons_of(*frame.world, *frame.caster, is_caustic, stored, request.seed, progress);
    if (pass.short_of_request)
      frame.warnings.push_back(
          fmt::format("{}: only {} of {} {} photons were stored after {} paths: {}; the image uses "
                      "those that there are",
                      request.scene_file, pass.photons.size(), stored,
                      is_caustic ? "caustic" : "global", pass.paths,
                      is_caustic ? "little light comes by mirrors and glass to diffuse surfaces"
                                 : "little light comes to diffuse surfaces"));
  }

  if (from_file) {
    check_plan_fits(frame, request.plan_file);
    if (!only_plan) check_plan_makes_an_image(frame.plan, request.plan_file, request.set);
  } else {
    PlannedFrame planned =
        make_plan(*frame.world, plan_request, frame.global_pass, frame.caustic_pass);
    frame.plan = planned.plan;
    frame.reasons = std::move(planned.reasons);
    if (!request.set.empty()) check_plan_fits(frame, "plan");
  }
  for (const std::string& coarse : {why_positions_are_coarse(frame.plan, frame.global_pass),
                                    why_pixels_are_coarse(frame.plan, *frame.world)})
    if (!coarse.empty())
      frame.warnings.push_back((from_file ? request.plan_file : "plan") + ": " + coarse);
  if (only_plan && !frame.plan.compressed()) return frame;

  const ProgressPhase phase(progress, "photon maps",
                            frame.global_pass.photons.size() + frame.caustic_pass.photons.size(),
                            "photons");
  for (const bool is_caustic : {false, true}) {
    const PhotonPass& pass = is_caustic ? frame.caustic_pass : frame.global_pass;
    PackCounts& counts = is_caustic ? frame.caustic_counts : frame.global_counts;
    const std::vector<PackedPhoton> packed =
        pack_photons(pass.photons, frame.plan, frame.plan.map(is_caustic), &counts);
    PhotonMap& map = is_caustic ? frame.caustic : frame.global;
    map = build_photon_map(packed, frame.plan);
    // A map for which the plan has no room is told here, not when hardware is to hold it.
    if (frame.plan.compressed()) try {
        photon_lines(frame.plan, map, is_caustic);
      } catch (const PlanError& error) {
        throw PlanError(
            fmt::format("{}: {}", from_file ? request.plan_file : "plan", error.what()));
      }
    if (counts.zeroed > 0 || counts.saturated > 0)
      frame.warnings.push_back(fmt::format(
          "{} map: the power format makes {} photons zero and clips {} of {}",
          is_caustic ? "caustic" : "global", counts.zeroed, counts.saturated, pass.photons.size()));
    if (arithmetic == Arithmetic::kReference)
      (is_caustic ? frame.reference_caustic : frame.reference_global) =
          std::make_unique<ReferenceGather>(
              in_map_order(pass.photons, is_caustic ? frame.caustic : frame.global));
    phase.advance(pass.photons.size());
  }
  return frame;
}

}  // namespace photonloom
