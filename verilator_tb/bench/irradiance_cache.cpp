// SPDX-License-Identifier: Apache-2.0
// Bench of the irradiance cache: --list shows its plans and cases.
#include "golden/unit/irradiance_cache.hpp"

#include "verilator_tb/bench/bench.hpp"

using namespace photonloom;

namespace {

Plan plan_of(const char* name, int records, int hits) {
  Plan plan;
  plan.scene = name;
  plan.cache_present = true;
  plan.cache_records = records;
  plan.cache_hits = hits;
  return plan;
}

std::vector<BenchPlan> plans() {
  Plan usual = plan_of("", 128, 4);
  Plan one = plan_of("", 1, 1);
  one.width = one.height = one.spp = 1;
  Plan coarse = plan_of("", 5, 8);
  coarse.position_bits = 5;
  coarse.normal_bits = 3;
  coarse.cache_angle_bits = 4;
  coarse.cache_weight_bits = 4;
  Plan fine = plan_of("", 300, 3);
  fine.position_bits = 24;
  fine.photon_bytes = 32;
  fine.normal_bits = 14;
  fine.cache_angle_bits = 30;
  fine.cache_weight_bits = 12;
  // No turn of the normal at all.
  Plan flat = plan_of("", 33, 8);
  flat.cache_angle_bits = 0;
  flat.lut_ram_words = 64;
  return {{"usual", usual}, {"one", one}, {"coarse", coarse}, {"fine", fine}, {"flat", flat}};
}

// A point in the cube of `edge` units at `corner`, with a record's reach of about `reach` units.
CacheLookup lookup(const Plan& plan, BenchRandom& random, uint32_t corner, uint32_t edge,
                   uint64_t reach) {
  CacheLookup l{};
  l.pixel = static_cast<uint32_t>(random.bits() & ones(plan.pixel_bits()));
  l.sample = static_cast<uint32_t>(random.bits() & ones(plan.sample_bits()));
  l.insert = 1;
  const uint64_t top = ones(plan.position_bits);
  for (uint32_t& x : l.position)
    x = static_cast<uint32_t>(std::min<uint64_t>(top, corner + random.below(edge)));
  const Reciprocal falloff = reciprocal(
      std::clamp<uint64_t>(reach * reach, 1, ones(plan.r2_bits() - 1)), plan.cache_falloff_bits());
  l.falloff = falloff.mantissa;
  l.falloff_exponent = falloff.exponent;
  return l;
}

void turn(const Plan& plan, BenchRandom& random, CacheLookup& l, uint32_t spread) {
  for (uint32_t& n : l.normal)
    n = static_cast<uint32_t>(std::min<uint64_t>(ones(plan.normal_bits), random.below(spread)));
}

uint32_t edge_of(const Plan& plan) { return 1u << (plan.position_bits - 1); }

// Tiles of `each` lookups; `make(i)` gives one.
template <class Make>
std::vector<CacheLookup> tiles(const Plan& plan, int count, int each, Make&& make) {
  std::vector<CacheLookup> in;
  for (int tile = 0; tile < count; ++tile)
    for (int i = 0; i < each; ++i) {
      in.push_back(make(i));
      in.back().clear = i == 0;
    }
  (void)plan;
  return in;
}

int many(const Plan& plan) { return 3 * plan.cache_records + 30; }

std::vector<StreamCase<CacheLookup>> cases() {
  using In = std::vector<CacheLookup>;
  return {
      // A reach at which some tiles fill and others do not.
      {"scattered",
       [](const Plan& plan, BenchRandom& random) -> In {
         const uint32_t edge = edge_of(plan);
         return tiles(plan, 3, many(plan), [&](int) {
           CacheLookup l = lookup(plan, random, 0, edge, 1 + random.below(edge));
           turn(plan, random, l, 4);
           return l;
         });
       }},
      // A frame's two passes: records come in, then all points look up again.
      {"two_passes",
       [](const Plan& plan, BenchRandom& random) -> In {
         const uint32_t edge = edge_of(plan);
         In in;
         for (int tile = 0; tile < 2; ++tile) {
           In first = tiles(plan, 1, many(plan), [&](int) {
             CacheLookup l = lookup(plan, random, edge / 2, edge / 4 + 1, 1 + edge / 16);
             turn(plan, random, l, 2);
             return l;
           });
           in.insert(in.end(), first.begin(), first.end());
           for (CacheLookup& l : first) {
             l.clear = l.insert = l.falloff = l.falloff_exponent = 0;
             in.push_back(l);
           }
         }
         return in;
       }},
      // No record covers another: the tile fills, and stays full.
      {"full",
       [](const Plan& plan, BenchRandom& random) -> In {
         return tiles(plan, 2, many(plan), [&](int i) {
           CacheLookup l = lookup(plan, random, 0, 1u << plan.position_bits, 1);
           l.position[0] =
               static_cast<uint32_t>(static_cast<uint64_t>(i) * 3 & ones(plan.position_bits));
           turn(plan, random, l, 2);
           return l;
         });
       }},
      // Every record at one point: equal weights, the earlier first.
      {"ties",
       [](const Plan& plan, BenchRandom& random) -> In {
         In in;
         for (int tile = 0; tile < 3; ++tile) {
           for (int i = 0; i < plan.cache_records + 3; ++i) {
             CacheLookup l = lookup(plan, random, 5, 1, 1);
             // One apart covers nothing with a reach of one; half way between two covers both.
             l.position[0] =
                 static_cast<uint32_t>(static_cast<uint64_t>(i) * 2 & ones(plan.position_bits));
             l.falloff_exponent = static_cast<uint32_t>(random.below(4));
             l.clear = i == 0;
             in.push_back(l);
             CacheLookup look = l;
             look.clear = look.insert = 0;
             look.position[0] |= 1;
             in.push_back(look);
           }
         }
         return in;
       }},
      // The largest distances and reaches, and every bit of a normal.
      {"corners",
       [](const Plan& plan, BenchRandom& random) -> In {
         const auto top = static_cast<uint32_t>(ones(plan.position_bits));
         const auto normal = static_cast<uint32_t>(ones(plan.normal_bits));
         return tiles(plan, 4, many(plan) / 2 + 8, [&](int) {
           CacheLookup l =
               lookup(plan, random, 0, 1,
                      uint64_t{1} << random.below(static_cast<uint64_t>(plan.r2_bits()) / 2));
           for (uint32_t& x : l.position)
             x = random.chance(0.5) ? static_cast<uint32_t>(random.below(3))
                                    : top - static_cast<uint32_t>(random.below(3));
           for (uint32_t& n : l.normal) n = random.chance(0.9) ? normal : 0;
           return l;
         });
       }},
      // Records at the corners of a cube or an octahedron, just too far apart to cover one another,
      // all of which cover its middle; before them others of no reach, so that their numbers vary.
      {"around",
       [](const Plan& plan, BenchRandom& random) -> In {
         In in;
         const uint32_t middle = edge_of(plan), all = 2 * middle;
         const uint32_t least = std::min(8u, middle / 2);
         for (int tile = 0; tile < 40; ++tile) {
           const auto half = static_cast<uint32_t>(least + random.below(middle - least));
           const bool cube = tile % 2 == 0;
           const size_t first = in.size();
           const int others = std::max(0, plan.cache_records - 8);
           for (uint64_t i = random.below(static_cast<uint64_t>(others) + 1); i > 0; --i)
             in.push_back(lookup(plan, random, 0, all, 1));
           for (uint32_t i = 0; i < (cube ? 8u : 6u); ++i) {
             // Neighbours are 2 or 1.414 halves apart.
             CacheLookup l = lookup(plan, random, middle, 1, cube ? 2 * half - 2 : half * 7 / 5);
             for (uint32_t axis = 0; axis < 3; ++axis)
               if (cube || axis == i / 2) {
                 const bool up = (cube ? i >> axis & 1 : i & 1) != 0;
                 l.position[axis] = up ? middle + half : middle - half;
               }
             in.push_back(l);
           }
           for (int i = 0; i < 4; ++i) {
             in.push_back(lookup(plan, random, middle - i / 2, 1 + static_cast<uint32_t>(i), 1));
             in.back().insert = 0;
           }
           for (size_t i = first; i < in.size(); ++i) in[i].clear = i == first;
         }
         return in;
       }},
      // Nothing but a new tile each time, and tiles that only look.
      {"clears",
       [](const Plan& plan, BenchRandom& random) -> In {
         return tiles(plan, 100, 1 + static_cast<int>(random.below(4)), [&](int) {
           CacheLookup l = lookup(plan, random, 1, 3, 2);
           l.insert = random.chance(0.7);
           return l;
         });
       }},
      // Tiles of a single lookup, one behind the other: each is to forget a record that has just
      // come.
      {"single",
       [](const Plan& plan, BenchRandom& random) -> In {
         return tiles(plan, 100, 1, [&](int) {
           CacheLookup l = lookup(plan, random, 1, 3, 2);
           l.insert = random.chance(0.7);
           return l;
         });
       },
       // None overlaps another: each takes the latency of docs/irradiance_cache.md.
       [](const Plan&, const In& in) -> Counters {
         return {{"cycles busy", 15 * in.size()}};
       }},
      // One apart or at one place, by the least exponent: the quotient has all bits behind the
      // point, and is often just below a number that rounds to another one.
      {"one_apart",
       [](const Plan& plan, BenchRandom& random) -> In {
         In in;
         const uint64_t all = ones(plan.cache_falloff_bits() + 1);
         for (int tile = 0; tile < 300; ++tile) {
           CacheLookup l = lookup(plan, random, 4, 1, 1);
           const uint64_t low = ones(1 + static_cast<int>(random.below(
                                             static_cast<uint64_t>(plan.cache_falloff_bits()))));
           l.falloff = static_cast<uint32_t>((random.bits() | low) & all);
           l.falloff_exponent = 0;
           l.insert = l.clear = 1;
           in.push_back(l);
           l.insert = l.clear = 0;
           l.position[random.below(3)] ^= static_cast<uint32_t>(random.below(2));
           in.push_back(l);
         }
         return in;
       }},
      // Every field at random; after reset there is no record, cleared or not.
      {"anything",
       [](const Plan& plan, BenchRandom& random) -> In {
         In in = tiles(plan, 3, many(plan), [&](int) {
           CacheLookup l = lookup(plan, random, 0, 1u << plan.position_bits, 1);
           turn(plan, random, l, 1u << plan.normal_bits);
           l.insert = random.chance(0.8);
           l.falloff = static_cast<uint32_t>(random.bits() & ones(plan.cache_falloff_bits() + 1));
           l.falloff_exponent =
               static_cast<uint32_t>(random.bits() & ones(plan.cache_falloff_exponent_bits()));
           return l;
         });
         in[0].clear = 0;
         return in;
       }},
  };
}

}  // namespace

int main(int argc, char** argv) {
  return stream_bench_main<IrradianceCache>(argc, argv, plans(), cases());
}
