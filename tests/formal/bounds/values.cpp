// SPDX-License-Identifier: Apache-2.0
// What golden makes of many inputs, at every width, for the scripts beside this file: a line
// NAME|word=width ...|input=number ...|definition=number ... each. `scripts/formal --golden` runs
// the scripts on the inputs and wants the same numbers. Numbers: integers, doubles in hex, a/b,
// NbE = N * 2^E, and a~b, a difference.
// A line "line|section.key|least|greatest" tells a range of the plan.
#include <fmt/core.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <string>
#include <type_traits>

#include "golden/numeric/octahedral.hpp"
#include "golden/numeric/random.hpp"
#include "golden/numeric/reciprocal.hpp"
#include "golden/numeric/shared_exponent.hpp"
#include "golden/plan/quantiser.hpp"
#include "golden/transport/sampling.hpp"
#include "golden/unit/cdf_sampler.hpp"
#include "golden/unit/irradiance_cache.hpp"
#include "golden/unit/photon_gatherer.hpp"
#include "golden/unit/shader.hpp"
#include "tests/extremes/suite/step_inputs.hpp"

using namespace photonloom;

namespace {

constexpr uint64_t kInputs = 60;  // a width

uint64_t bits(uint64_t i, uint64_t d) { return hash_bits(91, i, 1, d); }
double unit(uint64_t i, uint64_t d) { return to_unit(bits(i, d)); }

std::string hex(double x) { return fmt::format("{:a}", x); }
// A coordinate that adds and subtracts exactly.
double short_unit(uint64_t i, uint64_t d) { return std::floor(unit(i, d) * 0x1p40) * 0x1p-40; }

template <class... Args>
void put(fmt::format_string<Args...> text, Args&&... args) {
  fmt::print(text, std::forward<Args>(args)...);
  fmt::print("\n");
}

template <class F>
void each(int least, int greatest, F&& f) {
  for (int b = least; b <= greatest; ++b)
    for (uint64_t i = 0; i < kInputs; ++i) f(b, i);
}

void plan_lines() {
  const Plan plan;
  Plan::visit(plan, [](const char* section, const char* key, const auto& value, auto smallest,
                       auto largest, const char*) {
    if constexpr (std::is_same_v<std::decay_t<decltype(value)>, int>)
      // 0 bits of a reciprocal are none.
      put("line|{}.{}|{}|{}", section, key,
          std::string(key) == "reciprocal_bits" ? 8 : int64_t(smallest), int64_t(largest));
  });
}

Plan cube(int p, double extent, double origin) {
  Plan plan;
  plan.position_bits = p;
  plan.photon_bytes = 32;
  plan.extent = extent;
  plan.origin = {origin, origin, origin};
  plan.global.r2_max = plan.caustic.r2_max = plan.r2_limit();
  return plan;
}

void positions() {
  each(4, 24, [](int p, uint64_t i) {
    const double extent = 1 + unit(i, 0), origin = 6 * unit(i, 1) - 3;
    const Plan plan = cube(p, extent, origin);
    const double x = origin + 0.999 * extent * unit(i, 2);
    put("bound_position|p={}|t={}~{} E={}|q={}", p, hex(x), hex(origin), hex(extent),
        quantise_position(plan, Vec3(x))[0]);

    const Plan one = cube(p, 1, 0);
    const double scale = std::ldexp(1.0, p);
    std::string off;
    for (uint64_t c = 0; c < 6; ++c) {
      const double t = 0.999 * unit(i, 3 + c);
      off += fmt::format(" {}{}={}~{}", "xyz"[c % 3], 1 + c / 3, quantise_position(one, Vec3(t))[0],
                         hex(t * scale));
    }
    put("bound_distance|p={}|{}|", p, off.substr(1));

    if (i < 10) {
      // Ends among them.
      const auto place = [&](uint64_t d) {
        return i == 0 ? d < 23 ? 0 : 0.9999999999 : unit(i, d);
      };
      PackedPhoton photon{};
      photon.position = quantise_position(one, {place(20), place(21), place(22)});
      photon.direction = oct_encode(Vec3(0, 0, 1), one.direction_bits);
      const PhotonMap map = build_photon_map({&photon, 1}, one);
      GatherQuery query{};
      query.position = quantise_position(one, {place(23), place(24), place(25)});
      const OctCode n = oct_encode(Vec3(0, 0, 1), one.normal_bits);
      query.normal = {n.u, n.v};
      std::vector<Neighbour> found;
      search_gather(one, map, query, found);
      put("bound_squared_distance|p={}|x1={} y1={} z1={} x2={} y2={} z2={}|d2={}", p,
          photon.position[0], photon.position[1], photon.position[2], query.position[0],
          query.position[1], query.position[2], found.at(0).d2);
    }

    const double edge = 1 + unit(i, 9);
    const Plan scaled = cube(p, std::ldexp(edge, p), 0);
    const double radius = edge * std::exp2((p + 1) * unit(i, 10)) * 0.999;
    put("bound_largest_radius|p={}|radius={} unit={}|r2={}", p, hex(radius), hex(edge),
        radius_to_r2_max(scaled, radius));

    Plan cache = scaled;
    cache.cache_accuracy = 1 + unit(i, 11);
    cache.cache_radius_min = 0;
    cache.cache_radius_max = 1;
    cache.cache_weight_bits = 12;
    const double reach = (1 + 10 * unit(i, 12)) * edge / cache.cache_accuracy;
    const Reciprocal r = cache_falloff(cache, reach);
    // The reciprocal of an integer below 2^7 tells it.
    const double square =
        std::round(std::ldexp(1.0, cache.cache_falloff_bits() + int(r.exponent)) / r.mantissa);
    put("bound_reach|p={}|accuracy={} radius={} unit={}|square={}", p, hex(cache.cache_accuracy),
        hex(reach), hex(edge), int(square));
  });
}

void directions() {
  for (uint64_t i = 0; i < 2 * kInputs; ++i) {
    const double x = unit(i, 0) + 1e-3, y = unit(i, 1) + 1e-3, z = unit(i, 2) + 1e-3;
    const double scale = 1.3 / (x + y + z);
    const double a = x * scale, b = y * scale, c = z * scale;
    const char* input = "bound_fold||x={} y={} z={}|{}={}";
    put(fmt::runtime(input), hex(a), hex(b), hex(c), "s", hex(oct_fold({a, b, c}).x));
    // Folded over, x is 1 less the other coordinate.
    put(fmt::runtime(input), hex(b), hex(a), hex(c), "folded", hex(oct_fold({a, b, -c}).x));
  }
  each(2, 14, [](int b, uint64_t i) {
    double d[3];
    for (uint64_t c = 0; c < 3; ++c)
      d[c] = (short_unit(i, c) + 0x1p-40) * (bits(i, 4 + c) % 2 ? 1 : -1);
    const double sum = std::fabs(d[0]) + std::fabs(d[1]) + std::fabs(d[2]);
    const auto place = [&](size_t own, size_t other) {
      const double top = d[2] >= 0 ? d[own] : std::copysign(sum - std::fabs(d[other]), d[own]);
      return hex(top) + "/" + hex(sum);
    };
    const OctCode code = oct_encode({d[0], d[1], d[2]}, b);
    put("bound_direction|b={}|s={} t={} e=0 f=0 x=1/3 y=1/5|u={} v={}", b, place(0, 1), place(1, 0),
        code.u, code.v);

    Plan plan;
    plan.normal_bits = b;
    const double n = 0.999 * d[0] / sum;
    put("bound_normal|b={}|n={}|code={}", b, hex(n), quantise_normal(plan, {n, 0, 0})[0]);
  });
}

void powers() {
  each(2, 16, [](int m, uint64_t i) {
    double v = unit(i, 0) * std::ldexp(1.0, m + int(i % 30));
    if (i == 0) v = 0x1.fffffffffffffp-2;  // the sum with 1/2 is rounded up to 1
    PowerCode code = encode_power({v, 0, 0}, 1, m, 5, nullptr);
    put("bound_power|m={}|x={}|code={}", m, hex(std::ldexp(v, -int(code.exponent))),
        code.mantissa[0]);
    // From the least that wants the exponent on.
    v = std::ldexp(std::ldexp(1.0, m) - 0.5 + (i % 2 ? unit(i, 1) * std::ldexp(1.0, m) : 0),
                   1 + int(i % 20));
    code = encode_power({v, 0, 0}, 1, m, 5, nullptr);
    put("bound_largest_channel|m={}|x={}|code={}", m, hex(std::ldexp(v, -int(code.exponent))),
        code.mantissa[0]);
  });
}

void reciprocals() {
  each(8, 24, [](int w, uint64_t i) {
    const int size = 2 + int(i % 46);
    const uint64_t span = uint64_t{1} << size;
    const uint64_t x =
        i % 2 ? span + bits(i, 0) % span : 2 * span - 1 - bits(i, 0) % (span / 4 + 1) % 16;
    const Reciprocal r = reciprocal(x, w);
    put("bound_reciprocal|W={}|x={}b{}|R={}", w, x, w - int(r.exponent), r.mantissa);
  });
}

void shader() {
  ShaderCounts counts;
  for (int w = 8; w <= 24; ++w)
    for (int k = 2; k <= 256; k += k < 20 ? 1 : 59) {
      Plan plan = shading(w, 8);
      plan.k = k;
      Weight weight;
      weight.mantissa = {128, 0, 0};
      weight.exponent = {20, 0, 0};
      // 2^35 * 2^W * c * 2^7 * 2^(20 - 2W)
      const UInt128 c =
          Shader(plan).contribution(result_of(plan, uint64_t{1} << 35, 1, true), weight)[0] >>
          (62 - w);
      put("bound_full|W={}|k={}|c={}", w, k, uint64_t(c));
    }
  each(8, 24, [&](int w, uint64_t i) {
    Plan plan = shading(18, w);
    const double edge = 1 + unit(i, 0);
    plan.extent = std::ldexp(edge, plan.position_bits);
    const Shader shader(plan);
    GatherResult one = result_of(plan, 1, 1, false);
    one.count = 1;
    const double inverse = shader.photon_density(one), weight = 1 + unit(i, 1);
    if (w == 8)
      put("bound_area||unit={} weight={} colour=1 pi_off=0|inverse={}", hex(edge), hex(weight),
          hex(inverse));
    // Half of them around a power of two, where rounding carries.
    const double asked = i % 2 ? weight : (1 - 0x1p-26 * unit(i, 2)) / inverse;
    int exponent;
    const double fraction = std::frexp(asked * inverse, &exponent);
    const Weight got = shader.weight(Rgb(asked), false, counts);
    const int carried = got.exponent[0] - (exponent + plan.fraction_bits - w);
    put("bound_weight|w={}|y={} off=0|code={}", w, hex(std::ldexp(fraction, w)),
        got.mantissa[0] << carried);

    const double rho = i % 3 ? unit(i, 3) + 1e-9 : 1 - 0x1p-26 * unit(i, 3);
    const Weight share = shader.share(Rgb(rho), counts);
    const auto total = uint32_t(1 + bits(i, 4) % 32768);
    const auto part = uint32_t(1 + bits(i, 5) % std::min<uint32_t>(total, 4096));
    const uint64_t light = bits(i, 6) >> (4 + i % 40);
    put("bound_share|w={}|rho={} weight={} total={} light={} step=1b{}|code={} value={}", w,
        hex(std::ldexp(rho, -share.exponent[0])), part, total, light, share.exponent[0],
        share.mantissa[0], uint64_t(shader.interpolated({light, 0, 0}, part, total, share)[0]));
  });
  for (uint64_t i = 0; i < 4 * kInputs; ++i) {
    const Plan plan = shading(8 + int(i % 11), 12);
    const GatherResult r = result_of(plan, 1 + bits(i, 0) % 100000, 1 + bits(i, 1) % 1000, false);
    Weight weight;
    weight.mantissa = {uint32_t(2048 + bits(i, 2) % 2048), 0, 0};
    weight.exponent = {int32_t(bits(i, 3) % 40) - 40, 0, 0};
    put("bound_contribution||y={}b{}|q={}", r.flux[0] * weight.mantissa[0] * r.reciprocal,
        weight.exponent[0] - plan.reciprocal_bits - int(r.reciprocal_exponent),
        uint64_t(Shader(plan).contribution(r, weight)[0]));
    Plan light = shading(18, 18);
    light.fraction_bits = int(i % 161) - 64;
    light.integer_bits = 90;
    const double v = std::ldexp(unit(i, 4), int(i % 20) - light.fraction_bits);
    put("bound_light||y={}|q={}", hex(std::ldexp(v, light.fraction_bits)),
        uint64_t(Shader(light).pixel(Rgb(v), counts)[0]));
  }
}

void tables() {
  for (int a = 1; a <= 6; ++a) {
    const CellGeometry geometry(a);
    for (size_t c = 0; c < geometry.cells(); c += 1 + geometry.cells() / 200) {
      const IVec3 o = geometry.centre(c);
      put("bound_jacobian|a={}|r2={}|J={}", a, oct_dot(o, o), cell_jacobian(o, a));
    }
    for (uint64_t seed = 0; seed < 30; ++seed) {
      Plan plan;
      plan.cell_bits = a;
      plan.combine = TableCombine::kPhotons;  // so the exact weights are the sums of the powers
      plan.levels = 1;
      plan.probability_bits = 4 + int(seed % 20);
      const OctCode up = oct_encode(Vec3(0, 0, 1), plan.normal_bits);
      std::vector<SamplerPhoton> photons(40);
      std::vector<uint64_t> exact(geometry.cells());
      uint64_t sum = 0;
      for (uint64_t i = 0; i < photons.size(); ++i) {
        SamplerPhoton& p = photons[i];
        p.power = {{uint32_t(256 + bits(i, seed) % 255), 20, 30},
                   uint32_t(bits(i, seed + 40) % 16)};
        p.direction = oct_encode(sample_cosine({unit(i, seed + 80), unit(i, seed + 120)}),
                                 plan.direction_bits);
        const int shift = plan.direction_bits - a;
        const uint64_t value = (p.power.mantissa[0] + 50ull) << p.power.exponent;
        exact[((p.direction.v >> shift) << a) + (p.direction.u >> shift)] += value;
        sum += value;
      }
      const SampleTable table = build_sample_table(plan, geometry, up, photons);
      const int narrow = std::max(0, int(std::bit_width(sum)) - plan.probability_bits);
      for (size_t c = 0; c < exact.size(); ++c) {
        const uint64_t w = table.weight(c);
        if (w == 0) continue;
        if (exact[c] >> narrow > 0) put("bound_narrowed||y={}b{}|w={}", exact[c], -narrow, w);
        if (c % (1 + exact.size() / 16) == 0)
          put("bound_probability|a={}|share={}/{} sum={}b{} off={}~{}b{} total_off={}~{}b{}|w={} "
              "total={}",
              a, exact[c], sum, sum, -narrow, w, exact[c], -narrow, table.total(), sum, -narrow, w,
              table.total());
      }
    }
  }
  each(16, 48, [](int u, uint64_t seed) {
    Plan plan;
    plan.cell_bits = 1 + int(seed % 2);
    plan.probability_bits = 4 + int(seed % 3);
    plan.u_bits = u;
    const CellGeometry geometry(plan.cell_bits);
    std::vector<SamplerPhoton> photons(5);
    for (uint64_t i = 0; i < photons.size(); ++i)
      photons[i] = {
          {{uint32_t(bits(i, seed) % 512), 0, 0}, uint32_t(bits(i, seed + 1) % 4)},
          oct_encode(sample_cosine({unit(i, seed + 2), unit(i, seed + 3)}), plan.direction_bits)};
    const SampleTable table = build_sample_table(
        plan, geometry, oct_encode(Vec3(0.2, 0.1, 1), plan.normal_bits), photons);
    // The first code of a cell or of one behind it.
    const auto first = [&](size_t cell) {
      uint64_t low = 0, high = uint64_t{1} << u;
      while (low < high) {
        const uint64_t middle = low + (high - low) / 2;
        if (sample_cell(plan, table, middle) >= cell)
          high = middle;
        else
          low = middle + 1;
      }
      return low;
    };
    const size_t cell = seed % geometry.cells();
    if (table.weight(cell) > 0)
      put("bound_inversion|u={}|F={} w={} total={}|codes={}", u, table.prefix[cell],
          table.weight(cell), table.total(), first(cell + 1) - first(cell));
  });
}

void records() {
  each(4, 12, [](int b, uint64_t i) {
    Plan plan;
    plan.cache_weight_bits = b;
    plan.cache_angle_bits = 11;
    const int w = plan.cache_falloff_bits();
    const uint64_t reach2 = 2 + bits(i, 0) % (uint64_t{1} << (2 + i % 28));
    const CacheRecord record{{0, 0, 0}, {0, 0, 0}, reciprocal(reach2, w)};
    const double reach = std::sqrt(double(reach2));
    const UVec3 p{uint32_t(reach * unit(i, 1)), uint32_t(reach * 0.3 * unit(i, 2)), 0};
    const UVec3 n{uint32_t(20 * unit(i, 3)), 3, 0};
    const uint32_t got = cache_weight(plan, record, p, n);
    if (got == 0) return;
    const uint64_t d2 = uint64_t{p[0]} * p[0] + uint64_t{p[1]} * p[1];
    const uint64_t n2 = n[0] * n[0] + n[1] * n[1];
    const int e = int(record.falloff.exponent);
    put("bound_record|B={}|x={}b{} d={}b{} v={}b{}|got={}", b, reach2, w - e, d2, w - 1 - e, n2,
        b - plan.cache_angle_bits, got);
  });
}

}  // namespace

int main() {
  plan_lines();
  positions();
  directions();
  powers();
  reciprocals();
  shader();
  tables();
  records();
}
