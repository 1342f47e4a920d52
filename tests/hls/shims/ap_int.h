// SPDX-License-Identifier: Apache-2.0
// Stands for the vendor's ap_int.h in tests: ap_uint and ap_int behave as documented, as far as the
// adapter and the kernels use them. A slice that leaves the number ends the program.
#pragma once
#include <cstdio>
#include <cstdlib>

#include "wide.hpp"

template <int W, bool S>
struct ap_int_base {
  shim::Wide<W, S> value;

  ap_int_base() = default;
  template <class I, std::enable_if_t<std::is_integral_v<I>, int> = 0>
  ap_int_base(I v) : value(v) {}
  template <int W2, bool S2>
  ap_int_base(const ap_int_base<W2, S2>& other) : value(other.value) {}
  static ap_int_base of(const shim::Wide<W, S>& v) {
    ap_int_base r;
    r.value = v;
    return r;
  }

  unsigned to_uint() const { return value.word(0); }
  unsigned long long to_uint64() const { return value.low(); }
  bool operator[](int i) const {
    inside(i, i);
    return value.bit(i);
  }
  ap_int_base operator<<(int n) const { return of(value.shifted_left(static_cast<unsigned>(n))); }
  ap_int_base operator>>(int n) const { return of(value.shifted_right(static_cast<unsigned>(n))); }
  template <int W2, bool S2>
  ap_int_base operator<<(const ap_int_base<W2, S2>& n) const {
    return *this << static_cast<int>(n.to_uint());
  }
  template <int W2, bool S2>
  ap_int_base operator>>(const ap_int_base<W2, S2>& n) const {
    return *this >> static_cast<int>(n.to_uint());
  }
  template <class N>
  ap_int_base& operator+=(const N& n) {
    return *this = *this + n;
  }
  template <class N>
  ap_int_base& operator-=(const N& n) {
    return *this = *this - n;
  }
  ap_int_base& operator++() { return *this += 1; }

  // Bits lo to hi as something to assign to.
  struct Range {
    ap_int_base& number;
    int hi, lo;
    template <int W2, bool S2>
    Range& operator=(const ap_int_base<W2, S2>& v) {
      for (int i = lo; i <= hi; ++i) {
        const uint32_t bit = 1u << (i % 32);
        uint32_t& word = number.value.words[i / 32];
        word = (v.value.word((i - lo) / 32) >> ((i - lo) % 32) & 1) != 0 ? word | bit : word & ~bit;
      }
      return *this;
    }
  };
  Range range(int hi, int lo) {
    inside(hi, lo);
    return {*this, hi, lo};
  }

 private:
  static void inside(int hi, int lo) {
    if (lo >= 0 && hi < W && lo <= hi) return;
    std::fprintf(stderr, "ap_int: bits %d to %d of %d\n", hi, lo, W);
    std::abort();
  }
};
SHIM_OPERATORS(ap_int_base)

template <int W>
struct ap_uint : ap_int_base<W, false> {
  using ap_int_base<W, false>::ap_int_base;
  ap_uint() = default;
  ap_uint(const ap_int_base<W, false>& other) : ap_int_base<W, false>(other) {}
};
template <int W>
struct ap_int : ap_int_base<W, true> {
  using ap_int_base<W, true>::ap_int_base;
  ap_int() = default;
  ap_int(const ap_int_base<W, true>& other) : ap_int_base<W, true>(other) {}
};
