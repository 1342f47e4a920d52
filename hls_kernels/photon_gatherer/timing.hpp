// SPDX-License-Identifier: Apache-2.0
// What the gatherer's schedule stands on, for the kernel and for the model of it
// (hls_kernels/generate/schedule.hpp). Reasoned, not run on a vendor's tool.
#pragma once

namespace photonloom_hls {

struct GathererTiming {
  static constexpr int kLeastContexts = 4;  // queries in flight whatever the plan says
  // Cycles of a step: 3 for the memories, 4 for d^2 and the side that is lit, 2 for the first lane
  // that enters, 3 for the list.
  static constexpr int kStepLatency = 12;
  static constexpr int kLineTurns = 32;  // from a line's last beat to its photons
  static constexpr int kFreeTurns = 12;  // from the last photon of a query to the next query
};

}  // namespace photonloom_hls
