// SPDX-License-Identifier: Apache-2.0
#include "tests/extremes/suite/stability.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "golden/image/pixel_sum.hpp"
#include "golden/numeric/octahedral.hpp"
#include "golden/numeric/random.hpp"
#include "golden/numeric/reciprocal.hpp"
#include "golden/pipeline/prepare.hpp"
#include "golden/plan/plan_file.hpp"
#include "golden/transport/sampling.hpp"
#include "golden/unit/cdf_sampler.hpp"
#include "golden/unit/irradiance_cache.hpp"
#include "golden/unit/pack_photons.hpp"
#include "golden/unit/shader.hpp"
#include "tests/oracles/scenes.hpp"

namespace photonloom::extremes {
namespace {

double uniform(uint64_t i, uint64_t d) { return to_unit(hash_bits(78, i, 0, d)); }
Vec3 direction(uint64_t i, uint64_t d) { return sample_sphere({uniform(i, d), uniform(i, d + 1)}); }

template <class F>
double mean(uint64_t n, F&& f) {
  double sum = 0;
  for (uint64_t i = 0; i < n; ++i) sum += f(i);
  return sum / static_cast<double>(n);
}

template <class Error>
StabilityCurve curve(const char* line, const char* what, int least, int greatest, Error&& error) {
  StabilityCurve c{line, what, {}};
  for (int b = least; b <= greatest; ++b) c.points.push_back({b, error(b)});
  return c;
}

// Powers over more octaves than any format holds.
double power_error(int exponent_bits) {
  Plan plan;
  plan.mantissa_bits = 16;
  plan.exponent_bits = exponent_bits;
  std::vector<Photon> photons;
  for (uint64_t i = 0; i < 6000; ++i) {
    const double power = std::exp2(-60 * (static_cast<double>(i) + uniform(i, 0)) / 6000);
    photons.push_back({Vec3(0.5), Vec3(0, 0, 1), Rgb(power), 0, 0, 0});
  }
  plan.global.power_exponent = choose_power_exponent(photons, plan);
  const auto packed = pack_photons(photons, plan, plan.global, nullptr);
  return mean(photons.size(), [&](uint64_t i) {
    const double got = std::ldexp(static_cast<double>(power_value(packed[i].power, 0)),
                                  plan.global.power_exponent);
    return std::fabs(got / photons[i].power.x - 1);
  });
}

// Light from 2^from to 2^to: over more octaves than a pixel has bits.
double pixel_error(int integer_bits, int fraction_bits, double from, double to) {
  Plan plan;
  plan.integer_bits = integer_bits;
  plan.fraction_bits = fraction_bits;
  const Shader shader(plan);
  ShaderCounts counts;
  return mean(6000, [&](uint64_t i) {
    const double light =
        std::exp2(from + (to - from) * (static_cast<double>(i) + uniform(i, 1)) / 6000);
    return std::fabs(shader.radiance(shader.pixel(Rgb(light), counts)[0]) / light - 1);
  });
}

std::vector<SamplerPhoton> photons_of(const Plan& plan, uint64_t table) {
  std::vector<SamplerPhoton> photons(12);
  for (uint64_t i = 0; i < photons.size(); ++i)
    photons[i] = {{{static_cast<uint32_t>(256 + 255 * uniform(i, 100 + table)), 20, 30},
                   static_cast<uint32_t>(i % 4)},
                  oct_encode(direction(i, 200 + 2 * table), plan.direction_bits)};
  return photons;
}

// Half of the sum of |share of u's codes - w / W|: what part of the directions goes elsewhere.
double inversion_error(int u_bits) {
  Plan plan;
  plan.cell_bits = 1;
  plan.probability_bits = 6;
  plan.u_bits = u_bits;
  const CellGeometry geometry(plan.cell_bits);
  return mean(200, [&](uint64_t number) {
    const OctCode normal = oct_encode(direction(number, 10), plan.normal_bits);
    const SampleTable table = build_sample_table(plan, geometry, normal, photons_of(plan, number));
    // Cells never go back as u grows: the first code of each.
    std::vector<uint64_t> first(geometry.cells() + 1, uint64_t{1} << u_bits);
    for (size_t c = 0; c < geometry.cells(); ++c) {
      uint64_t below = 0, from = uint64_t{1} << u_bits;
      while (below < from) {
        const uint64_t u = below + (from - below) / 2;
        if (sample_cell(plan, table, u) < c)
          below = u + 1;
        else
          from = u;
      }
      first[c] = below;
    }
    double off = 0;
    for (size_t c = 0; c < geometry.cells(); ++c)
      off += std::fabs(std::ldexp(static_cast<double>(first[c + 1] - first[c]), -u_bits) -
                       static_cast<double>(table.weight(c)) / static_cast<double>(table.total()));
    return off / 2;
  });
}

// The angle between a direction and the centre of its code.
double code_error(int v_bits) {
  Plan plan;
  plan.cell_bits = 6;
  plan.v_bits = v_bits;
  const double codes = std::ldexp(1.0, plan.sample_direction_bits());
  return mean(4000, [&](uint64_t i) {
    const double u = codes * uniform(i, 20), v = codes * uniform(i, 21);
    const SampledCode code{1, {static_cast<uint32_t>(u), static_cast<uint32_t>(v)}};
    const Vec3 exact = sample_direction(plan, code, u - std::floor(u), v - std::floor(v));
    const Vec3 centre = sample_direction(plan, code, 0.5, 0.5);
    return std::atan2(glm::length(glm::cross(exact, centre)), glm::dot(exact, centre));
  });
}

// Half of the integral of |density of a table without photons - cos / pi|.
double cosine_error(int cell_bits) {
  Plan plan;
  plan.cell_bits = cell_bits;
  plan.probability_bits = 24;
  plan.normal_bits = 14;
  const CellGeometry geometry(cell_bits);
  const Vec3 normal = glm::normalize(Vec3(0.2, -0.3, 0.9));
  const SampleTable table =
      build_sample_table(plan, geometry, oct_encode(normal, plan.normal_bits), {});
  return 2 * kPi * mean(40000, [&](uint64_t i) {
           const Vec3 d = direction(i, 30);
           const OctCode cell = oct_encode(d, cell_bits);
           const double w =
               static_cast<double>(table.weight((size_t{cell.v} << cell_bits) + cell.u));
           double density = 0;
           if (w > 0)
             density =
                 1 / sample_inverse_pdf(plan, {w / static_cast<double>(table.total()), cell},
                                        d / (std::fabs(d.x) + std::fabs(d.y) + std::fabs(d.z)));
           return std::fabs(density - std::max(0.0, glm::dot(d, normal)) / kPi);
         });
}

// A record's weight at a turned normal, over all turns that it reaches.
double turn_error(int angle_bits) {
  Plan plan;
  plan.normal_bits = 14;
  plan.cache_weight_bits = 12;
  plan.cache_angle_bits = angle_bits;
  const double units = std::ldexp(0.5, plan.normal_bits);
  return std::sqrt(mean(20000, [&](uint64_t i) {
    // Normals whose tips are `apart` units away from each other.
    const double apart =
        std::min(2 * units, std::sqrt(uniform(i, 40)) * std::exp2(angle_bits / 2.0));
    const Vec3 n = direction(i, 41);
    const double half = std::asin(apart / units / 2);
    const Vec2 around = cos_sin_turns(uniform(i, 43));
    const Vec3 turned = Frame(n).to_world(
        Vec3(std::sin(2 * half) * around.x, std::sin(2 * half) * around.y, std::cos(2 * half)));
    const CacheRecord record{
        {0, 0, 0}, quantise_normal(plan, n), reciprocal(1 << 20, plan.cache_falloff_bits())};
    const uint32_t weight = cache_weight(plan, record, {0, 0, 0}, quantise_normal(plan, turned));
    const double due = 1 - std::ldexp(apart * apart, -angle_bits);
    return std::pow(std::ldexp(weight, -plan.cache_weight_bits) - due, 2);
  }));
}

// Whether the image of a small frame is another than with the planner's width.
double image_changes(const std::string& line, int bits) {
  const auto image = [](const std::vector<std::string>& set) {
    Scene s;
    oracle::add_room(s, oracle::add_diffuse(s, Rgb(0.5)), Vec3(0), Vec3(1, 2, 3)).radiance = Rgb(1);
    oracle::set_camera(s, Vec3(0.3, 0.4, 0.5), Vec3(1), Vec3(0, 1, 0), 90, 5, 3);
    FrameRequest r;
    r.photons = r.caustic_photons = 2000;
    r.k = 16;
    r.spp = 2;
    r.gather_rays = 4;
    r.set = set;
    const PreparedFrame frame =
        prepare_frame(std::make_unique<World>(s), r, Arithmetic::kGolden, nullptr);
    FrameUnits units = make_golden_units(frame.plan);
    FrameCounts counts;
    return pixel_sha256(render_frame(frame.input(Arithmetic::kGolden), units, counts));
  };
  // What lets every width be, and be read.
  std::vector<std::string> set;
  if (line == "gatherer.beat_bits") set = {"photon.bucket=16", "photon.photon_bytes=32"};
  if (line == "reorder.cell_bits") set = {"reorder.bins=8"};
  if (line == "frame.direction_bin_bits") set = {"frame.order=direction_bins"};
  const std::string usual = image(set);
  set.push_back(fmt::format("{}={}", line, bits));
  return image(set) == usual ? 0 : 1;
}

StabilityCurve unchanged(const std::string& line, int least, int greatest) {
  StabilityCurve c{line, "whether the image of a frame is another", {}};
  // A beat is a power of two.
  const bool doubles = line == "gatherer.beat_bits";
  for (int b = least; b <= greatest; b = doubles ? 2 * b : b + 1)
    c.points.push_back({b, image_changes(line, b)});
  return c;
}

struct Range {
  std::string line;
  int least, greatest;
};

// The lines of the plan that are a number of bits.
std::vector<Range> width_lines() {
  std::vector<Range> lines;
  Plan plan;
  Plan::visit(plan, [&](const std::string& section, const std::string& key, auto&, auto least,
                        auto greatest, const char*) {
    if (key.size() > 5 && key.substr(key.size() - 5) == "_bits")
      lines.push_back({section + "." + key, static_cast<int>(least), static_cast<int>(greatest)});
  });
  // What check_plan says beyond a line's own range.
  for (Range& r : lines) {
    if (r.line == "gather.reciprocal_bits") r.least = 8;        // or 0, for none
    if (r.line == "cache.angle_bits") r.greatest = 2 * 14 + 2;  // 2 gather.normal_bits + 2
  }
  return lines;
}

}  // namespace

std::vector<StabilityCurve> width_curves() {
  std::map<std::string, StabilityCurve> made;
  for (StabilityCurve& c : stability_curves()) made[c.line] = std::move(c);
  for (const StabilityCurve& c : {
           curve("photon.exponent_bits", "power, mean of relative errors over 60 octaves", 1, 5,
                 power_error),
           curve("pixel.integer_bits", "light, mean of relative errors from 1 to 2^120", 1, 96,
                 [](int b) { return pixel_error(b, 28, 0, 120); }),
           curve("pixel.fraction_bits", "light, mean of relative errors from 2^27 to 2^-120", -64,
                 96, [](int b) { return pixel_error(std::min(96, 124 - b), b, 27, -120); }),
           curve("sampler.u_bits", "part of the directions that goes to other cells", 16, 48,
                 inversion_error),
           curve("sampler.v_bits", "direction, mean angle to its code", 1, 12, code_error),
           curve("sampler.cell_bits", "part of the cosine that goes elsewhere", 1, 6, cosine_error),
           curve("cache.angle_bits", "weight of a record by the turn, root mean square", 0, 30,
                 turn_error),
       })
    made[c.line] = c;
  std::vector<StabilityCurve> curves;
  for (const Range& r : width_lines()) {
    if (const auto found = made.find(r.line); found != made.end())
      curves.push_back(found->second);
    else if (r.line == "gatherer.beat_bits" || r.line == "reorder.cell_bits" ||
             r.line == "frame.direction_bin_bits")
      curves.push_back(unchanged(r.line, r.least, r.greatest));
  }
  return curves;
}

std::vector<std::string> missing_widths(const std::vector<StabilityCurve>& curves) {
  std::vector<std::string> missing;
  for (const Range& r : width_lines()) {
    const auto found = std::find_if(curves.begin(), curves.end(),
                                    [&](const StabilityCurve& c) { return c.line == r.line; });
    if (found == curves.end() || found->points.empty())
      missing.push_back(r.line + " has no curve");
    else if (found->points.front().bits != r.least || found->points.back().bits != r.greatest)
      missing.push_back(fmt::format("{} goes from {} to {} bits, its curve from {} to {}", r.line,
                                    r.least, r.greatest, found->points.front().bits,
                                    found->points.back().bits));
  }
  return missing;
}

bool curve_fault_works() {
  const auto fault = [](const std::vector<double>& errors) {
    StabilityCurve c{"line", "error", {}};
    for (const double e : errors) c.points.push_back({static_cast<int>(c.points.size()), e});
    return !curve_fault(c).empty();
  };
  return !fault({1, 0.5, 0.3, 0.1, 0.09, 0.1}) && !fault({0, 0, 0}) && fault({0.1, 0.2, 0.01}) &&
         fault({0.5, 0.2, 0.1, 0.3}) && fault({1, 0.02, 0.01, 0.01}) &&
         fault({0.04, 0.03, 0.02, 0.001}) && fault({0, 0, 1}) && fault({1, std::nan(""), 0.1});
}

bool changes_nothing(const StabilityCurve& c) {
  return std::all_of(c.points.begin(), c.points.end(),
                     [](const StabilityPoint& p) { return p.error == 0; });
}

}  // namespace photonloom::extremes
