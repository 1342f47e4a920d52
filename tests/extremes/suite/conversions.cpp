// SPDX-License-Identifier: Apache-2.0
// The named conversions and the functions around them at their ends.
#include <fmt/core.h>

#include <cmath>
#include <limits>

#include "golden/numeric/hilbert.hpp"
#include "golden/numeric/octahedral.hpp"
#include "golden/numeric/random.hpp"
#include "golden/numeric/reciprocal.hpp"
#include "golden/pipeline/light_gradient.hpp"
#include "golden/plan/plan_file.hpp"
#include "golden/plan/quantiser.hpp"
#include "golden/transport/bsdf.hpp"
#include "golden/transport/sampling.hpp"
#include "golden/unit/pack_photons.hpp"
#include "golden/unit/photon_file.hpp"
#include "golden/unit/shader.hpp"
#include "tests/extremes/suite/suite.hpp"
#include "tests/scene_files.hpp"

namespace photonloom::extremes {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kLastUnit = 1 - 0x1p-53;  // of a random number: all bits set

Plan cube(double extent, const Vec3& origin, int bits) {
  Plan plan;
  plan.extent = extent;
  plan.origin = {origin.x, origin.y, origin.z};
  plan.position_bits = bits;
  return plan;
}

// Points in the middle of position units of a cube: their own unit, at both ends and between.
Case cube_case(const char* name, double extent, const Vec3& origin, int bits = 16) {
  return {
      name, Known::kClosedForm, fmt::format("the middle of unit i of 2^{} is in unit i", bits),
      [extent, origin, bits](Run& run) {
        const Plan plan = cube(extent, origin, bits);
        const uint64_t cells = uint64_t{1} << bits;
        for (uint64_t i : {uint64_t{0}, uint64_t{1}, cells / 3, cells / 2, cells - 2, cells - 1}) {
          const double x = (static_cast<double>(i) + 0.5) / static_cast<double>(cells) * extent;
          const UVec3 q = quantise_position(plan, origin + Vec3(x));
          for (const uint32_t c : q) run.exact("unit", i, c);
        }
      }};
}

Photon photon(double power) {
  return {Vec3(0.5), Vec3(0, 0, 1), Rgb(power, power / 2, 0), 0, 0, 0};
}

// The power format chosen for these photons gives each back to half a step of its largest channel.
Case power_case(const char* name, std::vector<double> powers, const char* right,
                uint64_t zeroed = 0) {
  return {name, zeroed ? Known::kSaturation : Known::kClosedForm, right,
          [powers, zeroed](Run& run) {
            Plan plan;
            std::vector<Photon> photons;
            for (const double p : powers) photons.push_back(photon(p));
            plan.global.power_exponent = choose_power_exponent(photons, plan);
            PackCounts counts;
            const auto packed = pack_photons(photons, plan, plan.global, &counts);
            for (size_t i = 0; i < powers.size(); ++i) {
              const double back = std::ldexp(static_cast<double>(power_value(packed[i].power, 0)),
                                             plan.global.power_exponent);
              const double least = std::ldexp(0.5, plan.global.power_exponent);
              run.near("power / W", powers[i], back, std::max(std::ldexp(powers[i], -9), least));
            }
            run.counted("zeroed", zeroed, counts.zeroed);
            run.counted("saturated", 0, counts.saturated);
          }};
}

double angle(const Vec3& a, const Vec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

Vec3 decoded(const Vec3& d, int bits) {
  const IVec3 o = oct_decode(oct_encode(d, bits), bits);
  return Vec3(o[0], o[1], o[2]);
}

Case direction_case(const char* name, std::vector<Vec3> directions) {
  return {
      name, Known::kClosedForm,
      "the decoded centre is within half a cell's diagonal: 2.13 * 2^(1 - b) rad, b = 2, 8 and 14",
      [directions](Run& run) {
        for (const int b : {2, 8, 14})
          for (const Vec3& d : directions)
            run.near("angle", 0, angle(d, decoded(d, b)), 2.13 * std::ldexp(2.0, -b));
      }};
}

std::string photon_line(const char* direction, const char* power = "1 1 1",
                        const char* position = "0 0 0") {
  return fmt::format(
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\nproperty double y\nproperty "
      "double z\nproperty double dx\nproperty double dy\nproperty double dz\nproperty double "
      "power_r\nproperty double power_g\nproperty double power_b\nend_header\n{} {} {}\n",
      position, direction, power);
}

Photon read_photon(const std::string& text) {
  const TestFolder folder;
  return read_photon_file(folder.write("photons.ply", text)).photons.at(0);
}

// A plan whose every line but the checks that tie lines together is usual.
Plan shading() {
  Plan plan;
  plan.global.r2_max = plan.caustic.r2_max = plan.r2_limit();
  return plan;
}

GatherResult largest_result(const Plan& plan) {
  GatherResult r{};
  for (uint64_t& f : r.flux) f = ones(plan.flux_bits());
  r.r2 = 1;
  const Reciprocal inverse = reciprocal(1, plan.reciprocal_bits);
  r.reciprocal = inverse.mantissa;
  r.reciprocal_exponent = inverse.exponent;
  return r;
}

// Each integer line of the plan, one beyond its least or greatest.
void beyond(Run& run, bool above) {
  uint64_t lines = 0, taken = 0;
  Plan plan;
  Plan::visit(plan, [&](const std::string& section, const std::string& key, auto& value, auto least,
                        auto greatest, const char*) {
    using T = std::remove_cvref_t<decltype(value)>;
    if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) {
      if (above && greatest == 0) return;
      const int64_t wrong = above ? int64_t(greatest) + 1 : int64_t(least) - 1;
      ++lines;
      Plan changed;
      try {
        set_plan_line(changed, fmt::format("{}.{}={}", section, key, wrong));
        ++taken;
      } catch (const PlanError&) {
      }
    }
  });
  run.holds("there are lines", lines > 40);
  run.exact("taken", 0, taken);
}

// Of a ray from the origin, whose normal is z, to a surface at y.
RayGradient gradient(const Vec3& y, const Vec3& normal, ClampCounts& counts) {
  Plan plan;
  plan.extent = 3;
  plan.cache_gradients = CacheGradients::kBoth;
  DiffuseHit from{}, to{};
  from.normal = from.shading_normal = Vec3(0, 0, 1);
  to.position = y;
  to.normal = to.shading_normal = normal;
  return ray_gradient(plan, from, glm::normalize(y), &to, counts);
}

Scene reflecting(const char* reflectance, const char* version) {
  return load_body(fmt::format("<shape type=\"cube\"><bsdf type=\"diffuse\"><rgb "
                               "name=\"reflectance\" value=\"{}\"/></bsdf></shape>",
                               reflectance),
                   version);
}

}  // namespace

