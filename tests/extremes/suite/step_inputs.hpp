// SPDX-License-Identifier: Apache-2.0
// Inputs of golden's arithmetic that both the measured and the proved bounds are tried on.
#pragma once
#include "golden/numeric/reciprocal.hpp"
#include "golden/packet/packet.hpp"
#include "golden/plan/plan.hpp"

namespace photonloom {

// Shading with few enough bits that a product is exact in 128.
inline Plan shading(int w, int weight_bits) {
  Plan plan;
  plan.reciprocal_bits = w;
  plan.weight_bits = weight_bits;
  plan.k = 50;
  plan.global.r2_max = plan.caustic.r2_max = plan.r2_limit();
  plan.integer_bits = 60;
  plan.fraction_bits = 40;
  return plan;
}

// A gather's answer of equal channels.
inline GatherResult result_of(const Plan& plan, uint64_t flux, uint64_t r2, bool full) {
  GatherResult r{};
  r.flux = {flux, flux, flux};
  r.r2 = r2;
  r.full = full;
  const Reciprocal inverse = reciprocal(r2, plan.reciprocal_bits);
  r.reciprocal = inverse.mantissa;
  r.reciprocal_exponent = inverse.exponent;
  return r;
}

}  // namespace photonloom
