// SPDX-License-Identifier: Apache-2.0
#include "golden/unit/cdf_sampler.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

#include "golden/numeric/elementary.hpp"
#include "golden/numeric/random.hpp"
#include "golden/unit/backend.hpp"
#include "tests/catch.hpp"

using namespace photonloom;

namespace {

std::vector<SamplerPhoton> random_photons(const Plan& plan, const Random& random, int count,
                                          uint32_t exponents) {
  std::vector<SamplerPhoton> photons;
  for (int i = 0; i < count; ++i) {
    SamplerPhoton p;
    const auto at = static_cast<uint64_t>(i);
    for (uint64_t c = 0; c < static_cast<uint64_t>(plan.channels); ++c)
      p.power.mantissa[c] = static_cast<uint32_t>(random.bits(at, c) & ones(plan.mantissa_bits));
    p.power.exponent = static_cast<uint32_t>(random.bits(at, 3) % exponents);
    p.direction = {static_cast<uint32_t>(random.bits(at, 4) & ones(plan.direction_bits)),
                   static_cast<uint32_t>(random.bits(at, 5) & ones(plan.direction_bits))};
    photons.push_back(p);
  }
  return photons;
}

OctCode random_normal(const Plan& plan, const Random& random) {
  return {static_cast<uint32_t>(random.bits(99, 0) & ones(plan.normal_bits)),
          static_cast<uint32_t>(random.bits(99, 1) & ones(plan.normal_bits))};
}

// A point of the octahedron |x| + |y| + |z| = m as docs/cdf_sampler.md has it: above the diagonals
// of the square [-m, m]^2 the point itself, beyond them its mirror image in the diagonal of its
// quadrant, below.
struct Point {
  int64_t x, y, z;
};
Point on_octahedron(int64_t s, int64_t t, int64_t m) {
  const int64_t over = std::abs(s) + std::abs(t) - m;
  if (over <= 0) return {s, t, -over};
  return {s - (s > 0 ? over : -over), t - (t > 0 ? over : -over), -over};
}
int64_t dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// Whether one of a cell's four corners has a positive dot product with the normal.
bool touches_upper_hemisphere(size_t cell, int cell_bits, const OctCode& normal, int normal_bits) {
  const int64_t m = int64_t{1} << cell_bits, normal_m = int64_t{1} << normal_bits;
  const Point n = on_octahedron(2 * int64_t{normal.u} + 1 - normal_m,
                                2 * int64_t{normal.v} + 1 - normal_m, normal_m);
  const auto column = static_cast<int64_t>(cell) % m, row = static_cast<int64_t>(cell) / m;
  for (const int64_t i : {column, column + 1})
    for (const int64_t j : {row, row + 1})
      if (dot(on_octahedron(2 * i - m, 2 * j - m, m), n) > 0) return true;
  return false;
}

Plan plan_with(int cell_bits, int probability_bits, TableCombine combine) {
  Plan plan;
  plan.cell_bits = cell_bits;
  plan.probability_bits = probability_bits;
  plan.combine = combine;
  plan.u_bits = std::max(16, plan.total_bits() + 8);
  return plan;
}

}  // namespace

TEST_CASE("sampler table: weights fit, cells touching the upper hemisphere have one, others none") {
  for (const auto combine : {TableCombine::kSum, TableCombine::kProduct})
    for (const int a : {1, 2, 4, 6})
      for (const int bits : {4, 12, 16}) {
        const Plan plan = plan_with(a, bits, combine);
        const CellGeometry geometry(a);
        for (uint64_t trial = 0; trial < 12; ++trial) {
          const Random random(5, Phase::kPath, trial);
          const auto photons =
              random_photons(plan, random, static_cast<int>(trial % 4) * 16, trial < 6 ? 4 : 32);
          const OctCode normal = random_normal(plan, random);
          const SampleTable table = build_sample_table(plan, geometry, normal, photons);
          CAPTURE(a, bits, trial);
          REQUIRE(table.total() <= ones(plan.total_bits()));
          for (size_t c = 0; c < geometry.cells(); ++c) {
            REQUIRE(table.weight(c) <= ones(bits));
            REQUIRE((table.weight(c) >= 1) ==
                    touches_upper_hemisphere(c, a, normal, plan.normal_bits));
          }
        }
      }
}

