// SPDX-License-Identifier: Apache-2.0
// The photon gatherer's bench: plans at the ends of every parameter.
#include <fmt/core.h>

#include "verilator_tb/bench/bench.hpp"
#include "verilator_tb/bench/gather_cases.hpp"

namespace photonloom {
namespace {

std::vector<BenchPlan> plans() {
  std::vector<BenchPlan> list;
  const auto add = [&](const char* name, auto&& change) {
    Plan p;
    p.position_bits = 12;
    p.k = 16;
    p.global = {.present = true, .photons = 1200};
    p.caustic = {.present = true, .photons = 300};
    p.cache_bytes = 2048;
    p.width = p.height = 64;
    change(p);
    for (MapPlan* m : {&p.global, &p.caustic}) m->r2_max = p.r2_limit();
    list.push_back({name, p});
  };
  add("base", [](Plan&) {});
  add("one_context", [](Plan& p) {
    p.contexts = 1;
    p.lanes = 1;
    p.k = 1;
    p.reciprocal_bits = 0;
    p.cache_bytes = 128;
    p.cache_ways = 1;
    p.cache_misses = 1;
    p.parity = true;
    p.caustic = {};
  });
  add("wide", [](Plan& p) {
    p.position_bits = 24;
    p.direction_bits = 12;
    p.normal_bits = 12;
    p.bucket = 16;
    p.lanes = 16;
    p.photon_bytes = 17;
    p.k = 64;
    p.cache_bytes = 272 * 4 * 4;
    p.cache_ways = 4;
    p.reciprocal_bits = 24;
  });
  add("fifty", [](Plan& p) {
    p.k = 50;
    p.lanes = 8;
    p.cache_ways = 3;
    p.cache_bytes = 3 * 128 * 8;
  });
  add("approximate", [](Plan& p) {
    p.k = 8;
    p.lanes = 2;
    p.epsilon_factor = 13;
    p.epsilon_shift = 3;
    p.leaf_limit = 4;
    p.r2_floor = 5000;
    p.nodes_per_cycle = p.candidates_per_cycle = p.powers_per_cycle = 2;
  });
  add("one_colour", [](Plan& p) {
    p.position_bits = 10;
    p.channels = 1;
    p.mantissa_bits = 7;
    p.exponent_bits = 3;
    p.direction_bits = 5;
    p.normal_bits = 3;
    p.photon_bytes = 8;
    p.contexts = 3;
    p.candidates_per_cycle = 2;
    p.cache_bytes = 64;
    p.cache_ways = 1;
    p.cache_misses = 2;
    p.reciprocal_bits = 8;
  });
  add("coarse", [](Plan& p) {
    p.position_bits = 4;
    p.k = 7;
    p.contexts = 5;
    p.nodes_per_cycle = 2;
    p.global.photons = 700;
    p.cache_misses = 16;
    p.parity = true;
  });
  add("one_line", [](Plan& p) {
    p.k = 3;
    p.global.photons = 8;
    p.caustic.photons = 30;
    p.contexts = 2;
    p.lanes = 1;
  });
  add("long_leaves", [](Plan& p) {
    p.k = 2;
    p.bucket = 32;
    p.contexts = 2;
    p.cache_ways = 1;
    p.cache_bytes = 4 * p.line_bytes();
  });
  add("compressed", [](Plan& p) {  // most leaves take several lines
    p.bucket = 16;
    p.photon_bytes = 9;
    p.photon_lines = PhotonLines::kCompressed;
    p.further_percent = 1500;
    p.cache_bytes = 2 * 2 * p.line_bytes();
    p.nodes_per_cycle = p.candidates_per_cycle = 2;
    p.beat_bits = 2 * p.line_bytes();  // a part
  });
  add("luts", [](Plan& p) {  // what block_ram's other half is made of shows in a netlist only
    p.k = 6;
    p.contexts = 6;
    p.nodes_per_cycle = p.powers_per_cycle = 2;
    p.candidates_per_cycle = 4;
    p.lut_ram_words = 128;
  });
  add("fast", [](Plan& p) {  // every width, as in fpga/fast
    p.k = 29;                // ranks of three ahead need a bit more
    p.contexts = 48;
    p.nodes_per_cycle = 2;
    p.lanes = 8;
    p.candidates_per_cycle = p.powers_per_cycle = 4;
    p.cache_ways = 5;
    p.cache_bytes = 5 * p.line_bytes() * 4;
    p.cache_misses = 8;
  });
  // Lists without codes of many contexts: beats of which no pair is kept pass those that wait.
  add("many_behind", [](Plan& p) {
    p.k = 16;
    p.contexts = 64;
    p.lanes = p.bucket / 2;
    p.cache_bytes = 64 * p.line_bytes();
  });
  // Lists of whole keys beside several trees, whose ends meet at one sum with two reciprocals.
  add("one_sum", [](Plan& p) {
    p.k = 8;
    p.contexts = 24;
    p.nodes_per_cycle = p.candidates_per_cycle = 2;
    p.lanes = 4;
    p.cache_ways = 2;
    p.cache_bytes = 2 * p.line_bytes() * 2;
    p.cache_misses = 6;
    p.parity = true;
  });
  // No leaf cache: two beats of the line port are a part of a line.
  add("uncached", [](Plan& p) {
    p.contexts = 12;
    p.cache_bytes = 0;
    p.lanes = 2;
    p.photon_bytes = 14;
    p.beat_bits = 8 * p.photon_bytes;
    p.parity = true;
  });
  // A line in one beat, straight to as many lanes, two of each part; more contexts than places
  // behind the lanes; no reciprocals.
  add("uncached_wide", [](Plan& p) {
    p.contexts = 48;
    p.cache_bytes = 0;
    p.lanes = p.bucket;
    p.beat_bits = 8 * p.line_bytes();
    p.nodes_per_cycle = p.candidates_per_cycle = p.powers_per_cycle = 2;
    p.reciprocal_bits = 0;
  });
  // One context and no leaf cache: a leaf is asked for as soon as its query starts.
  add("uncached_alone", [](Plan& p) {
    p.k = 3;
    p.contexts = 1;
    p.cache_bytes = 0;
    p.beat_bits = 8 * p.line_bytes();
    p.lanes = 8;
  });
  // The one nearest photon, without a leaf cache: two reciprocals beside one sum.
  add("nearest", [](Plan& p) {
    p.k = 1;
    p.contexts = 6;
    p.cache_bytes = 0;
    p.lanes = 4;
    p.beat_bits = 8 * p.photon_bytes * p.lanes;
    p.nodes_per_cycle = 2;
  });
  // No leaf cache, and beats of bytes that are no words of a C++ port; the caustic map alone.
  add("odd_beats", [](Plan& p) {
    p.bucket = 16;
    p.lanes = 1;
    p.photon_bytes = 11;
    p.mantissa_bits = 7;
    p.cache_bytes = 0;
    p.beat_bits = 8 * p.photon_bytes;
    p.global = {};
  });
  // More places than any board's plan, in two banks of lists of codes.
  add("hundred", [](Plan& p) {
    p.k = 100;
    p.contexts = 6;
    p.lanes = 8;
    p.nodes_per_cycle = p.candidates_per_cycle = p.powers_per_cycle = 2;
  });
  // Of a board with five gatherers: two levels of a descent at once, of a map whose upper nodes are
  // of even levels and one whose are of odd ones.
  add("levels", [](Plan& p) {
    p.k = 12;
    p.gatherers = 5;
    p.nodes_per_cycle = 2;
    p.caustic.photons = 600;
    p.parity = true;
  });
  // The other way round, the trees not full, with subtrees that are too far by less than all bits.
  add("levels_coarse", [](Plan& p) {
    p.k = 9;
    p.gatherers = 6;
    p.nodes_per_cycle = 2;
    p.contexts = 5;
    p.global.photons = 2400;
    p.position_bits = 6;
    p.epsilon_factor = 13;
    p.epsilon_shift = 3;
    p.leaf_limit = 6;
  });
  // Far, with so many places and so many beats a line that beats pass a list that waits.
  add("far_many", [](Plan& p) {
    p.k = 36;
    p.gatherers = 5;
    p.position_bits = 22;
    p.bucket = 16;
    p.lanes = 4;
    p.cache_bytes = 0;
  });
  // Before an SDRAM, two lists of codes: five lines of four beats wait for each, as of
  // sdram_k50_candidates2.
  add("five_lines", [](Plan& p) {
    p.k = 30;
    p.gatherers = 2;
    p.photon_memory = PhotonMemory::kSdram;
    p.candidates_per_cycle = 2;
    p.bucket = 16;
    p.lanes = 4;
    p.photon_bytes = 12;
    p.cache_bytes = 8 * p.line_bytes();
    p.beat_bits = 4 * 8 * p.photon_bytes;
  });
  // One of three before an SDRAM: far, with a leaf cache, and lists that compare whole keys.
  const auto far_cached = [](Plan& p) {
    p.k = 8;
    p.gatherers = 3;
    p.contexts = 6;
    p.photon_memory = PhotonMemory::kSdram;
    p.photon_bytes = 12;
    p.cache_bytes = 8 * p.line_bytes();
    p.beat_bits = 4 * 8 * p.photon_bytes;
  };
  add("far_cached", far_cached);
  // With more contexts than a cell of LUT RAM has words: a register before the sum, results in
  // block RAM though memories of 64 words are LUTs, codes.
  add("far_contexts", [&](Plan& p) {
    far_cached(p);
    p.k = 12;
    p.contexts = 20;
    p.lut_ram_words = 64;
  });
  return list;
}

// Whether no set of the cache is asked for more lines than it has ways: those of a map lie one
// behind the other.
bool fits_cache(const Plan& plan, const PhotonMap& global, const PhotonMap& caustic) {
  if (plan.cache_bytes == 0 || plan.photon_lines == PhotonLines::kCompressed) return false;
  const auto ways = static_cast<uint32_t>(plan.cache_ways);
  const auto sets = static_cast<uint32_t>(plan.cache_bytes / plan.line_bytes()) / ways;
  const auto in_a_set = [&](const PhotonMap& map) { return (map.lines + sets - 1) / sets; };
  return in_a_set(global) + in_a_set(caustic) <= ways;
}

// One case as golden and the hardware answer it.
void run_case(const GatherCase& c, const Plan& bench_plan, const RunOptions& options,
              const CompareContext& context, BenchRandom& random, BenchTotals& totals) {
  const GatherStimulus in = c.make(bench_plan, random);
  Plan plan = bench_plan;
  if (in.r2_max) {
    plan.global.r2_max = (*in.r2_max)[0];
    plan.caustic.r2_max = (*in.r2_max)[1];
  }
  const PhotonMap global = build_photon_map(in.global, plan);
  const PhotonMap caustic = build_photon_map(in.caustic, plan);
  const auto golden = make_golden_photon_gatherer(plan);
  RunOptions with_cache = options;
  with_cache.leaf_cache = in.leaf_cache;
  const auto rtl = make_rtl_photon_gatherer(plan, with_cache);
  const auto both = compare_units(plan, context, *golden, *rtl);
  both->load(global, caustic);
  std::vector<GatherResult> results;
  std::vector<GatherPhoton> photons;
  const auto ask = [&] {
    feed(in.queries, random,
         [&](std::span<const GatherQuery> piece) { both->process(piece, results, photons); });
  };
  ask();
  PhotonMap other_global, other_caustic;
  if (in.reload) {
    other_global = build_photon_map((*in.reload)[0], plan);
    other_caustic = build_photon_map((*in.reload)[1], plan);
    both->load(other_global, other_caustic);
    ask();
  }
  rtl->finish();
  const Counters counted = rtl->counters();
  check_counters(context.unit, golden->counters(), counted, rtl->cycles());
  if (const auto hits = counted.find("cache hits");
      in.leaf_cache.value_or(0) >= kFetchAnew && hits != counted.end() && hits->second)
    throw std::runtime_error(
        fmt::format("unit {}: {} lines were found in the cache, expected none with bit 63 of "
                    "0x800004",
                    context.unit, hits->second));
  const Counters due = golden->counters();
  // A leaf's one line is found in the cache or fetched.
  if (counted.contains("cache hits") && !plan.compressed() &&
      counted.at("cache hits") + counted.at("cache misses") != due.at("leaves"))
    throw std::runtime_error(fmt::format(
        "unit {}: counts {} lines found in the cache and {} fetched, expected the {} leaves' in "
        "all",
        context.unit, counted.at("cache hits"), counted.at("cache misses"), due.at("leaves")));
  // What enters a list was a candidate, and candidates are photons of the leaves.
  if (const auto candidates = counted.find("candidates"); candidates != counted.end()) {
    const uint64_t most = due.at("leaves") * static_cast<uint64_t>(plan.bucket);
    if (candidates->second < due.at("insertions") ||
        (!plan.compressed() && candidates->second > most))
      throw std::runtime_error(fmt::format(
          "unit {}: counts {} candidates, expected at least the {} that entered lists and at most "
          "the {} photons of the leaves",
          context.unit, candidates->second, due.at("insertions"), most));
  }
  // A query has one subtree, and each node divides one: all end as leaves or are dropped.
  if (counted.contains("dropped") && plan.leaf_limit == 0 && global.lines > 0 &&
      caustic.lines > 0 && !in.reload &&
      counted.at("dropped") + due.at("leaves") != due.at("nodes") + due.at("queries"))
    throw std::runtime_error(fmt::format(
        "unit {}: counts {} dropped, expected {} nodes + {} queries - {} leaves", context.unit,
        counted.at("dropped"), due.at("nodes"), due.at("queries"), due.at("leaves")));
  if (const auto faults = counted.find("faults"); faults != counted.end() && faults->second)
    throw std::runtime_error(fmt::format("unit {}: counts {} faults of memory, expected none",
                                         context.unit, faults->second));
  if (fits_cache(plan, global, caustic) && !in.leaf_cache && !in.reload && !options.restart_after)
    if (const auto misses = counted.find("cache misses");
        misses != counted.end() && misses->second > global.lines + caustic.lines)
      throw std::runtime_error(fmt::format(
          "unit {}: {} lines were fetched, expected each of the maps' {} at most once, as the "
          "cache holds them all",
          context.unit, misses->second, global.lines + caustic.lines));
  totals.compared += both->compared();
  totals.cycles += rtl->cycles();
}

Bench bench() {
  Bench bench{unit_name<PhotonGatherer>, plans(), {}};
  for (const GatherCase& c : gather_cases())
    bench.cases.push_back({c.name, [c](auto&... run) { run_case(c, run...); }});
  return bench;
}

}  // namespace
}  // namespace photonloom

int main(int argc, char** argv) { return photonloom::bench_main(argc, argv, photonloom::bench()); }
