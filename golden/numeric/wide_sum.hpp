// SPDX-License-Identifier: Apache-2.0
// An exact signed sum of products of 128-bit values and small weights, whatever their order.
#pragma once
#include <cmath>
#include <cstdint>

#include "golden/numeric/bits.hpp"

namespace photonloom {

// 192 bits, two's complement.
class WideSum {
 public:
  // value * weight, |weight| < 2^31.
  void add(UInt128 value, int32_t weight) {
    const uint64_t w = weight < 0 ? -static_cast<uint64_t>(weight) : static_cast<uint64_t>(weight);
    const UInt128 bottom = static_cast<uint64_t>(value) * UInt128{w};
    const UInt128 top = (value >> 64) * w + (bottom >> 64);
    WideSum product;
    product.low_ = (top << 64) | static_cast<uint64_t>(bottom);
    product.high_ = static_cast<uint64_t>(top >> 64);
    add(weight < 0 ? product.negative() : product);
  }
  void add(const WideSum& other) {
    low_ += other.low_;
    high_ += other.high_ + (low_ < other.low_ ? 1 : 0);
  }
  bool operator==(const WideSum&) const = default;

  // The nearest double, ties to even.
  double value() const {
    if (high_ >> 63) return -negative().value();
    if (high_ == 0) return static_cast<double>(low_);
    // The upper 128 of the 192 bits, and whether anything is below them.
    const int shift = 64 - clz(high_);
    const UInt128 upper = (UInt128{high_} << (128 - shift)) | (low_ >> shift);
    const bool rest = (low_ & ((UInt128{1} << shift) - 1)) != 0;
    return std::ldexp(static_cast<double>(upper | (rest ? 1 : 0)), shift);
  }

 private:
  static int clz(uint64_t x) { return __builtin_clzll(x); }
  WideSum negative() const {
    WideSum n;
    n.low_ = ~low_ + 1;
    n.high_ = ~high_ + (n.low_ == 0 ? 1 : 0);
    return n;
  }

  UInt128 low_ = 0;
  uint64_t high_ = 0;
};

}  // namespace photonloom
