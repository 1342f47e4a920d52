// SPDX-License-Identifier: Apache-2.0
// The toolset of Catapult and of Bambu: ac_int and ac_channel (Algorithmic C data types). The
// compiler is told -DPHOTONLOOM_HLS_CATAPULT.
#pragma once
#include <ac_int.h>

#include <ac_channel.h>

namespace photonloom_hls {

struct Catapult {
  template <int W>
  using uint = ac_int<W, false>;
  template <int W>
  using sint = ac_int<W, true>;
  template <int W>
  using bits = ac_int<W, false>;
  template <class E>
  using stream = ac_channel<E>;

  // Bits [lo, lo + N) of a number or word. slc() must not leave the number, so a slice that does is
  // taken by a shift.
  template <int N, int W, bool S>
  static uint<N> slice(const ac_int<W, S>& x, unsigned lo) {
    return uint<N>(x >> lo);
  }
  template <int N, int W>
  static void set_slice(ac_int<W, false>& x, unsigned lo, const ac_int<N, false>& value) {
    x.set_slc(static_cast<int>(lo), value);
  }
};

}  // namespace photonloom_hls
