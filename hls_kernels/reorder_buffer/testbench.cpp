// SPDX-License-Identifier: Apache-2.0
// Recorded packets through the top function; what comes out is what golden gave.
#include "hls_kernels/reorder_buffer/top.hpp"

#include "data/reorder_buffer.hpp"
#include "hls_kernels/testbench/testbench.hpp"

using namespace photonloom_hls;

HLS_MAIN {
  Testbench bench("reorder_buffer");
  HLS_CHANNEL(Tool, GatherQuery<Tool>, in, kPortDepth);
  HLS_CHANNEL(Tool, GatherQuery<Tool>, out, kPortDepth);
  bench.feed(in, recorded::in, recorded::in_packets);
  bench.call([&] { HLS_DESIGN(reorder_buffer)(in, out, recorded::in_packets); });
  bench.expect("out", out, recorded::out, recorded::out_packets);
  return bench.finish();
}
