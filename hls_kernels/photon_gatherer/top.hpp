// SPDX-License-Identifier: Apache-2.0
// The function that a tool synthesizes: takes `packets` queries and gives all their results and
// photons. `nodes` and `lines` are memory ports of kNodeWords and kLineBeats words.
#pragma once
#include "hls_kernels/toolset.hpp"

#include "hls_kernels/photon_gatherer/photon_gatherer.hpp"

namespace photonloom_hls {
using Gatherer = PhotonGatherer<Tool>;
constexpr int kLineBeats = (kGlobalMemoryLines + kCausticMemoryLines) * Gatherer::kBeats;
}  // namespace photonloom_hls

void photon_gatherer(
    photonloom_hls::Tool::stream<photonloom_hls::GatherQuery<photonloom_hls::Tool>>& in,
    photonloom_hls::Tool::stream<photonloom_hls::GatherResult<photonloom_hls::Tool>>& result,
    photonloom_hls::Tool::stream<photonloom_hls::GatherPhoton<photonloom_hls::Tool>>& photon,
    const photonloom_hls::Gatherer::Node* nodes, const photonloom_hls::Gatherer::Beat* lines,
    const photonloom_hls::GatherMaps<photonloom_hls::Tool>& maps,
    photonloom_hls::Tool::uint<32> packets);
