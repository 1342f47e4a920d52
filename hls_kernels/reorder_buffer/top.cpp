// SPDX-License-Identifier: Apache-2.0
#include "hls_kernels/reorder_buffer/top.hpp"

using namespace photonloom_hls;

HLS_TOP void reorder_buffer(Tool::stream<GatherQuery<Tool>>& in,
                            Tool::stream<GatherQuery<Tool>>& out, Tool::uint<32> packets) {
  HLS_PORT_STREAM(in);
  HLS_PORT_STREAM(out);
  HLS_PORT_REGISTER(packets);
  HLS_PORT_CONTROL;
  static ReorderBuffer<Tool> kernel;
  kernel.run(in, out, packets);
}
