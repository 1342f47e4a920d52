// SPDX-License-Identifier: Apache-2.0
// Recorded packets through the top function; what comes out is what golden gave.
#include "hls_kernels/cdf_sampler/top.hpp"

#include "data/cdf_sampler.hpp"
#include "hls_kernels/testbench/testbench.hpp"

using namespace photonloom_hls;

HLS_MAIN {
  Testbench bench("cdf_sampler");
  HLS_CHANNEL(Tool, SamplerInput<Tool>, in, kPortDepth);
  HLS_CHANNEL(Tool, Sample<Tool>, out, kPortDepth);
  bench.feed(in, recorded::in, recorded::in_packets);
  bench.call([&] { HLS_DESIGN(cdf_sampler)(in, out, recorded::in_packets); });
  bench.expect("out", out, recorded::out, recorded::out_packets);
  return bench.finish();
}
