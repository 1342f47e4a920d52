// SPDX-License-Identifier: Apache-2.0
#include "tests/extremes/suite/steps.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string_view>

#include "golden/numeric/octahedral.hpp"
#include "golden/numeric/random.hpp"
#include "golden/numeric/reciprocal.hpp"
#include "golden/numeric/shared_exponent.hpp"
#include "golden/plan/quantiser.hpp"
#include "golden/transport/sampling.hpp"
#include "golden/unit/cdf_sampler.hpp"
#include "golden/unit/irradiance_cache.hpp"
#include "golden/unit/pack_photons.hpp"
#include "golden/unit/photon_gatherer.hpp"
#include "golden/unit/reference_gather.hpp"
#include "golden/unit/shader.hpp"
#include "tests/extremes/suite/step_inputs.hpp"

namespace photonloom::extremes {
namespace {

double unit(uint64_t i, uint64_t d) { return to_unit(hash_bits(77, i, 0, d)); }
Vec3 point(uint64_t i, uint64_t d = 0) { return {unit(i, d), unit(i, d + 1), unit(i, d + 2)}; }
Vec3 direction(uint64_t i) { return sample_sphere({unit(i, 10), unit(i, 11)}); }
double angle(const Vec3& a, const Vec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}
Vec3 decode(OctCode code, int b) {
  const IVec3 o = oct_decode(code, b);
  return Vec3(o[0], o[1], o[2]);
}

// The worst of f(i), i < n.
template <class F>
double worst(uint64_t n, F&& f) {
  double most = 0;
  for (uint64_t i = 0; i < n; ++i) most = std::max(most, f(i));
  return most;
}

constexpr uint64_t kInputs = 20000;

Plan positions(int bits) {
  Plan plan;
  plan.position_bits = bits;
  plan.photon_bytes = 32;
  plan.extent = 2.5;
  plan.origin = {-1, 3, 0.125};
  plan.global.r2_max = plan.caustic.r2_max = plan.r2_limit();
  return plan;
}

Vec3 in_cube(const Plan& plan, const Vec3& u) {
  return Vec3(plan.origin[0], plan.origin[1], plan.origin[2]) + u * plan.extent;
}

Vec3 units(const Plan& plan, const Vec3& x) {
  return (x - in_cube(plan, Vec3(0))) / plan.position_unit();
}

Vec3 vec(const UVec3& q) { return Vec3(q[0], q[1], q[2]); }

double direction_bound(int b) { return 1.5 * std::sqrt(2.0) * std::ldexp(2.0, -b); }

double ratio_error(double got, double due) { return std::fabs(got / due - 1); }

// As `shading`, with a cube in which a weight's scale is 2^F.
Plan unit_shading(int w, int weight_bits) {
  Plan plan = shading(w, weight_bits);
  plan.extent = std::ldexp(std::sqrt(1 / kPi), plan.position_bits);
  return plan;
}

// The sampler's exact weights S(c) by combine = "sum", L = 1, in double.
struct ExactTable {
  std::vector<double> weight;
  double sum = 0;
  int narrow = 0;
};
ExactTable exact_table(const Plan& plan, OctCode normal, std::span<const SamplerPhoton> photons) {
  const CellGeometry geometry(plan.cell_bits);
  std::vector<double> power(geometry.cells()), cosine(geometry.cells());
  double tp = 0, tb = 0;
  const int shift = plan.direction_bits - plan.cell_bits;
  for (const SamplerPhoton& p : photons) {
    const double v = std::ldexp(
        static_cast<double>(p.power.mantissa[0] + p.power.mantissa[1] + p.power.mantissa[2]),
        static_cast<int>(p.power.exponent));
    power[((p.direction.v >> shift) << plan.cell_bits) + (p.direction.u >> shift)] += v;
    tp += v;
  }
  const IVec3 n = oct_decode(normal, plan.normal_bits);
  for (size_t c = 0; c < power.size(); ++c) {
    cosine[c] = static_cast<double>(std::max<int64_t>(0, oct_dot(geometry.centre(c), n))) *
                geometry.jacobians()[c];
    tb += cosine[c];
  }
  ExactTable table;
  for (size_t c = 0; c < power.size(); ++c) {
    table.weight.push_back(power[c] * tb + cosine[c] * tp);
    table.sum += table.weight.back();
  }
  int tp_bits, tb_bits;
  std::frexp(tp, &tp_bits);
  std::frexp(tb, &tb_bits);
  table.narrow = std::max(0, tp_bits + tb_bits + 1 - plan.probability_bits);
  return table;
}

std::vector<SamplerPhoton> table_photons(const Plan& plan, uint64_t seed) {
  std::vector<SamplerPhoton> photons(50);
  for (uint64_t i = 0; i < photons.size(); ++i)
    photons[i] = {{{static_cast<uint32_t>(256 + hash_bits(seed, i, 3, 0) % 255), 20, 30},
                   static_cast<uint32_t>(hash_bits(seed, i, 3, 1) % 4)},
                  oct_encode(sample_cosine({to_unit(hash_bits(seed, i, 3, 2)),
                                            to_unit(hash_bits(seed, i, 3, 3))}),
                             plan.direction_bits)};
  return photons;
}

Plan sampling(int probability_bits) {
  Plan plan;
  plan.probability_bits = probability_bits;
  plan.u_bits = 48;
  return plan;
}

template <class F>
std::vector<StepError> at(std::initializer_list<int> widths, const char* line, F&& f) {
  std::vector<StepError> list;
  for (const int b : widths) {
    const auto [measured, bound] = f(b);
    list.push_back({fmt::format("{} = {}", line, b), measured, bound});
  }
  return list;
}
using Both = std::pair<double, double>;

// The bounds have one home, which the proofs read too.
struct Bound {
  std::string_view step, formula, remark;
};
constexpr Bound kBounds[] = {
#define WORD(word, line)
#define STEP(name, formula, remark, shown) {name, formula, remark},
#include "tests/extremes/suite/steps.bounds"
#undef STEP
#undef WORD
};

const Bound& bound_of(std::string_view step) {
  for (const Bound& b : kBounds)
    if (b.step == step) return b;
  throw std::logic_error(fmt::format("steps.bounds has no step '{}'", step));
}

std::string shown_bound(std::string_view step) {
  const Bound& b = bound_of(step);
  return b.remark.empty() ? std::string(b.formula) : fmt::format("{}; {}", b.formula, b.remark);
}

using Words = std::map<std::string, double, std::less<>>;

// A formula of steps.bounds as a number.
class Formula {
 public:
  Formula(std::string_view text, const Words& words) : text_(text), words_(words) {}
  double value() {
    const double x = sum();
    if (!text_.empty()) fail();
    return x;
  }

