// SPDX-License-Identifier: Apache-2.0
// The bench of gather_engine: a cluster of gatherers on its photon memory, with the gatherer's
// cases, each as it is and through the reorder buffer.
#include <fmt/core.h>

#include "golden/packet/trace.hpp"
#include "verilator_tb/bench/bench.hpp"
#include "verilator_tb/bench/gather_cases.hpp"

namespace photonloom {
namespace {

// A cluster of gatherers with its photon memory: the gatherer's cases, some of them through the
// reorder buffer.
struct ClusterCase {
  std::string name;
  GatherCase gather;
  bool reordered = false;
  uint64_t photon_pause = 0;  // of the receiver of photons, RunOptions
};

std::vector<BenchPlan> plans() {
  std::vector<BenchPlan> list;
  const auto add = [&](const char* name, auto&& change) {
    Plan p;
    p.position_bits = 12;
    p.k = 8;
    p.global = {.present = true, .photons = 600};
    p.caustic = {.present = true, .photons = 100};
    p.cache_bytes = 512;
    p.width = p.height = 64;
    p.beat_bits = 8 * p.line_bytes();
    p.gatherers = 3;
    p.reorder_packets = 64;
    p.reorder_bins = 64;
    change(p);
    for (MapPlan* m : {&p.global, &p.caustic}) m->r2_max = p.r2_limit();
    list.push_back({name, p});
  };
  add("three", [](Plan&) {});
  add("one", [](Plan& p) {
    p.gatherers = 1;
    p.contexts = 2;
    p.beat_bits = 128;
    p.caustic = {};
    p.reorder_key = ReorderKey::kNone;
  });
  // Photons of 12 bytes in a stride of 14, lines of 28 words in two beats.
  add("eight", [](Plan& p) {
    p.gatherers = 8;
    p.contexts = 4;
    p.photon_bytes = 14;
    p.cache_bytes = 4 * p.line_bytes();
    p.beat_bits = 4 * p.line_bytes();
    p.reorder_key = ReorderKey::kHash;
    p.reorder_drain = ReorderDrain::kFullest;
  });
  // Lines of 96 bytes in three beats, so that a beat's address is a product.
  add("three_beats", [](Plan& p) {
    p.gatherers = 2;
    p.photon_bytes = 12;
    p.cache_bytes = 4 * p.line_bytes();
    p.beat_bits = 256;
    p.parity = true;
  });
  // Lines of 96 bytes in 24 beats: 2,049 to 4,096 beats, in banks of block RAM.
  add("banks", [](Plan& p) {
    p.gatherers = 2;
    p.photon_bytes = 12;
    p.cache_bytes = 4 * p.line_bytes();
    p.beat_bits = 32;
    p.parity = true;
  });
  // 1,536 lines of two beats, which stand side by side in a row; three gatherers, so that one port
  // has two of them.
  const auto rows = [](Plan& p) {
    p.bucket = p.lanes = 2;
    p.global.photons = 2048;
    p.caustic.photons = 1024;
    p.cache_bytes = 4 * p.line_bytes();
    p.cache_misses = 4;
    p.beat_bits = 4 * p.line_bytes();
    p.reorder_key = ReorderKey::kNone;
    p.parity = true;
  };
  add("rows", rows);
  // 1,024 lines of 12 words in rows of three beats, which cut photons.
  add("rows_of_three", [](Plan& p) {
    p.bucket = 4;
    p.gatherers = 2;
    p.global.photons = 4096;
    p.caustic = {};
    p.photon_bytes = 12;
    p.cache_bytes = 4 * p.line_bytes();
    p.beat_bits = 128;
  });
  // The last of three gatherers uses both ports: lines of two maps, of which a line's row is a sum.
  add("both_ports", [&](Plan& p) {
    rows(p);
    p.nodes_per_cycle = 2;
  });
  // And of one map, whose lines are the rows, of four beats.
  add("both_ports_at_once", [](Plan& p) {
    p.bucket = 4;
    p.nodes_per_cycle = 2;
    p.global.photons = 4096;
    p.caustic = {};
    p.cache_bytes = 4 * p.line_bytes();
    p.beat_bits = 128;
    p.reorder_key = ReorderKey::kNone;
    p.parity = true;
  });
  // Replies three cycles after their request to a list without codes, of a leaf that is the root.
  add("both_ports_early", [](Plan& p) {
    p.bucket = 4;
    p.k = 5;
    p.contexts = 2;
    p.nodes_per_cycle = 2;
    p.global.photons = 4096;
    p.caustic = {};
    p.cache_bytes = 0;
    p.beat_bits = 4 * p.line_bytes();
    p.reorder_key = ReorderKey::kNone;
  });
  // Both, and no leaf caches: five far gatherers, whose lanes take a beat from the memory's
  // registers.
  add("both_ports_uncached", [](Plan& p) {
    p.k = 12;
    p.gatherers = 5;
    p.bucket = 4;
    p.lanes = 2;
    p.contexts = 6;
    p.nodes_per_cycle = 2;
    p.global.photons = 5000;
    p.caustic = {};
    p.cache_bytes = 0;
    p.beat_bits = 4 * p.line_bytes();
    p.reorder_key = ReorderKey::kNone;
    p.parity = true;
  });
  // Of seven the last; both beats of a row are one part of a line for the lanes; the caustic map
  // alone.
  add("both_ports_of_seven", [](Plan& p) {
    p.k = 9;
    p.gatherers = 7;
    p.lanes = p.bucket = 4;
    p.contexts = 4;
    p.nodes_per_cycle = 2;
    p.global = {};
    p.caustic.photons = 5000;
    p.photon_bytes = 12;
    p.cache_bytes = 0;
    p.beat_bits = 4 * p.line_bytes();
    p.reorder_key = ReorderKey::kNone;
  });
  // Rows of two beats, straight to the lanes of five gatherers without leaf caches.
  add("uncached", [](Plan& p) {
    p.bucket = 4;
    p.lanes = 2;
    p.global.photons = 4096;
    p.caustic = {};
    p.cache_bytes = 0;
    p.beat_bits = 4 * p.line_bytes();
    p.gatherers = 5;
    p.reorder_key = ReorderKey::kNone;
  });
  // One gatherer and one query: a leaf that is its map's root comes as soon after a start as any.
  add("uncached_alone", [](Plan& p) {
    p.k = 3;
    p.gatherers = p.contexts = 1;
    p.cache_bytes = 0;
    p.lanes = p.bucket;
    p.reorder_key = ReorderKey::kNone;
  });
  // Five gatherers of lists of 12 places: results and photons come from far.
  add("far", [](Plan& p) {
    p.k = 12;
    p.gatherers = 5;
    p.contexts = 4;
    p.parity = true;
  });
  // Two levels of a descent at once, and whole parts of lines straight to the lanes.
  add("far_levels", [](Plan& p) {
    p.k = 12;
    p.gatherers = 6;
    p.contexts = 6;
    p.nodes_per_cycle = 2;
    p.global.photons = 2048;
    p.caustic = {};
    p.cache_bytes = 0;
    p.lanes = 4;
    p.photon_bytes = 12;
    p.beat_bits = 4 * 8 * p.photon_bytes;
    p.reorder_key = ReorderKey::kNone;
  });
  // A beat a line of 24 words, queries as they come: most lines come from the photon memory.
  add("whole_lines", [](Plan& p) {
    p.gatherers = 4;
    p.photon_bytes = 12;
    p.cache_bytes = 2 * p.line_bytes();
    p.cache_misses = 4;
    p.beat_bits = 8 * p.line_bytes();
    p.reorder_key = ReorderKey::kNone;
  });
  add("sdram", [](Plan& p) {
    p.photon_memory = PhotonMemory::kSdram;
    p.sdram_khz = kSdramMostKHz;
    p.board_cache_bytes = 16 * p.line_bytes();
  });
  // A cache of 256 lines with a prefetcher before it; lists of 12 places compare codes.
  add("sdram_prefetched", [](Plan& p) {
    p.k = 12;
    p.photon_memory = PhotonMemory::kSdram;
    p.sdram_khz = kSdramMostKHz;
    p.gatherers = 2;
    p.contexts = 4;
    p.lanes = 2;
    p.photon_bytes = 12;
    p.cache_bytes = 4 * p.line_bytes();
    p.beat_bits = 4 * p.line_bytes();
    p.board_cache_bytes = 256 * p.line_bytes();
  });
  // Three gatherers and a prefetcher at two node memories; far ones of more than 16 contexts.
  add("shared_nodes", [](Plan& p) {
    p.contexts = 20;
    p.photon_memory = PhotonMemory::kSdram;
    p.sdram_khz = kSdramMostKHz;
    p.photon_bytes = 12;
    p.cache_bytes = 4 * p.line_bytes();
    p.beat_bits = 4 * p.line_bytes();
    p.board_cache_bytes = 256 * p.line_bytes();
    p.shared_nodes = true;
    p.parity = true;
  });
  // Three gatherers alone: the last has the second memory for itself. With 32 contexts up to
  // 128 queries a gatherer may wait for the oldest.
  add("shared_nodes_odd", [](Plan& p) {
    p.shared_nodes = true;
    p.contexts = 32;
  });
  // Lines of 96 bytes, a beat a photon, a cache of four lines.
  add("sdram_narrow", [](Plan& p) {
    p.photon_memory = PhotonMemory::kSdram;
    p.sdram_khz = 87500;
    p.refreshes_ahead = 2;
    p.gatherers = 2;
    p.photon_bytes = 12;
    p.cache_bytes = 4 * p.line_bytes();
    p.beat_bits = p.line_bytes();
    p.board_cache_bytes = 4 * p.line_bytes();
    p.parity = true;
  });
  // Lines of 80 bytes; many of so few leaves are too large for one.
  add("sdram_compressed", [](Plan& p) {
    p.photon_memory = PhotonMemory::kSdram;
    p.sdram_khz = kSdramLeastKHz;
    p.gatherers = 2;
    p.position_bits = 16;
    p.photon_bytes = 10;
    p.photon_lines = PhotonLines::kCompressed;
    p.further_percent = 700;
    p.cache_bytes = 4 * p.line_bytes();
    p.beat_bits = 4 * p.line_bytes();
    p.board_cache_bytes = 8 * p.line_bytes();
  });
  return list;
}

std::vector<ClusterCase> cases() {
  std::vector<ClusterCase> list;
  for (const GatherCase& c : gather_cases()) {
    // Results go on while nobody takes photons, until every place for them is full.
    if (c.name == "all_want_photons") list.push_back({"photons_wait", c, false, 3000});
    list.push_back({c.name, c, false});
    list.push_back({c.name + "_reordered", c, true});
  }
  return list;
}

void run_case(const ClusterCase& c, const Plan& bench_plan, const RunOptions& options,
              const CompareContext& context, BenchRandom& random, BenchTotals& totals) {
  const GatherStimulus in = c.gather.make(bench_plan, random);
  Plan plan = bench_plan;
  if (in.r2_max) {
    plan.global.r2_max = (*in.r2_max)[0];
    plan.caustic.r2_max = (*in.r2_max)[1];
  }
  PhotonMap global = build_photon_map(in.global, plan);
  PhotonMap caustic = build_photon_map(in.caustic, plan);
  const auto golden = make_golden_photon_gatherer(plan);
  const auto order = make_golden_reorder_buffer(plan);
  // The SDRAM's clock from less than half the core's frequency to three times as much.
  RunOptions with_clock = options;
  with_clock.leaf_cache = in.leaf_cache;
  with_clock.photon_pause = c.photon_pause;
  with_clock.sdram_period = 0.33 + static_cast<double>(random.below(2000)) / 1000;
  const auto rtl = make_rtl_gather_engine(plan, with_clock, c.reordered);
  StreamComparer compare_results(PacketLayout::of<GatherResult>(plan), "result", context);
  StreamComparer compare_photons(PacketLayout::of<GatherPhoton>(plan), "photon", context);
  golden->load(global, caustic);
  rtl->load(global, caustic);

  const auto ask = [&](std::span<const GatherQuery> queries) {
    std::vector<GatherQuery> ordered;
    if (c.reordered)
      order->process(queries, ordered);
    else
      ordered.assign(queries.begin(), queries.end());
    std::vector<GatherResult> expected, results;
    std::vector<GatherPhoton> expected_photons, photons;
    golden->process(ordered, expected, expected_photons);
    rtl->process(queries, results, photons);
    const auto result_input = [&](size_t i) {
      return packet_to_json(PacketLayout::of<GatherQuery>(plan), &ordered[i]);
    };
    compare_results.compare<GatherResult>(expected, results, rtl->out_cycles(0), result_input);
    compare_photons.compare<GatherPhoton>(
        expected_photons, photons, rtl->out_cycles(1), [&](size_t i) {
          size_t q = 0;
          for (; !ordered[q].want_photons || ordered[q].flush || i >= expected[q].count; ++q)
            if (ordered[q].want_photons && !ordered[q].flush) i -= expected[q].count;
          return result_input(q);
        });
  };
  // Whatever waits in the reorder buffer comes out at the end.
  std::vector<GatherQuery> queries = in.queries;
  if (c.reordered) {
    queries.push_back({});
    queries.back().flush = 1;
  }
  const auto ask_all = [&] { feed(queries, random, ask); };
  ask_all();
  if (in.reload) {
    global = build_photon_map((*in.reload)[0], plan);
    caustic = build_photon_map((*in.reload)[1], plan);
    golden->load(global, caustic);
    rtl->load(global, caustic);
    ask_all();
  }
  rtl->finish();
  const Counters counted = rtl->counters();
  check_counters(context.unit, golden->counters(), counted, rtl->cycles());
  const auto expect = [&](const std::string& name, uint64_t due) {
    if (counted.at(name) != due)
      throw std::runtime_error(fmt::format("unit {}: counts {} {}, expected {}", context.unit,
                                           counted.at(name), name, due));
  };
  expect("reordered", c.reordered ? counted.at("packets in") : 0);
  expect("faults", 0);
  // An SDRAM's are fetched ahead too.
  if (plan.photon_memory == PhotonMemory::kBlockRam) expect("memory lines", counted.at("lines"));
  totals.compared += compare_results.compared() + compare_photons.compared();
  totals.cycles += rtl->cycles();
}

Bench bench() {
  // Where all photons lie in one point, each of the queries in flight reads every line; from an
  // SDRAM, with caches of a few lines, the first is through after half a million cycles and more.
  Bench bench{"gather_engine", plans(), {}, true, 5000000};
  for (const ClusterCase& c : cases())
    bench.cases.push_back({c.name, [c](auto&... run) { run_case(c, run...); }});
  return bench;
}

}  // namespace
}  // namespace photonloom

int main(int argc, char** argv) { return photonloom::bench_main(argc, argv, photonloom::bench()); }
