// SPDX-License-Identifier: Apache-2.0
#include "golden/numeric/elementary.hpp"

#include <cmath>

namespace photonloom {
namespace {

// Taylor series of sin and cos on [-pi/4, pi/4]; the first term left out is below 1e-18.
double sin_series(double x) {
  const double x2 = x * x;
  double sum = 0, term = x;
  for (int i = 1; i <= 10; ++i) {
    sum += term;
    term *= -x2 / static_cast<double>((2 * i) * (2 * i + 1));
  }
  return sum;
}

double cos_series(double x) {
  const double x2 = x * x;
  double sum = 0, term = 1;
  for (int i = 1; i <= 10; ++i) {
    sum += term;
    term *= -x2 / static_cast<double>((2 * i - 1) * (2 * i));
  }
  return sum;
}

constexpr double kLn2 = 0.693147180559945309417;

}  // namespace

Vec2 cos_sin_turns(double x) {
  x -= std::floor(x);
  const double octant = std::floor(x * 4 + 0.5);
  const double angle = (x - octant * 0.25) * (2 * kPi);
  const double s = sin_series(angle), c = cos_series(angle);
  switch (static_cast<int>(octant) & 3) {
    case 0:
      return {c, s};
    case 1:
      return {-s, c};
    case 2:
      return {-c, -s};
    default:
      return {s, -c};
  }
}

double angle_of(double x, double y) {
  const double ax = std::fabs(x);
  const double small = ax < y ? ax : y, large = ax < y ? y : ax;
  if (large == 0) return 0;
  // tan(a/4) from tan(a), a <= pi/4; then the series, whose first term left out is below 1e-19.
  double z = small / large;
  for (int i = 0; i < 2; ++i) z = z / (1.0 + std::sqrt(1.0 + z * z));
  const double z2 = z * z;
  double sum = 0, power = z;
  for (int i = 0; i < 13; ++i) {
    sum += power / static_cast<double>(2 * i + 1);
    power *= -z2;
  }
  double angle = 4 * sum;
  if (ax < y) angle = kPi / 2 - angle;
  return x < 0 ? kPi - angle : angle;
}

double exp2_exact(double x) {
  if (x < -1080) return 0;
  if (x > 1030) return HUGE_VAL;
  if (std::isnan(x)) return x;
  const double whole = std::floor(x + 0.5);
  const double y = (x - whole) * kLn2;  // |y| <= 0.347
  double sum = 0, term = 1;
  for (int i = 1; i <= 16; ++i) {
    sum += term;
    term *= y / static_cast<double>(i);
  }
  return std::ldexp(sum, static_cast<int>(whole));
}

double log2_exact(double x) {
  if (x <= 0) return -HUGE_VAL;
  if (!std::isfinite(x)) return x;
  int exponent;
  double m = std::frexp(x, &exponent);  // [0.5, 1)
  if (m < 0.70710678118654752440) {
    m *= 2;
    --exponent;
  }
  // ln m = 2 artanh((m-1)/(m+1)); |z| <= 0.1716
  const double z = (m - 1) / (m + 1), z2 = z * z;
  double sum = 0, power = z;
  for (int i = 0; i < 12; ++i) {
    sum += power / static_cast<double>(2 * i + 1);
    power *= z2;
  }
  return static_cast<double>(exponent) + 2 * sum / kLn2;
}

double pow_exact(double x, double y) {
  if (y == 0) return 1;
  if (x <= 0) return 0;
  return exp2_exact(y * log2_exact(x));
}

}  // namespace photonloom
