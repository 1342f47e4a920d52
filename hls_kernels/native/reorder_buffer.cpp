// SPDX-License-Identifier: Apache-2.0
#include "hls_kernels/reorder_buffer/reorder_buffer.hpp"
#include "hls_kernels/native/shell.hpp"

namespace photonloom_hls {

std::unique_ptr<Shell> make_shell(uint64_t seed, const FarEnd& far_end) {
  using Query = GatherQuery<Native>;
  return std::make_unique<StreamShell<ReorderBuffer<Native>, Query, Query>>(seed, far_end);
}

}  // namespace photonloom_hls

PHOTONLOOM_HLS_INTERFACE(ReorderBuffer)