 private:
  [[noreturn]] void fail() const {
    throw std::logic_error(
        fmt::format("steps.bounds: a formula cannot be read from '{}' on", text_));
  }
  bool take(char c) {
    while (!text_.empty() && text_[0] == ' ') text_.remove_prefix(1);
    if (text_.empty() || text_[0] != c) return false;
    text_.remove_prefix(1);
    return true;
  }
  double sum() {
    double x = product();
    for (;;)
      if (take('+'))
        x += product();
      else if (take('-'))
        x -= product();
      else
        return x;
  }
  double product() {
    double x = power();
    for (;;)
      if (take('*'))
        x *= power();
      else if (take('/'))
        x /= power();
      else
        return x;
  }
  double power() {
    const double x = atom();
    return take('^') ? std::pow(x, atom()) : x;
  }
  double atom() {
    if (take('-')) return -atom();
    if (take('(')) {
      const double x = sum();
      if (!take(')')) fail();
      return x;
    }
    const auto is_word = [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) || c == '.';
    };
    const auto end = std::ranges::find_if_not(text_, is_word);
    const std::string word(text_.begin(), end);
    if (word.empty()) fail();
    text_.remove_prefix(word.size());
    if (word == "sqrt") return std::sqrt(atom());
    if (std::isdigit(static_cast<unsigned char>(word[0]))) return std::stod(word);
    const auto found = words_.find(word);
    if (found == words_.end()) throw std::logic_error("steps.bounds: no value of " + word);
    return found->second;
  }

  std::string_view text_;
  const Words& words_;
};

double bound(std::string_view step, const Words& words) {
  return Formula(bound_of(step).formula, words).value();
}

}  // namespace

