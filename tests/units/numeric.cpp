// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "golden/numeric/elementary.hpp"
#include "golden/numeric/hilbert.hpp"
#include "golden/numeric/octahedral.hpp"
#include "golden/numeric/random.hpp"
#include "golden/numeric/reciprocal.hpp"
#include "golden/numeric/sha256.hpp"
#include "golden/numeric/shared_exponent.hpp"
#include "golden/packet/packet.hpp"
#include "golden/plan/quantiser.hpp"
#include "golden/unit/cdf_sampler.hpp"
#include "golden/unit/irradiance_cache.hpp"
#include "golden/unit/photon_gatherer.hpp"
#include "golden/unit/shader.hpp"
#include "tests/catch.hpp"

using namespace photonloom;

TEST_CASE("octahedral centres encode to their own code, at every width") {
  for (int b : {2, 4, 8})
    for (uint32_t u = 0; u < (1u << b); ++u)
      for (uint32_t v = 0; v < (1u << b); ++v) {
        const IVec3 o = oct_decode({u, v}, b);
        REQUIRE(std::abs(o[0]) + std::abs(o[1]) + std::abs(o[2]) == (1 << b));
        REQUIRE((oct_encode(Vec3(o[0], o[1], o[2]), b) == OctCode{u, v}));
      }
}

TEST_CASE("the top bits of an octahedral code are the coarser code") {
  for (uint64_t i = 0; i < 10000; ++i) {
    const Random r(7, Phase::kPath, i);
    const Vec3 d(r.unit(0, 0) - 0.5, r.unit(0, 1) - 0.5, r.unit(0, 2) - 0.5);
    const OctCode fine = oct_encode(d, 12), coarse = oct_encode(d, 4);
    REQUIRE(fine.u >> 8 == coarse.u);
    REQUIRE(fine.v >> 8 == coarse.v);
  }
}

TEST_CASE("the Hilbert curve visits every cell once, each next to the one before") {
  const int b = 3;
  std::vector<UVec3> at(size_t{1} << (3 * b), UVec3{99, 99, 99});
  for (uint32_t x = 0; x < 8; ++x)
    for (uint32_t y = 0; y < 8; ++y)
      for (uint32_t z = 0; z < 8; ++z) {
        at[hilbert_index({x, y, z}, b)] = {x, y, z};
        REQUIRE(hilbert_index({x, y, z}, b) >> 3 == hilbert_index({x >> 1, y >> 1, z >> 1}, b - 1));
      }
  for (size_t i = 1; i < at.size(); ++i) {
    int distance = 0;
    for (size_t c = 0; c < 3; ++c)
      distance += std::abs(static_cast<int>(at[i][c]) - static_cast<int>(at[i - 1][c]));
    REQUIRE(distance == 1);
  }
}

TEST_CASE("reciprocal is within one unit of the division for every mantissa") {
  for (int w : {8, 12, 18})
    for (uint64_t m = uint64_t{1} << w; m < uint64_t{2} << w; ++m) {
      const Reciprocal r = reciprocal(m, w);
      REQUIRE(r.exponent == static_cast<uint32_t>(w));
      const double exact = std::ldexp(1.0, 2 * w) / static_cast<double>(m);
      REQUIRE(exact - r.mantissa >= 0);
      REQUIRE(exact - r.mantissa < 1);
    }
  REQUIRE(reciprocal((uint64_t{1} << 30) - 1, 8) == Reciprocal{256, 30});  // the carry
}

TEST_CASE("elementary functions agree with libm") {
  for (int i = -4000; i <= 4000; ++i) {
    const double x = i * 0.00137, turn = x - std::floor(x);
    REQUIRE(std::fabs(cos_sin_turns(x).x - std::cos(2 * kPi * turn)) < 4e-15);
    REQUIRE(std::fabs(cos_sin_turns(x).y - std::sin(2 * kPi * turn)) < 4e-15);
    REQUIRE(std::fabs(exp2_exact(x * 20) / std::exp2(x * 20) - 1) < 1e-13);
    if (x > 0) REQUIRE(std::fabs(pow_exact(x, 33.3) / std::pow(x, 33.3) - 1) < 1e-12);
  }
}

TEST_CASE("elementary functions of infinity and of no number are libm's") {
  const double nan = std::nan("");
  CHECK(log2_exact(HUGE_VAL) == HUGE_VAL);
  CHECK(pow_exact(HUGE_VAL, 2.2) == HUGE_VAL);
  CHECK(pow_exact(HUGE_VAL, -1) == 0);
  CHECK(exp2_exact(-HUGE_VAL) == 0);
  CHECK(std::isnan(exp2_exact(nan)));
  CHECK(std::isnan(log2_exact(nan)));
  CHECK(std::isnan(pow_exact(nan, 2)));
}

TEST_CASE("shared exponent: the largest channel keeps its top bit, the error is half a step") {
  for (uint64_t i = 0; i < 20000; ++i) {
    const Random r(3, Phase::kPath, i);
    const double scale = std::exp2(r.unit(1, 0) * 38);
    const std::array<double, 3> v{r.unit(0, 0) * scale, r.unit(0, 1) * scale, r.unit(0, 2) * scale};
    bool saturated = false;
    const PowerCode p = encode_power(v, 3, 9, 5, &saturated);
    REQUIRE_FALSE(saturated);
    const uint32_t top = std::max({p.mantissa[0], p.mantissa[1], p.mantissa[2]});
    if (p.exponent > 0) REQUIRE(top >= 256);
    for (int c = 0; c < 3; ++c)
      REQUIRE(std::fabs(static_cast<double>(power_value(p, c)) - v[c]) <=
              std::ldexp(0.5, static_cast<int>(p.exponent)));
  }
}

