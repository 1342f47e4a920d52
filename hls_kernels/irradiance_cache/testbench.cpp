// SPDX-License-Identifier: Apache-2.0
// Recorded packets through the top function; what comes out is what golden gave.
#include "hls_kernels/irradiance_cache/top.hpp"

#include "data/irradiance_cache.hpp"
#include "hls_kernels/testbench/testbench.hpp"

using namespace photonloom_hls;

HLS_MAIN {
  Testbench bench("irradiance_cache");
  HLS_CHANNEL(Tool, CacheLookup<Tool>, in, kPortDepth);
  HLS_CHANNEL(Tool, CacheResult<Tool>, out, kPortDepth);
  bench.feed(in, recorded::in, recorded::in_packets);
  bench.call([&] { HLS_DESIGN(irradiance_cache)(in, out, recorded::in_packets); });
  bench.expect("out", out, recorded::out, recorded::out_packets);
  return bench.finish();
}
