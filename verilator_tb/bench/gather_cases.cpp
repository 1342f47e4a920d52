// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/bench/gather_cases.hpp"

#include <algorithm>

#include "golden/numeric/octahedral.hpp"

namespace photonloom {

namespace {

uint32_t position(const Plan& plan, BenchRandom& random) {
  return static_cast<uint32_t>(random.below(uint64_t{1} << plan.position_bits));
}

// Any valid code: where the exponent is not 0 the largest mantissa has its top bit.
PackedPhoton photon(const Plan& plan, BenchRandom& random) {
  PackedPhoton p{};
  for (uint32_t& x : p.position) x = position(plan, random);
  p.power.exponent = static_cast<uint32_t>(random.bits() & ones(plan.exponent_bits));
  for (int c = 0; c < plan.channels; ++c)
    p.power.mantissa[static_cast<size_t>(c)] =
        static_cast<uint32_t>(random.bits() & ones(plan.mantissa_bits));
  if (p.power.exponent) p.power.mantissa[0] |= 1u << (plan.mantissa_bits - 1);
  p.direction = {static_cast<uint32_t>(random.bits() & ones(plan.direction_bits)),
                 static_cast<uint32_t>(random.bits() & ones(plan.direction_bits))};
  return p;
}

std::vector<PackedPhoton> photons(const Plan& plan, BenchRandom& random, uint64_t count) {
  std::vector<PackedPhoton> list;
  for (uint64_t i = 0; i < count; ++i) list.push_back(photon(plan, random));
  return list;
}

GatherQuery query(const Plan& plan, BenchRandom& random) {
  GatherQuery q{};
  q.pixel = static_cast<uint32_t>(random.bits() & ones(plan.pixel_bits()));
  q.sample = static_cast<uint32_t>(random.bits() & ones(plan.sample_bits()));
  q.tag = static_cast<uint32_t>(random.bits() & ones(plan.tag_bits()));
  q.map = random.below(4) == 0;
  q.want_photons = random.below(4) == 0;
  for (uint32_t& x : q.position) x = position(plan, random);
  for (uint32_t& n : q.normal) n = static_cast<uint32_t>(random.bits() & ones(plan.normal_bits));
  return q;
}

constexpr int kQueries = 120;

GatherStimulus stimulus(const Plan& plan, BenchRandom& random, uint64_t global, uint64_t caustic) {
  GatherStimulus s;
  s.global = photons(plan, random, std::min(global, plan.global.photons));
  s.caustic = photons(plan, random, std::min(caustic, plan.caustic.photons));
  for (int i = 0; i < kQueries; ++i) s.queries.push_back(query(plan, random));
  return s;
}

// Queries stand on photons, so that distances of 0 and bounds of 0 occur.
void onto_photons(GatherStimulus& s, BenchRandom& random) {
  for (GatherQuery& q : s.queries) {
    const auto& map = q.map ? s.caustic : s.global;
    if (!map.empty()) q.position = map[random.below(map.size())].position;
  }
}

}  // namespace

std::vector<GatherCase> gather_cases() {
  return {
      {"uniform",
       [](const Plan& plan, BenchRandom& random) {
         GatherStimulus s = stimulus(plan, random, ~0ull, ~0ull);
         for (int i = 0; i < 2 * kQueries; ++i) s.queries.push_back(query(plan, random));
         return s;
       }},
      {"clusters",
       [](const Plan& plan, BenchRandom& random) {
         GatherStimulus s = stimulus(plan, random, ~0ull, ~0ull);
         const uint32_t mask = static_cast<uint32_t>(ones(plan.position_bits));
         for (auto* map : {&s.global, &s.caustic})
           for (size_t i = 0; i < map->size(); ++i)
             for (size_t axis = 0; axis < 3; ++axis)
               (*map)[i].position[axis] =
                   ((*map)[i % 7].position[axis] + static_cast<uint32_t>(random.below(8))) & mask;
         onto_photons(s, random);
         return s;
       }},
      // A lattice: equal distances across every split.
      {"equal_distances",
       [](const Plan& plan, BenchRandom& random) {
         GatherStimulus s = stimulus(plan, random, ~0ull, ~0ull);
         const uint32_t step = plan.position_bits > 6 ? 1u << (plan.position_bits - 3) : 4;
         const auto snap = [&](UVec3& p) {
           for (uint32_t& x : p) x = x / step * step;
         };
         for (PackedPhoton& p : s.global) snap(p.position);
         for (PackedPhoton& p : s.caustic) snap(p.position);
         for (GatherQuery& q : s.queries) snap(q.position);
         return s;
       }},
      {"one_point",
       [](const Plan& plan, BenchRandom& random) {
         GatherStimulus s = stimulus(plan, random, ~0ull, ~0ull);
         for (PackedPhoton& p : s.global) p.position = s.global[0].position;
         for (PackedPhoton& p : s.caustic) p.position = s.caustic[0].position;
         const auto& there = s.global.empty() ? s.caustic : s.global;
         for (size_t i = 0; i < s.queries.size(); i += 2) s.queries[i].position = there[0].position;
         return s;
       }},
      {"empty", [](const Plan& plan, BenchRandom& random) { return stimulus(plan, random, 0, 0); }},
      {"one_photon",
       [](const Plan& plan, BenchRandom& random) { return stimulus(plan, random, 1, 1); }},
      // The root is a leaf: of all leaves it comes first to the lanes. A query amid the photons is
      // followed by one far from them, to which the bound of the one before would be too small.
      {"one_leaf",
       [](const Plan& plan, BenchRandom& random) {
         const auto leaf = static_cast<uint64_t>(plan.bucket);
         GatherStimulus s = stimulus(plan, random, leaf, leaf);
         const auto near = static_cast<uint32_t>(ones(plan.position_bits) / 8);
         for (auto* map : {&s.global, &s.caustic})
           for (PackedPhoton& p : *map)
             for (uint32_t& x : p.position) x &= near;
         for (size_t i = 0; i < s.queries.size(); ++i)
           for (uint32_t& x : s.queries[i].position) x = i % 2 ? ~near & x : near & x;
         return s;
       }},
      {"fewer_than_k",
       [](const Plan& plan, BenchRandom& random) {
         return stimulus(plan, random, static_cast<uint64_t>(plan.k) - 1,
                         static_cast<uint64_t>(plan.k) / 2 + 1);
       }},
      {"partial_last_line",
       [](const Plan& plan, BenchRandom& random) {
         return stimulus(plan, random, static_cast<uint64_t>(plan.bucket) * 5 + 1,
                         static_cast<uint64_t>(plan.bucket) * 2 - 1);
       }},
      {"radius",
       [](const Plan& plan, BenchRandom& random) {
         GatherStimulus s = stimulus(plan, random, ~0ull, ~0ull);
         const uint64_t r = (uint64_t{1} << plan.position_bits) / 6;
         s.r2_max = {r * r, r * r / 3};
         return s;
       }},
      {"radius_0",
       [](const Plan& plan, BenchRandom& random) {
         GatherStimulus s = stimulus(plan, random, ~0ull, ~0ull);
         s.r2_max = {0, 0};
         onto_photons(s, random);
         return s;
       }},
      // Photons and queries in opposite corners: the largest distances there are.
      {"corners",
       [](const Plan& plan, BenchRandom& random) {
         GatherStimulus s = stimulus(plan, random, ~0ull, ~0ull);
         const auto corner = [&](UVec3& p) {
           for (uint32_t& x : p)
             x = random.below(2) ? static_cast<uint32_t>(ones(plan.position_bits)) : 0;
         };
         for (PackedPhoton& p : s.global) corner(p.position);
         for (PackedPhoton& p : s.caustic) corner(p.position);
         for (GatherQuery& q : s.queries) corner(q.position);
         return s;
       }},
      // Normals of one side, photons of the other: nothing may be found, everything is visited.
      {"back_side",
       [](const Plan& plan, BenchRandom& random) {
         GatherStimulus s = stimulus(plan, random, 200, 50);
         const auto code = [](double z, int bits) { return oct_encode(Vec3(0, 0, z), bits); };
         for (auto* map : {&s.global, &s.caustic})
           for (size_t i = 0; i < map->size(); ++i)
             if (i % 16) (*map)[i].direction = code(-1, plan.direction_bits);
         for (GatherQuery& q : s.queries) {
           const OctCode up = code(1, plan.normal_bits);
           q.normal = {up.u, up.v};
         }
         return s;
       }},
      // One in three of the light's side, so that leaves have gaps between the photons that count
      // while the nearest shrink the bound behind which others wait.
      {"both_sides",
       [](const Plan& plan, BenchRandom& random) {
         GatherStimulus s = stimulus(plan, random, ~0ull, ~0ull);
         const auto code = [](double z, int bits) { return oct_encode(Vec3(0, 0, z), bits); };
         for (auto* map : {&s.global, &s.caustic})
           for (PackedPhoton& p : *map)
             p.direction = code(random.below(3) == 0 ? 1 : -1, plan.direction_bits);
         for (GatherQuery& q : s.queries) {
           const OctCode up = code(1, plan.normal_bits);
           q.normal = {up.u, up.v};
         }
         return s;
       }},
      {"all_want_photons",
       [](const Plan& plan, BenchRandom& random) {
         GatherStimulus s = stimulus(plan, random, ~0ull, ~0ull);
         for (GatherQuery& q : s.queries) q.want_photons = 1;
         return s;
       }},
      {"flushes",
       [](const Plan& plan, BenchRandom& random) {
         GatherStimulus s = stimulus(plan, random, ~0ull, ~0ull);
         for (GatherQuery& q : s.queries) q.flush = random.below(3) == 0;
         for (int i = 0; i < 80; ++i) {
           GatherQuery q = query(plan, random);
           q.flush = 1;
           s.queries.push_back(q);
         }
         return s;
       }},
      // The largest code of every field, so that the sum needs all its bits.
      {"largest_powers",
       [](const Plan& plan, BenchRandom& random) {
         GatherStimulus s = stimulus(plan, random, ~0ull, ~0ull);
         for (auto* map : {&s.global, &s.caustic})
           for (PackedPhoton& p : *map) {
             p.power.exponent = static_cast<uint32_t>(ones(plan.exponent_bits));
             for (int c = 0; c < plan.channels; ++c)
               p.power.mantissa[static_cast<size_t>(c)] =
                   static_cast<uint32_t>(ones(plan.mantissa_bits));
           }
         return s;
       }},
      // The same few lines over and over: hits, and many who wait for the same line.
      {"same_place",
       [](const Plan& plan, BenchRandom& random) {
         GatherStimulus s = stimulus(plan, random, ~0ull, ~0ull);
         for (size_t i = 0; i < s.queries.size(); ++i)
           s.queries[i].position = s.queries[i / 40 * 40].position;
         return s;
       }},
      // Other photons in as many lines, while the cache still holds the first ones' lines.
      {"reload",
       [](const Plan& plan, BenchRandom& random) {
         GatherStimulus s = stimulus(plan, random, 60, 30);
         s.reload = {photons(plan, random, s.global.size()),
                     photons(plan, random, s.caustic.size())};
         return s;
       }},
      {"part_of_cache",
       [](const Plan& plan, BenchRandom& random) {
         GatherStimulus s = stimulus(plan, random, 60, 30);
         s.leaf_cache = (uint64_t{1} << random.below(4)) - 1;
         return s;
       }},
      {"no_cache",
       [](const Plan& plan, BenchRandom& random) {
         GatherStimulus s = stimulus(plan, random, 60, 30);
         s.leaf_cache = kFetchAnew | ((uint64_t{1} << random.below(4)) - 1);
         return s;
       }},
      // Queries of the map without photons end at once, between the ends of searches.
      {"one_map_empty",
       [](const Plan& plan, BenchRandom& random) {
         const bool is_caustic = random.below(2) != 0;
         GatherStimulus s = stimulus(plan, random, is_caustic ? 60 : 0, is_caustic ? 0 : 60);
         for (GatherQuery& q : s.queries) q.map = random.below(2) != 0;
         return s;
       }},
  };
}

}  // namespace photonloom
