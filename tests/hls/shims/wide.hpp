// SPDX-License-Identifier: Apache-2.0
// What both shims are made of: integers of W bits in words of 32, two's complement, by their
// documentation: a result is as wide as it must be, an assignment keeps the low bits.
#pragma once
#include <cstdint>
#include <type_traits>

namespace shim {

template <int W, bool S>
struct Wide {
  static_assert(W >= 1);
  static constexpr int kWords = (W + 31) / 32;
  uint32_t words[kWords];

  Wide() {
    for (uint32_t& w : words) w = 0xa5a5a5a5u;  // neither library sets a fresh integer
    wrap();
  }
  template <class I, std::enable_if_t<std::is_integral_v<I>, int> = 0>
  explicit Wide(I value) {
    const auto all = static_cast<uint64_t>(value);
    const uint32_t fill = value < I(0) ? ~0u : 0u;
    for (int i = 0; i < kWords; ++i)
      words[i] = i == 0   ? static_cast<uint32_t>(all)
                 : i == 1 ? static_cast<uint32_t>(all >> 32)
                          : fill;
    wrap();
  }
  template <int W2, bool S2>
  explicit Wide(const Wide<W2, S2>& other) {
    for (int i = 0; i < kWords; ++i) words[i] = other.word(i);
    wrap();
  }

  bool negative() const { return S && bit(W - 1); }
  bool bit(int i) const { return (words[i / 32] >> (i % 32) & 1) != 0; }
  // Beyond the number: its sign.
  uint32_t word(int i) const { return i < kWords ? words[i] : negative() ? ~0u : 0u; }
  uint64_t low() const { return word(0) | static_cast<uint64_t>(word(1)) << 32; }

  // Bits beyond W repeat the sign, or are 0.
  void wrap() {
    if constexpr (W % 32 != 0) {
      const uint32_t mask = (1u << (W % 32)) - 1;
      uint32_t& top = words[kWords - 1];
      top = S && (top >> (W % 32 - 1) & 1) ? top | ~mask : top & mask;
    }
  }

  Wide shifted_left(unsigned n) const {
    Wide r(0);
    for (unsigned i = n; i < static_cast<unsigned>(W); ++i)
      if (bit(static_cast<int>(i - n))) r.words[i / 32] |= 1u << (i % 32);
    r.wrap();
    return r;
  }
  Wide shifted_right(unsigned n) const {
    Wide r(0);
    for (unsigned i = 0; i < static_cast<unsigned>(W); ++i) {
      const bool b = i + n < static_cast<unsigned>(W) ? bit(static_cast<int>(i + n)) : negative();
      if (b) r.words[i / 32] |= 1u << (i % 32);
    }
    r.wrap();
    return r;
  }
};

constexpr int larger(int a, int b) { return a > b ? a : b; }
// Bits that hold both, of the signedness of the result.
constexpr int common(int w1, bool s1, int w2, bool s2) {
  return larger(w1 + (s2 && !s1 ? 1 : 0), w2 + (s1 && !s2 ? 1 : 0));
}
template <class I>
constexpr int width_of = std::is_same_v<I, bool> ? 1 : static_cast<int>(8 * sizeof(I));

template <int W, bool S, class A, class B>
Wide<W, S> sum(const A& a, const B& b, bool subtract) {
  Wide<W, S> r(0);
  uint64_t carry = subtract ? 1 : 0;
  for (int i = 0; i < r.kWords; ++i) {
    carry += static_cast<uint64_t>(a.word(i)) + (subtract ? ~b.word(i) : b.word(i));
    r.words[i] = static_cast<uint32_t>(carry);
    carry >>= 32;
  }
  r.wrap();
  return r;
}
template <int W, bool S, class A, class B>
Wide<W, S> product(const A& a, const B& b) {
  Wide<W, S> r(0);
  for (int i = 0; i < r.kWords; ++i) {
    uint64_t carry = 0;
    for (int j = 0; i + j < r.kWords; ++j) {
      carry += static_cast<uint64_t>(a.word(i)) * b.word(j) + r.words[i + j];
      r.words[i + j] = static_cast<uint32_t>(carry);
      carry >>= 32;
    }
  }
  r.wrap();
  return r;
}
template <class A, class B>
bool equal(const A& a, const B& b) {
  for (int i = 0; i < larger(A::kWords, B::kWords) + 1; ++i)
    if (a.word(i) != b.word(i)) return false;
  return true;
}
template <class A, class B>
bool less(const A& a, const B& b) {
  if (a.negative() != b.negative()) return a.negative();
  for (int i = larger(A::kWords, B::kWords); i >= 0; --i)
    if (a.word(i) != b.word(i)) return a.word(i) < b.word(i);
  return false;
}

}  // namespace shim