std::vector<Step> arithmetic_steps() {
  std::vector<Step> steps = {
      {"position", "x -> floor((x - origin) / unit) (`quantise_position`)",
       [] {
         return at({4, 16, 24}, "position_bits", [](int b) -> Both {
           const Plan plan = positions(b);
           return {worst(kInputs,
                         [&](uint64_t i) {
                           const Vec3 x = in_cube(plan, point(i));
                           return max_component(
                               glm::abs(units(plan, x) - vec(quantise_position(plan, x))));
                         }),
                   bound("position", {{"p", b}})};
         });
       }},
      {"distance", "the distance of two quantised points beside that of the points",
       [] {
         return at({4, 16, 24}, "position_bits", [](int b) -> Both {
           const Plan plan = positions(b);
           return {worst(kInputs,
                         [&](uint64_t i) {
                           const Vec3 x = in_cube(plan, point(i)), y = in_cube(plan, point(i, 3));
                           const double exact = glm::length(units(plan, x) - units(plan, y));
                           const double got = glm::length(vec(quantise_position(plan, x)) -
                                                          vec(quantise_position(plan, y)));
                           return std::fabs(got - exact);
                         }),
                   bound("distance", {{"p", b}})};
         });
       }},
      {"squared distance", "d2 of quantised positions (`search_gather`)",
       [] {
         return at({4, 24}, "position_bits", [](int b) -> Both {
           const Plan plan = positions(b);
           return {worst(300,
                         [&](uint64_t i) {
                           PackedPhoton p{};
                           p.position = quantise_position(plan, in_cube(plan, point(i)));
                           p.direction = oct_encode(Vec3(0, 0, 1), plan.direction_bits);
                           const PhotonMap map = build_photon_map({&p, 1}, plan);
                           GatherQuery q{};
                           q.position = quantise_position(plan, in_cube(plan, point(i, 3)));
                           const OctCode n = oct_encode(Vec3(0, 0, 1), plan.normal_bits);
                           q.normal = {n.u, n.v};
                           std::vector<Neighbour> found;
                           search_gather(plan, map, q, found);
                           const Vec3 d = vec(p.position) - vec(q.position);
                           return std::fabs(static_cast<double>(found.at(0).d2) - glm::dot(d, d));
                         }),
                   bound("squared distance", {})};
         });
       }},
      {"largest radius", "radius -> floor((radius / unit)^2) (`radius_to_r2_max`)",
       [] {
         return at({4, 16, 24}, "position_bits", [](int b) -> Both {
           const Plan plan = positions(b);
           return {
               worst(kInputs,
                     [&](uint64_t i) {
                       // Of any size up to the widest; a long double has 11 bits more.
                       const double r = plan.position_unit() * std::exp2((b + 1) * unit(i, 0));
                       const long double units = static_cast<long double>(r) / plan.position_unit();
                       return static_cast<double>(std::fabs(
                           units * units - static_cast<long double>(radius_to_r2_max(plan, r))));
                     }),
               bound("largest radius", {{"p", b}})};
         });
       }},
      {"direction", "a direction -> the centre of its octahedral cell (`oct_encode`, `oct_decode`)",
       [] {
         return at({2, 4, 8, 14}, "direction_bits", [](int b) -> Both {
           return {worst(kInputs,
                         [&](uint64_t i) {
                           // Half of them around the faces' centres, where cells are longest.
                           const Vec3 d = i % 2
                                              ? direction(i)
                                              : glm::normalize(Vec3(i & 2 ? 1 : -1, i & 4 ? 1 : -1,
                                                                    i & 8 ? 1 : -1) +
                                                               direction(i) * std::ldexp(4.0, -b));
                           return angle(d, decode(oct_encode(d, b), b));
                         }),
                   bound("direction", {{"b", b}})};
         });
       }},
      {"side of a surface", "o(direction) . o(normal) > 0 beside that of the directions themselves",
       [] {
         return at({4, 8, 14}, "direction_bits = normal_bits", [](int b) -> Both {
           return {worst(20 * kInputs,
                         [&](uint64_t i) {
                           const Vec3 n = direction(i);
                           // Near the horizon, where it can go wrong.
                           const Frame frame(n);
                           const Vec2 turn = cos_sin_turns(unit(i, 20));
                           const double height = (unit(i, 21) - 0.5) * 6 * direction_bound(b);
                           const Vec3 d =
                               glm::normalize(frame.to_world(Vec3(turn.x, turn.y, height)));
                           const bool due = glm::dot(d, n) > 0;
                           const bool got = oct_dot(oct_decode(oct_encode(d, b), b),
                                                    oct_decode(oct_encode(n, b), b)) > 0;
                           return due == got ? 0 : std::fabs(glm::dot(d, n));
                         }),
                   bound("side of a surface", {{"b", b}})};
         });
       }},
      {"power", "a channel's power -> mantissa * 2^e (`encode_power`), in steps of 2^e",
       [] {
         return at({2, 9, 16}, "mantissa_bits", [](int m) -> Both {
           return {worst(kInputs,
                         [&](uint64_t i) {
                           // The first: its sum with 1/2 is 1 in double.
                           const double v =
                               i ? unit(i, 0) * std::ldexp(1.0, m + static_cast<int>(i % 30))
                                 : 0x1.fffffffffffffp-2;
                           const std::array<double, 3> value{v, v * unit(i, 1), v * unit(i, 2)};
                           bool saturated = false;
                           const PowerCode code = encode_power(value, 3, m, 5, &saturated);
                           double off = 0;
                           for (int c = 0; c < 3; ++c)
                             off =
                                 std::max(off, std::fabs(static_cast<double>(power_value(code, c)) -
                                                         value[static_cast<size_t>(c)]));
                           return std::ldexp(off, -static_cast<int>(code.exponent));
                         }),
                   bound("power", {{"m", m}})};
         });
       }},
      {"largest channel", "the same, over the largest channel, where e > 0",
       [] {
         return at({2, 9, 16}, "mantissa_bits", [](int m) -> Both {
           return {worst(kInputs,
                         [&](uint64_t i) {
                           const double v =
                               std::ldexp(1 + unit(i, 0), m + 3 + static_cast<int>(i % 20));
                           bool saturated = false;
                           const PowerCode code = encode_power({v, 0, 0}, 1, m, 5, &saturated);
                           return ratio_error(static_cast<double>(power_value(code, 0)), v);
                         }),
                   bound("largest channel", {{"m", m}})};
         });
       }},
      {"flux", "the sum of k coded powers beside that of the powers",
       [] {
         return at({8, 50, 256}, "k", [](int k) -> Both {
           Plan plan;
           plan.k = k;
           std::vector<Neighbour> found;
           std::vector<PackedPhoton> photons;
           double due = 0, steps = 0;
           for (int i = 0; i < k; ++i) {
             // Ties: every power lies half way between two codes.
             const int e = i % 8;
             const double v = std::ldexp(256 + i % 200 + 0.5, e);
             bool saturated = false;
             PackedPhoton p{};
             p.power = encode_power({v, 0, 0}, 3, 9, 5, &saturated);
             photons.push_back(p);
             due += v;
             steps += std::ldexp(1.0, static_cast<int>(p.power.exponent));
           }
           const PhotonMap map = build_photon_map(photons, plan);
           for (int i = 0; i < k; ++i) found.push_back({0, static_cast<uint32_t>(i)});
           const GatherResult r = make_gather_result(plan, map, GatherQuery{}, found, {});
           return {std::fabs(static_cast<double>(r.flux[0]) - due),
                   bound("flux", {{"m", 9}, {"steps", steps}})};
         });
       }},
      {"reciprocal", "1 / r2 as mantissa and exponent (`reciprocal`), relative",
       [] {
         return at({8, 18, 24}, "reciprocal_bits", [](int w) -> Both {
           return {worst(4 * kInputs,
                         [&](uint64_t i) {
                           // Half of them just below a power of two, where R is shortest.
                           const int size = 2 + static_cast<int>(i % 46);
                           const uint64_t span = uint64_t{1} << size;
                           const uint64_t x =
                               i % 2 ? span + hash_bits(1, i, 0, 0) % span
                                     : 2 * span - 1 - hash_bits(1, i, 0, 0) % (span / 4 + 1) % 4096;
                           const Reciprocal r = reciprocal(x, w);
                           const double got = std::ldexp(static_cast<double>(r.mantissa),
                                                         -w - static_cast<int>(r.exponent));
                           return std::fabs(got * static_cast<double>(x) - 1);
                         }),
                   bound("reciprocal", {{"W", w}})};
         });
       }},
      {"c = (k - 1) / k", "its W-bit constant (`Shader`), absolute",
       [] {
         return at({8, 18, 24}, "reciprocal_bits", [](int w) -> Both {
           return {
               worst(255,
                     [&](uint64_t i) {
                       Plan plan = unit_shading(w, 8);
                       plan.k = static_cast<int>(i) + 2;
                       plan.integer_bits = 90;
                       plan.fraction_bits = 20;
                       const Shader shader(plan);
                       // 2^35 / 1 * c * 2^7 * 2^20: what c makes of a power of two.
                       Weight weight;
                       weight.mantissa = {128, 0, 0};
                       weight.exponent = {20, 0, 0};
                       const auto value = [&](bool full) {
                         return static_cast<double>(shader.contribution(
                             result_of(plan, uint64_t{1} << 35, 1, full), weight)[0]);
                       };
                       return std::fabs(value(true) / value(false) -
                                        static_cast<double>(i + 1) / static_cast<double>(i + 2));
                     }),
               bound("c = (k - 1) / k", {{"W", w}})};
         });
       }},
      {"weight", "a query's weight as mantissa and exponent (`Shader::weight`), relative",
       [] {
         return at({8, 18, 24}, "weight_bits", [](int bits) -> Both {
           const Plan plan = unit_shading(8, bits);
           const Shader shader(plan);
           return {worst(kInputs,
                         [&](uint64_t i) {
                           const double v =
                               std::ldexp(1 + (i % 2 ? unit(i, 0) : 1e-4 * unit(i, 0)), -60);
                           ShaderCounts counts;
                           const Weight w = shader.weight(Rgb(v), false, counts);
                           return ratio_error(
                               std::ldexp(w.mantissa[0], w.exponent[0] - plan.fraction_bits), v);
                         }),
                   bound("weight", {{"w", bits}})};
         });
       }},
      {"contribution",
       "flux * R * c * weight rounded half up (`Shader::contribution`), in pixel units",
       [] {
         return at({8, 18}, "reciprocal_bits", [](int w) -> Both {
           const Plan plan = unit_shading(w, 12);
           const Shader shader(plan);
           return {
               worst(kInputs,
                     [&](uint64_t i) {
                       const GatherResult r = result_of(plan, 1 + hash_bits(2, i, 0, 0) % 100000,
                                                        1 + hash_bits(2, i, 0, 1) % 1000, false);
                       Weight weight;
                       weight.mantissa = {
                           static_cast<uint32_t>(2048 + hash_bits(2, i, 0, 2) % 2048), 0, 0};
                       weight.exponent = {static_cast<int32_t>(hash_bits(2, i, 0, 3) % 12) - 24, 0,
                                          0};
                       // Below 2^63 before it is rounded: exact as an integer, a long double holds
                       // it.
                       const long double exact = std::ldexp(
                           static_cast<long double>(r.flux[0] * weight.mantissa[0]) *
                               static_cast<long double>(r.reciprocal),
                           weight.exponent[0] - w - static_cast<int>(r.reciprocal_exponent));
                       return static_cast<double>(std::fabs(
                           static_cast<long double>(shader.contribution(r, weight)[0]) - exact));
                     }),
               bound("contribution", {})};
         });
       }},
      {"light found on the way", "direct light, emission -> 2^-F (`Shader::pixel`), in pixel units",
       [] {
         return at({20, 40, 90}, "fraction_bits", [](int f) -> Both {
           Plan plan = unit_shading(18, 18);
           plan.fraction_bits = f;
           plan.integer_bits = 20;
           const Shader shader(plan);
           return {worst(kInputs,
                         [&](uint64_t i) {
                           const double v =
                               std::ldexp(unit(i, 0), 6 - f + static_cast<int>(i % 20));
                           ShaderCounts counts;
                           return std::fabs(static_cast<double>(shader.pixel(Rgb(v), counts)[0]) -
                                            std::ldexp(v, f));
                         }),
                   bound("light found on the way", {})};
         });
       }},
      {"share of a record", "light * f * 2^(x - 12) (`Shader::interpolated`), in pixel units",
       [] {
         return at({8, 18, 24}, "weight_bits", [](int bits) -> Both {
           const Plan plan = unit_shading(18, bits);
           const Shader shader(plan);
           double most = 0, bound_there = 1;
           for (uint64_t i = 0; i < kInputs; ++i) {
             const double rho = 0.5 + 0.5 * (i % 2 ? unit(i, 0) : 1e-3 * unit(i, 0));
             ShaderCounts counts;
             const Weight share = shader.share(Rgb(rho, 0, 0), counts);
             const auto total = static_cast<uint32_t>(1 + hash_bits(3, i, 0, 0) % 1000);
             const auto weight = static_cast<uint32_t>(1 + hash_bits(3, i, 0, 1) % total);
             const double light = std::floor(std::ldexp(1 + unit(i, 1), 30));
             const double due = light * rho * weight / total;
             const double got = static_cast<double>(shader.interpolated(
                 {static_cast<uint64_t>(light), 0, 0}, weight, total, share)[0]);
             const double step = std::ldexp(1.0, share.exponent[0]);
             const double here =
                 bound("share of a record",
                       {{"w", bits}, {"due", due}, {"light", light}, {"step", step}});
             if (std::fabs(got - due) / here > most / bound_there) {
               most = std::fabs(got - due);
               bound_there = here;
             }
           }
           return {most, bound_there};
         });
       }},
      {"Jacobian of a cell", "floor(28 * 16^a / |o|^4) (`cell_jacobian`), relative",
       [] {
         return at({2, 4, 6}, "cell_bits", [](int a) -> Both {
           const uint32_t edge = 1u << a;
           return {worst(uint64_t{edge} * edge,
                         [&](uint64_t i) {
                           const IVec3 o = oct_decode({uint32_t(i) % edge, uint32_t(i) / edge}, a);
                           const auto r2 = static_cast<double>(oct_dot(o, o));
                           const double exact = std::ldexp(28.0, 4 * a) / (r2 * r2);
                           return 1 - cell_jacobian(o, a) / exact;
                         }),
                   bound("Jacobian of a cell", {})};
         });
       }},
      {"narrowed weight", "S(c) -> max(1, S >> s) (`build_sample_table`), in units of a weight",
       [] {
         return at({8, 16, 24}, "probability_bits", [](int b) -> Both {
           const Plan plan = sampling(b);
           const CellGeometry geometry(plan.cell_bits);
           const OctCode up = oct_encode(Vec3(0, 0, 1), plan.normal_bits);
           double most = 0;
           for (uint64_t seed = 0; seed < 20; ++seed) {
             const auto photons = table_photons(plan, seed);
             const ExactTable exact = exact_table(plan, up, photons);
             const SampleTable table = build_sample_table(plan, geometry, up, photons);
             for (size_t c = 0; c < geometry.cells(); ++c)
               if (table.weight(c) > 0)
                 most = std::max(most, std::fabs(static_cast<double>(table.weight(c)) -
                                                 std::ldexp(exact.weight[c], -exact.narrow)));
           }
           return {most, bound("narrowed weight", {})};
         });
       }},
      {"probability of a cell", "w / W beside S / sum of S",
       [] {
         return at({8, 16, 24}, "probability_bits", [](int b) -> Both {
           const Plan plan = sampling(b);
           const CellGeometry geometry(plan.cell_bits);
           const OctCode up = oct_encode(Vec3(0, 0, 1), plan.normal_bits);
           double most = 0, total_there = 1;
           for (uint64_t seed = 0; seed < 20; ++seed) {
             // All power in one cell: the floors of all others take from it.
             auto photons = table_photons(plan, seed);
             if (seed % 2)
               for (SamplerPhoton& p : photons) p.direction = photons[0].direction;
             const ExactTable exact = exact_table(plan, up, photons);
             const SampleTable table = build_sample_table(plan, geometry, up, photons);
             const auto total = static_cast<double>(table.total());
             for (size_t c = 0; c < geometry.cells(); ++c) {
               const double off = std::fabs(static_cast<double>(table.weight(c)) / total -
                                            exact.weight[c] / exact.sum);
               if (off * total > most * total_there) {
                 total_there = total;
                 most = off;
               }
             }
           }
           return {most,
                   bound("probability of a cell", {{"a", plan.cell_bits}, {"total", total_there}})};
         });
       }},
      {"inversion", "the share of u's codes that take a cell beside w / W (`sample_cell`)",
       [] {
         return at({16, 18}, "u_bits", [](int b) -> Both {
           Plan plan;
           plan.cell_bits = 1;
           plan.probability_bits = 6;
           plan.u_bits = b;
           const CellGeometry geometry(plan.cell_bits);
           const SampleTable table =
               build_sample_table(plan, geometry, oct_encode(Vec3(0.2, 0.1, 1), plan.normal_bits),
                                  table_photons(plan, 3));
           std::vector<uint64_t> codes(geometry.cells());
           for (uint64_t u = 0; u < uint64_t{1} << b; ++u) ++codes[sample_cell(plan, table, u)];
           double most = 0;
           for (size_t c = 0; c < codes.size(); ++c)
             most = std::max(most, std::fabs(std::ldexp(static_cast<double>(codes[c]), -b) -
                                             static_cast<double>(table.weight(c)) /
                                                 static_cast<double>(table.total())));
           return {most, bound("inversion", {{"u", b}})};
         });
       }},
      {"normal of a record", "each coordinate plus 1 -> units of 2^(1 - b) (`quantise_normal`)",
       [] {
         return at({2, 8, 14}, "normal_bits", [](int b) -> Both {
           Plan plan;
           plan.normal_bits = b;
           return {worst(kInputs,
                         [&](uint64_t i) {
                           const Vec3 n = direction(i);
                           return max_component(glm::abs((n + 1.0) * std::ldexp(0.5, b) -
                                                         vec(quantise_normal(plan, n))));
                         }),
                   bound("normal of a record", {{"b", b}})};
         });
       }},
      {"reach of a record", "its square -> floor, at least 1 (`cache_falloff`), in unit^2",
       [] {
         return at({8, 16, 24}, "position_bits", [](int b) -> Both {
           Plan plan = positions(b);
           plan.cache_accuracy = 1;
           plan.cache_radius_max = 1;
           plan.cache_weight_bits = 12;
           return {worst(kInputs,
                         [&](uint64_t i) {
                           const double reach = 1 + 10 * unit(i, 0);
                           const Reciprocal r = cache_falloff(plan, reach * plan.position_unit());
                           // The reciprocal of an integer below 2^7 tells it.
                           const double square =
                               std::round(std::ldexp(1.0, plan.cache_falloff_bits() +
                                                              static_cast<int>(r.exponent)) /
                                          r.mantissa);
                           return reach * reach - square;
                         }),
                   bound("reach of a record", {{"p", b}})};
         });
       }},
      {"weight of a record",
       "2^B (1 - d2 / reach2 - n2 / 2^angle_bits) (`cache_weight`), in units of 2^-B",
       [] {
         return at({4, 8, 12}, "cache.weight_bits", [](int b) -> Both {
           Plan plan;
           plan.cache_weight_bits = b;
           return {worst(10 * kInputs,
                         [&](uint64_t i) {
                           const uint64_t reach2 =
                               2 + hash_bits(4, i, 0, 0) % (uint64_t{1} << (2 + i % 28));
                           CacheRecord record{
                               {0, 0, 0}, {0, 0, 0}, reciprocal(reach2, plan.cache_falloff_bits())};
                           const double reach = std::sqrt(static_cast<double>(reach2));
                           const UVec3 p{static_cast<uint32_t>(reach * unit(i, 1)),
                                         static_cast<uint32_t>(reach * 0.3 * unit(i, 2)), 1};
                           const UVec3 n{static_cast<uint32_t>(20 * unit(i, 3)), 3, 0};
                           const uint32_t got = cache_weight(plan, record, p, n);
                           if (got == 0) return 0.0;
                           const double d2 = glm::dot(vec(p), vec(p)),
                                        n2 = glm::dot(vec(n), vec(n));
                           const double due = std::ldexp(1 - d2 / static_cast<double>(reach2) -
                                                             std::ldexp(n2, -plan.cache_angle_bits),
                                                         b);
                           return due > got + 1.0 / 16 ? HUGE_VAL : got - due;
                         }),
                   bound("weight of a record", {})};
         });
       }},
      {"pixel", "the sum of all contributions",
       [] {
         return at({1, 20}, "clog2(spp)", [](int bits) -> Both {
           // The largest contributions there are, as many as a pixel adds.
           Plan plan;
           plan.spp = 1 << bits;
           plan.integer_bits = 40;
           plan.fraction_bits = 40;
           const UInt128 largest = (UInt128{1} << plan.pixel_contribution_bits()) - 1;
           const UInt128 count = UInt128{static_cast<unsigned>(plan.spp)} *
                                 static_cast<unsigned>(plan.gather_rays + 4);
           return {largest * count >> plan.pixel_sum_bits() == 0 ? 0.0 : 1.0, bound("pixel", {})};
         });
       }},
  };
  for (Step& step : steps) step.bound = shown_bound(step.name);
  return steps;
}

