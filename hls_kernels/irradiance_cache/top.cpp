// SPDX-License-Identifier: Apache-2.0
#include "hls_kernels/irradiance_cache/top.hpp"

using namespace photonloom_hls;

HLS_TOP void irradiance_cache(Tool::stream<CacheLookup<Tool>>& in,
                              Tool::stream<CacheResult<Tool>>& out, Tool::uint<32> packets) {
  HLS_PORT_STREAM(in);
  HLS_PORT_STREAM(out);
  HLS_PORT_REGISTER(packets);
  HLS_PORT_CONTROL;
  static IrradianceCache<Tool> kernel;
  kernel.run(in, out, packets);
}