TEST_CASE("sampler table: which cells have a weight, for every normal of 2 x 5 bits") {
  // Coarse normals lie across the corners' directions often, where the dot product is 0.
  for (const int a : {1, 2, 3, 5}) {
    Plan plan = plan_with(a, 16, TableCombine::kSum);
    plan.normal_bits = 5;
    const CellGeometry geometry(a);
    size_t wrong = 0, with_weight = 0;
    for (uint32_t code = 0; code < 1024; ++code) {
      const OctCode normal{code % 32, code / 32};
      const SampleTable table = build_sample_table(plan, geometry, normal, {});
      for (size_t c = 0; c < geometry.cells(); ++c) {
        with_weight += table.weight(c) > 0;
        wrong += (table.weight(c) > 0) != touches_upper_hemisphere(c, a, normal, plan.normal_bits);
      }
    }
    CAPTURE(a);
    CHECK(wrong == 0);
    // Opposite cells: one of them at least touches it, and not always both do.
    CHECK(with_weight >= 512 * geometry.cells());
    CHECK(with_weight < 1024 * geometry.cells());
  }
}

TEST_CASE("sampler table: without photons the weights follow the cosine's integral") {
  Plan plan = plan_with(4, 24, TableCombine::kSum);
  plan.u_bits = 40;
  const CellGeometry geometry(4);
  for (uint64_t trial = 0; trial < 8; ++trial) {
    const OctCode normal = random_normal(plan, Random(6, Phase::kPath, trial));
    const IVec3 ni = oct_decode(normal, plan.normal_bits);
    const Vec3 n = glm::normalize(Vec3(ni[0], ni[1], ni[2]));
    const SampleTable table = build_sample_table(plan, geometry, normal, {});
    for (size_t c = 0; c < geometry.cells(); ++c) {
      double integral = 0;  // of cos / pi over the cell
      const int fine = 16;
      for (int i = 0; i < fine; ++i)
        for (int j = 0; j < fine; ++j) {
          const double s = (static_cast<double>(c & 15) + (i + 0.5) / fine) / 8 - 1;
          const double t = (static_cast<double>(c >> 4) + (j + 0.5) / fine) / 8 - 1;
          const Vec3 p = oct_unfold(s, t);
          const double cosine = glm::dot(glm::normalize(p), n);
          if (cosine > 0) integral += cosine * oct_jacobian(p) / (64.0 * fine * fine) / kPi;
        }
      const double weight =
          static_cast<double>(table.weight(c)) / static_cast<double>(table.total());
      CAPTURE(trial, c, integral, weight);
      // J has 5 to 8 bits, and a cell that the horizon cuts is judged by its centre.
      REQUIRE(std::fabs(weight - integral) <= 0.06 * integral + 0.001);
    }
  }
}

TEST_CASE(
    "sampler table: the sum gives photons and cosine equal shares, the product their overlap") {
  Plan plan = plan_with(4, 20, TableCombine::kSum);
  const CellGeometry geometry(4);
  // All photons in one cell right above the normal's.
  const OctCode normal{128, 128};
  const std::vector<SamplerPhoton> photons(10, {{{100, 50, 20}, 3}, {140, 140}});
  const size_t cell = (140 >> 4) * 16 + (140 >> 4);
  const SampleTable none = build_sample_table(plan, geometry, normal, {});
  const SampleTable sum = build_sample_table(plan, geometry, normal, photons);
  const double cosine = static_cast<double>(none.weight(cell)) / static_cast<double>(none.total());
  REQUIRE(static_cast<double>(sum.weight(cell)) / static_cast<double>(sum.total()) ==
          Approx(0.5 + cosine / 2).margin(1e-3));
  plan.combine = TableCombine::kProduct;
  const SampleTable product = build_sample_table(plan, geometry, normal, photons);
  REQUIRE(static_cast<double>(product.weight(cell)) / static_cast<double>(product.total()) > 0.99);
  // No photon has power: the cosine alone, not a flat floor.
  const std::vector<SamplerPhoton> black(10, {{{0, 0, 0}, 3}, {140, 140}});
  REQUIRE(build_sample_table(plan, geometry, normal, black).weight(cell) > 100);
}

