// SPDX-License-Identifier: Apache-2.0
// Whether a plan can be used for a scene and its photons, whoever wrote its lines.
#pragma once
#include <string>
#include <vector>

#include "golden/plan/plan.hpp"
#include "golden/transport/world.hpp"

namespace photonloom {

// Whether the plan's channels hold the colours of these photons.
bool channels_hold(const Plan& plan, const std::vector<Photon>& photons);

// Why it cannot: the cube does not hold the surfaces, or one channel is to hold photons of several
// colours. Empty: it can. How many photons a map has addresses for is left to who fills it.
std::string plan_misfit(const Plan& plan, const World& world, const PhotonPass& global,
                        const PhotonPass& caustic);

}  // namespace photonloom
