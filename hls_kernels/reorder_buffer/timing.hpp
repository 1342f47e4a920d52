// SPDX-License-Identifier: Apache-2.0
// What the reorder buffer's schedule stands on, for the kernel and for the model of it
// (hls_kernels/generate/schedule.hpp). Reasoned, not run on a vendor's tool.
#pragma once

namespace photonloom_hls {

struct ReorderTiming {
  static constexpr int kLengthLatency = 4;  // length_: read 1, choose 1, read 1, write 1
  static constexpr int kHeadLatency = 3;    // head_ to next_ to head_: read 1, read 1, write 1
  static constexpr int kBinsALook = 8;      // bins that a turn looks at for the fullest
};

}  // namespace photonloom_hls