namespace {

// S(c) and the bound of docs/cdf_sampler.md, word by word and in double, which holds these numbers
// exactly: the plans here keep them below 2^53.
std::vector<double> weights_by_definition(const Plan& plan, const OctCode& normal,
                                          const std::vector<SamplerPhoton>& photons) {
  const int a = plan.cell_bits, edge = 1 << a;
  const CellGeometry geometry(a);
  const size_t cells = geometry.cells();
  std::vector<double> p(cells), q(cells), b(cells), s(cells);
  double tp = 0, tb = 0;
  const double n = std::min<double>(plan.k, static_cast<double>(photons.size()));
  for (size_t i = 0; i < static_cast<size_t>(n); ++i) {
    const SamplerPhoton& photon = photons[i];
    const auto& m = photon.power.mantissa;
    const double power = std::ldexp(m[0] + m[1] + m[2], static_cast<int>(photon.power.exponent));
    const uint32_t column = photon.direction.u >> (plan.direction_bits - a);
    p[(photon.direction.v >> (plan.direction_bits - a)) * static_cast<uint32_t>(edge) + column] +=
        power;
    tp += power;
  }
  const IVec3 up = oct_decode(normal, plan.normal_bits);
  for (size_t c = 0; c < cells; ++c) {
    b[c] = std::max(0.0, static_cast<double>(oct_dot(geometry.centre(c), up))) *
           geometry.jacobians()[c];
    tb += b[c];
  }
  for (size_t c = 0; c < cells; ++c)
    for (int l = 0; l < plan.levels; ++l)
      for (size_t other = 0; other < cells; ++other)
        if (other % static_cast<size_t>(edge) >> l == c % static_cast<size_t>(edge) >> l &&
            other / static_cast<size_t>(edge) >> l == c / static_cast<size_t>(edge) >> l)
          q[c] += std::ldexp(p[other], 2 * (plan.levels - 1 - l));
  const double d = std::ldexp(plan.levels, 2 * (plan.levels - 1)), dtp = d * std::max(tp, 1.0);
  const auto width = [](double x) {
    return static_cast<int>(std::bit_width(static_cast<uint64_t>(x)));
  };
  int bits = 0;
  for (size_t c = 0; c < cells; ++c) switch (plan.combine) {
      case TableCombine::kSum:
        s[c] = q[c] * tb + b[c] * dtp;
        bits = width(dtp) + width(tb) + 1;
        break;
      case TableCombine::kProduct:
        s[c] = tp == 0 ? d * b[c] : q[c] * b[c];
        bits = width(dtp) + a + plan.normal_bits + 8;
        break;
      case TableCombine::kWeighted:
        s[c] = n * q[c] * tb + plan.cosine_samples * b[c] * dtp;
        bits = width(dtp) + width(tb) + width(n + plan.cosine_samples);
        break;
      case TableCombine::kPhotons:
        s[c] = tp == 0 ? b[c] : q[c];
        bits = width(tp == 0 ? tb : dtp);
        break;
      case TableCombine::kCosine:
        s[c] = b[c];
        bits = width(tb);
        break;
    }
  for (size_t c = 0; c < cells; ++c) {
    s[c] = std::floor(std::ldexp(s[c], -std::max(0, bits - plan.probability_bits)));
    s[c] = touches_upper_hemisphere(c, a, normal, plan.normal_bits) ? std::max(1.0, s[c]) : 0;
  }
  return s;
}

constexpr TableCombine kCombines[] = {TableCombine::kSum, TableCombine::kProduct,
                                      TableCombine::kWeighted, TableCombine::kPhotons,
                                      TableCombine::kCosine};

}  // namespace

TEST_CASE(
    "sampler table: the weights are those of the definition, for every combination and level") {
  for (const auto combine : kCombines)
    for (const int a : {1, 2, 3})
      for (int levels = 1; levels <= a + 1; ++levels) {
        Plan plan = plan_with(a, 10, combine);
        plan.levels = levels;
        plan.mantissa_bits = 4;
        plan.normal_bits = 5;
        plan.cosine_samples = 9;
        plan.k = 12;
        const CellGeometry geometry(a);
        for (uint64_t trial = 0; trial < 6; ++trial) {
          const Random random(11, Phase::kPath, trial);
          // None, some, more than k; and without power.
          auto photons = random_photons(plan, random, static_cast<int>(trial) * 4, 4);
          if (trial == 5)
            for (SamplerPhoton& p : photons) p.power.mantissa = {0, 0, 0};
          const OctCode normal = random_normal(plan, random);
          const SampleTable table = build_sample_table(plan, geometry, normal, photons);
          const std::vector<double> expected = weights_by_definition(plan, normal, photons);
          CAPTURE(static_cast<int>(combine), a, levels, trial);
          for (size_t c = 0; c < geometry.cells(); ++c)
            REQUIRE(static_cast<double>(table.weight(c)) == expected[c]);
        }
      }
}

