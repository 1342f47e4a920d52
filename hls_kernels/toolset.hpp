// SPDX-License-Identifier: Apache-2.0
// The toolset that a top function and its testbench are compiled with, as the compiler is told.
#pragma once
#if defined(PHOTONLOOM_HLS_NATIVE)
#include "hls_kernels/native/toolset.hpp"
namespace photonloom_hls {
using Tool = Native;
}
#elif defined(PHOTONLOOM_HLS_VITIS)
#include "hls_kernels/vitis/toolset.hpp"
namespace photonloom_hls {
using Tool = Vitis;
}
#elif defined(PHOTONLOOM_HLS_CATAPULT)
#include "hls_kernels/catapult/toolset.hpp"
namespace photonloom_hls {
using Tool = Catapult;
}
#else
#error "expected -DPHOTONLOOM_HLS_NATIVE, -DPHOTONLOOM_HLS_VITIS or -DPHOTONLOOM_HLS_CATAPULT"
#endif
