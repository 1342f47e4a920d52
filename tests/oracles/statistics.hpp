// SPDX-License-Identifier: Apache-2.0
// How a random estimate is held against a closed form: the larger of the stated relative tolerance
// and four standard errors, with the standard error at most half of the stated tolerance.
#pragma once
#include <cmath>
#include <cstdint>
#include <initializer_list>

#include "tests/catch.hpp"
#include "tests/oracles/scenes.hpp"

namespace photonloom::oracle {

inline constexpr std::initializer_list<uint64_t> kSeeds = {1, 20, 300};

struct Estimate {
  double mean = 0, error = 0;  // standard error of the mean
};

// Of independent values.
class Tally {
 public:
  void add(double x) {
    ++n_;
    sum_ += x;
    square_ += x * x;
  }
  Estimate estimate() const {
    const double n = static_cast<double>(n_), mean = sum_ / n;
    return {mean, std::sqrt(std::max(0.0, square_ / n - mean * mean) / (n - 1))};
  }

 private:
  uint64_t n_ = 0;
  double sum_ = 0, square_ = 0;
};

// Mean of a layer over the image, with the error of the image's own `error` layer, which is that of
// all layers together.
inline Estimate image_estimate(const Image& image, const std::string& layer = "") {
  const std::string channel = layer.empty() ? "G" : layer + ".G";
  double squares = 0;
  for (float e : image.find("error.G")->pixels)
    squares += static_cast<double>(e) * static_cast<double>(e);
  const double n = static_cast<double>(image.find("error.G")->pixels.size());
  return {channel_mean(image, channel), std::sqrt(squares) / n};
}

inline void check_estimate(const char* what, uint64_t seed, const Estimate& e, double expected,
                           double tolerance) {
  INFO(what << ", seed " << seed << ": " << e.mean << " +- " << e.error << ", expected "
            << expected);
  const double stated = tolerance * std::fabs(expected);
  CHECK(e.error <= stated / 2);
  CHECK(std::fabs(e.mean - expected) <= std::max(stated, 4 * e.error));
}

}  // namespace photonloom::oracle
