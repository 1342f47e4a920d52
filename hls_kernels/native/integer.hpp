// SPDX-License-Identifier: Apache-2.0
// Integers of stated width for native runs, with the semantics that ap_(u)int and ac_int share:
// sums, differences and products are as wide as they must be, an assignment keeps the low bits, a
// shift keeps the width of its left side. A fresh integer holds a pattern, not 0.
#pragma once
#include <cstdint>
#include <type_traits>

namespace photonloom_hls {

__extension__ typedef __int128 Wide;
__extension__ typedef unsigned __int128 UnsignedWide;

// 1 <= W <= 128 bits.
template <int W, bool Signed>
class Integer {
  static_assert(W >= 1 && W <= 128, "an integer has 1 to 128 bits; wider words are Bits");

 public:
  using Raw =
      std::conditional_t<W <= 32, uint32_t, std::conditional_t<W <= 64, uint64_t, UnsignedWide>>;
  using Value = std::conditional_t<
      !Signed, Raw,
      std::conditional_t<W <= 32, int32_t, std::conditional_t<W <= 64, int64_t, Wide>>>;
  static constexpr int kWidth = W;
  static constexpr bool kSigned = Signed;

  constexpr Integer() : value_(wrap(static_cast<Raw>(0xa5a5a5a5a5a5a5a5ull))) {}
  template <class I, std::enable_if_t<std::is_integral_v<I>, int> = 0>
  constexpr Integer(I value) : value_(wrap(static_cast<Raw>(value))) {}
  template <int W2, bool S2>
  constexpr Integer(const Integer<W2, S2>& other) : value_(wrap(static_cast<Raw>(other.value()))) {}

  // The low W bits of a number.
  template <class N>
  static constexpr Integer of(N number) {
    Integer result(0);
    result.value_ = wrap(static_cast<Raw>(number));
    return result;
  }

  constexpr Value value() const { return value_; }
  constexpr unsigned to_uint() const { return static_cast<unsigned>(value_); }
  constexpr uint64_t to_uint64() const { return static_cast<uint64_t>(value_); }
  constexpr bool operator[](unsigned i) const {
    return i < static_cast<unsigned>(W) && (static_cast<Raw>(value_) >> i & 1) != 0;
  }

  constexpr Integer operator<<(unsigned n) const {
    return n >= static_cast<unsigned>(W) ? Integer(0) : of(static_cast<Raw>(value_) << n);
  }
  constexpr Integer operator>>(unsigned n) const {
    if (n < static_cast<unsigned>(W)) return of(value_ >> n);
    if constexpr (Signed) return Integer(value_ < 0 ? -1 : 0);
    return Integer(0);
  }

  template <class N>
  constexpr Integer& operator+=(const N& n) {
    return *this = Integer(*this + n);
  }
  template <class N>
  constexpr Integer& operator-=(const N& n) {
    return *this = Integer(*this - n);
  }
  constexpr Integer& operator++() { return *this += 1; }