TEST_CASE("sampler inversion: every t belongs to the cell that holds it; the ends of u") {
  Plan plan = plan_with(2, 8, TableCombine::kSum);
  plan.u_bits = 20;
  const CellGeometry geometry(2);
  const Random random(8, Phase::kPath, 0);
  const auto photons = random_photons(plan, random, 20, 8);
  const SampleTable table =
      build_sample_table(plan, geometry, random_normal(plan, random), photons);
  std::vector<uint64_t> hits(geometry.cells());
  size_t previous = 0;
  for (uint64_t u = 0; u <= ones(plan.u_bits); ++u) {
    const size_t c = sample_cell(plan, table, u);
    REQUIRE(c >= previous);
    REQUIRE(table.weight(c) > 0);
    previous = c;
    ++hits[c];
  }
  for (size_t c = 0; c < geometry.cells(); ++c) {
    const double expected = static_cast<double>(table.weight(c)) /
                            static_cast<double>(table.total()) * static_cast<double>(1u << 20);
    REQUIRE(std::fabs(static_cast<double>(hits[c]) - expected) <= 1);
  }
}

TEST_CASE("the density of sampled directions integrates to 1 over the sphere") {
  for (const auto combine : kCombines)
    for (const int a : {1, 3, 4}) {
      Plan plan = plan_with(a, 16, combine);
      plan.levels = a;
      const CellGeometry geometry(a);
      const Random random(9, Phase::kPath, static_cast<uint64_t>(a));
      const auto photons = random_photons(plan, random, 50, 8);
      const SampleTable table =
          build_sample_table(plan, geometry, random_normal(plan, random), photons);
      // Over directions, not over the square, so that the Jacobian is tested too: midpoints in
      // (z, phi), where solid angle is uniform.
      const int rings = 500, sectors = 1000;
      double integral = 0;
      for (int i = 0; i < rings; ++i)
        for (int j = 0; j < sectors; ++j) {
          const double z = (i + 0.5) / rings * 2 - 1, phi = (j + 0.5) / sectors * 2 * kPi;
          const double r = std::sqrt(1 - z * z);
          const Vec3 d(r * std::cos(phi), r * std::sin(phi), z);
          const OctCode code = oct_encode(d, a);
          Sample sample{};
          sample.cell_index = (code.v << a) + code.u;
          sample.weight = static_cast<uint32_t>(table.weight(sample.cell_index));
          sample.total = table.total();
          const Vec3 unfolded = d / (std::fabs(d.x) + std::fabs(d.y) + std::fabs(d.z));
          integral += 1 / sample_inverse_pdf(plan, sampled_code(sample), unfolded);
        }
      integral *= 4 * kPi / (double(rings) * sectors);
      CAPTURE(a);
      REQUIRE(integral == Approx(1).margin(4e-3));
    }
}

TEST_CASE("every sampler takes each cell as often as its probability says: chi^2") {
  // Random u through the unit; cells with an expectation below 10 are judged together.
  constexpr uint32_t kRequests = 20000;
  for (const auto combine : kCombines)
    for (const int levels : {1, 4}) {
      Plan plan = plan_with(4, 16, combine);
      plan.levels = levels;
      const Random random(12, Phase::kPath, static_cast<uint64_t>(levels));
      const auto photons = random_photons(plan, random, 40, 6);
      const OctCode normal = random_normal(plan, random);
      std::vector<SamplerInput> in(1 + photons.size() + kRequests);
      in[0].normal = {normal.u, normal.v};
      for (size_t i = 0; i < photons.size(); ++i) {
        SamplerInput& photon = in[1 + i];
        photon.kind = 1;
        photon.mantissa = photons[i].power.mantissa;
        photon.exponent = photons[i].power.exponent;
        photon.direction = {photons[i].direction.u, photons[i].direction.v};
      }
      for (uint64_t i = 0; i < kRequests; ++i) {
        SamplerInput& request = in[1 + photons.size() + i];
        request.kind = 2;
        request.u = random.bits(1000 + i, 0) & ones(plan.u_bits);
      }
      std::vector<Sample> samples;
      make_golden_cdf_sampler(plan)->process(in, samples);
      REQUIRE(samples.size() == kRequests);
      const SampleTable table = build_sample_table(plan, CellGeometry(4), normal, photons);
      std::vector<double> hits(256);
      for (const Sample& s : samples) {
        REQUIRE(s.weight == table.weight(s.cell_index));
        REQUIRE(s.total == table.total());
        ++hits[s.cell_index];
      }
      double chi2 = 0, rest = 0, rest_hits = 0;
      int freedom = -1;
      const auto add = [&](double seen, double expected) {
        chi2 += (seen - expected) * (seen - expected) / expected;
        ++freedom;
      };
      for (size_t c = 0; c < 256; ++c) {
        const double expected =
            static_cast<double>(table.weight(c)) / static_cast<double>(table.total()) * kRequests;
        if (expected < 10) {
          rest += expected;
          rest_hits += hits[c];
        } else {
          add(hits[c], expected);
        }
      }
      if (rest >= 10) add(rest_hits, rest);
      CAPTURE(static_cast<int>(combine), levels, freedom, chi2);
      REQUIRE(freedom > 4);
      // Wilson and Hilferty: the cube root is nearly normal; 4 sigma to both sides.
      const double f = 2.0 / (9 * freedom);
      const double z = (std::cbrt(chi2 / freedom) - (1 - f)) / std::sqrt(f);
      CHECK(std::fabs(z) < 4);
    }
}

