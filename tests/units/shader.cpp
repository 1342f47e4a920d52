// SPDX-License-Identifier: Apache-2.0
// The shader against the same formula in wide arithmetic.
#include "golden/unit/shader.hpp"

#include <cmath>
#include <limits>
#include <random>

#include "golden/numeric/elementary.hpp"
#include "golden/numeric/reciprocal.hpp"
#include "golden/plan/plan_file.hpp"
#include "tests/catch.hpp"

using namespace photonloom;

namespace {

Plan test_plan(int w) {
  Plan plan;
  plan.global = {true, 1000, -30, 0, 0};
  plan.global.r2_max = plan.r2_limit();
  plan.reciprocal_bits = w;
  plan.fraction_bits = 40;
  plan.integer_bits = 60;
  check_plan(plan);
  return plan;
}

GatherResult result_of(const Plan& plan, uint64_t flux, uint64_t r2, bool full) {
  GatherResult r{};
  r.flux = {flux, flux / 2, 0};
  r.r2 = r2;
  r.full = full;
  r.count = full ? static_cast<uint32_t>(plan.k) : 1;
  if (plan.reciprocal_bits) {
    const Reciprocal x = reciprocal(std::max(r2, plan.r2_floor), plan.reciprocal_bits);
    r.reciprocal = x.mantissa;
    r.reciprocal_exponent = x.exponent;
  }
  return r;
}

}  // namespace

TEST_CASE("a contribution is flux c / (pi r^2) times the weight, to the widths of the plan") {
  std::mt19937_64 random(7);
  INFO("seed 7");
  for (const int w : {0, 8, 18, 24}) {
    const Plan plan = test_plan(w);
    const Shader shader(plan);
    // The rounding of r^2, R, c and the weight, each at most 2^-W or 2^-18 of the value.
    const double bound = 3 * std::ldexp(1.0, -plan.shader_bits()) + 0x1p-18;
    for (int i = 0; i < 2000; ++i) {
      const uint64_t flux = random() & ones(plan.flux_bits());
      const uint64_t r2 = 1 + (random() & ones(static_cast<int>(random() % 34)));
      const bool full = random() & 1;
      const double weight = std::ldexp(1 + static_cast<double>(random() >> 11) * 0x1p-53,
                                       -static_cast<int>(random() % 20));
      ShaderCounts counts;
      const PixelValue value =
          shader.contribution(result_of(plan, flux, r2, full),
                              shader.weight(Rgb(weight, weight, weight), false, counts));
      const double u = plan.position_unit();
      const double expected = std::ldexp(static_cast<double>(flux), -30) *
                              (full ? (plan.k - 1.0) / plan.k : 1.0) /
                              (kPi * static_cast<double>(r2) * u * u) * weight;
      INFO("W " << w << ", flux " << flux << ", r2 " << r2 << ", weight " << weight);
      CHECK(counts.weights == 0);
      CHECK(std::fabs(shader.radiance(value[0]) - expected) <= bound * expected + 0x1p-41);
      CHECK(value[2] == 0);
    }
  }
}

TEST_CASE("contributions and light round half up") {
  Plan plan = test_plan(18);
  plan.k = 2;  // c = 1/2 when full
  plan.fraction_bits = 0;
  const Shader shader(plan);
  Weight one;
  one.mantissa = {1u << 17, 1u << 17, 1u << 17};
  one.exponent = {-17, -17, -17};
  const auto value = [&](uint64_t flux, uint64_t r2) {
    return static_cast<uint64_t>(shader.contribution(result_of(plan, flux, r2, true), one)[0]);
  };
  CHECK(value(1, 1) == 1);  // 0.5
  CHECK(value(3, 1) == 2);  // 1.5
  CHECK(value(1, 2) == 0);  // 0.25
  CHECK(value(5, 2) == 1);  // 1.25
  CHECK(value(6, 2) == 2);  // 1.5
  ShaderCounts counts;
  CHECK(static_cast<uint64_t>(shader.pixel(Rgb(0.5, 0.49, 2.5), counts)[0]) == 1);
  CHECK(static_cast<uint64_t>(shader.pixel(Rgb(0.5, 0.49, 2.5), counts)[1]) == 0);
  CHECK(static_cast<uint64_t>(shader.pixel(Rgb(0.5, 0.49, 2.5), counts)[2]) == 3);
  CHECK(shader.pixel(Rgb(-1, 0, 0), counts)[0] == 0);
  CHECK(counts.direct == 0);
  CHECK(counts.not_finite == 0);
  const double infinity = std::numeric_limits<double>::infinity();
  CHECK(shader.pixel(Rgb(infinity, 0, std::nan("")), counts) == PixelValue{});
  CHECK(counts.not_finite == 2);
  CHECK(shader.weight(Rgb(infinity, 0, 0), false, counts) == Weight{});
  CHECK(counts.not_finite == 3);
}

TEST_CASE("no contribution reaches 2^(I+F), at the largest flux, weight and reciprocal") {
  for (const uint64_t floor : {uint64_t{1}, uint64_t{3}, uint64_t{1000}})
    for (const int w : {0, 8, 24}) {
      Plan plan = test_plan(w);
      plan.k = 64;
      plan.r2_floor = floor;
      const Shader shader(plan);
      ShaderCounts counts;
      const Weight weight = shader.weight(Rgb(1e60), false, counts);
      CHECK(counts.weights == 3);
      CHECK(weight.mantissa[0] == ones(plan.weight_bits));
      CHECK(weight.exponent[0] == plan.weight_exponent_max());
      for (const bool full : {false, true}) {
        const GatherResult r = result_of(plan, ones(plan.flux_bits()), floor, full);
        CHECK(shader.contribution(r, weight)[0] >> plan.pixel_contribution_bits() == 0);
      }
      CHECK(shader.pixel(Rgb(1e60), counts)[0] >> plan.pixel_contribution_bits() == 0);
      CHECK(counts.direct == 3);
      // And the largest that is not clipped is not far below.
      CHECK(shader.pixel(Rgb(std::ldexp(0.99, plan.integer_bits - 1)), counts)[0] > 0);
      CHECK(counts.direct == 3);
    }
}
