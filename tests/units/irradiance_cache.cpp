// SPDX-License-Identifier: Apache-2.0
#include "golden/unit/irradiance_cache.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "golden/numeric/random.hpp"
#include "golden/plan/plan_file.hpp"
#include "golden/unit/backend.hpp"
#include "golden/unit/shader.hpp"
#include "tests/catch.hpp"

using namespace photonloom;

namespace {

Plan cache_plan() {
  Plan plan;
  plan.cache_present = true;
  return plan;
}

CacheLookup lookup_at(const UVec3& position, uint64_t reach, uint32_t insert = 1) {
  const Plan plan = cache_plan();
  const Reciprocal r = reciprocal(reach * reach, plan.cache_falloff_bits());
  CacheLookup l{};
  l.insert = insert;
  l.position = position;
  l.normal = {128, 128, 255};
  l.falloff = r.mantissa;
  l.falloff_exponent = r.exponent;
  return l;
}

std::vector<CacheResult> answers(const Plan& plan, const std::vector<CacheLookup>& in) {
  std::vector<CacheResult> out;
  make_golden_irradiance_cache(plan)->process(in, out);
  return out;
}

}  // namespace

TEST_CASE("a weight is 1 - d^2 / reach^2 - n^2 / 2^angle_bits, up to its rounding") {
  const Random random(1, Phase::kPath, 1);
  uint64_t positive = 0, none = 0;
  for (const int bits : {4, 8, 12})
    for (const int angle : {0, 7, 11, 18})
      for (uint64_t i = 0; i < 3000; ++i) {
        Plan plan = cache_plan();
        plan.cache_weight_bits = bits;
        plan.cache_angle_bits = angle;
        const auto size = static_cast<int>(random.bits(i, 0) % 17);
        UVec3 a{}, b{}, na{}, nb{};
        for (size_t c = 0; c < 3; ++c) {
          a[c] = static_cast<uint32_t>(random.bits(i, 1 + c) & ones(size));
          b[c] = static_cast<uint32_t>(random.bits(i, 4 + c) & ones(size));
          na[c] = static_cast<uint32_t>(100 + random.bits(i, 7 + c) % 16);
          nb[c] = static_cast<uint32_t>(100 + random.bits(i, 10 + c) % 16);
        }
        const uint64_t reach2 = 1 + (random.bits(i, 13) & ones(2 * size));
        const uint32_t w =
            cache_weight(plan, {a, na, reciprocal(reach2, plan.cache_falloff_bits())}, b, nb);
        double d2 = 0, n2 = 0;
        for (size_t c = 0; c < 3; ++c) {
          d2 += std::pow(double(a[c]) - double(b[c]), 2);
          n2 += std::pow(double(na[c]) - double(nb[c]), 2);
        }
        const double one = std::ldexp(1.0, bits);
        const double exact =
            one * (1 - d2 / static_cast<double>(reach2) - n2 / std::ldexp(1.0, angle));
        // The reciprocal has four bits more than the weight; every other step rounds up.
        const double slack = one * std::ldexp(1.0, -bits - 2);
        INFO(bits << " " << angle << " " << i << ": " << w << " for " << exact);
        REQUIRE(w >= exact - 1 - slack);
        REQUIRE(w <= std::max(exact, 0.0) + 3 + slack);
        REQUIRE(w <= one);
        if (n2 >= std::ldexp(1.0, angle)) REQUIRE(w == 0);
        if (d2 == 0 && n2 == 0) REQUIRE(w == one);
        (w > 0 ? positive : none) += 1;
      }
  CHECK(positive > 1000);
  CHECK(none > 1000);
}

TEST_CASE("a point that no record covers becomes one, and covers what lies in its reach") {
  const std::vector<CacheResult> out =
      answers(cache_plan(), {lookup_at({1000, 1000, 1000}, 128), lookup_at({1064, 1000, 1000}, 7),
                             lookup_at({1128, 1000, 1000}, 128), lookup_at({1064, 1000, 1000}, 1)});
  CHECK(out[0].inserted == 1);
  CHECK(out[0].number == 0);
  CHECK(out[0].count == 0);
  CHECK(out[1].inserted == 0);
  CHECK(out[1].count == 1);
  CHECK(out[1].record[0] == 0);
  CHECK(out[1].weight[0] == 192);  // of 256: a quarter is lost to half the reach
  CHECK(out[2].inserted == 1);     // at the reach's end
  CHECK(out[2].number == 1);
  CHECK(out[3].count == 2);
  CHECK(out[3].weight[0] == out[3].weight[1]);
  CHECK(out[3].record[0] == 0);  // the earlier one
  CHECK(out[3].record[1] == 1);
}