namespace {

// 20,000 photons on a plane, light from all above, powers over four octaves; every width at its
// greatest.
Plan widest() {
  Plan plan;
  plan.position_bits = 24;
  plan.direction_bits = plan.normal_bits = 14;
  plan.mantissa_bits = 16;
  plan.photon_bytes = 32;
  plan.k = 50;
  plan.reciprocal_bits = 24;
  plan.weight_bits = 24;
  plan.integer_bits = 60;
  plan.fraction_bits = 60;
  plan.gather_rays = 1;
  plan.spp = 1;
  plan.global.present = true;
  plan.global.photons = 20000;
  plan.global.r2_max = plan.caustic.r2_max = plan.r2_limit();
  return plan;
}

struct Plane {
  std::vector<Photon> photons;
  std::vector<Vec3> queries;
  Vec3 normal;
  std::vector<double> due;
};

const Plane& plane() {
  static const Plane made = [] {
    Plane p;
    p.normal = glm::normalize(Vec3(0.2, -0.35, 0.9));
    const Frame frame(p.normal);
    const auto on_plane = [&](double u, double v) {
      return Vec3(0.5) + frame.s * (0.7 * (u - 0.5)) + frame.t * (0.7 * (v - 0.5));
    };
    for (uint64_t i = 0; i < 20000; ++i) {
      const Vec3 d = frame.to_world(sample_cosine({unit(i, 30), unit(i, 31)}));
      // Photons from below too: directions decide which count.
      p.photons.push_back({on_plane(unit(i, 32), unit(i, 33)), i % 4 ? d : -d,
                           Rgb(std::exp2(4 * unit(i, 34))), 0, 0, 0});
    }
    const ReferenceGather reference(p.photons);
    for (uint64_t i = 0; i < 400; ++i) {
      p.queries.push_back(on_plane(0.1 + 0.8 * unit(i, 35), 0.1 + 0.8 * unit(i, 36)));
      std::vector<ReferenceNeighbour> found;
      reference.find(p.queries.back(), p.normal, 50, HUGE_VAL, found);
      p.due.push_back(reference.irradiance(found, 50, HUGE_VAL, 0, Kernel::kFlat).y);
    }
    return p;
  }();
  return made;
}

// Median of golden's relative errors: a photon that is the k-th with one width and not with another
// is an event of its own, and rare.
double estimate_error(Plan plan) {
  const Plane& p = plane();
  plan.global.r2_max = plan.caustic.r2_max = plan.r2_limit();
  plan.global.power_exponent = choose_power_exponent(p.photons, plan);
  const auto packed = pack_photons(p.photons, plan, plan.global, nullptr);
  const PhotonMap map = build_photon_map(packed, plan), none = build_photon_map({}, plan);
  const auto gatherer = make_golden_photon_gatherer(plan);
  gatherer->load(map, none);
  std::vector<GatherQuery> queries;
  const OctCode n = oct_encode(p.normal, plan.normal_bits);
  for (const Vec3& x : p.queries) {
    GatherQuery q{};
    q.position = quantise_position(plan, x);
    q.normal = {n.u, n.v};
    queries.push_back(q);
  }
  std::vector<GatherResult> results;
  std::vector<GatherPhoton> photons;
  gatherer->process(queries, results, photons);
  const Shader shader(plan);
  ShaderCounts counts;
  std::vector<double> errors;
  for (size_t i = 0; i < results.size(); ++i) {
    const double scale = 1e-6 * (1 + unit(i, 37));
    const Weight weight = shader.weight(Rgb(scale), false, counts);
    const double got = shader.radiance(shader.contribution(results[i], weight)[1]);
    errors.push_back(ratio_error(got, scale * p.due[i]));
  }
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  return *middle;
}

// What part of all directions changes sides, with codes of these bits.
double side_error(int direction_bits, int normal_bits) {
  // All that can lie within three times both bounds of the horizon, where cosines are uniform.
  const double band =
      std::min(1.0, 3 * (direction_bound(direction_bits) + direction_bound(normal_bits)));
  const uint64_t n = 40000;
  uint64_t wrong = 0;
  for (uint64_t i = 0; i < n; ++i) {
    const Vec3 normal = direction(i);
    const double z = band * (2 * unit(i, 21) - 1);
    const Vec3 d =
        Frame(normal).to_world(Vec3(std::sqrt(1 - z * z) * cos_sin_turns(unit(i, 20)), z));
    wrong += (z > 0) != (oct_dot(oct_decode(oct_encode(d, direction_bits), direction_bits),
                                 oct_decode(oct_encode(normal, normal_bits), normal_bits)) > 0);
  }
  return band * static_cast<double>(wrong) / static_cast<double>(n);
}

// Half of the sum of |w / W - S / sum of S|: what part of the directions goes elsewhere.
double table_error(const Plan& plan) {
  const CellGeometry geometry(plan.cell_bits);
  const OctCode up = oct_encode(Vec3(0.1, 0.2, 0.9), plan.normal_bits);
  double sum = 0;
  for (uint64_t seed = 0; seed < 10; ++seed) {
    const auto photons = table_photons(plan, seed);
    const ExactTable exact = exact_table(plan, up, photons);
    const SampleTable table = build_sample_table(plan, geometry, up, photons);
    for (size_t c = 0; c < geometry.cells(); ++c)
      sum += std::fabs(static_cast<double>(table.weight(c)) / static_cast<double>(table.total()) -
                       exact.weight[c] / exact.sum);
  }
  return sum / 20;
}

double record_error(const Plan& plan) {
  double sum = 0;
  for (uint64_t i = 0; i < 4000; ++i) {
    const CacheRecord record{{0, 0, 0}, {0, 0, 0}, reciprocal(1000000, plan.cache_falloff_bits())};
    const UVec3 p{static_cast<uint32_t>(900 * unit(i, 40)),
                  static_cast<uint32_t>(300 * unit(i, 41)), 0};
    const double due = 1 - glm::dot(vec(p), vec(p)) / 1e6;
    sum += std::pow(std::ldexp(cache_weight(plan, record, p, {0, 0, 0}), -plan.cache_weight_bits) -
                        std::max(due, 0.0),
                    2);
  }
  return std::sqrt(sum / 4000);
}

template <class Set, class Error>
StabilityCurve curve(const char* line, const char* what, int least, int greatest, Set&& set,
                     Error&& error) {
  StabilityCurve c{line, what, {}};
  for (int b = least; b <= greatest; ++b) c.points.push_back({b, error(set(b))});
  return c;
}

}  // namespace

