// SPDX-License-Identifier: Apache-2.0
// A reconstruction filter as a table of integers: what a sample counts in the pixels around it
// (docs/frame.md).
#pragma once
#include <cmath>
#include <cstdint>
#include <vector>

#include "golden/numeric/vec.hpp"
#include "golden/scene/scene.hpp"

namespace photonloom {

// f at a distance from the pixel's centre, pixels.
double filter_value(const Filter& filter, double distance);

class FilterTable {
 public:
  // Places of a sample within its pixel, and what f = 1 counts, along one axis.
  static constexpr int kPlaces = 64;
  static constexpr int kOneBits = 14;

  explicit FilterTable(const Filter& filter);

  // Pixels on either side of a sample's own that it counts in; 0 for the box.
  int reach() const { return reach_; }
  bool is_plain_box() const { return plain_box_; }

  // For a coordinate's fraction of a pixel, in [0, 1).
  static int place(double fraction) { return static_cast<int>(fraction * kPlaces); }
  // Along one axis, in the pixel `offset` from the sample's own: -reach() to reach().
  int32_t weight(int offset, int place) const {
    return weights_[static_cast<size_t>((offset + reach_) * kPlaces + place)];
  }
  // In the pixel (x, y) further, for a sample at these places within its own; f = 1 counts 1.
  double weight(int x, int y, const Vec2& places) const {
    return std::ldexp(static_cast<double>(weight(x, place(places.x)) * weight(y, place(places.y))),
                      -2 * kOneBits);
  }
  // Mean over all places of the weight, and of its square; f = 1 counts 1.
  double mean(int offset) const { return means_[static_cast<size_t>(offset + reach_)]; }
  double mean_square(int offset) const { return squares_[static_cast<size_t>(offset + reach_)]; }
  // What a sample's weights along one axis add up to in the pixel number `pixel` of a row or column
  // of `size`, in the mean, where each pixel has one sample.
  double mean_sum(int pixel, int size) const;

 private:
  int reach_ = 0;
  bool plain_box_ = true;
  std::vector<int32_t> weights_;
  std::vector<double> means_, squares_;
};

}  // namespace photonloom
