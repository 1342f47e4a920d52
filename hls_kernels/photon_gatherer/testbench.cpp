// SPDX-License-Identifier: Apache-2.0
// Recorded queries in recorded photon maps through the top function; what comes out is what golden
// gave.
#include "hls_kernels/photon_gatherer/top.hpp"

#include <vector>

#include "data/photon_gatherer.hpp"
#include "hls_kernels/testbench/testbench.hpp"

using namespace photonloom_hls;

HLS_MAIN {
  Testbench bench("photon_gatherer");
  std::vector<Gatherer::Node> nodes(Gatherer::kNodeWords);
  std::vector<Gatherer::Beat> lines(kLineBeats);
  GatherMaps<Tool> maps;
  for (unsigned map = 0; map < 2; ++map) {
    maps.lines[map] = recorded::map_lines[map];
    maps.r2_max[map] = recorded::map_r2_max[map];
  }
  for (unsigned i = 0; i < recorded::nodes_words; ++i)
    nodes[recorded::nodes[i].address] = recorded::nodes[i].data;
  const unsigned first[2] = {0, kGlobalMemoryLines * Gatherer::kBeats};
  const unsigned beats[2] = {recorded::global_beats, recorded::caustic_beats};
  const uint32_t* words[2] = {recorded::global, recorded::caustic};
  for (unsigned map = 0; map < 2; ++map)
    for (unsigned i = 0; i < beats[map]; ++i)
      from_words<kLineBeatBits>(words[map] + i * ((kLineBeatBits + 31) / 32),
                                lines[first[map] + i]);

  HLS_CHANNEL(Tool, GatherQuery<Tool>, in, kPortDepth);
  HLS_CHANNEL(Tool, GatherResult<Tool>, result, kPortDepth);
  HLS_CHANNEL(Tool, GatherPhoton<Tool>, photon, kPortDepth);
  bench.feed(in, recorded::in, recorded::in_packets);
  bench.call([&] {
    HLS_DESIGN(photon_gatherer)
    (in, result, photon, nodes.data(), lines.data(), maps, recorded::in_packets);
  });
  bench.expect("result", result, recorded::result, recorded::result_packets);
  bench.expect("photon", photon, recorded::photon, recorded::photon_packets);
  return bench.finish();
}