TEST_CASE("the heaviest records leave, heaviest first") {
  // Around (1000, 1000, 1000), further from each other than they reach.
  const std::vector<UVec3> places{{1000, 1000, 1080}, {1060, 1000, 1000}, {1000, 1070, 1000},
                                  {940, 1000, 1000},  {1000, 930, 1000},  {1000, 1000, 920}};
  for (const int hits : {1, 3, 8}) {
    Plan plan = cache_plan();
    plan.cache_hits = hits;
    std::vector<CacheLookup> in;
    for (const UVec3& place : places) in.push_back(lookup_at(place, 85));
    in.push_back(lookup_at({1000, 1000, 1000}, 85));
    const std::vector<CacheResult> out = answers(plan, in);
    for (size_t i = 0; i < places.size(); ++i) REQUIRE(out[i].inserted == 1);
    const CacheResult& r = out.back();
    const std::vector<uint32_t> order{1, 3, 2, 4, 0, 5};
    REQUIRE(r.count == std::min<size_t>(static_cast<size_t>(hits), order.size()));
    for (size_t i = 0; i < r.record.size(); ++i) {
      CHECK(r.record[i] == (i < r.count ? order[i] : 0));
      if (i > 0) CHECK(r.weight[i] <= r.weight[i - 1]);
      CHECK((r.weight[i] > 0) == (i < r.count));
    }
  }
}

TEST_CASE("a full tile takes no more records, a new one begins empty, a look makes none") {
  Plan plan = cache_plan();
  plan.cache_records = 2;
  std::vector<CacheLookup> in;
  for (uint32_t i = 0; i < 4; ++i) in.push_back(lookup_at({1000 * i, 0, 0}, 10));
  in.push_back(lookup_at({3000, 0, 0}, 10));
  in.back().clear = 1;
  in.push_back(lookup_at({0, 0, 0}, 10, 0));
  in.push_back(lookup_at({3000, 0, 0}, 10, 0));
  const std::vector<CacheResult> out = answers(plan, in);
  for (size_t i : {0u, 1u}) CHECK((out[i].inserted == 1 && out[i].number == i));
  for (size_t i : {2u, 3u}) CHECK((out[i].full == 1 && out[i].inserted == 0 && out[i].number == 0));
  CHECK((out[4].inserted == 1 && out[4].number == 0));
  CHECK((out[5].count == 0 && out[5].inserted == 0 && out[5].full == 0));
  CHECK((out[6].count == 1 && out[6].record[0] == 0 && out[6].weight[0] == 256));
}

TEST_CASE("how calls cut the lookups does not matter") {
  const Plan plan = cache_plan();
  const Random random(3, Phase::kPath, 1);
  std::vector<CacheLookup> in;
  for (uint64_t i = 0; i < 600; ++i) {
    in.push_back(lookup_at({static_cast<uint32_t>(random.bits(i, 0) % 500),
                            static_cast<uint32_t>(random.bits(i, 1) % 500), 0},
                           1 + random.bits(i, 2) % 60, i < 400));
    in.back().clear = i % 300 == 0;
  }
  const std::vector<CacheResult> whole = answers(plan, in);
  const auto unit = make_golden_irradiance_cache(plan);
  std::vector<CacheResult> cut;
  for (size_t at = 0, n = 1; at < in.size(); at += n, n = n % 7 + 1)
    unit->process(std::span(in).subspan(at, std::min(n, in.size() - at)), cut);
  CHECK(cut == whole);
  const Counters counters = unit->counters();
  CHECK(counters.at("lookups") == in.size());
  CHECK(counters.at("hits") > 100);
  CHECK(counters.at("records made") > 50);
  CHECK(counters.at("hits") + counters.at("records made") + counters.at("full") <= in.size());
}

