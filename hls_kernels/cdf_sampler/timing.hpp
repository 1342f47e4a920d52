// SPDX-License-Identifier: Apache-2.0
// What the sampler's schedule stands on, for the kernel and for the model of it
// (hls_kernels/generate/schedule.hpp). Reasoned, not run on a vendor's tool.
#pragma once

namespace photonloom_hls {

struct SamplerTiming {
  // power_: read and add, then write; the sum of the turn before is forwarded.
  static constexpr int kPowerLatency = 2;
  static constexpr int kPowerTurns = 2;  // until the memory itself has it
};

}  // namespace photonloom_hls
