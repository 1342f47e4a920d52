// SPDX-License-Identifier: Apache-2.0
// A toolset whose operations are declared and nothing more: what scripts/hls-subset compiles
// kernels with, so that the syntax tree holds the kernel and no library.
#pragma once

namespace photonloom_hls {

template <int W, bool S>
struct Number {
  Number();
  Number(long long);
  template <int W2, bool S2>
  Number(const Number<W2, S2>&);
  unsigned to_uint() const;
  bool operator[](unsigned) const;
  Number operator<<(unsigned) const;
  Number operator>>(unsigned) const;
  template <class N>
  Number& operator+=(const N&);
  template <class N>
  Number& operator-=(const N&);
  Number& operator++();
  char bit[W];
};

#define DECLARED_OPERATOR(op, width)                                               \
  template <int W1, bool S1, int W2, bool S2>                                      \
  Number<(width), true> operator op(const Number<W1, S1>&, const Number<W2, S2>&); \
  template <int W1, bool S1>                                                       \
  Number<W1 + 64, true> operator op(const Number<W1, S1>&, long long);             \
  template <int W1, bool S1>                                                       \
  Number<W1 + 64, true> operator op(long long, const Number<W1, S1>&);
#define DECLARED_COMPARISON(op)                                   \
  template <int W1, bool S1, int W2, bool S2>                     \
  bool operator op(const Number<W1, S1>&, const Number<W2, S2>&); \
  template <int W1, bool S1>                                      \
  bool operator op(const Number<W1, S1>&, long long);
DECLARED_OPERATOR(+, W1 + W2)
DECLARED_OPERATOR(-, W1 + W2)
DECLARED_OPERATOR(*, W1 + W2)
DECLARED_OPERATOR(&, W1 + W2)
DECLARED_OPERATOR(|, W1 + W2)
DECLARED_OPERATOR(^, W1 + W2)
DECLARED_COMPARISON(==)
DECLARED_COMPARISON(!=)
DECLARED_COMPARISON(<)
DECLARED_COMPARISON(<=)
DECLARED_COMPARISON(>)
DECLARED_COMPARISON(>=)

template <class E>
struct Queue {
  explicit Queue(const char*);
  E read();
  void write(const E&);
};

struct Declared {
  template <int W>
  using uint = Number<W, false>;
  template <int W>
  using sint = Number<W, true>;
  template <int W>
  using bits = Number<W, false>;
  template <class E>
  using stream = Queue<E>;
  template <int N, int W, bool S>
  static uint<N> slice(const Number<W, S>&, unsigned);
  template <int N, int W>
  static void set_slice(Number<W, false>&, unsigned, const Number<N, false>&);
};

}  // namespace photonloom_hls
