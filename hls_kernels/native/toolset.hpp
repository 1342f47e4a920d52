// SPDX-License-Identifier: Apache-2.0
// The native toolset: what kernels are compiled with where no vendor's tool is. The compiler is
// told -DPHOTONLOOM_HLS_NATIVE, so that hls_kernels/pragmas.hpp instruments them.
#pragma once
#ifndef PHOTONLOOM_HLS_NATIVE
#error "the native toolset needs -DPHOTONLOOM_HLS_NATIVE"
#endif

#include "hls_kernels/native/integer.hpp"
#include "hls_kernels/native/simulation.hpp"

namespace photonloom_hls {

struct Native {
  template <int W>
  using uint = Integer<W, false>;
  template <int W>
  using sint = Integer<W, true>;
  // A word without arithmetic, of any width.
  template <int W>
  using bits = Bits<W>;
  template <class E>
  using stream = Stream<E>;

  // Bits [lo, lo + N) of a number or word.
  template <int N, int W, bool S>
  static uint<N> slice(const Integer<W, S>& x, unsigned lo) {
    return uint<N>::of(lo < static_cast<unsigned>(W) ? x.value() >> lo : 0);
  }
  template <int N, int W>
  static uint<N> slice(const Bits<W>& x, unsigned lo) {
    return x.template slice<N>(lo);
  }
  template <int N, int W>
  static void set_slice(Bits<W>& x, unsigned lo, const uint<N>& value) {
    x.template set<N>(lo, value);
  }
  template <int N, int W>
  static void set_slice(Bits<W>& x, unsigned lo, const Bits<N>& value) {
    x.set_word(lo, value);
  }
};

}  // namespace photonloom_hls
