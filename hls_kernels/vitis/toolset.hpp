// SPDX-License-Identifier: Apache-2.0
// The toolset of Vitis HLS: ap_(u)int of arbitrary precision and hls::stream (AMD UG1399). The
// compiler is told -DPHOTONLOOM_HLS_VITIS.
#pragma once
// Lines have up to 4,096 bits, the most that ap_int.h can be asked for; it has 1,024 otherwise.
#ifndef AP_INT_MAX_W
#define AP_INT_MAX_W 4096
#endif
#include <ap_int.h>
#include <hls_stream.h>

namespace photonloom_hls {

struct Vitis {
  template <int W>
  using uint = ap_uint<W>;
  template <int W>
  using sint = ap_int<W>;
  template <int W>
  using bits = ap_uint<W>;
  template <class E>
  using stream = hls::stream<E>;

  // Bits [lo, lo + N) of a number or word. range() must not leave the number, so a slice that does
  // is taken by a shift.
  template <int N, class X>
  static uint<N> slice(const X& x, unsigned lo) {
    return uint<N>(x >> static_cast<int>(lo));
  }
  template <int N, int W>
  static void set_slice(bits<W>& x, unsigned lo, const uint<N>& value) {
    x.range(static_cast<int>(lo) + N - 1, static_cast<int>(lo)) = value;
  }
};

}  // namespace photonloom_hls