// The operators of a number type Number<W, S> whose `value` is a Wide.
#define SHIM_OPERATOR(Number, op, width, sign, expression)                              \
  template <int W1, bool S1, int W2, bool S2>                                           \
  auto operator op(const Number<W1, S1>& x, const Number<W2, S2>& y) {                  \
    constexpr int kW = (width);                                                         \
    constexpr bool kS = (sign);                                                         \
    [[maybe_unused]] const auto& a = x.value;                                           \
    [[maybe_unused]] const auto& b = y.value;                                           \
    return Number<kW, kS>::of(expression);                                              \
  }                                                                                     \
  template <int W1, bool S1, class I, std::enable_if_t<std::is_integral_v<I>, int> = 0> \
  auto operator op(const Number<W1, S1>& x, I y) {                                      \
    return x op Number<shim::width_of<I>, std::is_signed_v<I>>(y);                      \
  }                                                                                     \
  template <int W1, bool S1, class I, std::enable_if_t<std::is_integral_v<I>, int> = 0> \
  auto operator op(I x, const Number<W1, S1>& y) {                                      \
    return Number<shim::width_of<I>, std::is_signed_v<I>>(x) op y;                      \
  }
#define SHIM_COMPARISON(Number, op, expression)                                         \
  template <int W1, bool S1, int W2, bool S2>                                           \
  bool operator op(const Number<W1, S1>& x, const Number<W2, S2>& y) {                  \
    const auto& a = x.value;                                                            \
    const auto& b = y.value;                                                            \
    return (expression);                                                                \
  }                                                                                     \
  template <int W1, bool S1, class I, std::enable_if_t<std::is_integral_v<I>, int> = 0> \
  bool operator op(const Number<W1, S1>& x, I y) {                                      \
    return x op Number<shim::width_of<I>, std::is_signed_v<I>>(y);                      \
  }
#define SHIM_OPERATORS(Number)                                                               \
  SHIM_OPERATOR(Number, +, shim::common(W1, S1, W2, S2) + 1, S1 || S2,                       \
                (shim::sum<kW, kS>(a, b, false)))                                            \
  SHIM_OPERATOR(Number, -, shim::common(W1, S1, W2, S2) + 1, true,                           \
                (shim::sum<kW, kS>(a, b, true)))                                             \
  SHIM_OPERATOR(Number, *, W1 + W2, S1 || S2, (shim::product<kW, kS>(a, b)))                 \
  SHIM_OPERATOR(Number, &, shim::common(W1, S1, W2, S2), S1 || S2,                           \
                (shim::bitwise<kW, kS>(a, b, [](uint32_t p, uint32_t q) { return p & q; }))) \
  SHIM_OPERATOR(Number, |, shim::common(W1, S1, W2, S2), S1 || S2,                           \
                (shim::bitwise<kW, kS>(a, b, [](uint32_t p, uint32_t q) { return p | q; }))) \
  SHIM_OPERATOR(Number, ^, shim::common(W1, S1, W2, S2), S1 || S2,                           \
                (shim::bitwise<kW, kS>(a, b, [](uint32_t p, uint32_t q) { return p ^ q; }))) \
  SHIM_COMPARISON(Number, ==, shim::equal(a, b))                                             \
  SHIM_COMPARISON(Number, !=, !shim::equal(a, b))                                            \
  SHIM_COMPARISON(Number, <, shim::less(a, b))                                               \
  SHIM_COMPARISON(Number, >, shim::less(b, a))                                               \
  SHIM_COMPARISON(Number, <=, !shim::less(b, a))                                             \
  SHIM_COMPARISON(Number, >=, !shim::less(a, b))

namespace shim {
template <int W, bool S, class A, class B, class F>
Wide<W, S> bitwise(const A& a, const B& b, F&& f) {
  Wide<W, S> r(0);
  for (int i = 0; i < r.kWords; ++i) r.words[i] = f(a.word(i), b.word(i));
  r.wrap();
  return r;
}
}  // namespace shim
