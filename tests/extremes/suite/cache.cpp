// SPDX-License-Identifier: Apache-2.0
// The irradiance cache at its ends.
#include <algorithm>
#include <cmath>

#include "golden/numeric/random.hpp"
#include "golden/unit/irradiance_cache.hpp"
#include "tests/extremes/suite/suite.hpp"

namespace photonloom::extremes {
namespace {

using In = std::vector<CacheLookup>;
using Out = std::vector<CacheResult>;

Plan usual_cache() {
  Plan plan;
  plan.cache_present = true;
  plan.cache_records = 32;
  plan.cache_hits = 4;
  return plan;
}

Plan least_cache() {
  Plan plan = usual_cache();
  plan.position_bits = 4;
  plan.normal_bits = 2;
  plan.cache_records = plan.cache_hits = 1;
  plan.cache_angle_bits = 0;
  plan.cache_weight_bits = 4;
  return plan;
}

Plan greatest_cache() {
  Plan plan = usual_cache();
  plan.position_bits = 24;
  plan.normal_bits = 14;
  plan.photon_bytes = 32;
  plan.cache_records = 4096;
  plan.cache_hits = 8;
  plan.cache_angle_bits = 30;
  plan.cache_weight_bits = 12;
  return plan;
}

// A lookup with the reach of a record in position units.
CacheLookup lookup(const Plan& plan, const UVec3& position, double reach, bool insert = true,
                   const Vec3& normal = Vec3(0, 0, 1), ClampCounts* counts = nullptr) {
  CacheLookup l{};
  l.position = position;
  l.normal = quantise_normal(plan, normal);
  l.insert = insert;
  Plan wide = plan;  // reach = accuracy * radius, no limit on it
  wide.cache_accuracy = 1;
  wide.cache_radius_min = 0;
  wide.cache_radius_max = 1e6;
  const Reciprocal falloff = cache_falloff(wide, reach * plan.position_unit(), counts);
  l.falloff = falloff.mantissa;
  l.falloff_exponent = falloff.exponent;
  return l;
}

UVec3 at(uint32_t x, uint32_t y = 9, uint32_t z = 9) { return {x, y, z}; }

// 2^B (1 - d^2 / reach^2 - n^2 / 2^angle) in double; golden is above it by less than three units.
double ideal(const Plan& plan, double d2, double reach, double n2) {
  const double w = std::ldexp(1.0, plan.cache_weight_bits) *
                   (1 - d2 / (reach * reach) - std::ldexp(n2, -plan.cache_angle_bits));
  return std::max(0.0, w);
}

}  // namespace

Group cache_cases() {
  std::vector<Case> cases{
      {"an empty tile", Known::kDefinition, "no record, no weight; the point becomes record 0",
       [](Run& run) {
         const Out out =
             run.process<IrradianceCache>(usual_cache(), {lookup(usual_cache(), at(5), 10)});
         run.exact("count", 0, out.at(0).count);
         run.exact("inserted", 1, out.at(0).inserted);
         run.exact("number", 0, out.at(0).number);
       }},
      {"a look without insert", Known::kDefinition, "nothing is found and nothing is kept",
       [](Run& run) {
         const Out out = run.process<IrradianceCache>(
             usual_cache(),
             {lookup(usual_cache(), at(5), 10, false), lookup(usual_cache(), at(5), 10, false)});
         run.exact("count", 0, out.at(1).count);
         run.exact("inserted", 0, out.at(1).inserted);
       }},
      {"a point on its record", Known::kClosedForm, "d = 0, n = 0: the whole weight 2^8",
       [](Run& run) {
         const Out out = run.process<IrradianceCache>(
             usual_cache(), {lookup(usual_cache(), at(5), 10), lookup(usual_cache(), at(5), 10)});
         run.exact("weight", 256, out.at(1).weight[0]);
         run.exact("inserted", 0, out.at(1).inserted);
       }},
      {"a point at the reach", Known::kClosedForm, "d = reach = 8: the weight is 0, a new record",
       [](Run& run) {
         const Out out = run.process<IrradianceCache>(
             usual_cache(), {lookup(usual_cache(), at(5), 8), lookup(usual_cache(), at(13), 8)});
         run.exact("count", 0, out.at(1).count);
         run.exact("number", 1, out.at(1).number);
       }},
      {"a point one unit within the reach", Known::kClosedForm,
       "256 (1 - 49/64) = 60, rounded up by less than three units",
       [](Run& run) {
         const Out out = run.process<IrradianceCache>(
             usual_cache(), {lookup(usual_cache(), at(5), 8), lookup(usual_cache(), at(12), 8)});
         run.near("weight", 60 + 1.5, out.at(1).weight[0], 1.5);
       }},
      {"a reach below one position unit", Known::kSaturation,
       "the squared reach is at least 1, counted in `clamped_reaches`: the same unit is covered "
       "wholly, the next is not",
       [](Run& run) {
         ClampCounts counts;
         const auto tiny = [&](uint32_t x) {
           return lookup(usual_cache(), at(x), 1e-9, true, Vec3(0, 0, 1), &counts);
         };
         const Out out = run.process<IrradianceCache>(usual_cache(), {tiny(5), tiny(5), tiny(6)});
         run.counted("clamped reaches", 3, counts.reaches);
         lookup(usual_cache(), at(5), 1, true, Vec3(0, 0, 1), &counts);
         run.counted("and of a reach of 1", 3, counts.reaches);
         run.exact("weight", 256, out.at(1).weight[0]);
         run.exact("count", 0, out.at(2).count);
       }},
      {"a radius of zero and an endless one", Known::kSaturation,
       "they are kept within radius_min and radius_max of the plan, counted in `clamped_radii`",
       [](Run& run) {
         Plan plan = usual_cache();
         plan.cache_radius_min = 0.01;
         plan.cache_radius_max = 0.02;
         ClampCounts counts;
         const auto same = [&](double a, double b) {
           return cache_falloff(plan, a, &counts) == cache_falloff(plan, b, &counts);
         };
         run.holds("least", same(0, 0.01 * plan.extent));
         run.holds("greatest",
                   same(1e300, 0.02 * plan.extent) && same(HUGE_VAL, 0.02 * plan.extent));
         run.counted("clamped radii", 3, counts.radii);
         run.counted("clamped reaches", 0, counts.reaches);
       }},
      {"the widest reach", Known::kSaturation,
       "its square is at most 2^33 - 1 of 34 bits, counted in `clamped_reaches`: a point in the "
       "opposite corner, 3 (2^16 - 1)^2, is not covered, one at half of the edges is",
       [](Run& run) {
         const Plan plan = usual_cache();
         ClampCounts counts;
         const CacheLookup record = lookup(plan, {0, 0, 0}, 1e9, true, Vec3(0, 0, 1), &counts);
         run.counted("clamped reaches", 1, counts.reaches);
         const Out out = run.process<IrradianceCache>(
             plan, {record, lookup(plan, {65535, 65535, 65535}, 1, false),
                    lookup(plan, {32768, 32768, 32768}, 1, false)});
         run.exact("count", 0, out.at(1).count);
         run.near("weight",
                  ideal(plan, 3 * std::ldexp(1.0, 30), std::sqrt(std::ldexp(1.0, 33)), 0) + 1.5,
                  out.at(2).weight[0], 1.5);
       }},
      {"opposite normals", Known::kClosedForm, "n^2 = 2^(2 * 8 - 0) and more: no weight",
       [](Run& run) {
         const Out out = run.process<IrradianceCache>(
             usual_cache(), {lookup(usual_cache(), at(5), 100),
                             lookup(usual_cache(), at(5), 100, false, Vec3(0, 0, -1))});
         run.exact("count", 0, out.at(1).count);
       }},
      {"normals on the axes and a hair beside", Known::kClosedForm,
       "2^8 (1 - n^2 / 2^11) of the quantised normals, rounded up by less than three units",
       [](Run& run) {
         const Plan plan = usual_cache();
         for (int axis = 0; axis < 3; ++axis)
           for (const double sign : {-1.0, 1.0}) {
             Vec3 n(0);
             n[axis] = sign;
             Vec3 turned = n;
             turned[(axis + 1) % 3] = 0.1;
             turned = glm::normalize(turned);
             const Out out = run.process<IrradianceCache>(
                 plan,
                 {lookup(plan, at(5), 100, true, n), lookup(plan, at(5), 100, false, turned)});
             const UVec3 a = quantise_normal(plan, n), b = quantise_normal(plan, turned);
             double n2 = 0;
             for (size_t c = 0; c < 3; ++c) n2 += std::pow(double(a[c]) - double(b[c]), 2);
             run.near("weight", ideal(plan, 0, 100, n2) + 1.5, out.at(1).weight[0], 1.5);
           }
       }},
      {"a full tile", Known::kSaturation,
       "record number 33 of 32 does not become one: flag `full`, and the answer stays empty",
       [](Run& run) {
         const Plan plan = usual_cache();
         In in;
         for (uint32_t i = 0; i < 34; ++i) in.push_back(lookup(plan, at(10 * i), 2));
         const Out out = run.process<IrradianceCache>(plan, in);
         run.counted("full", 0, out.at(31).full);
         run.counted("full", 1, out.at(32).full);
         run.exact("inserted", 0, out.at(33).inserted);
         run.exact("count", 0, out.at(33).count);
       }},
      {"more records than places in an answer", Known::kDefinition,
       "8 records cover the point: the 4 heaviest, heaviest first",
       [](Run& run) {
         const Plan plan = usual_cache();
         In in;
         // 100 apart so that none covers another, with reaches that all cover the middle.
         for (uint32_t i = 0; i < 8; ++i) in.push_back(lookup(plan, at(1000 + 100 * i), 99));
         for (uint32_t i = 0; i < 8; ++i) {  // reaches are the records' own: make them wide
           const CacheLookup wide = lookup(plan, at(0), 5000);
           in[i].falloff = wide.falloff;
           in[i].falloff_exponent = wide.falloff_exponent;
           in[i].normal[0] = static_cast<uint32_t>(60 * (i % 4));  // turned away from each other
           in[i].normal[1] = static_cast<uint32_t>(60 * (i / 4));
         }
         in.push_back(lookup(plan, at(1350), 1, false));
         in.back().normal = in[1].normal;
         const Out out = run.process<IrradianceCache>(plan, in);
         uint64_t inserted = 0;
         for (const CacheResult& r : out) inserted += r.inserted;
         run.exact("records", 8, inserted);
         run.exact("heaviest", 1, out.back().record[0]);
         for (uint32_t i = 1; i < out.back().count; ++i)
           run.holds("in order", out.back().weight[i - 1] >= out.back().weight[i]);
       }},
      {"records of equal weight", Known::kDefinition, "the earlier ones, in their order",
       [](Run& run) {
         const Plan plan = usual_cache();
         const In in{lookup(plan, at(10), 12), lookup(plan, at(30), 12),
                     lookup(plan, at(20, 19), 12), lookup(plan, at(20, 9, 19), 12),
                     lookup(plan, at(20), 1, false)};
         const Out out = run.process<IrradianceCache>(plan, in);
         run.exact("count", 4, out.back().count);
         for (uint32_t i = 0; i < 4; ++i) run.exact("record", i, out.back().record[i]);
       }},
      {"clear on every lookup", Known::kDefinition,
       "each is the first of its tile: record 0 each time",
       [](Run& run) {
         const Plan plan = usual_cache();
         In in(50, lookup(plan, at(5), 10));
         for (CacheLookup& l : in) l.clear = 1;
         for (const CacheResult& r : run.process<IrradianceCache>(plan, in)) {
           run.exact("inserted", 1, r.inserted);
           run.exact("number", 0, r.number);
         }
       }},
      {"100,000 lookups of one point", Known::kClosedForm, "one record, 99,999 whole weights",
       [](Run& run) {
         const Plan plan = usual_cache();
         const Out out = run.process<IrradianceCache>(plan, In(100000, lookup(plan, at(5), 10)));
         uint64_t whole = 0;
         for (const CacheResult& r : out) whole += r.count == 1 && r.weight[0] == 256;
         run.exact("whole weights", 99999, whole);
       }},
      {"position_bits = 4, normal_bits = 2, 1 record, angle_bits = 0, weight_bits = 4",
       Known::kClosedForm,
       "any turn of the normal ends a record; 2^4 on it; the second finds it full",
       [](Run& run) {
         const Plan plan = least_cache();
         const Out out = run.process<IrradianceCache>(
             plan, {lookup(plan, at(5), 3), lookup(plan, at(5), 3),
                    lookup(plan, at(5), 3, true, Vec3(1, 0, 0)), lookup(plan, at(15, 0, 0), 3)});
         run.exact("weight", 16, out.at(1).weight[0]);
         run.exact("count", 0, out.at(2).count);
         run.exact("full", 1, out.at(2).full);
         run.exact("full", 1, out.at(3).full);
       }},
      {"position_bits = 24, normal_bits = 14, angle_bits = 30, weight_bits = 12",
       Known::kClosedForm,
       "2^12 (1 - d^2 / reach^2 - n^2 / 2^30) over the whole cube, rounded up by less than three "
       "units",
       [](Run& run) {
         const Plan plan = greatest_cache();
         const uint32_t reach = 12000000;
         In in{lookup(plan, {0, 0, 0}, reach)};
         std::vector<double> due;
         for (uint32_t i = 1; i < 40; ++i) {
           const uint32_t d = i * 300007;
           in.push_back(lookup(plan, {d, 0, 0}, 1, false, glm::normalize(Vec3(0.3, 0, 1))));
           const UVec3 a = in[0].normal, b = in.back().normal;
           double n2 = 0;
           for (size_t c = 0; c < 3; ++c) n2 += std::pow(double(a[c]) - double(b[c]), 2);
           due.push_back(ideal(plan, double(d) * d, reach, n2));
         }
         const Out out = run.process<IrradianceCache>(plan, in);
         for (size_t i = 0; i < due.size(); ++i)
           run.near("weight", due[i] > 0 ? due[i] + 1.5 : 0, out.at(i + 1).weight[0],
                    due[i] > 0 ? 1.5 : 3);
       }},
      {"4,096 records in a tile", Known::kClosedForm,
       "none covers another: all become records, then `full`",
       [](Run& run) {
         const Plan plan = greatest_cache();
         In in;
         for (uint32_t i = 0; i < 4100; ++i) in.push_back(lookup(plan, at(4000 * i), 5));
         const Out out = run.process<IrradianceCache>(plan, in);
         run.exact("number", 4095, out.at(4095).number);
         run.exact("full", 1, out.at(4096).full);
       }},
      {"angle_bits beyond the normals", Known::kRefusal,
       "squared distances of normals end below 2^18",
       [](Run& run) {
         Plan plan = usual_cache();
         plan.cache_angle_bits = 19;
         run.refused("cache.angle_bits is 19", [&] { run.process<IrradianceCache>(plan, {}); });
       }},
      {"a least radius above the greatest", Known::kRefusal, "no radius lies between them",
       [](Run& run) {
         Plan plan = usual_cache();
         plan.cache_radius_min = 0.3;
         run.refused("cache.radius_min is 0.3", [&] { run.process<IrradianceCache>(plan, {}); });
       }},
  };
  return {"irradiance_cache",
          "Plans: 32 records and 4 hits; every line at its least; every line at its greatest.",
          std::move(cases)};
}

}  // namespace photonloom::extremes
