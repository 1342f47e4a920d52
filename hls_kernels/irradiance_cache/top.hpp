// SPDX-License-Identifier: Apache-2.0
// The function that a tool synthesizes: takes `packets` packets from `in` and gives to `out` all
// that they determine. State stays from call to call.
#pragma once
#include "hls_kernels/toolset.hpp"

#include "hls_kernels/irradiance_cache/irradiance_cache.hpp"

void irradiance_cache(
    photonloom_hls::Tool::stream<photonloom_hls::CacheLookup<photonloom_hls::Tool>>& in,
    photonloom_hls::Tool::stream<photonloom_hls::CacheResult<photonloom_hls::Tool>>& out,
    photonloom_hls::Tool::uint<32> packets);
