// SPDX-License-Identifier: Apache-2.0
#include "golden/planner/plan_fit.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace photonloom {

bool channels_hold(const Plan& plan, const std::vector<Photon>& photons) {
  if (plan.channels != 1) return true;
  const auto& c = plan.channel_color;
  const double brightest = std::max({c[0], c[1], c[2]});
  for (const Photon& p : photons) {
    const double power = max_component(p.power);
    for (int i = 0; i < 3; ++i)
      if (std::fabs(p.power[i] * brightest - c[static_cast<size_t>(i)] * power) >
          0x1p-30 * power * brightest)
        return false;
  }
  return true;
}

std::string plan_misfit(const Plan& plan, const World& world, const PhotonPass& global,
                        const PhotonPass& caustic) {
  for (int axis = 0; axis < 3; ++axis) {
    const double lower = plan.origin[static_cast<size_t>(axis)];
    if (world.lower()[axis] < lower || world.upper()[axis] > lower + plan.extent)
      return fmt::format(
          "the cube of scene.origin and scene.extent does not hold the scene, which goes from {} "
          "to {} in {}; expected a plan made for it",
          world.lower()[axis], world.upper()[axis], "xyz"[axis]);
  }
  if (!channels_hold(plan, global.photons) || !channels_hold(plan, caustic.photons))
    return "photon.channels is 1, but the scene's photons have other colours than "
           "photon.channel_color; expected 3";
  return "";
}

}  // namespace photonloom
