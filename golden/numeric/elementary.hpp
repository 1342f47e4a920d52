// SPDX-License-Identifier: Apache-2.0
// Elementary functions from + - x / and sqrt alone, so that they give the same bits with every
// compiler and libm.
#pragma once
#include "golden/numeric/vec.hpp"

namespace photonloom {

inline constexpr double kPi = 3.14159265358979323846;

// (cos, sin) of 2 pi x; error below 4 ulp of 1.
Vec2 cos_sin_turns(double x);

// Angle of (x, y) in radians, in [0, pi], for y >= 0; error below 4 ulp of pi.
double angle_of(double x, double y);

// 2^x and log2(x), and from them x^y for x >= 0; relative error below 1e-13.
double exp2_exact(double x);
double log2_exact(double x);
double pow_exact(double x, double y);

}  // namespace photonloom