TEST_CASE("reach: the accuracy times the radius within its limits, never below one unit") {
  Plan plan = cache_plan();
  plan.extent = 65536;  // one position unit is 1
  plan.cache_accuracy = 0.5;
  plan.cache_radius_min = 64.0 / 65536;
  plan.cache_radius_max = 1024.0 / 65536;
  const int w = plan.cache_falloff_bits();
  ClampCounts counts;
  CHECK(cache_falloff(plan, 200, &counts) == reciprocal(100 * 100, w));
  CHECK(cache_falloff(plan, 64, &counts) == reciprocal(32 * 32, w));
  CHECK(cache_falloff(plan, 1024, &counts) == reciprocal(512 * 512, w));
  CHECK(counts.radii == 0);
  CHECK(cache_falloff(plan, 0, &counts) == reciprocal(32 * 32, w));
  CHECK(cache_falloff(plan, 1e9, &counts) == reciprocal(512 * 512, w));
  CHECK(counts.radii == 2);
  CHECK(counts.reaches == 0);
  plan.cache_accuracy = 1e-6;
  CHECK(cache_falloff(plan, 200, &counts) == reciprocal(1, w));
  plan.cache_accuracy = 1e9;
  CHECK(cache_falloff(plan, 200, &counts) == reciprocal(ones(plan.r2_bits() - 1), w));
  CHECK(counts.radii == 2);
  CHECK(counts.reaches == 2);
}

TEST_CASE("a normal is kept to within a unit, whatever its sign") {
  const Plan plan = cache_plan();
  for (int i = 0; i < 3; ++i)
    for (const double sign : {-1.0, 1.0}) {
      Vec3 n(0);
      n[i] = sign;
      const UVec3 q = quantise_normal(plan, n);
      for (int c = 0; c < 3; ++c)
        CHECK(q[static_cast<size_t>(c)] == (c != i ? 128u : sign < 0 ? 0u : 255u));
    }
}

TEST_CASE("shares of a record's light add up to it, within their rounding") {
  Plan plan;
  plan.fraction_bits = 30;
  const Shader shader(plan);
  ShaderCounts counts;
  const Random random(5, Phase::kPath, 1);
  for (uint64_t i = 0; i < 2000; ++i) {
    const double rho = 1e-3 + random.unit(i, 0);
    const Weight share = shader.share(Rgb(rho, 0, 1), counts);
    const int size = static_cast<int>(random.bits(i, 1) % 100);
    UInt128 light = random.bits(i, 2);
    light = (light << 64 | random.bits(i, 3)) >> (127 - size);
    uint32_t total = 0;
    std::array<uint32_t, 4> weights{};
    for (uint32_t& w : weights)
      total += w = 1 + static_cast<uint32_t>(random.bits(i, 4 + (&w - weights.data())) % 256);
    PixelValue sum{};
    for (const uint32_t w : weights) {
      const PixelValue v = shader.interpolated({light, light, light}, w, total, share);
      for (size_t c = 0; c < 3; ++c) sum[c] += v[c];
    }
    const auto exact = static_cast<double>(light);
    INFO(i);
    REQUIRE(sum[1] == 0);
    REQUIRE(std::fabs(static_cast<double>(sum[2]) - exact) <= 2 + exact * 1e-5);
    REQUIRE(std::fabs(static_cast<double>(sum[0]) - exact * rho) <= 2 + exact * rho * 1e-5);
  }
  CHECK(counts.not_finite == 0);
}

TEST_CASE("one record's share is exact where it divides nothing") {
  Plan plan;
  const Shader shader(plan);
  ShaderCounts counts;
  const Weight half = shader.share(Rgb(0.5, 1, 2), counts);
  const UInt128 light = UInt128{0x123456789abcdef0ull} << 40;
  const PixelValue v = shader.interpolated({light, light, light}, 7, 7, half);
  CHECK((v == PixelValue{light / 2, light, light * 2}));
  const PixelValue odd = shader.interpolated({3, 1, 0}, 1, 1, half);
  CHECK((odd == PixelValue{2, 1, 0}));  // half up
}

TEST_CASE("what a cache cannot go with is refused") {
  Plan plan = cache_plan();
  CHECK(!find_problem(plan));
  plan.first_rays = plan.gather_rays / 2;
  CHECK(find_problem(plan)->line == "cache.present");
  plan = cache_plan();
  plan.cache_angle_bits = 2 * plan.normal_bits + 3;
  CHECK(find_problem(plan)->line == "cache.angle_bits");
  plan = cache_plan();
  plan.cache_radius_min = 2 * plan.cache_radius_max;
  CHECK(find_problem(plan)->line == "cache.radius_min");
}
