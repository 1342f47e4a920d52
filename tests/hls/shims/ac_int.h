// SPDX-License-Identifier: Apache-2.0
// Stands for ac_int.h in tests: ac_int behaves as documented, as far as the adapter and the kernels
// use it. A slice that leaves the number ends the program.
#pragma once
#include <cstdio>
#include <cstdlib>

#include "wide.hpp"

template <int W, bool S>
class ac_int {
 public:
  shim::Wide<W, S> value;

  ac_int() = default;
  template <class I, std::enable_if_t<std::is_integral_v<I>, int> = 0>
  ac_int(I v) : value(v) {}
  template <int W2, bool S2>
  ac_int(const ac_int<W2, S2>& other) : value(other.value) {}
  static ac_int of(const shim::Wide<W, S>& v) {
    ac_int r;
    r.value = v;
    return r;
  }

  unsigned to_uint() const { return value.word(0); }
  unsigned long long to_uint64() const { return value.low(); }
  bool operator[](int i) const {
    inside(i, 1);
    return value.bit(i);
  }
  ac_int operator<<(unsigned n) const { return of(value.shifted_left(n)); }
  ac_int operator>>(unsigned n) const { return of(value.shifted_right(n)); }
  template <int W2>
  ac_int operator<<(const ac_int<W2, false>& n) const {
    return *this << n.to_uint();
  }
  template <int W2>
  ac_int operator>>(const ac_int<W2, false>& n) const {
    return *this >> n.to_uint();
  }
  template <class N>
  ac_int& operator+=(const N& n) {
    return *this = *this + n;
  }
  template <class N>
  ac_int& operator-=(const N& n) {
    return *this = *this - n;
  }
  ac_int& operator++() { return *this += 1; }

  template <int W2, bool S2>
  ac_int& set_slc(int lo, const ac_int<W2, S2>& v) {
    inside(lo, W2);
    for (int i = lo; i < lo + W2; ++i) {
      const uint32_t bit = 1u << (i % 32);
      uint32_t& word = value.words[i / 32];
      word = v.value.bit(i - lo) ? word | bit : word & ~bit;
    }
    return *this;
  }

 private:
  static void inside(int lo, int n) {
    if (lo >= 0 && lo + n <= W) return;
    std::fprintf(stderr, "ac_int: %d bits from %d of %d\n", n, lo, W);
    std::abort();
  }
};
SHIM_OPERATORS(ac_int)
