// SPDX-License-Identifier: Apache-2.0
// What the irradiance cache's schedule stands on, for the kernel and for the model of it
// (hls_kernels/generate/schedule.hpp). Reasoned, not run on a vendor's tool.
#pragma once

namespace photonloom_hls {

struct CacheTiming {
  static constexpr int kDecideLatency = 14;  // cycles from a record to its weight, and to hits_
  static constexpr int kDecideTurns = 16;    // from the last record to the decision
};

}  // namespace photonloom_hls
