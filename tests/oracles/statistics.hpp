// SPDX-License-Identifier: Apache-2.0
// How a random estimate is held against a closed form: within the stated relative tolerance, of
// which its standard error is at most a quarter. So four standard errors fit the tolerance, and
// nothing wider than what a test's title says is ever applied.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>

#include "tests/catch.hpp"
#include "tests/oracles/scenes.hpp"

namespace photonloom::oracle {

inline constexpr std::initializer_list<uint64_t> kSeeds = {1, 20, 300};

// The seed of one of the independent batches behind an estimate. Batches of different seeds share
// none, so that what is seen with each of kSeeds is independent.
inline uint64_t batch_seed(uint64_t seed, uint64_t batch) {
  constexpr uint64_t kBatches = 1000;
  REQUIRE(batch < kBatches);
  return seed * kBatches + batch;
}

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

// The mean over all emitted paths, those without photons included, of the sum over a path's photons
// of value(photon): photons of one path are no independent values.
template <class Value>
Estimate per_path(const PhotonPass& pass, Value&& value) {
  double sum = 0, squares = 0;
  const double n = static_cast<double>(pass.paths);
  for (size_t i = 0; i < pass.photons.size();) {
    double x = 0;
    const uint64_t path = pass.photons[i].path;
    for (; i < pass.photons.size() && pass.photons[i].path == path; ++i)
      x += value(pass.photons[i]) * n;
    sum += x;
    squares += x * x;
  }
  const double mean = sum / n;
  return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean) / (n - 1))};
}

inline void check_estimate(const char* what, uint64_t seed, const Estimate& e, double expected,
                           double tolerance) {
  INFO(what << ", seed " << seed << ": " << e.mean << " +- " << e.error << ", expected "
            << expected);
  const double stated = tolerance * std::fabs(expected);
  CHECK(e.error <= stated / 4);
  CHECK(std::fabs(e.mean - expected) <= stated);
}

}  // namespace photonloom::oracle
