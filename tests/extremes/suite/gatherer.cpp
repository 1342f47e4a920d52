// SPDX-License-Identifier: Apache-2.0
// The photon gatherer at its ends. Three plans, so that three models are built.
#include <algorithm>
#include <cmath>

#include "golden/numeric/random.hpp"
#include "golden/plan/quantiser.hpp"
#include "tests/extremes/suite/suite.hpp"

namespace photonloom::extremes {
namespace {

using Photons = std::vector<PackedPhoton>;
using Queries = std::vector<GatherQuery>;

// The formats of most frames, with room for a million photons.
Plan usual_gatherer() {
  Plan plan;
  plan.k = 16;
  plan.global = {.present = true, .photons = 1000000};
  plan.global.r2_max = plan.caustic.r2_max = plan.r2_limit();
  return plan;
}

// Every width and count at its least; the floor of r^2 at its greatest.
Plan least_gatherer() {
  Plan plan;
  plan.position_bits = 4;
  plan.direction_bits = plan.normal_bits = plan.mantissa_bits = 2;
  plan.exponent_bits = 1;
  plan.channels = 1;
  plan.bucket = 2;
  plan.photon_bytes = 8;
  plan.k = 1;
  plan.global = {.present = true, .photons = 64};
  plan.reciprocal_bits = 8;
  plan.contexts = plan.lanes = plan.cache_ways = plan.cache_misses = 1;
  plan.cache_bytes = 16;
  plan.width = plan.height = plan.spp = 1;
  plan.gather_rays = 0;
  plan.global.r2_max = plan.caustic.r2_max = plan.r2_limit();
  plan.r2_floor = plan.r2_limit();
  return plan;
}

// Every width of a format at its greatest, k and the bucket too.
Plan greatest_gatherer() {
  Plan plan;
  plan.position_bits = 24;
  plan.direction_bits = plan.normal_bits = 14;
  plan.mantissa_bits = 16;
  plan.exponent_bits = 5;
  plan.bucket = 16;
  plan.photon_bytes = 32;
  plan.beat_bits = 4096;
  plan.lanes = 16;
  plan.contexts = 4;
  plan.cache_bytes = 8192;
  plan.k = 256;
  plan.reciprocal_bits = 24;
  plan.global = {.present = true, .photons = 4096};
  plan.global.r2_max = plan.caustic.r2_max = plan.r2_limit();
  return plan;
}

UVec3 corner(const Plan& plan, unsigned which) {
  const auto top = static_cast<uint32_t>(ones(plan.position_bits));
  return {which & 1 ? top : 0, which & 2 ? top : 0, which & 4 ? top : 0};
}

UVec3 middle(const Plan& plan) {
  const uint32_t m = 1u << (plan.position_bits - 1);
  return {m, m, m};
}

// A photon that comes from above, with the power 1 * 2^0 in each channel.
PackedPhoton photon(const Plan& plan, const UVec3& position, uint32_t mantissa = 1,
                    uint32_t exponent = 0, const Vec3& direction = Vec3(0, 0, 1)) {
  PackedPhoton p{};
  p.position = position;
  for (int c = 0; c < plan.channels; ++c) p.power.mantissa[static_cast<size_t>(c)] = mantissa;
  p.power.exponent = exponent;
  p.direction = oct_encode(direction, plan.direction_bits);
  return p;
}

GatherQuery query(const Plan& plan, const UVec3& position, const Vec3& normal = Vec3(0, 0, 1)) {
  GatherQuery q{};
  q.position = position;
  const OctCode code = oct_encode(normal, plan.normal_bits);
  q.normal = {code.u, code.v};
  q.want_photons = 1;
  return q;
}

UVec3 plus(UVec3 p, int axis, uint32_t d) {
  p[static_cast<size_t>(axis)] += d;
  return p;
}

// d^2 by the definition, in double: exact below 2^53.
double distance2(const UVec3& a, const UVec3& b) {
  double sum = 0;
  for (size_t c = 0; c < 3; ++c) {
    const double d = static_cast<double>(a[c]) - static_cast<double>(b[c]);
    sum += d * d;
  }
  return sum;
}

// The k photons that a look at every photon of the map finds; all face the query here.
struct Nearest {
  std::vector<uint32_t> indices;
  double r2 = 0;
  long double flux = 0;  // first channel
};
Nearest look_at_all(const Plan& plan, const PhotonMap& map, const UVec3& at) {
  std::vector<std::pair<double, uint32_t>> list;
  for (uint64_t i = 0; i < map.count; ++i) {
    const double d2 = distance2(map.slots[i].position, at);
    if (d2 <= static_cast<double>(plan.global.r2_max)) list.push_back({d2, uint32_t(i)});
  }
  const size_t n = std::min(list.size(), static_cast<size_t>(plan.k));
  std::partial_sort(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(n), list.end());
  Nearest nearest;
  for (size_t i = 0; i < n; ++i) {
    nearest.indices.push_back(list[i].second);
    const PowerCode& power = map.slots[list[i].second].power;
    nearest.flux +=
        std::ldexp(static_cast<long double>(power.mantissa[0]), static_cast<int>(power.exponent));
    nearest.r2 = list[i].first;
  }
  if (n < static_cast<size_t>(plan.k)) nearest.r2 = static_cast<double>(plan.global.r2_max);
  return nearest;
}

std::vector<uint32_t> indices(std::span<const GatherPhoton> photons) {
  std::vector<uint32_t> list;
  for (const GatherPhoton& p : photons) list.push_back(p.index);
  return list;
}

// Golden's answers beside a look at every photon.
void check_all(Run& run, const Plan& plan, const Run::Gathered& found, const Queries& queries) {
  size_t at = 0;
  for (size_t i = 0; i < queries.size(); ++i) {
    const Nearest due = look_at_all(plan, found.map, queries[i].position);
    const GatherResult& r = found.results[i];
    run.exact("count", due.indices.size(), r.count);
    run.exact("r2", static_cast<uint64_t>(due.r2), r.r2);
    run.exact("flux", static_cast<uint64_t>(due.flux), r.flux[0]);
    run.same("photons", due.indices, indices(std::span(found.photons).subspan(at, r.count)));
    at += r.count;
  }
}

// One query, its one answer.
struct One {
  GatherResult result;
  std::vector<GatherPhoton> photons;
};
One ask(Run& run, const Plan& plan, const Photons& photons, const GatherQuery& q) {
  const Run::Gathered found = run.gather(plan, photons, {q});
  return {found.results.at(0), found.photons};
}

uint32_t hashed(uint64_t i, uint64_t dimension, int bits) {
  return static_cast<uint32_t>(hash_bits(19, i, 0, dimension) >> (64 - bits));
}

Photons uniform(const Plan& plan, uint64_t n) {
  Photons photons;
  for (uint64_t i = 0; i < n; ++i)
    photons.push_back(photon(plan,
                             {hashed(i, 0, plan.position_bits), hashed(i, 1, plan.position_bits),
                              hashed(i, 2, plan.position_bits)},
                             1 + hashed(i, 3, plan.mantissa_bits) % 200, hashed(i, 4, 4)));
  return photons;
}

Queries anywhere(const Plan& plan, uint64_t n) {
  Queries queries;
  for (uint64_t i = 0; i < n; ++i)
    queries.push_back(
        query(plan, {hashed(i, 5, plan.position_bits), hashed(i, 6, plan.position_bits),
                     hashed(i, 7, plan.position_bits)}));
  return queries;
}

// 81 photons in a row, 10 units apart along `step`, the query on the one in the middle.
Case row_of_photons(const char* name, const UVec3& step, const char* where) {
  return {name, Known::kClosedForm,
          std::string("photons 10 units apart on ") + where +
              ": of k = 16 one is at 0, 14 in pairs up to 7 steps, and of the pair at 8 steps one: "
              "r2 = (8 steps)^2",
          [step](Run& run) {
            const Plan plan = usual_gatherer();
            Photons photons;
            for (uint32_t i = 0; i < 81; ++i)
              photons.push_back(
                  photon(plan, {20000 + i * step[0], 20000 + i * step[1], 20000 + i * step[2]}));
            const GatherQuery q =
                query(plan, {20000 + 40 * step[0], 20000 + 40 * step[1], 20000 + 40 * step[2]});
            const One one = ask(run, plan, photons, q);
            const uint64_t step2 = uint64_t{step[0]} * step[0] + uint64_t{step[1]} * step[1] +
                                   uint64_t{step[2]} * step[2];
            run.exact("r2", 64 * step2, one.result.r2);
            run.exact("count", 16, one.result.count);
          }};
}

// A lattice around the query: the k-th distance follows from how many points lie on each sphere.
Case lattice(const char* name, int dimensions, uint32_t k_step2, const char* why) {
  return {name, Known::kClosedForm, why, [dimensions, k_step2](Run& run) {
            const Plan plan = usual_gatherer();
            const uint32_t step = 100;
            Photons photons;
            for (uint32_t x = 0; x < 9; ++x)
              for (uint32_t y = 0; y < 9; ++y)
                for (uint32_t z = 0; z < (dimensions == 3 ? 9u : 1u); ++z)
                  photons.push_back(
                      photon(plan, {30000 + x * step, 30000 + y * step, 30000 + z * step}));
            const Queries queries{query(plan, {30400, 30400, dimensions == 3 ? 30400u : 30000u})};
            const Run::Gathered found = run.gather(plan, photons, queries);
            run.exact("r2", uint64_t{k_step2} * step * step, found.results[0].r2);
            check_all(run, plan, found, queries);
          }};
}

// Photons from all six axes on a surface that faces one of them.
Case axis_case(int axis, bool negative) {
  static const char* const names[] = {"x", "y", "z"};
  const std::string normal = std::string(negative ? "-" : "+") + names[axis];
  return {"normal " + normal, Known::kClosedForm,
          "light along " + normal + " counts, light from the other side does not",
          [axis, negative](Run& run) {
            const Plan plan = usual_gatherer();
            Vec3 n(0);
            n[axis] = negative ? -1 : 1;
            const Photons photons{photon(plan, middle(plan), 5, 0, n),
                                  photon(plan, middle(plan), 7, 0, -n)};
            const One one = ask(run, plan, photons, query(plan, middle(plan), n));
            run.exact("flux", 5, one.result.flux[0]);
            run.exact("count", 1, one.result.count);
          }};
}

// A photon of every code of a set on a surface of every normal of a set: o . o > 0 and nothing
// else.
void facing(Run& run, const Plan& plan, const std::vector<OctCode>& directions,
            const std::vector<OctCode>& normals) {
  Photons photons;
  for (const OctCode& d : directions) {
    photons.push_back(photon(plan, middle(plan)));
    photons.back().direction = d;
  }
  Queries queries;
  for (const OctCode& n : normals) {
    queries.push_back(query(plan, middle(plan)));
    queries.back().normal = {n.u, n.v};
  }
  const Run::Gathered found = run.gather(plan, photons, queries);
  const auto decode = [](const OctCode& c, int b) {
    // The page's definition in double: the centre of the cell, unfolded, times 2^b.
    const double cells = std::ldexp(1.0, b);
    return oct_unfold((2 * c.u + 1) / cells - 1, (2 * c.v + 1) / cells - 1) * cells;
  };
  for (size_t i = 0; i < normals.size(); ++i) {
    const Vec3 n = decode(normals[i], plan.normal_bits);
    uint64_t due = 0;
    for (const OctCode& d : directions)
      due += glm::dot(decode(d, plan.direction_bits), n) > 0;  // integers in double: exact
    run.exact("count", std::min<uint64_t>(due, static_cast<uint64_t>(plan.k)),
              found.results[i].count);
  }
}

std::vector<OctCode> edge_codes(int b) {
  const auto top = static_cast<uint32_t>(ones(b));
  std::vector<OctCode> codes;
  for (const uint32_t i : {0u, top / 3, top / 2, top / 2 + 1, top})
    for (const OctCode& c : {OctCode{i, 0}, OctCode{i, top}, OctCode{0, i}, OctCode{top, i}})
      codes.push_back(c);
  return codes;
}

std::vector<OctCode> seam_codes(int b) {
  const auto cells = uint32_t{1} << b;
  std::vector<OctCode> codes;  // along |x| + |y| = 1 and across both middles
  for (uint32_t i = 0; i < cells / 2; i += std::max(1u, cells / 16)) {
    codes.push_back({i, cells / 2 - 1 - i});
    codes.push_back({cells / 2 + i, i});
    codes.push_back({cells / 2 - 1, i});
    codes.push_back({cells / 2, i});
  }
  return codes;
}

}  // namespace

Group gatherer_cases() {
  std::vector<Case> cases{
      {"no photon", Known::kDefinition, "an empty map answers n = 0, flux 0, r2 = r2_max, not full",
       [](Run& run) {
         const One one =
             ask(run, usual_gatherer(), {}, query(usual_gatherer(), middle(usual_gatherer())));
         run.exact("count", 0, one.result.count);
         run.exact("flux", 0, one.result.flux[0]);
         run.exact("r2", usual_gatherer().r2_limit(), one.result.r2);
         run.exact("full", 0, one.result.full);
       }},
      {"one photon, at the query", Known::kClosedForm,
       "n = 1 of k = 16: its power is the flux, r2 stays r2_max",
       [](Run& run) {
         const Plan plan = usual_gatherer();
         const One one =
             ask(run, plan, {photon(plan, middle(plan), 300, 9)}, query(plan, middle(plan)));
         run.exact("flux", 300u << 9, one.result.flux[0]);
         run.exact("r2", plan.r2_limit(), one.result.r2);
         run.exact("full", 0, one.result.full);
       }},
      {"one photon, in the opposite corner", Known::kClosedForm,
       "without a radius it is found from each of the 8 corners, d2 = 3 (2^16 - 1)^2",
       [](Run& run) {
         const Plan plan = usual_gatherer();
         for (unsigned c = 0; c < 8; ++c) {
           const One one =
               ask(run, plan, {photon(plan, corner(plan, 7 - c))}, query(plan, corner(plan, c)));
           run.exact("d2", 3 * ones(16) * ones(16), one.photons.at(0).d2);
           run.exact("count", 1, one.result.count);
         }
       }},
      {"1,000,000 photons", Known::kReference,
       "for 20 queries the k photons, their order and their sum are those of a look at all in "
       "double",
       [](Run& run) {
         const Plan plan = usual_gatherer();
         const Queries queries = anywhere(plan, 20);
         check_all(run, plan, run.gather(plan, uniform(plan, 1000000), queries), queries);
       },
       true},
      {"1,000,000 coincident photons", Known::kClosedForm,
       "all tie at d2 = 0: the indices 0 to 15 win, r2 = 0 is below the floor and flagged "
       "`clamped`",
       [](Run& run) {
         const Plan plan = usual_gatherer();
         const One one = ask(run, plan, Photons(1000000, photon(plan, middle(plan), 3)),
                             query(plan, middle(plan)));
         std::vector<uint32_t> first(16);
         for (uint32_t i = 0; i < 16; ++i) first[i] = i;
         run.same("indices", first, indices(one.photons));
         run.exact("flux", 48, one.result.flux[0]);
         run.exact("r2", 0, one.result.r2);
         run.counted("clamped", 1, one.result.clamped);
       },
       true},
      {"1,000,000 equal powers", Known::kClosedForm, "16 times one power, exactly, wherever asked",
       [](Run& run) {
         const Plan plan = usual_gatherer();
         Photons photons = uniform(plan, 1000000);
         for (PackedPhoton& p : photons) p.power = {{511, 256, 1}, 31};
         for (const GatherResult& r : run.gather(plan, photons, anywhere(plan, 10)).results) {
           run.exact("flux", (uint64_t{16 * 511} << 31), r.flux[0]);
           run.exact("flux", (uint64_t{16} << 31), r.flux[2]);
         }
       },
       true},
      {"coincident photons, query on them", Known::kSaturation,
       "r2 = 0 < r2_floor = 1: flag `clamped`, the reciprocal is that of the floor, 2^W * 2^-W",
       [](Run& run) {
         const Plan plan = usual_gatherer();
         const One one =
             ask(run, plan, Photons(40, photon(plan, middle(plan))), query(plan, middle(plan)));
         run.counted("clamped", 1, one.result.clamped);
         run.exact("reciprocal", 1u << 18, one.result.reciprocal);
         run.exact("exponent", 0, one.result.reciprocal_exponent);
       }},
      {"coincident photons, query one unit away", Known::kClosedForm,
       "r2 = 1 is the floor and not below it: not clamped",
       [](Run& run) {
         const Plan plan = usual_gatherer();
         const One one = ask(run, plan, Photons(40, photon(plan, middle(plan))),
                             query(plan, plus(middle(plan), 1, 1)));
         run.exact("r2", 1, one.result.r2);
         run.counted("clamped", 0, one.result.clamped);
       }},
      {"k above the number of photons", Known::kClosedForm,
       "15 photons for k = 16: all of them, r2 = r2_max, not full",
       [](Run& run) {
         const Plan plan = usual_gatherer();
         Photons photons;
         for (uint32_t i = 0; i < 15; ++i) photons.push_back(photon(plan, {i, i, i}, 1 + i));
         const One one = ask(run, plan, photons, query(plan, corner(plan, 7)));
         run.exact("count", 15, one.result.count);
         run.exact("flux", 15 * 16 / 2, one.result.flux[0]);
         run.exact("r2", plan.r2_limit(), one.result.r2);
         run.exact("full", 0, one.result.full);
       }},
      {"k equal to the number of photons", Known::kClosedForm,
       "16 photons in a row from the query: full, r2 = 15^2",
       [](Run& run) {
         const Plan plan = usual_gatherer();
         Photons photons;
         for (uint32_t i = 0; i < 16; ++i) photons.push_back(photon(plan, {i, 0, 0}));
         const One one = ask(run, plan, photons, query(plan, {0, 0, 0}));
         run.exact("full", 1, one.result.full);
         run.exact("r2", 225, one.result.r2);
       }},
      {"k one below the number of photons", Known::kClosedForm,
       "of 17 photons in a row the farthest is left out: r2 = 15^2, flux 16",
       [](Run& run) {
         const Plan plan = usual_gatherer();
         Photons photons;
         for (uint32_t i = 0; i < 17; ++i) photons.push_back(photon(plan, {0, 0, i}));
         const One one = ask(run, plan, photons, query(plan, {0, 0, 0}));
         run.exact("flux", 16, one.result.flux[0]);
         run.exact("r2", 225, one.result.r2);
       }},
      {"r2_max = 0", Known::kClosedForm,
       "only what stands in the query's own unit counts: 3 of the 30 photons",
       [](Run& run) {
         Plan plan = usual_gatherer();
         plan.global.r2_max = 0;
         Photons photons(3, photon(plan, middle(plan)));
         for (uint32_t i = 1; i < 28; ++i)
           photons.push_back(photon(plan, plus(middle(plan), int(i % 3), i)));
         const One one = ask(run, plan, photons, query(plan, middle(plan)));
         run.exact("count", 3, one.result.count);
         run.exact("r2", 0, one.result.r2);
         run.counted("clamped", 1, one.result.clamped);
       }},
      {"r2_max = 0 with k photons in the unit", Known::kClosedForm,
       "a bound of 0 prunes all that is apart, and 20 ties keep the 16 lowest indices",
       [](Run& run) {
         Plan plan = usual_gatherer();
         plan.global.r2_max = 0;
         Photons photons = uniform(plan, 500);
         for (size_t i = 0; i < 20; ++i) photons[i * 7].position = middle(plan);
         const Queries queries{query(plan, middle(plan))};
         check_all(run, plan, run.gather(plan, photons, queries), queries);
       }},
      {"radius below one position unit", Known::kClosedForm,
       "r2_max = floor((0.999 unit)^2) = 0: the radius is no less than nothing, photons of the "
       "same "
       "unit count",
       [](Run& run) {
         Plan plan = usual_gatherer();
         plan.global.r2_max = radius_to_r2_max(plan, 0.999 * plan.position_unit());
         run.exact("r2_max", 0, plan.global.r2_max);
         const One one =
             ask(run, plan, {photon(plan, middle(plan)), photon(plan, plus(middle(plan), 0, 1))},
                 query(plan, middle(plan)));
         run.exact("count", 1, one.result.count);
       }},
      {"r2_max at its greatest", Known::kClosedForm,
       "2^34 - 1 lies above every d2: all 1,000 photons are candidates, 16 are kept",
       [](Run& run) {
         const Plan plan = usual_gatherer();
         run.exact("r2_max", ones(34), plan.global.r2_max);
         const Queries queries{query(plan, corner(plan, 0)), query(plan, corner(plan, 7))};
         check_all(run, plan, run.gather(plan, uniform(plan, 1000), queries), queries);
       }},
      {"photons at r2_max and one beyond", Known::kClosedForm,
       "d2 = 25 counts with r2_max = 25, d2 = 26 does not",
       [](Run& run) {
         Plan plan = usual_gatherer();
         plan.global.r2_max = 25;
         const UVec3 m = middle(plan);
         const One one = ask(
             run, plan,
             {photon(plan, {m[0] + 3, m[1] + 4, m[2]}), photon(plan, {m[0] + 5, m[1], m[2] + 1})},
             query(plan, m));
         run.exact("count", 1, one.result.count);
         run.exact("d2", 25, one.photons.at(0).d2);
       }},
      row_of_photons("photons in a row along x", {10, 0, 0}, "a line along x"),
      row_of_photons("photons in a row along y", {0, 10, 0}, "a line along y"),
      row_of_photons("photons in a row along z", {0, 0, 10}, "a line along z"),
      row_of_photons("photons on a diagonal", {10, 10, 10}, "the cube's diagonal"),
      row_of_photons("photons on a steep line", {1, 10, 100},
                     "a line that splits on one axis only"),
      lattice("square lattice", 2, 5,
              "1 + 4 + 4 + 4 points lie within 2 steps, the next 8 at sqrt 5: r2 = 5 steps^2, the "
              "ties are won by index"),
      lattice("cubic lattice", 3, 2,
              "1 + 6 points lie within 1 step, the next 12 at sqrt 2: r2 = 2 steps^2, the ties are "
              "won by index"),
      {"all photons at the same distance", Known::kClosedForm,
       "48 photons at d2 = 1 + 4 + 9 (all signs and orders): the 16 lowest indices",
       [](Run& run) {
         const Plan plan = usual_gatherer();
         Photons photons;
         const int orders[6][3] = {{1, 2, 3}, {1, 3, 2}, {2, 1, 3},
                                   {2, 3, 1}, {3, 1, 2}, {3, 2, 1}};
         for (const auto& o : orders)
           for (unsigned s = 0; s < 8; ++s) {
             UVec3 p = middle(plan);
             for (size_t c = 0; c < 3; ++c)
               p[c] = s >> c & 1 ? p[c] - uint32_t(o[c]) : p[c] + uint32_t(o[c]);
             photons.push_back(photon(plan, p));
           }
         const One one = ask(run, plan, photons, query(plan, middle(plan)));
         std::vector<uint32_t> first(16);
         for (uint32_t i = 0; i < 16; ++i) first[i] = i;
         run.same("indices", first, indices(one.photons));
         run.exact("r2", 14, one.result.r2);
       }},
      {"coplanar photons, queries on and off the plane", Known::kReference,
       "as a look at all finds them, also 1 and 30,000 units above",
       [](Run& run) {
         const Plan plan = usual_gatherer();
         Photons photons = uniform(plan, 3000);
         for (PackedPhoton& p : photons) p.position[2] = 777;
         Queries queries = anywhere(plan, 30);
         for (size_t i = 0; i < queries.size(); ++i)
           queries[i].position[2] = i % 3 == 0 ? 777 : i % 3 == 1 ? 778 : 30777;
         check_all(run, plan, run.gather(plan, photons, queries), queries);
       }},
      {"photons in two far clumps", Known::kReference,
       "a query between them finds those of the nearer one, in the order of (d2, index)",
       [](Run& run) {
         const Plan plan = usual_gatherer();
         Photons photons = uniform(plan, 400);
         for (size_t i = 0; i < photons.size(); ++i)
           for (uint32_t& x : photons[i].position) x = (i % 2 ? 65000 : 100) + x % 50;
         const Queries queries{query(plan, middle(plan)), query(plan, {32000, 33000, 32500})};
         check_all(run, plan, run.gather(plan, photons, queries), queries);
       }},
      {"one photon 2^20 times all others", Known::kClosedForm,
       "the sum is exact: 2^20 + 15, no small power is lost beside the large one",
       [](Run& run) {
         const Plan plan = usual_gatherer();
         Photons photons(16, photon(plan, middle(plan)));
         photons[7] = photon(plan, middle(plan), 256, 12);
         const One one = ask(run, plan, photons, query(plan, middle(plan)));
         run.exact("flux", (1u << 20) + 15, one.result.flux[0]);
       }},
      {"powers 2^0 to 2^31 in one sum", Known::kClosedForm,
       "16 photons of 1 * 2^(2i): their sum is (4^16 - 1) / 3, exactly",
       [](Run& run) {
         const Plan plan = usual_gatherer();
         Photons photons;
         for (uint32_t i = 0; i < 16; ++i)
           photons.push_back(i < 4 ? photon(plan, middle(plan), 1u << (2 * i), 0)
                                   : photon(plan, middle(plan), 256, 2 * i - 8));
         const One one = ask(run, plan, photons, query(plan, middle(plan)));
         run.exact("flux", 0x55555555u, one.result.flux[0]);
       }},
      {"largest powers", Known::kClosedForm,
       "16 * 511 * 2^31 takes the top bit of the 44: no channel wraps",
       [](Run& run) {
         const Plan plan = usual_gatherer();
         const One one = ask(run, plan, Photons(16, photon(plan, middle(plan), 511, 31)),
                             query(plan, middle(plan)));
         for (size_t c = 0; c < 3; ++c)
           run.exact("flux", uint64_t{16 * 511} << 31, one.result.flux[c]);
       }},
      {"powers of zero", Known::kClosedForm,
       "photons without power are photons: they count, take the radius and add 0",
       [](Run& run) {
         const Plan plan = usual_gatherer();
         const One one = ask(run, plan, Photons(20, photon(plan, middle(plan), 0)),
                             query(plan, plus(middle(plan), 2, 2)));
         run.exact("count", 16, one.result.count);
         run.exact("flux", 0, one.result.flux[0]);
         run.exact("r2", 4, one.result.r2);
       }},
      axis_case(0, false),
      axis_case(0, true),
      axis_case(1, false),
      axis_case(1, true),
      axis_case(2, false),
      axis_case(2, true),
      {"directions on the octahedron's outer edges", Known::kDefinition,
       "codes with u or v at 0 and 2^b - 1, where -z folds: o . o > 0 counts, nothing else",
       [](Run& run) { facing(run, usual_gatherer(), edge_codes(8), edge_codes(8)); }},
      {"directions on the octahedral seams", Known::kDefinition,
       "codes along |x| + |y| = 1 and both middles: o . o > 0 counts, nothing else",
       [](Run& run) { facing(run, usual_gatherer(), seam_codes(8), seam_codes(8)); }},
      {"grazing light", Known::kDefinition,
       "of directions along a surface, o . o = 0 is rejected and the least positive one counts",
       [](Run& run) {
         const Plan plan = usual_gatherer();
         const OctCode normal{200, 99};
         const IVec3 n = oct_decode(normal, 8);
         std::vector<OctCode> zero, least_positive;
         int64_t smallest = INT64_MAX;
         for (uint32_t u = 0; u < 256; ++u)
           for (uint32_t v = 0; v < 256; ++v) {
             const int64_t dot = oct_dot(oct_decode({u, v}, 8), n);
             if (dot == 0) zero.push_back({u, v});
             if (dot > 0 && dot < smallest) {
               smallest = dot;
               least_positive.clear();
             }
             if (dot == smallest) least_positive.push_back({u, v});
           }
         run.holds("there are such codes", !zero.empty() && !least_positive.empty());
         zero.resize(std::min<size_t>(zero.size(), 10));
         const OctCode last = least_positive.at(0);
         Photons photons;
         for (const OctCode& code : zero) {
           photons.push_back(photon(plan, middle(plan), 1));
           photons.back().direction = code;
         }
         photons.push_back(photon(plan, middle(plan), 100));
         photons.back().direction = last;
         GatherQuery q = query(plan, middle(plan));
         q.normal = {normal.u, normal.v};
         const One one = ask(run, plan, photons, q);
         run.exact("count", 1, one.result.count);
         run.exact("flux", 100, one.result.flux[0]);
       }},
      {"all photons from behind", Known::kClosedForm,
       "none counts and none shrinks the radius: n = 0, r2 = r2_max, every leaf is visited",
       [](Run& run) {
         const Plan plan = usual_gatherer();
         Photons photons = uniform(plan, 300);
         for (PackedPhoton& p : photons) p.direction = oct_encode(Vec3(0, 0, -1), 8);
         const One one = ask(run, plan, photons, query(plan, middle(plan)));
         run.exact("count", 0, one.result.count);
         run.exact("r2", plan.r2_limit(), one.result.r2);
         run.exact("leaves", (300 + 7) / 8, one.result.leaves);
         run.exact("insertions", 0, one.result.insertions);
       }},
      {"a wall of no thickness", Known::kClosedForm,
       "photons of both sides in one plane: each side finds its own 16 only, though they tie",
       [](Run& run) {
         const Plan plan = usual_gatherer();
         Photons photons;
         for (int i = 0; i < 32; ++i)
           photons.push_back(
               photon(plan, middle(plan), i % 2 ? 1 : 100, 0, Vec3(0, 0, i % 2 ? 1 : -1)));
         const Run::Gathered found = run.gather(
             plan, photons,
             {query(plan, middle(plan), Vec3(0, 0, 1)), query(plan, middle(plan), Vec3(0, 0, -1))});
         run.exact("flux", 16, found.results[0].flux[0]);
         run.exact("flux", 1600, found.results[1].flux[0]);
       }},
      {"a partial last line", Known::kDefinition,
       "N = 8 lines + 1: the 7 unused slots hold no photon, whatever lies near",
       [](Run& run) {
         const Plan plan = usual_gatherer();
         const Queries queries{query(plan, {0, 0, 0}), query(plan, corner(plan, 7))};
         check_all(run, plan, run.gather(plan, uniform(plan, 65), queries), queries);
       }},
      {"flushes only", Known::kDefinition,
       "each is answered by a flush with every number 0, in its place",
       [](Run& run) {
         const Plan plan = usual_gatherer();
         Queries queries = anywhere(plan, 5);
         for (GatherQuery& q : queries) q.flush = 1;
         const Run::Gathered found = run.gather(plan, uniform(plan, 40), queries);
         for (const GatherResult& r : found.results) {
           run.exact("flush", 1, r.flush);
           run.exact("count", 0, r.count);
           run.exact("flux", 0, r.flux[0]);
         }
         run.exact("photons", 0, found.photons.size());
       }},
      {"no query", Known::kDefinition, "nothing goes in, nothing comes out",
       [](Run& run) {
         const Run::Gathered found =
             run.gather(usual_gatherer(), uniform(usual_gatherer(), 40), {});
         run.exact("results", 0, found.results.size());
       }},
      {"reciprocal of powers of two", Known::kClosedForm,
       "r2 = 4^j is inverted exactly: mantissa 2^18, exponent 2j",
       [](Run& run) {
         const Plan plan = usual_gatherer();
         for (uint32_t j = 0; j < 16; j += 3) {
           Photons photons(16, photon(plan, {0, 0, 0}));
           const One one = ask(run, plan, photons, query(plan, {1u << j, 0, 0}));
           run.exact("mantissa", 1u << 18, one.result.reciprocal);
           run.exact("exponent", 2 * j, one.result.reciprocal_exponent);
         }
       }},
      {"reciprocal with a carry", Known::kClosedForm,
       "r2 = r2_max = 2^34 - 1 rounds up to 2^34: mantissa 2^18, exponent 34",
       [](Run& run) {
         const Plan plan = usual_gatherer();
         const One one = ask(run, plan, {photon(plan, {0, 0, 0})}, query(plan, {9, 9, 9}));
         run.exact("mantissa", 1u << 18, one.result.reciprocal);
         run.exact("exponent", 34, one.result.reciprocal_exponent);
       }},
      {"position_bits = 4, photon_bytes = 8, bucket = 2", Known::kClosedForm,
       "corner to corner d2 = 3 * 15^2; the answer is the nearest of 64 photons, k = 1",
       [](Run& run) {
         const Plan plan = least_gatherer();
         Photons photons;
         for (uint32_t i = 0; i < 64; ++i)
           photons.push_back(photon(plan, {i % 4 * 5, i / 4 % 4 * 5, i / 16 * 5}));
         const Queries queries{query(plan, {0, 0, 0}), query(plan, {15, 15, 15}),
                               query(plan, {7, 8, 7}), query(plan, {2, 13, 3})};
         check_all(run, plan, run.gather(plan, photons, queries), queries);
         const One one = ask(run, plan, {photon(plan, corner(plan, 7))}, query(plan, {0, 0, 0}));
         run.exact("d2", 675, one.photons.at(0).d2);
       }},
      {"direction_bits = 2, normal_bits = 2", Known::kDefinition,
       "all 16 directions on all 16 normals: o . o > 0 counts, k = 1 of them is kept",
       [](Run& run) {
         std::vector<OctCode> codes;
         for (uint32_t i = 0; i < 16; ++i) codes.push_back({i % 4, i / 4});
         facing(run, least_gatherer(), codes, codes);
       }},
      {"mantissa_bits = 2, exponent_bits = 1", Known::kClosedForm,
       "the largest power is 3 * 2^1 and the flux has just its 3 bits",
       [](Run& run) {
         const Plan plan = least_gatherer();
         run.exact("flux bits", 3, plan.flux_bits());
         const One one =
             ask(run, plan, {photon(plan, middle(plan), 3, 1)}, query(plan, middle(plan)));
         run.exact("flux", 6, one.result.flux[0]);
       }},
      {"r2_floor at its greatest", Known::kSaturation,
       "every r2 lies below 2^10 - 1 or is it: `clamped` for d2 = 3, not for r2 = r2_max",
       [](Run& run) {
         const Plan plan = least_gatherer();
         const One near = ask(run, plan, {photon(plan, {8, 8, 8})}, query(plan, {9, 9, 9}));
         run.counted("clamped", 1, near.result.clamped);
         run.exact("reciprocal", 1u << 8, near.result.reciprocal);
         run.exact("exponent", 10, near.result.reciprocal_exponent);
         const One none = ask(run, plan, {}, query(plan, {9, 9, 9}));
         run.counted("clamped", 0, none.result.clamped);
       }},
      {"position_bits = 24", Known::kClosedForm,
       "corner to corner d2 = 3 (2^24 - 1)^2 in 50 bits, and a neighbour at d2 = 1 is told apart",
       [](Run& run) {
         const Plan plan = greatest_gatherer();
         const One one = ask(run, plan, {photon(plan, corner(plan, 7)), photon(plan, {1, 0, 0})},
                             query(plan, {0, 0, 0}));
         run.exact("d2", 1, one.photons.at(0).d2);
         run.exact("d2", 3 * ones(24) * ones(24), one.photons.at(1).d2);
       }},
      {"direction_bits = 14, normal_bits = 14", Known::kDefinition,
       "codes on edges and seams of 2^14 cells: o . o > 0 counts, nothing else",
       [](Run& run) {
         facing(run, greatest_gatherer(), edge_codes(14), edge_codes(14));
         facing(run, greatest_gatherer(), seam_codes(14), edge_codes(14));
       }},
      {"mantissa_bits = 16, exponent_bits = 5, k = 256", Known::kClosedForm,
       "256 * 65535 * 2^31 takes all but the last of 55 bits, in three channels",
       [](Run& run) {
         const Plan plan = greatest_gatherer();
         run.exact("flux bits", 55, plan.flux_bits());
         const One one = ask(run, plan, Photons(256, photon(plan, middle(plan), 65535, 31)),
                             query(plan, middle(plan)));
         run.exact("count", 256, one.result.count);
         for (size_t c = 0; c < 3; ++c)
           run.exact("flux", uint64_t{256} * 65535 << 31, one.result.flux[c]);
       }},
      {"k = 256 of 4,096 photons in lines of 16", Known::kReference,
       "photons, order and sum are those of a look at all",
       [](Run& run) {
         const Plan plan = greatest_gatherer();
         const Queries queries = anywhere(plan, 12);
         check_all(run, plan, run.gather(plan, uniform(plan, 4096), queries), queries);
       }},
      {"reciprocal_bits = 24", Known::kClosedForm,
       "r2 = 2^50 - 1 rounds up to 2^50; r2 = 3 gives floor(2^48 / (1.5 * 2^24))",
       [](Run& run) {
         const Plan plan = greatest_gatherer();
         const One far = ask(run, plan, {photon(plan, {0, 0, 0})}, query(plan, {9, 9, 9}));
         run.exact("mantissa", 1u << 24, far.result.reciprocal);
         run.exact("exponent", 50, far.result.reciprocal_exponent);
         const One three =
             ask(run, plan, Photons(256, photon(plan, {4, 4, 4})), query(plan, {5, 5, 5}));
         run.exact("mantissa", (uint64_t{1} << 25) / 3, three.result.reciprocal);
       }},
  };
  return {"photon_gatherer",
          "Plans: the usual formats with k = 16 and room for 1,000,000 photons; every width, k and "
          "bucket at its least; every width, k and bucket at its greatest.",
          std::move(cases)};
}

}  // namespace photonloom::extremes
