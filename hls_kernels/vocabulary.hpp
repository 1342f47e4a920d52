// SPDX-License-Identifier: Apache-2.0
// What kernels say beside C++: the plan's constants and packets, and small functions over any
// toolset's types. Which toolset a kernel is compiled with is its template parameter.
#pragma once
#include "hls_kernels/pragmas.hpp"
#include "photonloom_hls.hpp"

namespace photonloom_hls {

// Packets that a stream at a kernel's port holds in native runs.
constexpr unsigned kPortDepth = 2;

// Bits that address n things; 0 for n <= 1.
constexpr int clog2(unsigned long long n) {
  int bits = 0;
  for (int b = 0; b < 64; ++b)
    if (1ull << b < n) bits = b + 1;
  return bits;
}
constexpr int at_least(int least, int x) { return x < least ? least : x; }

// An integer as the place in an array or the length of a shift.
template <class Uint>
unsigned index(const Uint& x) {
  return x.to_uint();
}

// x with bit i set or cleared.
template <class Uint>
Uint with_bit(const Uint& x, unsigned i, bool set) {
  const Uint bit = Uint(1) << i;
  Uint result = x | bit;
  if (!set) result = result ^ bit;
  return result;
}

// The lowest set bit's place, 0 where none is.
template <class T, int W>
typename T::template uint<at_least(1, clog2(W))> lowest_bit(const typename T::template uint<W>& x) {
  typename T::template uint<at_least(1, clog2(W))> place = 0;
  for (int i = W - 1; i >= 0; --i) {
    HLS_UNROLL
    if (x[i]) place = i;
  }
  return place;
}

// How many bits x takes: 1 + the highest set bit's place, 0 for 0.
template <class T, int W>
typename T::template uint<clog2(W + 1)> bit_width(const typename T::template uint<W>& x) {
  typename T::template uint<clog2(W + 1)> width = 0;
  for (int i = 0; i < W; ++i) {
    HLS_UNROLL
    if (x[i]) width = i + 1;
  }
  return width;
}

// What is pushed comes out Turns pushes later: the feedback of a pipelined loop whose distance is a
// number that the tool can see.
template <class E, int Turns>
class Delay {
 public:
  E push(const E& e) {
    HLS_PARTITION(places_, 1)
    const E out = places_[Turns - 1];
    for (int i = Turns - 1; i > 0; --i) {
      HLS_UNROLL
      places_[i] = places_[i - 1];
    }
    places_[0] = e;
    return out;
  }
  void fill(const E& e) {
    for (int i = 0; i < Turns; ++i) {
      HLS_UNROLL
      places_[i] = e;
    }
  }

 private:
  E places_[Turns];
};

// An octahedral code of B bits a coordinate as an integer direction, |x| + |y| + |z| = 2^B.
template <class T, int B>
struct Direction {
  using Part = typename T::template sint<B + 2>;
  Part x, y, z;

  static Direction decode(const typename T::template uint<B>& u,
                          const typename T::template uint<B>& v) {
    const Part one = 1 << B;
    const Part column = 2 * index(u) + 1 - (1 << B), row = 2 * index(v) + 1 - (1 << B);
    const Part ax = magnitude(column), ay = magnitude(row);
    Direction d;
    d.z = one - ax - ay;
    d.x = column;
    d.y = row;
    if (d.z < 0) {
      const Part fx = one - ay, fy = one - ax;
      d.x = fx;
      if (column < 0) d.x = 0 - fx;
      d.y = fy;
      if (row < 0) d.y = 0 - fy;
    }
    return d;
  }

  static Part magnitude(const Part& p) {
    Part m = p;
    if (p < 0) m = 0 - p;
    return m;
  }
};

// The exact product of two directions.
template <class T, int B1, int B2>
typename T::template sint<B1 + B2 + 2> dot(const Direction<T, B1>& a, const Direction<T, B2>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

}  // namespace photonloom_hls