std::vector<StabilityCurve> stability_curves() {
  const char* estimate = "estimate, median of relative errors";
  const auto of = [](int Plan::*line) {
    return [line](int b) {
      Plan plan = widest();
      plan.*line = b;
      return plan;
    };
  };
  return {
      curve("photon.position_bits", estimate, 4, 24, of(&Plan::position_bits), estimate_error),
      curve(
          "photon.direction_bits", "part of all directions that changes sides", 2, 14,
          [](int b) { return b; }, [](int b) { return side_error(b, 14); }),
      curve(
          "gather.normal_bits", "part of all directions that changes sides", 2, 14,
          [](int b) { return b; }, [](int b) { return side_error(14, b); }),
      curve("photon.mantissa_bits", estimate, 2, 16, of(&Plan::mantissa_bits), estimate_error),
      curve("gather.reciprocal_bits", estimate, 8, 24, of(&Plan::reciprocal_bits), estimate_error),
      curve("pixel.weight_bits", estimate, 8, 24, of(&Plan::weight_bits), estimate_error),
      curve(
          "sampler.probability_bits", "part of the directions that goes to other cells", 4, 24,
          [](int b) { return sampling(b); }, table_error),
      curve(
          "cache.weight_bits", "weight of a record, root mean square", 4, 12,
          [](int b) {
            Plan plan;
            plan.cache_weight_bits = b;
            return plan;
          },
          record_error),
  };
}

std::string curve_fault(const StabilityCurve& c) {
  double floor = HUGE_VAL;  // what the other lines leave
  for (const StabilityPoint& p : c.points) {
    if (!std::isfinite(p.error)) return fmt::format("{} bits: no number", p.bits);
    floor = std::min(floor, p.error);
  }
  for (size_t i = 1; i < c.points.size(); ++i) {
    const StabilityPoint &coarse = c.points[i - 1], &fine = c.points[i];
    if (fine.error > kNoise * std::max(coarse.error, floor))
      return fmt::format("{} bits: {:.3g}, with a bit less {:.3g}", fine.bits, fine.error,
                         coarse.error);
    if (coarse.error > kCliff * std::max(fine.error, floor))
      return fmt::format("{} bits: {:.3g}, with a bit more {:.3g}: a cliff", coarse.bits,
                         coarse.error, fine.error);
  }
  return "";
}

}  // namespace photonloom::extremes