Group conversion_cases() {
  std::vector<Case> cases{
      cube_case("position: a cube 1e-6 across", 1e-6, Vec3(0)),
      cube_case("position: a cube 1e6 across", 1e6, Vec3(-5e5)),
      cube_case("position: a cube 1e-12 across", 1e-12, Vec3(-1e-13)),
      cube_case("position: a cube 1e12 across, 24 bits", 1e12, Vec3(3e11), 24),
      cube_case("position: a unit cube 1e6 from the origin", 1, Vec3(1e6, -1e6, 1e6)),
      cube_case("position: a unit cube 1e6 from the origin, 24 bits", 1, Vec3(1e6, -1e6, 1e6), 24),
      cube_case("position: 4 bits", 2, Vec3(-1), 4),
      {"position: outside of the cube", Known::kSaturation,
       "taken as the nearest unit and counted, a point once: `outside_positions` of queries and "
       "lookups, `outside_photons` of photons; a plan whose cube does not hold the scene is "
       "refused",
       [](Run& run) {
         const Plan plan = cube(2, Vec3(-1), 16);
         ClampCounts counts;
         run.exact("below", 0, quantise_position(plan, Vec3(-1.0000001), &counts)[0]);
         run.exact("above", 65535, quantise_position(plan, Vec3(1), &counts)[0]);
         run.exact("far above", 65535, quantise_position(plan, Vec3(1e300), &counts)[0]);
         run.counted("outside", 3, counts.positions);
         quantise_position(plan, Vec3(-1), &counts);
         quantise_position(plan, Vec3(0x1.fffffp-1), &counts);
         run.counted("and of both corners within", 3, counts.positions);
         PackCounts packed;
         Photon p = photon(1);
         p.position = Vec3(1.5, 0, 0);
         pack(p, plan, plan.global, &packed);
         run.counted("photons", 1, packed.outside);
       }},
      {"radius: zero, endless, huge", Known::kDefinition,
       "0 means none: r2_max = 2^34 - 1, which is also the most that a radius gives",
       [](Run& run) {
         const Plan plan = cube(1, Vec3(0), 16);
         for (const double r : {0.0, 2.0, 1e300, HUGE_VAL})
           run.exact("r2_max", ones(34), radius_to_r2_max(plan, r));
       }},
      {"radius: from r2_max and back", Known::kClosedForm,
       "a squared distance survives its radius at 4 and 24 bits, from 0 to the greatest",
       [](Run& run) {
         for (const int bits : {4, 24}) {
           const Plan plan = cube(1e-6, Vec3(0), bits);
           for (const uint64_t r2 : {uint64_t{1}, uint64_t{2}, uint64_t{99}, plan.r2_limit() / 3,
                                     plan.r2_limit() - 1, plan.r2_limit()})
             run.exact("r2_max", r2, radius_to_r2_max(plan, radius_for_r2_max(plan, r2)));
         }
       }},
      power_case("power: 1e-30 W", {1e-30, 3e-31}, "within 2^-9 of itself: the power unit follows"),
      power_case("power: 1e30 W", {1e30, 3e29}, "within 2^-9 of itself: the power unit follows"),
      power_case("power: zero", {0, 0}, "stays zero and is not counted as lost"),
      power_case("power: one photon 1e6 times all others", {1e6, 1, 1, 0.7},
                 "both within 2^-9 of themselves: 5 bits of exponent span 31 octaves"),
      power_case("power: 1e-30 beside 1e30", {1e30, 1e-30},
                 "the small one becomes 0 and is counted: `zeroed` is 1", 1),
      {"power: larger than the format", Known::kSaturation,
       "taken as the largest code 511 * 2^31 and counted: `saturated` is 1",
       [](Run& run) {
         Plan plan;
         plan.global.power_exponent = -60;
         PackCounts counts;
         const PackedPhoton p = pack(photon(1), plan, plan.global, &counts);
         run.exact("power", uint64_t{511} << 31, power_value(p.power, 0));
         run.counted("saturated", 1, counts.saturated);
       }},
      {"power: 2-bit mantissas with 1 bit of exponent", Known::kClosedForm,
       "0 to 6 units round to 0, 1, 2, 3, 4, 4 or 6, 6: half up to the code's step",
       [](Run& run) {
         const uint64_t due[] = {0, 1, 2, 3, 4, 6, 6};
         for (int v = 0; v <= 6; ++v) {
           bool saturated = false;
           const PowerCode code = encode_power({double(v), 0, 0}, 1, 2, 1, &saturated);
           run.exact("units", due[v], power_value(code, 0));
           run.holds("not saturated", !saturated);
         }
       }},
      {"power: 16-bit mantissas at the top of their exponents", Known::kClosedForm,
       "65535 * 2^31 is the largest code; half a step above it does not fit and is counted",
       [](Run& run) {
         bool saturated = false;
         const double top = 65535 * 0x1p31;
         run.exact("largest", power_max(16, 5),
                   power_value(encode_power({top, 0, 0}, 3, 16, 5, &saturated), 0));
         run.holds("fits", !saturated);
         encode_power({top + 0x1p30, 0, 0}, 3, 16, 5, &saturated);
         run.holds("counted", saturated);
       }},
      direction_case("direction: the six axes", {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0),
                                                 Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)}),
      direction_case("direction: seams", {Vec3(1, 1, 0), Vec3(-1, 1, 0), Vec3(1, -1, 1e-300),
                                          Vec3(1, 0, 1), Vec3(0, 1, -1), Vec3(-1, -1, -0.0)}),
      direction_case("direction: centres of faces, where cells are longest",
                     {Vec3(1, 1, 1), Vec3(-1, 1, 1), Vec3(1, -1, -1), Vec3(-1, -1, -1)}),
      direction_case("direction: a hair beside poles and axes",
                     {Vec3(1e-17, 0, 1), Vec3(-1e-17, 1e-17, -1), Vec3(1, 1e-300, -1e-300)}),
      {"direction: every code of 2 bits and edges of 14", Known::kClosedForm,
       "a centre encodes to its own code",
       [](Run& run) {
         uint64_t others = 0;
         const auto try_code = [&](uint32_t u, uint32_t v, int b) {
           const IVec3 o = oct_decode({u, v}, b);
           others += !(oct_encode(Vec3(o[0], o[1], o[2]), b) == OctCode{u, v});
         };
         for (uint32_t i = 0; i < 16; ++i) try_code(i % 4, i / 4, 2);
         for (uint32_t i = 0; i < 16384; ++i)
           for (const uint32_t e : {0u, 8191u, 8192u, 16383u}) {
             try_code(i, e, 14);
             try_code(e, i, 14);
             try_code(i, 16383 - i, 14);
           }
         run.exact("others", 0, others);
       }},
      {"direction: tiny and huge vectors of a photon file", Known::kClosedForm,
       "1e-310 and 1e308 times (1, -2, 2): the code of (1, -2, 2)",
       [](Run& run) {
         const OctCode due = oct_encode(Vec3(1, -2, 2), 8);
         for (const char* d : {"1e-310 -2e-310 2e-310", "0.8e308 -1.6e308 1.6e308"}) {
           const OctCode code = oct_encode(read_photon(photon_line(d)).direction, 8);
           run.exact("u", due.u, code.u);
           run.exact("v", due.v, code.v);
         }
       }},
      {"direction: zero", Known::kRefusal, "a vector of length 0 has no direction",
       [](Run& run) {
         run.refused("dx, dy, dz are all 0", [] { read_photon(photon_line("0 0 0")); });
       }},
      {"power: negative", Known::kRefusal, "light is not negative",
       [](Run& run) {
         run.refused("power_g is -1, expected no negative number",
                     [] { read_photon(photon_line("0 0 1", "1 -1 1")); });
       }},
      {"power: no number", Known::kRefusal, "NaN and infinity are no powers",
       [](Run& run) {
         run.refused("expected", [] { read_photon(photon_line("0 0 1", "nan 1 1")); });
         run.refused("expected", [] { read_photon(photon_line("0 0 1", "1 inf 1")); });
         run.refused("expected", [] { read_photon(photon_line("0 0 1", "1 1 1", "0 -inf 0")); });
       }},
      {"Hilbert index: 1 and 7 bits", Known::kClosedForm,
       "every cell once, each next to the one before, from 0 to 8^b - 1",
       [](Run& run) {
         for (const int b : {1, 7}) {
           const uint32_t edge = 1u << b;
           std::vector<UVec3> cells(size_t{1} << (3 * b), UVec3{999, 0, 0});
           for (uint32_t i = 0; i < cells.size(); ++i) {
             const UVec3 c{i % edge, i / edge % edge, i / edge / edge};
             cells[hilbert_index(c, b)] = c;
           }
           uint64_t jumps = 0;
           for (size_t i = 1; i < cells.size(); ++i) {
             int distance = 0;
             for (size_t a = 0; a < 3; ++a)
               distance += std::abs(int(cells[i][a]) - int(cells[i - 1][a]));
             jumps += distance != 1;
           }
           run.exact("jumps", 0, jumps);
         }
       }},
      {"reciprocal: 1 and 2^50 - 1, W = 8 and 24", Known::kClosedForm,
       "1 is exact; 2^50 - 1 rounds up to 2^50, exact again; 3 is floor(2^(2W) / (3 * 2^(W - 1)))",
       [](Run& run) {
         for (const int w : {8, 24}) {
           run.exact("mantissa", uint64_t{1} << w, reciprocal(1, w).mantissa);
           run.exact("mantissa", uint64_t{1} << w, reciprocal(ones(50), w).mantissa);
           run.exact("exponent", 50, reciprocal(ones(50), w).exponent);
           run.exact("mantissa", (uint64_t{1} << (w + 1)) / 3, reciprocal(3, w).mantissa);
         }
       }},
      {"random numbers 0 and all ones: one number", Known::kClosedForm,
       "64 bits become 0 and 1 - 2^-53, never 1",
       [](Run& run) {
         run.holds("0", to_unit(0) == 0);
         run.holds("1 - 2^-53", to_unit(~0ull) == kLastUnit);
       }},
      {"random numbers 0 and all ones: directions", Known::kClosedForm,
       "unit vectors, on the hemisphere where they belong, at all four corners of the square",
       [](Run& run) {
         for (const double u : {0.0, kLastUnit})
           for (const double v : {0.0, kLastUnit}) {
             for (const Vec3& d :
                  {sample_cosine({u, v}), sample_sphere({u, v}), sample_cone({u, v}, 1e-12)})
               run.near("length", 1, glm::length(d), 1e-12);
             run.holds("upper", sample_cosine({u, v}).z >= 0);
             run.holds("cone", sample_cone({u, v}, 1e-12).z >= 1 - 1.1e-12);
             run.holds("disk", glm::length(sample_disk({u, v})) <= 1);
           }
       }},
      {"Fresnel: index 1", Known::kClosedForm, "no reflection, at any angle",
       [](Run& run) {
         for (const double c : {1.0, 0.5, 1e-3}) run.near("R", 0, fresnel_dielectric(c, 1), 1e-12);
       }},
      {"Fresnel: index 1e3 and 1e-3, head on", Known::kClosedForm, "((n - 1) / (n + 1))^2",
       [](Run& run) {
         const double due = std::pow(999.0 / 1001.0, 2);
         run.near("R", due, fresnel_dielectric(1, 1e3), 1e-12);
         run.near("R", due, fresnel_dielectric(1, 1e-3), 1e-12);
       }},
      {"Fresnel: grazing", Known::kClosedForm, "R = 1 - 4 n cos / sqrt(n^2 - 1) ... tends to 1",
       [](Run& run) {
         // To first order in the cosine, both polarisations: 1 - 2 cos (n^2 + 1) / sqrt(n^2 - 1).
         const double n = 1.5, c = 1e-8;
         run.near("R", 1 - 2 * c * (n * n + 1) / std::sqrt(n * n - 1), fresnel_dielectric(c, n),
                  1e-13);
       }},
      {"Fresnel: the critical angle", Known::kClosedForm,
       "1 at and beyond it; just within it 1 - O(sqrt of the distance)",
       [](Run& run) {
         const double ior = 1 / 1.5, critical = std::sqrt(1 - ior * ior);
         run.near("R at it", 1, fresnel_dielectric(critical, ior), 1e-7);
         run.near("R beyond", 1, fresnel_dielectric(critical - 1e-9, ior), 0);
         run.near("R far beyond", 1, fresnel_dielectric(1e-9, ior), 0);
         run.holds("R within", fresnel_dielectric(critical + 1e-3, ior) < 0.9);
       }},
      {"Fresnel: a perfect mirror", Known::kClosedForm, "eta = k = 0 reflects all",
       [](Run& run) {
         for (const double c : {1.0, 1e-9})
           run.near("R", 1, fresnel_conductor(c, Rgb(0), Rgb(0)).x, 0);
       }},
      {"weight: zero", Known::kDefinition, "mantissa 0: contributes 0",
       [](Run& run) {
         ShaderCounts counts;
         const Shader shader(shading());
         const Weight w = shader.weight(Rgb(0), false, counts);
         run.exact("mantissa", 0, w.mantissa[0]);
         run.exact("contribution", UInt128{0},
                   shader.contribution(largest_result(shading()), w)[0]);
         run.exact("counted", 0, counts.weights);
       }},
      {"weight: 1e-300", Known::kClosedForm, "a normalised mantissa; the contribution rounds to 0",
       [](Run& run) {
         ShaderCounts counts;
         const Shader shader(shading());
         const Weight w = shader.weight(Rgb(1e-300), false, counts);
         run.holds("normalised", w.mantissa[0] >> 17 == 1);
         run.exact("contribution", UInt128{0},
                   shader.contribution(largest_result(shading()), w)[0]);
       }},
      {"weight: 1e290", Known::kSaturation,
       "taken as the largest that fits, counted in `saturated_weights`; the largest contribution "
       "stays "
       "below 2^(I + F - 1)",
       [](Run& run) {
         ShaderCounts counts;
         const Plan plan = shading();
         const Shader shader(plan);
         const Weight w = shader.weight(Rgb(1e290), false, counts);
         run.counted("counted", 3, counts.weights);
         const UInt128 value = shader.contribution(largest_result(plan), w)[0];
         run.holds("below 2^(I+F-1)", value >> (plan.pixel_contribution_bits() - 1) == 0);
         run.holds("its top bits are in use", value >> (plan.pixel_contribution_bits() - 3) != 0);
       }},
      {"weight: no number", Known::kSaturation, "NaN and infinity count in `not_finite` and add 0",
       [](Run& run) {
         ShaderCounts counts;
         const Shader shader(shading());
         run.exact("mantissa", 0, shader.weight(Rgb(kNan, HUGE_VAL, 0), false, counts).mantissa[0]);
         run.counted("counted", 2, counts.not_finite);
       }},
      {"weight: 8 and 24 bits", Known::kClosedForm,
       "2^-40 - 2^-70 carries into the exponent: 2^(w - 1) * 2^e",
       [](Run& run) {
         for (const int bits : {8, 24}) {
           Plan plan = shading();
           plan.weight_bits = bits;
           plan.extent = std::ldexp(std::sqrt(1 / kPi), 16);  // the scale is 1
           ShaderCounts counts;
           const Weight w = Shader(plan).weight(Rgb(0x1p-40 - 0x1p-70), false, counts);
           run.exact("mantissa", 1u << (bits - 1), w.mantissa[0]);
         }
       }},
      {"share: 1e300", Known::kSaturation,
       "what a record's light is multiplied with is at most what a pixel has room for, and counted",
       [](Run& run) {
         ShaderCounts counts;
         const Plan plan = shading();
         const Shader shader(plan);
         const Weight share = shader.share(Rgb(1e300), counts);
         run.counted("counted", 3, counts.weights);
         const UInt128 light = UInt128{1} << (plan.pixel_contribution_bits() - 1);
         const UInt128 one = shader.interpolated({light, 1, 0}, 256, 256, share)[0];
         run.holds("no wrap", one >= light);
         run.holds("room", one >> plan.pixel_sum_bits() == 0);
       }},
      {"direct light: zero, least, greatest", Known::kSaturation,
       "0 is 0; half a unit rounds up to 1; 2^I is taken as half of the range and counted in "
       "`saturated_direct`",
       [](Run& run) {
         const Plan plan = shading();  // I = F = 32
         const Shader shader(plan);
         ShaderCounts counts;
         run.exact("0", UInt128{0}, shader.pixel(Rgb(0), counts)[0]);
         run.exact("half a unit", UInt128{1}, shader.pixel(Rgb(0x1p-33), counts)[0]);
         run.exact("below half", UInt128{0}, shader.pixel(Rgb(0x1.fffffp-34), counts)[0]);
         run.counted("counted", 0, counts.direct);
         run.exact("2^32", UInt128{1} << 63, shader.pixel(Rgb(0x1p32), counts)[0]);
         run.counted("counted", 3, counts.direct);
         shader.pixel(Rgb(kNan), counts);
         run.counted("not finite", 3, counts.not_finite);
       }},
      {"gradient: light from above", Known::kClosedForm,
       "turn = omega / (n . omega) and way = (4 omega - n_y / (n_y . omega)) / r of a ray that "
       "goes "
       "(3, 0, 4): 49,152 and 5,898 units, nothing counted",
       [](Run& run) {
         ClampCounts counts;
         const RayGradient g = gradient(Vec3(3, 0, 4), Vec3(0, 0, -1), counts);
         run.exact("turn x", 3 * 65536 / 4, g.turn[0]);
         run.exact("turn z", 65536, g.turn[2]);
         run.exact("way x", 5898, g.way[0]);  // 4 * 0.6 * 3 / 5 * 2^12 = 5898.24
         run.exact("way z", 0, g.way[2]);
         run.counted("counted", 0, counts.gradients);
       }},
      {"gradient: light along the surface", Known::kSaturation,
       "1 / (n . omega) is 2^20, in units of 2^-16 beyond 31 bits: taken as 2^31 - 1 and counted "
       "in "
       "`saturated_gradients`; the number across the surface is 1",
       [](Run& run) {
         ClampCounts counts;
         const RayGradient g = gradient(Vec3(1, 0, 0x1p-20), Vec3(-1, 0, 0), counts);
         run.exact("turn x", ones(31), g.turn[0]);
         run.exact("turn z", 65536, g.turn[2]);
         run.counted("counted", 1, counts.gradients);
       }},
      {"gradient: a surface 2^-20 away", Known::kSaturation,
       "the way goes with 1 / r: taken as -(2^31 - 1) and counted, on one axis",
       [](Run& run) {
         ClampCounts counts;
         const RayGradient g = gradient(Vec3(-0x1p-20, 0, 0x1p-20), Vec3(0, 0, -1), counts);
         run.exact("way x", -static_cast<int64_t>(ones(31)), g.way[0]);
         run.exact("way y", 0, g.way[1]);
         run.counted("counted", 1, counts.gradients);
       }},
      {"gradient: a change of all light and more", Known::kSaturation,
       "c is kept within -1 to 1, so that light is 0 to 2 times itself, and counted in "
       "`clamped_changes`; where it is within, and where there is no light, nothing counts",
       [](Run& run) {
         ClampCounts counts;
         RecordGradient<Arithmetic::kGolden> record;
         record.add({1000, 0, 0}, {{65536, 0, 0}, {0, 0, 0}});  // light 1000 times a turn of 1
         const auto factor = [&](double turn, double light = 1000) {
           return record.factor(0, light, Vec3(turn, 0, 0), Vec3(0), counts);
         };
         run.near("half", 1.5, factor(0.5), 0);
         run.near("all", 2, factor(1), 0);
         run.near("none left", 0, factor(-1), 0);
         run.near("no light", 1, factor(5, 0), 0);
         run.counted("counted", 0, counts.changes);
         run.near("more", 2, factor(1.01), 0);
         run.near("less", 0, factor(-1e9), 0);
         run.counted("counted", 2, counts.changes);
       }},
      {"packets: every field all zeros and all ones", Known::kClosedForm,
       "unpack(pack(x)) = x, for every packet, at the least and the greatest widths",
       [](Run& run) {
         Plan least;
         least.position_bits = 4;
         least.direction_bits = least.normal_bits = least.mantissa_bits = 2;
         least.exponent_bits = 1;
         least.channels = 1;
         least.k = 1;
         least.width = least.height = least.spp = 1;
         least.gather_rays = 0;
         least.reciprocal_bits = 0;
         Plan greatest;
         greatest.position_bits = 24;
         greatest.direction_bits = greatest.normal_bits = 14;
         greatest.mantissa_bits = 16;
         greatest.k = 256;
         greatest.width = greatest.height = 16384;
         greatest.spp = 1 << 20;
         greatest.gather_rays = 65535;
         greatest.u_bits = 48;
         greatest.probability_bits = 24;
         greatest.cell_bits = 6;
         greatest.v_bits = 12;
         greatest.cache_hits = 8;
         greatest.global.photons = 1u << 30;
         uint64_t others = 0;
         for (const Plan& plan : {least, Plan{}, greatest})
           for_each_packet([&](auto tag) {
             using P = typename decltype(tag)::type;
             const PacketLayout layout = PacketLayout::of<P>(plan);
             for (const uint64_t fill : {uint64_t{0}, ~uint64_t{0}}) {
               P packet{}, back{};
               for (const FieldPlace& f : layout.fields())
                 for (int i = 0; i < f.elements; ++i)
                   layout.set(&packet, f, i, fill & ones(f.bits));
               std::vector<uint32_t> words(layout.words());
               layout.pack(&packet, words.data());
               layout.unpack(words.data(), &back);
               others += !(packet == back);
             }
           });
         run.exact("others", 0, others);
       }},
      {"plan: every line one below its least", Known::kRefusal, "each is refused",
       [](Run& run) { beyond(run, false); }},
      {"plan: every line one above its greatest", Known::kRefusal, "each is refused",
       [](Run& run) { beyond(run, true); }},
      {"plan: a product of 128 bits", Known::kRefusal,
       "flux, reciprocal, constant and weight together have room for 127 bits",
       [](Run& run) {
         Plan plan;
         plan.mantissa_bits = 16;
         plan.photon_bytes = 32;
         plan.k = 256;
         plan.reciprocal_bits = 24;
         plan.weight_bits = 24;
         run.refused("pixel.weight_bits is 24", [&] { check_plan(plan); });
       }},
      {"plan: extents of 0, infinity and no number", Known::kRefusal, "no cube has such an edge",
       [](Run& run) {
         for (const double extent : {0.0, -1.0, HUGE_VAL, kNan, 1e-200, 1e200}) {
           Plan plan;
           plan.extent = extent;
           run.refused("scene.extent", [&] { check_plan(plan); });
         }
       }},
      {"albedo above 1, scene of 3.x", Known::kRefusal,
       "a surface that sends more light than arrives is refused",
       [](Run& run) {
         run.refused("expected at most 1", [] { reflecting("1.0001", "3.0.0"); });
         run.refused("expected at most 1", [] { reflecting("0.5, 2, 0.5", "3.0.0"); });
       }},
      {"albedo above 1, scene of 0.6", Known::kSaturation,
       "as Mitsuba 0.6 does: scaled to 0.99, and a warning says by what",
       [](Run& run) {
         const Scene scene = reflecting("2", "0.6.0");
         run.near("albedo", 0.99, scene.bsdfs.at(0).diffuse.x, 1e-15);
         run.counted("warnings", 1, scene.warnings.size());
       }},
      {"albedo 1", Known::kDefinition, "taken as it is, without a warning",
       [](Run& run) {
         const Scene scene = reflecting("1", "3.0.0");
         run.near("albedo", 1, scene.bsdfs.at(0).diffuse.x, 0);
         run.exact("warnings", 0, scene.warnings.size());
       }},
      {"albedo below 0", Known::kRefusal, "no reflectance is negative",
       [](Run& run) { run.refused("reflectance", [] { reflecting("-0.1", "3.0.0"); }); }},
  };
  return {
      "conversions",
      "The named conversions (positions, powers, directions, weights, light), what randomness and "
      "Fresnel's equations give at their ends, and what plans and files refuse.",
      std::move(cases)};
}

}  // namespace photonloom::extremes
