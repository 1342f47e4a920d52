// SPDX-License-Identifier: Apache-2.0
// Light as a frame adds it up: exact integers in a golden frame, so that no order of sums shows;
// doubles in a reference frame.
#pragma once
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "golden/numeric/wide_sum.hpp"
#include "golden/pipeline/frame.hpp"

namespace photonloom {

// Calls f(0) to f(count - 1) by several threads.
template <class F>
void parallel(size_t count, F&& f) {
  tbb::parallel_for(tbb::blocked_range<size_t>(0, count, 16), [&](const auto& range) {
    for (size_t i = range.begin(); i < range.end(); ++i) f(i);
  });
}

inline void add(PixelValue& sum, const PixelValue& value) {
  for (size_t c = 0; c < 3; ++c) sum[c] += value[c];
}
inline void add(Rgb& sum, const Rgb& value) { sum += value; }

// A value times part / whole, rounded half up where it is an integer.
inline PixelValue scaled(const PixelValue& value, uint64_t part, uint64_t whole) {
  PixelValue result;
  for (size_t c = 0; c < 3; ++c)
    result[c] = value[c] / whole * part + (2 * (value[c] % whole) * part + whole) / (2 * whole);
  return result;
}
inline Rgb scaled(const Rgb& value, uint64_t part, uint64_t whole) {
  return value * (static_cast<double>(part) / static_cast<double>(whole));
}

// A colour's light, in the unit of the sums below.
inline double light_of(const PixelValue& value, size_t c) { return static_cast<double>(value[c]); }
inline double light_of(const Rgb& value, size_t c) { return value[static_cast<int>(c)]; }

// Light times small weights, added up.
struct WideRgb {
  std::array<WideSum, 3> sum;
  void add(const WideRgb& other) {
    for (size_t c = 0; c < 3; ++c) sum[c].add(other.sum[c]);
  }
  void add(const PixelValue& value, int32_t weight) {
    for (size_t c = 0; c < 3; ++c) sum[c].add(value[c], weight);
  }
  double operator[](size_t c) const { return sum[c].value(); }
};
struct DoubleRgb {
  Rgb sum{0};
  void add(const DoubleRgb& other) { sum += other.sum; }
  void add(const Rgb& value, int32_t weight) { sum += value * static_cast<double>(weight); }
  double operator[](size_t c) const { return sum[static_cast<int>(c)]; }
};

template <Arithmetic kArithmetic>
struct LightValues {
  static constexpr bool kGolden = kArithmetic == Arithmetic::kGolden;
  using Value = std::conditional_t<kGolden, PixelValue, Rgb>;
  // What a query's answer is multiplied with.
  using QueryWeight = std::conditional_t<kGolden, Weight, Rgb>;
  using FilmSum = std::conditional_t<kGolden, WideRgb, DoubleRgb>;
};

template <class Value>
struct Layers {
  Value direct{}, caustic{}, indirect{}, emission{};
};

// Sums the saturations of parallel work, which are nearly always none.
struct SharedCounts {
  std::atomic<uint64_t> weights{0}, direct{0}, not_finite{0};
  std::array<std::atomic<uint64_t>, sizeof(ClampCounts) / sizeof(uint64_t)> clamps{};
  void take(const ShaderCounts& c) {
    if (c.not_finite) not_finite += c.not_finite;
    if (c.weights) weights += c.weights;
    if (c.direct) direct += c.direct;
  }
  void take(const ClampCounts& c) {
    auto* sum = clamps.data();
    ClampCounts::visit([&](const char*, auto member) {
      if (c.*member) *sum += c.*member;
      ++sum;
    });
  }
  void give(FrameCounts& to) const {
    to.shader.weights += weights;
    to.shader.direct += direct;
    to.shader.not_finite += not_finite;
    const auto* sum = clamps.data();
    ClampCounts::visit([&](const char*, auto member) { to.clamps.*member += *sum++; });
  }
};

}  // namespace photonloom
