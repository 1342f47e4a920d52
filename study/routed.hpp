// SPDX-License-Identifier: Apache-2.0
// What photon_gatherer takes of an ULX3S's LFE5U-85F once it is placed and routed (scripts/fpga),
// where a study asks for more than the prediction.
#pragma once
#include <string>

#include "golden/plan/plan.hpp"

namespace photonloom {

struct RoutedResources {
  double lut = 0, ff = 0, dsp = 0, ebr = 0;  // lut: LUT-equivalents
  double mhz = 0;                            // Fmax of one placement
};

// Why nothing can be routed here, as a sentence; empty where it can.
std::string routing_missing();

// Minutes of work. `folder` takes the plan's file. Throws std::runtime_error with what the flow
// said.
RoutedResources routed_gatherer(const Plan& plan, const std::string& folder);

}  // namespace photonloom
