// SPDX-License-Identifier: Apache-2.0
#include "hls_kernels/cdf_sampler/top.hpp"

using namespace photonloom_hls;

HLS_TOP void cdf_sampler(Tool::stream<SamplerInput<Tool>>& in, Tool::stream<Sample<Tool>>& out,
                         Tool::uint<32> packets) {
  HLS_PORT_STREAM(in);
  HLS_PORT_STREAM(out);
  HLS_PORT_REGISTER(packets);
  HLS_PORT_CONTROL;
  static CdfSampler<Tool> kernel;
  kernel.run(in, out, packets);
}
