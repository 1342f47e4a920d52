// SPDX-License-Identifier: Apache-2.0
#include "study/point_plan.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include "golden/numeric/strict_number.hpp"
#include "golden/pipeline/prepare.hpp"
#include "golden/planner/plan_fit.hpp"
#include "golden/planner/planner.hpp"
#include "golden/unit/pack_photons.hpp"
#include "golden/unit/photon_lines.hpp"
#include "verilator_tb/model/tools.hpp"

namespace photonloom {
namespace {

template <class T>
T number(const std::string& line, const std::string& text) {
  if (const auto value = strict_number<T>(text)) return *value;
  throw PlanError(fmt::format("{} is {}, expected a number", line, text));
}

// Of an integer line of the plan, spelt as its file may spell it: 64, 6_4, 0x40, +64.
int plan_integer(const std::string& line, const std::string& text, int Plan::*member) {
  Plan plan;
  set_plan_line(plan, line + "=" + text);
  return plan.*member;
}

}  // namespace

int smallest_stride(const Plan& plan) {
  int bytes = std::max(4, (plan.photon_bits() + 7) / 8);
  while (bytes * plan.bucket % 16 != 0) ++bytes;
  return bytes;
}

LineValues joined_lines(const LineValues& base, const LineValues& lines) {
  LineValues all;
  for (const LineValues* from : {&base, &lines})
    for (const auto& [names, value] : *from) {
      std::istringstream stream(names);
      for (std::string name; std::getline(stream, name, '+');) {
        const auto old = std::find_if(all.begin(), all.end(),
                                      [&](const auto& line) { return line.first == name; });
        if (old == all.end())
          all.emplace_back(name, value);
        else
          old->second = value;
      }
    }
  return all;
}

PointPlan plan_of_point(StudyScene& scene, const Study& study, const LineValues& lines) {
  FrameRequest frame;  // for what it takes as not asked for
  PlanRequest request;
  double radius_scale = 1;
  bool packed = false;
  std::optional<int> rays;
  for (const auto& [name, value] : joined_lines(study.base, lines)) {
    if (name == "photons")
      frame.photons = number<uint64_t>(name, value);
    else if (name == "caustic_photons")
      frame.caustic_photons = number<uint64_t>(name, value);
    else if (name == "radius_scale")
      radius_scale = number<double>(name, value);
    else if (name == "packed")
      packed = value == "true";
    else if (name == "frame.spp")
      frame.spp = plan_integer(name, value, &Plan::spp);
    else if (name == "frame.gather_rays")
      rays = plan_integer(name, value, &Plan::gather_rays);
    else if (name == "gather.k")
      frame.k = plan_integer(name, value, &Plan::k);
    else
      request.set.push_back(name + "=" + value);
  }
  const World& world = scene.world();
  request.spp = samples_per_pixel(frame, world.scene());
  request.gather_rays = rays.value_or(gather_rays_per_sample(frame, request.spp));
  request.photons = frame.photons.value_or(request.photons);
  request.caustic_photons = frame.caustic_photons.value_or(request.caustic_photons);
  request.k = frame.k.value_or(request.k);

  const MapsNeeded needed = maps_needed(world, request.gather_rays);
  const PhotonPass none;
  std::shared_ptr<const PhotonPass> passes[2];
  for (const bool is_caustic : {false, true})
    if (is_caustic ? needed.caustic : needed.global)
      passes[is_caustic] = scene.photons(
          is_caustic, is_caustic ? request.caustic_photons : request.photons, study.seeds[0]);
  const auto make = [&] {
    return make_plan(world, request, passes[0] ? *passes[0] : none, passes[1] ? *passes[1] : none);
  };
  if (radius_scale != 1 || packed) {
    // What these two ask for depends on the plan without them, whose stride always has room.
    const Plan plan = make().plan;
    if (radius_scale != 1)
      for (const bool is_caustic : {false, true})
        if (plan.map(is_caustic).present)
          request.set.push_back(fmt::format("{}.radius={}", is_caustic ? "caustic" : "global",
                                            radius_scale * plan.map(is_caustic).radius));
    // Compressed photons have no padding.
    if (packed && !plan.compressed())
      request.set.push_back(fmt::format("photon.photon_bytes={}", smallest_stride(plan)));
  }
  PlannedFrame planned = make();
  if (const std::string why = plan_misfit(planned.plan, world, passes[0] ? *passes[0] : none,
                                          passes[1] ? *passes[1] : none);
      !why.empty())
    throw PlanError("plan: " + why);
  if (planned.plan.compressed())  // whether the lines have room shows with the map alone
    for (const bool is_caustic : {false, true})
      if (passes[is_caustic]) {
        PackCounts counts;
        const MapPlan& map = planned.plan.map(is_caustic);
        photon_lines(
            planned.plan,
            build_photon_map(pack_photons(passes[is_caustic]->photons, planned.plan, map, &counts),
                             planned.plan),
            is_caustic);
      }
  PointPlan result{std::move(planned.plan), std::move(planned.reasons), {}};
  result.command = fmt::format(
      "photonloom plan {} -o plan.toml --size {}x{} --seed {} --spp {} --gather-rays {} --photons "
      "{} --caustic-photons {} --k {}",
      model_tools::shell_word(scene.file()), study.width, study.height, study.seeds[0], request.spp,
      request.gather_rays, request.photons, request.caustic_photons, request.k);
  for (const std::string& line : request.set)
    result.command += " --set " + model_tools::shell_word(line);
  return result;
}

}  // namespace photonloom
