// SPDX-License-Identifier: Apache-2.0
// Derives a plan from a scene and a request, with the reason for every line; see docs/plan.md.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "golden/plan/plan.hpp"
#include "golden/plan/plan_file.hpp"
#include "golden/transport/world.hpp"

namespace photonloom {

struct PlanRequest {
  uint64_t photons = 500000;  // stored, a map each
  uint64_t caustic_photons = 500000;
  int k = 50;
  std::optional<double> radius;  // of both maps, scene units; 0: none. Else the formula
  int spp = 16;
  int gather_rays = 16;
  // Relative error that the formats may add to an estimate. Else the formats of struct Plan.
  std::optional<double> format_error;
  std::vector<std::string> set;           // "section.key=value", over everything
  std::string photon_file, caustic_file;  // where photons were read from; empty: traced
};

// Which photon maps the scene can fill and the image can use, and why.
struct MapsNeeded {
  bool global = false, caustic = false;
  std::string global_reason, caustic_reason;
};
MapsNeeded maps_needed(const World& world, int gather_rays);

// Maximum gather radius in scene units: r^2 = share * k * area / (pi * photons), the radius at
// which a gather finds share * k photons where they lie evenly; share is kGlobalShare or
// kCausticShare. docs/plan.md says why.
inline constexpr double kGlobalShare = 1.0, kCausticShare = 0.25;
double default_radius(double share, int k, double area, uint64_t photons);

// Photon lines that a board keeps in block RAM: 18 Kibit blocks of an LFE5U-85F, of which the
// gatherers need some too. Larger maps go to an SDRAM.
inline constexpr uint64_t kBoardBlockRamBytes = 262144;

struct PlannedFrame {
  Plan plan;
  PlanReasons reasons;
};

// Throws PlanError where gathers of a plan give no light: (k - 1) / k is 0 for k = 1. `name` is the
// plan's, or the option's that says k; `assignments` are those of its lines.
void check_plan_makes_an_image(const Plan& plan, const std::string& name,
                               const std::vector<std::string>& assignments);

// A sentence where a pixel's steps are coarser than any plan has them that is derived; "" else.
std::string why_pixels_are_coarse(const Plan& plan, const World& world);

// A sentence where a position's unit is too large beside the part of the cube in which the photons
// lie; "" else.
std::string why_positions_are_coarse(const Plan& plan, const PhotonPass& global);

// The reasons of photon.bucket and frame.order in a derived plan; whoever changes the stride of a
// photon, or the reorder buffer, says them anew.
std::string bucket_reason(const Plan& plan);
std::string order_reason(const Plan& plan);

// The plan for rendering these photons. Throws PlanError, with the reason, where there is none.
PlannedFrame make_plan(const World& world, const PlanRequest& request, const PhotonPass& global,
                       const PhotonPass& caustic);

}  // namespace photonloom