 private:
  static constexpr Value wrap(Raw raw) {
    constexpr int kStorage = static_cast<int>(8 * sizeof(Raw));
    if constexpr (W == kStorage) {
      return static_cast<Value>(raw);
    } else if constexpr (Signed) {
      return static_cast<Value>(raw << (kStorage - W)) >> (kStorage - W);
    } else {
      return raw & ((Raw{1} << W) - 1);
    }
  }
  Value value_;
};

namespace integer_detail {

constexpr int larger(int a, int b) { return a > b ? a : b; }
// Bits that a number needs beside one of the other signedness.
constexpr int common(int w1, bool s1, int w2, bool s2) {
  return larger(w1 + (s2 && !s1 ? 1 : 0), w2 + (s1 && !s2 ? 1 : 0));
}
template <class I>
using Native =
    Integer<std::is_same_v<I, bool> ? 1 : static_cast<int>(8 * sizeof(I)), std::is_signed_v<I>>;

}  // namespace integer_detail

// The result of each operator, computed in its own storage.
#define PHOTONLOOM_HLS_OPERATOR(op, width, is_signed)                                   \
  template <int W1, bool S1, int W2, bool S2>                                           \
  constexpr auto operator op(const Integer<W1, S1>& a, const Integer<W2, S2>& b) {      \
    using Result = Integer<(width), (is_signed)>;                                       \
    using Raw = typename Result::Raw;                                                   \
    return Result::of(static_cast<Raw>(a.value()) op static_cast<Raw>(b.value()));      \
  }                                                                                     \
  template <int W1, bool S1, class I, std::enable_if_t<std::is_integral_v<I>, int> = 0> \
  constexpr auto operator op(const Integer<W1, S1>& a, I b) {                           \
    return a op integer_detail::Native<I>(b);                                           \
  }                                                                                     \
  template <int W1, bool S1, class I, std::enable_if_t<std::is_integral_v<I>, int> = 0> \
  constexpr auto operator op(I a, const Integer<W1, S1>& b) {                           \
    return integer_detail::Native<I>(a) op b;                                           \
  }
PHOTONLOOM_HLS_OPERATOR(+, integer_detail::common(W1, S1, W2, S2) + 1, S1 || S2)
PHOTONLOOM_HLS_OPERATOR(-, integer_detail::common(W1, S1, W2, S2) + 1, true)
PHOTONLOOM_HLS_OPERATOR(*, W1 + W2, S1 || S2)
PHOTONLOOM_HLS_OPERATOR(&, integer_detail::common(W1, S1, W2, S2), S1 || S2)
PHOTONLOOM_HLS_OPERATOR(|, integer_detail::common(W1, S1, W2, S2), S1 || S2)
PHOTONLOOM_HLS_OPERATOR(^, integer_detail::common(W1, S1, W2, S2), S1 || S2)
#undef PHOTONLOOM_HLS_OPERATOR

#define PHOTONLOOM_HLS_COMPARISON(op)                                                         \
  template <int W1, bool S1, int W2, bool S2>                                                 \
  constexpr bool operator op(const Integer<W1, S1>& a, const Integer<W2, S2>& b) {            \
    using Common = typename Integer<integer_detail::common(W1, S1, W2, S2), S1 || S2>::Value; \
    return static_cast<Common>(a.value()) op static_cast<Common>(b.value());                  \
  }                                                                                           \
  template <int W1, bool S1, class I, std::enable_if_t<std::is_integral_v<I>, int> = 0>       \
  constexpr bool operator op(const Integer<W1, S1>& a, I b) {                                 \
    return a op integer_detail::Native<I>(b);                                                 \
  }
PHOTONLOOM_HLS_COMPARISON(==)
PHOTONLOOM_HLS_COMPARISON(!=)
PHOTONLOOM_HLS_COMPARISON(<)
PHOTONLOOM_HLS_COMPARISON(<=)
PHOTONLOOM_HLS_COMPARISON(>)
PHOTONLOOM_HLS_COMPARISON(>=)
#undef PHOTONLOOM_HLS_COMPARISON

// A word of any width without arithmetic: packets and lines. Words of 32 bits, the least
// significant first; unused bits are 0.
template <int W>
class Bits {
  static_assert(W >= 1);

 public:
  static constexpr unsigned kWords = (W + 31) / 32;

  Bits() {
    for (uint32_t& word : words_) word = 0;
  }

  uint32_t* words() { return words_; }
  const uint32_t* words() const { return words_; }

  // Bits [lo, lo + N), N <= 64.
  template <int N>
  Integer<N, false> slice(unsigned lo) const {
    static_assert(N <= 64);
    const unsigned word = lo / 32, bit = lo % 32;
    UnsignedWide all = 0;
    for (unsigned i = 0; i < 3; ++i)
      if (word + i < kWords) all |= static_cast<UnsignedWide>(words_[word + i]) << (32 * i);
    return Integer<N, false>::of(all >> bit);
  }
  template <int N>
  void set(unsigned lo, const Integer<N, false>& value) {
    static_assert(N <= 64);
    const unsigned word = lo / 32, bit = lo % 32;
    const UnsignedWide mask = ((static_cast<UnsignedWide>(1) << N) - 1) << bit;
    const UnsignedWide all = static_cast<UnsignedWide>(value.value()) << bit;
    for (unsigned i = 0; i < 3 && word + i < kWords; ++i) {
      const auto m = static_cast<uint32_t>(mask >> (32 * i));
      words_[word + i] = (words_[word + i] & ~m) | (static_cast<uint32_t>(all >> (32 * i)) & m);
    }
  }
  template <int N>
  void set_word(unsigned lo, const Bits<N>& value) {
    for (unsigned at = 0; at < static_cast<unsigned>(N); at += 32)
      set_low(lo + at, value.words()[at / 32], static_cast<unsigned>(N) - at);
  }

 private:
  // The low min(32, n) bits of `value`.
  void set_low(unsigned lo, uint32_t value, unsigned n) {
    const uint64_t ones = n >= 32 ? 0xffffffffull : (1ull << n) - 1;
    const uint64_t mask = ones << (lo % 32), all = static_cast<uint64_t>(value) << (lo % 32);
    for (unsigned i = 0; i < 2 && lo / 32 + i < kWords; ++i) {
      const auto m = static_cast<uint32_t>(mask >> (32 * i));
      uint32_t& word = words_[lo / 32 + i];
      word = (word & ~m) | (static_cast<uint32_t>(all >> (32 * i)) & m);
    }
  }

  uint32_t words_[kWords];
};

}  // namespace photonloom_hls