TEST_CASE("golden cdf_sampler: streams cut anywhere, odd streams, directions in their cells") {
  Plan plan = plan_with(4, 16, TableCombine::kSum);
  plan.k = 20;
  const Random random(10, Phase::kPath, 0);
  std::vector<SamplerInput> in;
  const auto header = [&](uint32_t i) {
    SamplerInput p{};
    p.pixel = i;
    p.sample = i % 16;
    p.normal = {static_cast<uint32_t>(random.bits(i, 10) & 255),
                static_cast<uint32_t>(random.bits(i, 11) & 255)};
    in.push_back(p);
  };
  const auto photon = [&](uint32_t i) {
    SamplerInput p{};
    p.kind = 1;
    p.mantissa = {i % 512, 7, 9};
    p.exponent = i % 9;
    p.direction = {static_cast<uint32_t>(random.bits(i, 12) & 255),
                   static_cast<uint32_t>(random.bits(i, 13) & 255)};
    in.push_back(p);
  };
  const auto request = [&](uint32_t i) {
    SamplerInput p{};
    p.kind = 2;
    p.tag = i % 17;
    p.u = random.bits(i, 14) & ones(plan.u_bits);
    p.v = {static_cast<uint32_t>(random.bits(i, 15) & 255),
           static_cast<uint32_t>(random.bits(i, 16) & 255)};
    in.push_back(p);
  };
  request(0);  // no table yet: nothing comes of it
  photon(1);
  for (uint32_t t = 0; t < 40; ++t) {
    header(t);
    for (uint32_t i = 0; i < t; ++i) photon(t * 50 + i);
    for (uint32_t i = 0; i < t % 5; ++i) request(t * 50 + i);
  }
  photon(3);  // after its table's first request: no part of it
  request(4);
  std::vector<Sample> whole;
  make_golden_cdf_sampler(plan)->process(in, whole);
  REQUIRE(whole.size() == 81);
  for (const size_t chunk : {1u, 3u, 64u}) {
    const auto unit = make_golden_cdf_sampler(plan);
    std::vector<Sample> out;
    for (size_t i = 0; i < in.size(); i += chunk)
      unit->process(std::span(in).subspan(i, std::min(chunk, in.size() - i)), out);
    REQUIRE(out == whole);
  }
  for (const Sample& s : whole) {
    REQUIRE(s.direction[0] >> plan.v_bits == (s.cell_index & 15));
    REQUIRE(s.direction[1] >> plan.v_bits == s.cell_index >> 4);
    for (const double jitter : {0.01, 0.5, 0.99}) {
      const Vec3 d = sample_direction(plan, sampled_code(s), jitter, 1 - jitter);
      const OctCode code = oct_encode(d, plan.sample_direction_bits());
      REQUIRE((code == OctCode{s.direction[0], s.direction[1]}));
    }
  }
  // k = 20: the photons after the twentieth count for nothing.
  Plan larger = plan;
  larger.k = 200;
  std::vector<Sample> all;
  make_golden_cdf_sampler(larger)->process(in, all);
  REQUIRE(all.size() == whole.size());
  REQUIRE(all != whole);
}