TEST_CASE("quantisation is monotone: a larger number never has a smaller code") {
  for (const int bits : {4, 16, 24}) {
    Plan plan;
    plan.position_bits = bits;
    plan.weight_bits = bits < 8 ? 8 : bits;
    plan.cache_accuracy = 1;
    plan.cache_radius_max = 10;
    const Shader shader(plan);
    ShaderCounts counts;
    std::vector<double> values;
    for (uint64_t i = 0; i < 4000; ++i)
      values.push_back(Random(9, Phase::kPath, i).unit(0, 0) *
                       std::exp2(-static_cast<int>(i % 30)));
    std::sort(values.begin(), values.end());
    const auto weight = [&](double v) {
      const Weight w = shader.weight(Rgb(v * 1e-12), false, counts);
      return std::ldexp(static_cast<double>(w.mantissa[0]), w.exponent[0]);
    };
    const auto power = [&](double v) {
      bool saturated = false;
      return power_value(encode_power({v * 0x1p30, 0, 0}, 3, bits < 16 ? bits : 16, 5, &saturated),
                         0);
    };
    const auto reach = [&](double v) {  // the larger, the smaller its reciprocal
      const Reciprocal r = cache_falloff(plan, v * 5);
      return std::ldexp(-static_cast<double>(r.mantissa), -static_cast<int>(r.exponent));
    };
    for (size_t i = 1; i < values.size(); ++i) {
      const double a = values[i - 1], b = values[i];
      CAPTURE(bits, a, b);
      REQUIRE(quantise_position(plan, Vec3(a))[0] <= quantise_position(plan, Vec3(b))[0]);
      REQUIRE(quantise_normal(plan, Vec3(2 * a - 1))[1] <=
              quantise_normal(plan, Vec3(2 * b - 1))[1]);
      if (a > 0) REQUIRE(radius_to_r2_max(plan, a) <= radius_to_r2_max(plan, b));
      REQUIRE(power(a) <= power(b));
      REQUIRE(weight(a) <= weight(b));
      REQUIRE(shader.pixel(Rgb(a), counts)[2] <= shader.pixel(Rgb(b), counts)[2]);
      REQUIRE(reach(a) <= reach(b));
      REQUIRE(oct_encode(Vec3(a, 0, 1), 12).u <= oct_encode(Vec3(b, 0, 1), 12).u);
    }
  }
}

TEST_CASE("sums do not depend on the order of what is added") {
  Plan plan;
  plan.k = 64;
  plan.global.r2_max = plan.r2_limit();
  std::vector<PackedPhoton> photons(64);
  std::vector<SamplerPhoton> table;
  for (uint64_t i = 0; i < photons.size(); ++i) {
    const Random r(5, Phase::kPath, i);
    for (size_t c = 0; c < 3; ++c)
      photons[i].position[c] = static_cast<uint32_t>(r.bits(0, c) >> 48);
    photons[i].power = {{static_cast<uint32_t>(256 + r.bits(1, 0) % 256),
                         static_cast<uint32_t>(r.bits(1, 1) % 512), 511},
                        static_cast<uint32_t>(r.bits(1, 2) % 32)};
    photons[i].direction = oct_encode(Vec3(r.unit(2, 0) - 0.5, r.unit(2, 1) - 0.5, 0.5), 8);
    table.push_back({photons[i].power, photons[i].direction});
  }
  GatherQuery query{};
  const OctCode up = oct_encode(Vec3(0, 0, 1), 8);
  query.normal = {up.u, up.v};
  const CellGeometry geometry(plan.cell_bits);
  std::vector<Channels64> sums;
  std::vector<std::vector<uint64_t>> prefixes;
  for (uint64_t order = 0; order < 20; ++order) {
    const PhotonMap map = build_photon_map(photons, plan);
    std::vector<Neighbour> found;
    const SearchCounts counts = search_gather(plan, map, query, found);
    sums.push_back(make_gather_result(plan, map, query, found, counts).flux);
    prefixes.push_back(build_sample_table(plan, geometry, up, table).prefix);
    for (size_t i = photons.size(); i-- > 1;) {
      const size_t j = Random(6, Phase::kPath, order).bits(i, 0) % (i + 1);
      std::swap(photons[i], photons[j]);
      std::swap(table[i], table[j]);
    }
  }
  for (size_t i = 1; i < sums.size(); ++i) {
    REQUIRE(sums[i] == sums[0]);
    REQUIRE(prefixes[i] == prefixes[0]);
  }
}

TEST_CASE("packet fields are visited in order with the plan's widths") {
  Plan plan;
  plan.global.photons = 4000;
  int bits = 0;
  GatherQuery::fields(plan, [&](auto, const FieldInfo& f) { bits += f.elements * f.bits; });
  REQUIRE(bits == 16 + 4 + 5 + 3 + 48 + 16);
  int packets = 0;
  for_each_packet([&](auto) { ++packets; });
  REQUIRE(packets == 7);
}

TEST_CASE("SHA-256 of the examples of FIPS 180-4 and of a million letters") {
  const auto sum = [](const std::string& text) {
    Sha256 s;
    s.add(text);
    return s.hex();
  };
  CHECK(sum("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  CHECK(sum("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq") ==
        "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  CHECK(sum(std::string(1000000, 'a')) ==
        "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}
