// SPDX-License-Identifier: Apache-2.0
#include "hls_kernels/photon_gatherer/top.hpp"

using namespace photonloom_hls;

HLS_TOP void photon_gatherer(Tool::stream<GatherQuery<Tool>>& in,
                             Tool::stream<GatherResult<Tool>>& result,
                             Tool::stream<GatherPhoton<Tool>>& photon, const Gatherer::Node* nodes,
                             const Gatherer::Beat* lines, const GatherMaps<Tool>& maps,
                             Tool::uint<32> packets) {
  HLS_PORT_STREAM(in);
  HLS_PORT_STREAM(result);
  HLS_PORT_STREAM(photon);
  HLS_PORT_MEMORY(nodes, Gatherer::kNodeWords);
  HLS_PORT_MEMORY(lines, kLineBeats);
  HLS_PORT_REGISTER(maps);
  HLS_PORT_REGISTER(packets);
  HLS_PORT_CONTROL;
  static Gatherer kernel;
  kernel.run(in, result, photon, nodes, lines, maps, packets);
}
