// SPDX-License-Identifier: Apache-2.0
#include "golden/transport/film_filter.hpp"

#include <algorithm>
#include <cmath>

#include "golden/numeric/elementary.hpp"

namespace photonloom {
namespace {

double exponential(double x) {
  constexpr double kBits = 1.4426950408889634;  // log2(e)
  return exp2_exact(x * kBits);
}

// sin(pi x) / (pi x).
double sinc(double x) { return x == 0 ? 1 : cos_sin_turns(x / 2).y / (kPi * x); }

double mitchell(double x, double b, double c) {
  const double x2 = x * x, x3 = x2 * x;
  if (x < 1) return ((12 - 9 * b - 6 * c) * x3 + (-18 + 12 * b + 6 * c) * x2 + 6 - 2 * b) / 6;
  return ((-b - 6 * c) * x3 + (6 * b + 30 * c) * x2 + (-12 * b - 48 * c) * x + 8 * b + 24 * c) / 6;
}

}  // namespace

double filter_value(const Filter& filter, double distance) {
  const double x = std::fabs(distance), r = filter.radius;
  if (x > r) return 0;
  switch (filter.kind) {
    case FilterKind::kTent:
      return 1 - x / r;
    case FilterKind::kGaussian: {
      const double a = -1 / (2 * filter.stddev * filter.stddev);
      return std::max(0.0, exponential(a * x * x) - exponential(a * r * r));
    }
    case FilterKind::kMitchell:
      return mitchell(x, filter.b, filter.c);
    case FilterKind::kLanczos:
      return sinc(x) * sinc(x / r);
    default:
      return 1;
  }
}

FilterTable::FilterTable(const Filter& filter)
    : reach_(static_cast<int>(std::ceil(filter.radius + 0.5)) - 1),
      plain_box_(filter.is_plain_box()) {
  constexpr double kOne = 1 << kOneBits;
  for (int offset = -reach_; offset <= reach_; ++offset) {
    double sum = 0, squares = 0;
    for (int place = 0; place < kPlaces; ++place) {
      const double f = filter_value(filter, offset + 0.5 - (place + 0.5) / kPlaces);
      const double w = std::copysign(std::floor(std::fabs(f) * kOne + 0.5), f);
      weights_.push_back(static_cast<int32_t>(w));
      sum += w / kOne;
      squares += w * w / (kOne * kOne);
    }
    means_.push_back(sum / kPlaces);
    squares_.push_back(squares / kPlaces);
  }
}

double FilterTable::mean_sum(int pixel, int size) const {
  double sum = 0;
  for (int offset = -reach_; offset <= reach_; ++offset)
    if (pixel - offset >= 0 && pixel - offset < size) sum += mean(offset);
  return sum;
}

}  // namespace photonloom
