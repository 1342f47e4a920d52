// SPDX-License-Identifier: Apache-2.0
// Bench of the reorder buffer: --list shows its plans and cases.
#include <fmt/core.h>

#include "golden/unit/reorder_buffer.hpp"

#include "verilator_tb/bench/bench.hpp"

using namespace photonloom;

namespace {

Plan plan_of(const char* name, ReorderKey key, ReorderDrain drain, int packets, int bins,
             int cell_bits) {
  Plan plan;
  plan.scene = name;
  plan.reorder_key = key;
  plan.reorder_drain = drain;
  plan.reorder_packets = packets;
  plan.reorder_bins = bins;
  plan.reorder_cell_bits = cell_bits;
  return plan;
}

std::vector<BenchPlan> plans() {
  Plan wide = plan_of("", ReorderKey::kHilbert, ReorderDrain::kSweep, 512, 512, 3);
  Plan fullest = plan_of("", ReorderKey::kHash, ReorderDrain::kFullest, 257, 128, 4);
  fullest.position_bits = 12;
  fullest.normal_bits = 6;
  // Far fewer packets than bins: the sweep moves on with almost every packet.
  Plan sparse = plan_of("", ReorderKey::kHilbert, ReorderDrain::kSweep, 30, 512, 3);
  Plan tiny = plan_of("", ReorderKey::kHash, ReorderDrain::kSweep, 3, 16, 2);
  tiny.position_bits = 5;
  Plan one = plan_of("", ReorderKey::kHilbert, ReorderDrain::kFullest, 1, 1, 1);
  Plan few = plan_of("", ReorderKey::kHilbert, ReorderDrain::kFullest, 40, 8, 1);
  few.position_bits = 20;
  Plan pass = plan_of("", ReorderKey::kNone, ReorderDrain::kSweep, 1, 1, 1);
  // All memories of LUTs: what block_ram's other half is made of shows in a netlist only.
  Plan luts = plan_of("", ReorderKey::kHilbert, ReorderDrain::kSweep, 40, 16, 2);
  luts.lut_ram_words = 128;
  return {{"sweep", wide}, {"sparse", sparse}, {"fullest", fullest},   {"tiny", tiny},
          {"one", one},    {"few_bins", few},  {"pass_through", pass}, {"luts", luts}};
}

GatherQuery flush_packet(const Plan& plan, BenchRandom& random) {
  GatherQuery q{};
  q.pixel = static_cast<uint32_t>(random.bits() & ones(plan.pixel_bits()));
  q.flush = 1;
  return q;
}

// A query in a cell of the key's grid, everything else random.
GatherQuery query_in(const Plan& plan, BenchRandom& random, const UVec3& cell) {
  const int rest = plan.position_bits - plan.reorder_cell_bits;
  GatherQuery q{};
  q.pixel = static_cast<uint32_t>(random.bits() & ones(plan.pixel_bits()));
  q.sample = static_cast<uint32_t>(random.bits() & ones(plan.sample_bits()));
  q.tag = static_cast<uint32_t>(random.bits() & ones(plan.tag_bits()));
  q.map = static_cast<uint32_t>(random.below(2));
  q.want_photons = static_cast<uint32_t>(random.below(2));
  for (size_t c = 0; c < 3; ++c)
    q.position[c] = cell[c] << rest | static_cast<uint32_t>(random.bits() & ones(rest));
  for (uint32_t& n : q.normal) n = static_cast<uint32_t>(random.bits() & ones(plan.normal_bits));
  return q;
}

uint32_t cells(const Plan& plan) { return 1u << (3 * plan.reorder_cell_bits); }

UVec3 cell_number(const Plan& plan, uint32_t number) {
  const int b = plan.reorder_cell_bits;
  const auto mask = static_cast<uint32_t>(ones(b));
  return {number & mask, number >> b & mask, number >> 2 * b & mask};
}

UVec3 any_cell(const Plan& plan, BenchRandom& random) {
  return cell_number(plan, static_cast<uint32_t>(random.below(cells(plan))));
}

// A cell of each bin that has one, by bin.
std::vector<UVec3> cells_by_bin(const Plan& plan) {
  std::vector<UVec3> found(static_cast<size_t>(plan.reorder_bins));
  std::vector<bool> known(found.size());
  for (uint32_t i = 0; i < cells(plan); ++i) {
    UVec3 position = cell_number(plan, i);
    for (uint32_t& x : position) x <<= plan.position_bits - plan.reorder_cell_bits;
    const uint32_t bin = plan.reorder_key == ReorderKey::kNone ? 0 : reorder_bin(plan, position);
    found[bin] = cell_number(plan, i);
    known[bin] = true;
  }
  std::vector<UVec3> list;
  for (size_t b = 0; b < found.size(); ++b)
    if (known[b]) list.push_back(found[b]);
  return list;
}

// Enough packets to fill the pool and to turn it over.
uint64_t many(const Plan& plan) { return 400 + 2 * static_cast<uint64_t>(plan.reorder_packets); }

// `count` queries with cells from `cell(i)`, then a flush.
template <class Cell>
std::vector<GatherQuery> queries(const Plan& plan, BenchRandom& random, uint64_t count,
                                 Cell&& cell) {
  std::vector<GatherQuery> in;
  for (uint64_t i = 0; i < count; ++i) in.push_back(query_in(plan, random, cell(i)));
  in.push_back(flush_packet(plan, random));
  return in;
}

// Where only the last packet is a flush, the input waits while the bins are made empty after reset
// (docs/reorder_buffer.md), for a choice, and in the cycle in which one is made.
void check_choice_waits(const Plan& plan, const Counters& golden, const Counters& hardware) {
  if (plan.reorder_key == ReorderKey::kNone || plan.reorder_drain != ReorderDrain::kFullest) return;
  const uint64_t waits = hardware.at("choice waits"), stalls = hardware.at("stalls in"),
                 clearing = 4 * static_cast<uint64_t>(plan.reorder_bins) + 2;
  if (stalls > clearing + golden.at("choices") + waits)
    throw std::runtime_error(fmt::format(
        "counts {} choice waits, expected more: the input waited for {} cycles, of which {} are "
        "after reset and {} those of choices",
        waits, stalls, clearing, golden.at("choices")));
}

std::vector<StreamCase<GatherQuery>> cases() {
  using In = std::vector<GatherQuery>;
  return {
      {"uniform",
       [](const Plan& plan, BenchRandom& random) -> In {
         return queries(plan, random, many(plan), [&](uint64_t) { return any_cell(plan, random); });
       },
       nullptr, check_choice_waits},
      {"clustered",
       [](const Plan& plan, BenchRandom& random) -> In {
         return queries(plan, random, many(plan), [&](uint64_t) {
           return random.chance(0.1)
                      ? any_cell(plan, random)
                      : cell_number(plan, static_cast<uint32_t>(random.below(4)) % cells(plan));
         });
       }},
      {"one_bin",
       [](const Plan& plan, BenchRandom& random) -> In {
         const UVec3 cell = any_cell(plan, random);
         return queries(plan, random, many(plan), [&](uint64_t) { return cell; });
       }},
      // Every bin in turn, upwards; then downwards, so that each packet lies behind the sweep.
      {"one_per_bin",
       [](const Plan& plan, BenchRandom& random) -> In {
         const std::vector<UVec3> list = cells_by_bin(plan);
         return queries(plan, random, many(plan),
                        [&](uint64_t i) { return list[i % list.size()]; });
       },
       nullptr, check_choice_waits},
      {"downwards",
       [](const Plan& plan, BenchRandom& random) -> In {
         const std::vector<UVec3> list = cells_by_bin(plan);
         return queries(plan, random, many(plan),
                        [&](uint64_t i) { return list[list.size() - 1 - i % list.size()]; });
       }},
      // The first and the last bin: a sweep that turns over again and again.
      {"two_bins",
       [](const Plan& plan, BenchRandom& random) -> In {
         const std::vector<UVec3> list = cells_by_bin(plan);
         return queries(plan, random, many(plan),
                        [&](uint64_t) { return random.chance(0.5) ? list.front() : list.back(); });
       }},
      // Bins of equal length, filled from the highest down; packets join the bin being drained.
      {"ties",
       [](const Plan& plan, BenchRandom& random) -> In {
         const std::vector<UVec3> list = cells_by_bin(plan);
         const size_t used = std::min<size_t>(list.size(), 7);
         uint64_t at = 0;
         return queries(plan, random, many(plan), [&](uint64_t) {
           if (random.chance(0.02)) return list[random.below(used)];
           return list[used - 1 - at++ % used];
         });
       }},
      // Flush on empty, twice in a row, after one packet, one short of full, at full, one beyond.
      {"flushes",
       [](const Plan& plan, BenchRandom& random) -> In {
         const auto pool = static_cast<uint64_t>(plan.reorder_packets);
         In in{flush_packet(plan, random), flush_packet(plan, random)};
         for (const uint64_t count : {uint64_t{1}, pool - 1, pool, pool + 1, uint64_t{0}, pool / 2})
           for (const GatherQuery& q :
                queries(plan, random, count, [&](uint64_t) { return any_cell(plan, random); }))
             in.push_back(q);
         return in;
       }},
      {"random_flushes",
       [](const Plan& plan, BenchRandom& random) -> In {
         In in;
         for (uint64_t i = 0; i < many(plan); ++i)
           in.push_back(random.chance(0.03) ? flush_packet(plan, random)
                                            : query_in(plan, random, any_cell(plan, random)));
         return in;  // what is held at the end stays there
       }},
  };
}

}  // namespace

int main(int argc, char** argv) {
  return stream_bench_main<ReorderBuffer>(argc, argv, plans(), cases());
}
