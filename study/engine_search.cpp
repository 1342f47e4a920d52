// SPDX-License-Identifier: Apache-2.0
#include "study/engine_search.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <stdexcept>

#include "golden/unit/photon_gatherer.hpp"
#include "rtl/generate/clocks.hpp"
#include "study/cycle_fit.hpp"
#include "study/frame_gathers.hpp"
#include "study/gather_cost.hpp"
#include "study/point_plan.hpp"
#include "verilator_tb/throughput/roofline.hpp"

namespace photonloom {
namespace {

// Gathers of a frame that engines are chosen for.
constexpr size_t kQueries = 131072;
// Queries whose reciprocals are counted.
constexpr size_t kCounted = 1024;
// As fast within this part is as fast.
constexpr double kAsFast = 0.01;
// Figures that differ by so little differ by the roundings of their sums: such engines are equals.
// No check is held to this; it decides ties alone.
constexpr double kRounding = 1e-9;
// From a request to a line's first beat where nobody else asks: of rtl/board/photon_ram.sv, and of
// the cache of rtl/board/photon_sdram.sv.
constexpr int kBlockRamLatency = 5, kSharedCacheLatency = 9;
// Of rtl/board/sdram_controller.sv, in its clock, from a READ to the line's first halfword; its
// banks, and the halfwords of a row of all of them.
constexpr int kSdramReadLatency = 5;
constexpr uint32_t kSdramBanks = 4, kSdramRow = 2048;
constexpr uint32_t kSharedWays = 4;
// Queries over which the work of gatherers and SDRAM evens out: those in flight, those that wait,
// and those whose lines are asked for ahead. The best power of two for engines of one to three
// gatherers in four scenes of tests/study/engine_frames_slow.cpp; half or double of it changes what
// is predicted by up to 5 %.
constexpr size_t kEvenedOut = 128;
// Before an SDRAM: lines of the cache, and places of the pool: 16 less than its memories have words
// waste none of them.
constexpr int kSharedLines[] = {512, 1024}, kPools[] = {2032, 4080, 8176, 12272};
// Of a gatherer's own cache. None before block RAM alone: each leaf of all gatherers would pass the
// one port of the cache before an SDRAM; two gatherers of k = 50 bear it, which is not searched.
constexpr int kLeafCacheLines[] = {0, 16, 32, 64, 128};

using Order = std::vector<uint32_t>;

// As the plan's reorder buffer lets queries go that come in their own order.
Order served_order(const Plan& plan, std::span<const GatherQuery> queries) {
  Order order(queries.size());
  std::iota(order.begin(), order.end(), 0u);
  return buffered_order(plan, queries, order);
}

// Searches, and the cycles of a reciprocal, which no plan's engine changes.
struct Load {
  GatherSearches searches;
  double reciprocal = 0;
};

// Cycles of rtl/common/reciprocal.sv, a result in the mean; 0 where a plan has none.
double reciprocal_cycles(const Plan& plan, const PhotonMap& global, const PhotonMap& caustic,
                         std::span<const GatherQuery> queries) {
  if (plan.reciprocal_bits == 0) return 0;
  const std::unique_ptr<PhotonGatherer> golden = make_golden_photon_gatherer(plan);
  golden->load(global, caustic);
  std::vector<GatherResult> results;
  std::vector<GatherPhoton> photons;
  std::vector<GatherQuery> counted;
  for (size_t i = 0; i < queries.size(); i += std::max<size_t>(1, queries.size() / kCounted))
    counted.push_back(queries[i]);
  golden->process(counted, results, photons);
  double sum = 0;
  for (const GatherResult& r : results) {
    const int zeros = plan.r2_bits() - std::bit_width(std::max<uint64_t>(r.r2, plan.r2_floor));
    sum += (plan.reciprocal_bits + 2) / 2 + 5 + zeros / 4 + zeros % 4;
  }
  return sum / static_cast<double>(results.size());
}

Load load_of(const Plan& plan, const PhotonMap& global, const PhotonMap& caustic,
             std::span<const GatherQuery> queries) {
  return {searched(plan, global, caustic, queries),
          reciprocal_cycles(plan, global, caustic, queries)};
}

// Lines that a gatherer asks the photon memory for, a query: its share of queries dealt in turn,
// through its own cache. Widths and contexts hardly matter to what a cache fetches: they are the
// usual ones, so that engines that differ in them alone are told apart by their cycles alone.
double lines_asked(const Plan& plan, const LineVisits& visits, const Order& order) {
  Plan usual = plan;
  usual.contexts = 16;
  usual.lanes = std::min(4, plan.bucket);
  usual.beat_bits = 8 * plan.photon_bytes * usual.lanes;
  Order own;
  for (size_t i = 0; i < order.size(); i += static_cast<size_t>(plan.gatherers))
    own.push_back(order[i]);
  return static_cast<double>(lines_fetched(leaf_cache_shape(plan), visits, own, usual.contexts,
                                           lookup_times(usual, kBlockRamLatency))) /
         static_cast<double>(own.size());
}

// What the SDRAM has to do, of each kEvenedOut queries in the order in which they are served.
struct SdramWork {
  double lines = 0;  // of all queries, a query
  struct Part {
    double searches = 0;  // of the searches of all queries, by the lines that they read
    double cycles = 0;    // of the SDRAM's clock, a query of all
  };
  std::vector<Part> parts = {};
};

// Queries that are searched at a time, near enough to tell what a cache keeps for them: a power of
// two, so that few such numbers are followed.
size_t queries_at_once(const Plan& plan) {
  const auto contexts = static_cast<size_t>(plan.gatherers) * static_cast<size_t>(plan.contexts);
  return std::bit_floor(contexts + contexts / 2);
}

// Lines that the cache before the SDRAM lacks, where queries_at_once() read a line each in turn,
// and row changes: of each that leaves a row for another one of the bank that was just read.
SdramWork work_of_sdram(const Plan& plan, const LineVisits& visits, const Order& order) {
  const auto line_bytes = static_cast<uint32_t>(plan.line_bytes());
  // Sets are a power of two, as rtl/board/photon_sdram.sv has them.
  CacheModel cache(
      {std::max<uint32_t>(1, std::bit_floor(static_cast<uint32_t>(plan.board_cache_bytes) /
                                            line_bytes / kSharedWays)),
       kSharedWays});
  // A line has a place of a power of two halfwords; those of the caustic map come after the others.
  const uint32_t halfwords = line_bytes / 2, row_lines = kSdramRow >> clog2(halfwords);
  const uint32_t caustic = 1u << plan.line_address_bits();
  const auto first_caustic = static_cast<uint32_t>(plan.memory_lines(plan.global));
  const double change = row_change_cycles(plan.sdram_khz);
  struct Flight {
    std::span<const uint32_t> lines;
    size_t part = 0;
  };
  std::vector<Flight> flights(queries_at_once(plan));
  std::vector<SdramWork::Part> parts((order.size() + kEvenedOut - 1) / kEvenedOut);
  size_t next = 0, busy = 0, fetched = 0;
  const auto enter = [&](Flight& flight) {
    while (flight.lines.empty() && next < order.size()) {
      flight.part = next / kEvenedOut;
      flight.lines = visits.of(order[next++]);
      parts[flight.part].searches += 1 + static_cast<double>(flight.lines.size());
    }
    busy += !flight.lines.empty();
  };
  for (Flight& flight : flights) enter(flight);
  uint32_t last = 0;
  while (busy > 0)
    for (Flight& flight : flights) {
      if (flight.lines.empty()) continue;
      const uint32_t line = flight.lines.front();
      if (!cache.read(line)) {
        const uint32_t place = line < caustic ? line : first_caustic + line - caustic;
        const bool changes = fetched > 0 && place % kSdramBanks == last % kSdramBanks &&
                             place / row_lines != last / row_lines;
        parts[flight.part].cycles += halfwords + (changes ? change : 0);
        last = place;
        ++fetched;
      }
      flight.lines = flight.lines.subspan(1);
      if (!flight.lines.empty()) continue;
      --busy;
      enter(flight);
    }
  const auto queries = static_cast<double>(order.size());
  for (SdramWork::Part& part : parts) {
    part.searches /= queries + static_cast<double>(visits.total());
    part.cycles /= kRefreshLeaves * queries;
  }
  return {static_cast<double>(fetched) / queries, std::move(parts)};
}

// sdram: where the plan has one.
EngineCycles predict(const Plan& plan, const Load& of, double lines, const SdramWork* sdram,
                     int core_khz) {
  EngineCycles e;
  GatherLoad load = of.searches.load;
  load.misses = lines;
  int latency = kBlockRamLatency;
  if (sdram) {
    // A line that the cache lacks comes whole before its first beat goes on.
    const double slow = lines > 0 ? std::min(1.0, sdram->lines / lines) : 0;
    const double read = kSdramReadLatency + plan.line_bytes() / 2.0;
    latency = kSharedCacheLatency +
              static_cast<int>(std::lround(slow * read * core_khz / plan.sdram_khz));
  }
  // What the fit has not, for it does not bind where leaf caches and one candidate a cycle do: a
  // reciprocal takes its time (rtl/common/reciprocal.sv). Queries that wait for one hold nothing
  // else up.
  const bool apart = !sdram && plan.cache_bytes != 0;
  e.gatherers = std::max(modelled_cycles(plan, load, latency,
                                         apart ? LineBeats::kElsewhere : LineBeats::kBound),
                         of.reciprocal / std::max(1, plan.reciprocals())) /
                plan.gatherers;
  const double beats = plan.line_beats();
  if (sdram) {
    e.memory_lines = sdram->lines;
    // A port of the cache reads a beat a cycle; the SDRAM a halfword a cycle of its clock. The
    // first queries of a region wait for its lines, and while the others are searched the SDRAM
    // waits for the next region: what binds differs from part to part.
    const double port = kCycleFit.memory * beats * lines;
    for (const SdramWork::Part& part : sdram->parts) {
      const double memory = std::max(part.cycles * core_khz / plan.sdram_khz, port * part.searches);
      e.memory += memory;
      e.cycles += std::max(e.gatherers * part.searches, memory);
    }
    return e;
  }
  // A port reads a row a cycle, and its beats go to a gatherer one after the other.
  const double row = plan.photon_ram_row(), ports = std::min(2, plan.gatherers);
  e.memory = kCycleFit.memory * beats * lines / (row * ports);
  if (apart) {
    // With a cache between, lines come while others are searched, and a port is never idle while
    // some are waited for: what has more to do binds, and the other waits for nothing.
    e.memory = std::max(e.memory, kCycleFit.memory * beats * lines / plan.gatherers);
    e.cycles = std::max(e.gatherers, e.memory);
  } else {
    e.cycles = std::pow(std::pow(e.gatherers, kUncachedPower) + std::pow(e.memory, kUncachedPower),
                        1 / kUncachedPower);
  }
  return e;
}

EngineCycles predict(const Plan& plan, const Load& of, const LineVisits& visits, const Order& order,
                     int core_khz) {
  const double lines = lines_asked(plan, visits, order);
  if (plan.photon_memory != PhotonMemory::kSdram)
    return predict(plan, of, lines, nullptr, core_khz);
  const SdramWork work = work_of_sdram(plan, visits, order);
  return predict(plan, of, lines, &work, core_khz);
}

// A board's memory for the lines, and the buffer in front of the gatherers. cache_lines: of the
// cache before an SDRAM.
struct Stream {
  PhotonMemory memory;
  ReorderKey key;
  int packets, cache_lines;
  size_t order;  // by number
  // Of an SDRAM, by bytes a photon and queries at once.
  std::map<std::pair<int, size_t>, SdramWork> work = {};
};

// Values of the searched lines.
struct Widths {
  int gatherers, nodes, candidates, powers, lanes, contexts, cache_lines, lut_words, stride;
};

const char* name_of(ReorderKey key) {
  constexpr const char* kNames[] = {"none", "hilbert", "hash"};
  return kNames[static_cast<size_t>(key)];
}

std::string too_many_wires(const Plan& p) {
  const bool cached = p.cache_bytes != 0;
  const int most = cached ? kEngineWires : kUncachedWires;
  if (p.gatherers * p.beat_bits <= most) return "";
  return fmt::format(
      "needs beats of {} bits together, and no faster top {} leaf caches with more than {} was "
      "routed",
      p.gatherers * p.beat_bits, cached ? "with" : "without", most);
}

// Whether a node memory for each two gatherers is tried: where it was routed.
bool may_share_nodes(const Plan& p) {
  return p.photon_memory == PhotonMemory::kSdram && p.nodes_per_cycle == 1 && p.gatherers > 1;
}

std::string divided(const Plan& p) {
  if (p.photon_memory != PhotonMemory::kBlockRam) return "";
  const bool rows = p.photon_ram_row() > 1;
  if (!p.photon_ram_is_divided() || (rows && p.cache_bytes == 0)) return "";
  return fmt::format(
      "needs {} beats of {} bits, in {} of block RAM, and no engine with such {} was routed",
      p.photon_ram_beats(), p.beat_bits, rows ? "rows" : "banks",
      rows ? "rows and leaf caches" : "banks");
}

// The widest beat of at most 1,024 bits that the wires leave each gatherer: whole words of 32 bits
// that divide a line, and without a leaf cache what the lanes take a cycle, as
// rtl/board/photon_ram.sv takes them, photons may be cut; none in banks.
int widest_beat(Plan p) {
  const bool cached = p.cache_bytes != 0;
  const int whole = 8 * p.photon_bytes * (cached ? p.bucket : p.lanes);
  const int wires = (cached ? kEngineWires : kUncachedWires) / p.gatherers;
  for (p.beat_bits = std::min({1024, wires, whole}) / 32 * 32; p.beat_bits > 32; p.beat_bits -= 32)
    if (whole % p.beat_bits == 0 && divided(p).empty()) break;
  return p.beat_bits;
}

Plan with(const Plan& plan, const Stream& s, const Widths& w) {
  Plan p = plan;
  p.photon_memory = s.memory;
  p.reorder_key = s.key;
  p.reorder_packets = s.packets;
  p.photon_bytes = w.stride;
  p.board_cache_bytes =
      s.memory == PhotonMemory::kSdram ? s.cache_lines * p.line_bytes() : plan.board_cache_bytes;
  p.gatherers = w.gatherers;
  p.nodes_per_cycle = w.nodes;
  p.candidates_per_cycle = w.candidates;
  p.powers_per_cycle = w.powers;
  p.lanes = w.lanes;
  p.contexts = w.contexts;
  p.cache_ways = 2;
  p.cache_bytes = w.cache_lines * p.line_bytes();
  p.lut_ram_words = w.lut_words;
  p.shared_nodes = false;
  // Before an SDRAM as many photons as lanes: no more come from the chip at once.
  p.beat_bits = s.memory == PhotonMemory::kBlockRam ? widest_beat(p) : 8 * w.stride * w.lanes;
  return p;
}

// Bytes a photon: those of the plan, and where lines are plain ones as few as hold it, and as many
// as the planner pads it to.
std::vector<int> strides(const Plan& plan) {
  if (plan.photon_lines != PhotonLines::kPlain) return {plan.photon_bytes};
  const int padded = plan.photon_bits() > 8 * 16 ? 32 : 16;
  std::vector<int> all = {smallest_stride(plan), plan.photon_bytes, padded};
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

std::vector<Widths> all_widths(const Plan& plan) {
  std::vector<Widths> all;
  for (int gatherers = 1; gatherers <= 8; ++gatherers)
    for (const int nodes : {1, 2})
      for (const int candidates : {1, 2, 4})
        for (const int powers : {1, 2, 4})
          for (const int lanes : {2, 4, 8})
            for (const int contexts : {8, 16, 32, 48})
              for (const int cache_lines : kLeafCacheLines)
                for (const int lut_words : {0, 32, 64, 128})
                  for (const int stride : strides(plan)) {
                    if (powers > candidates || lanes > plan.bucket) continue;
                    all.push_back({gatherers, nodes, candidates, powers, lanes, contexts,
                                   cache_lines, lut_words, stride});
                  }
  return all;
}

}  // namespace

std::vector<GatherQuery> engine_queries(const PreparedFrame& frame, Progress* progress) {
  Plan plan = frame.plan;
  // Queries as the frame makes them: which buffer they pass is searched for.
  plan.reorder_key = ReorderKey::kNone;
  const auto kept_of = [&](int spp) {
    plan.spp = spp;
    FrameUnits units = make_golden_units(plan);
    auto watched = std::make_unique<WatchedGatherer>(plan, kQueries);
    const WatchedGatherer& window = *watched;
    units.photon_gatherer = std::move(watched);
    FrameCounts counts;
    const FrameInput input{*frame.world,  *frame.caster, plan,    frame.global,
                           frame.caustic, nullptr,       nullptr, frame.seed};
    render_frame(input, units, counts, progress);
    return window.kept();
  };
  std::vector<GatherQuery> kept = kept_of(1);
  // The first samples of a small frame may all miss.
  if (kept.empty() && frame.plan.spp > 1) kept = kept_of(frame.plan.spp);
  return kept;
}

std::string engine_misfit(const Plan& plan, const BoardDescription& board) {
  const std::string why = misfit(plan, board, kEngineShare);
  if (!why.empty()) return why;
  const std::string wires = too_many_wires(plan);
  return wires.empty() ? divided(plan) : wires;
}

EngineCycles engine_cycles(const Plan& plan, const PhotonMap& global, const PhotonMap& caustic,
                           std::span<const GatherQuery> queries, int core_khz) {
  const Load load = load_of(plan, global, caustic, queries);
  const LineVisits& visits = load.searches.visits;
  return predict(plan, load, visits, served_order(plan, queries), core_khz);
}

std::vector<const char*> engine_lines(const BoardDescription& board, PhotonLines photons) {
  std::vector<const char*> lines{"board.gatherers",
                                 "board.photon_memory",
                                 "board.cache_bytes",
                                 "board.lut_ram_words",
                                 "board.shared_nodes",
                                 "gatherer.nodes_per_cycle",
                                 "gatherer.candidates_per_cycle",
                                 "gatherer.powers_per_cycle",
                                 "gatherer.lanes",
                                 "gatherer.contexts",
                                 "gatherer.cache_bytes",
                                 "gatherer.cache_ways",
                                 "gatherer.beat_bits",
                                 "reorder.key"};
  if (photons == PhotonLines::kPlain) lines.push_back("photon.photon_bytes");
  // Before block RAM the pool is the plan's own.
  if (board.tops.count("sdram")) lines.insert(lines.end(), {"reorder.packets", "board.sdram_khz"});
  return lines;
}

EngineSearch fastest_engine(const Plan& given, const PhotonMap& global, const PhotonMap& caustic,
                            std::span<const GatherQuery> queries, const BoardDescription& board) {
  if (queries.empty())
    throw std::runtime_error(
        "--board: the frame asks for no gather but those for tables, so no engine is faster than "
        "another");
  const bool has_sdram = board.tops.count("sdram") && board.sdram;
  Plan plan = given;
  if (has_sdram) plan.sdram_khz = sdram_clock(board, plan.sdram_khz);
  const Load load = load_of(plan, global, caustic, queries);
  const LineVisits& visits = load.searches.visits;

  // ---- memories and buffers ----
  std::vector<Stream> streams;
  std::vector<Order> orders;
  std::map<std::pair<ReorderKey, int>, size_t> order_of;
  const auto add = [&](PhotonMemory memory, ReorderKey key, int packets, int cache_lines) {
    Plan p = plan;
    p.photon_memory = memory;
    p.reorder_key = key;
    p.reorder_packets = packets;
    p.board_cache_bytes = cache_lines * p.line_bytes();
    const auto [at, is_new] = order_of.try_emplace({key, packets}, orders.size());
    if (is_new) orders.push_back(served_order(p, queries));
    streams.push_back({memory, key, packets, cache_lines, at->second});
  };
  const ReorderKey ordered =
      plan.reorder_key == ReorderKey::kNone ? ReorderKey::kHilbert : plan.reorder_key;
  if (board.tops.count("block_ram"))
    for (const ReorderKey key : {ordered, ReorderKey::kNone})
      add(PhotonMemory::kBlockRam, key, plan.reorder_packets, 0);
  if (has_sdram)
    for (const int lines : kSharedLines) {
      for (const int packets : kPools) add(PhotonMemory::kSdram, ordered, packets, lines);
      add(PhotonMemory::kSdram, ReorderKey::kNone, plan.reorder_packets, lines);
    }
  if (streams.empty())
    throw std::runtime_error(
        fmt::format("--board: {} has no top for gathers, expected block_ram or sdram in its {}",
                    board.name, board.file));

  // ---- all engines that fit, predicted ----
  struct Candidate {
    size_t stream;
    Widths widths;
    bool shared_nodes;
    BoardNeeds needs;
    EngineCycles cycles;
  };
  // What was counted, by what it depends on.
  std::map<std::array<int, 3>, double> asked;
  std::map<std::array<int, 11>, BoardNeeds> gatherers;
  std::map<std::array<int, 6>, BoardNeeds> others;
  const auto needs_of = [&](size_t stream, const Widths& w, const Plan& p) {
    const auto [one, new_gatherer] = gatherers.try_emplace(
        {p.photon_memory == PhotonMemory::kSdram, p.far_gatherers(), p.beat_bits, w.nodes,
         w.candidates, w.powers, w.lanes, w.contexts, w.cache_lines, w.lut_words, w.stride});
    if (new_gatherer) one->second = gatherer_needs(p);
    const auto [rest, new_rest] =
        others.try_emplace({static_cast<int>(stream), p.beat_bits, w.lut_words, w.stride,
                            p.prefetch_queries(), p.shared_nodes ? w.gatherers : 0});
    if (new_rest) rest->second = other_needs(p);
    return rest->second + w.gatherers * one->second;
  };
  const auto why_not = [&](const Plan& p, const BoardNeeds& needs) {
    std::string why = misfit(needs, board, kEngineShare);
    if (why.empty()) why = too_many_wires(p);
    return why.empty() ? divided(p) : why;
  };
  std::vector<Candidate> fitting;
  // Of those that a plan may have and that do not fit, the one with the least block RAM.
  double least_blocks = std::numeric_limits<double>::infinity();
  std::string why_smallest, why_no_plan;
  const std::vector<Widths> widths = all_widths(plan);
  for (size_t i = 0; i < streams.size(); ++i) {
    Stream& at = streams[i];
    for (const Widths& w : widths) {
      if (w.cache_lines == 0 && at.memory == PhotonMemory::kSdram) continue;
      Plan p = with(plan, at, w);
      BoardNeeds needs = needs_of(i, w, p);
      std::string why = why_not(p, needs);
      // Shared nodes change no cycle, only what fits.
      if (!why.empty() && may_share_nodes(p)) {
        p.shared_nodes = true;
        needs = needs_of(i, w, p);
        why = why_not(p, needs);
      }
      if (!why.empty() && needs.blocks >= least_blocks) continue;
      if (const auto problem = find_problem(p)) {
        why_no_plan = problem->line + " " + problem->what;
        continue;
      }
      if (!why.empty()) {
        least_blocks = needs.blocks;
        why_smallest = why;
        continue;
      }
      const auto [lines, is_new] =
          asked.try_emplace({static_cast<int>(at.order), w.gatherers, w.cache_lines});
      if (is_new) lines->second = lines_asked(p, visits, orders[at.order]);
      const SdramWork* sdram = nullptr;
      if (at.memory == PhotonMemory::kSdram) {
        const auto [work, is_first] = at.work.try_emplace({w.stride, queries_at_once(p)});
        if (is_first) work->second = work_of_sdram(p, visits, orders[at.order]);
        sdram = &work->second;
      }
      fitting.push_back(
          {i, w, p.shared_nodes, needs, predict(p, load, lines->second, sdram, board.core_khz)});
    }
  }
  if (fitting.empty())
    throw std::runtime_error(
        why_smallest.empty()
            ? fmt::format("--board: no engine for {} can be planned: {}", board.name, why_no_plan)
            : fmt::format("--board: no engine fits {}: the smallest {}{}", board.name, why_smallest,
                          why_no_plan.empty() ? "" : "; others cannot be planned: " + why_no_plan));

  // ---- the fastest, and of those as fast the smallest ----
  std::vector<const Candidate*> left;
  for (const Candidate& c : fitting) left.push_back(&c);
  const auto keep_least = [&](double part, const auto& figure) {
    double least = std::numeric_limits<double>::infinity();
    for (const Candidate* c : left) least = std::min(least, figure(*c));
    std::erase_if(left, [&](const Candidate* c) { return figure(*c) > least * (1 + part); });
  };
  const auto cycles = [](const Candidate& c) { return c.cycles.cycles; };
  keep_least(kAsFast, cycles);
  keep_least(kRounding, [](const Candidate& c) { return c.needs.lut; });
  keep_least(kRounding, cycles);
  // Of equals one that leaves the SDRAM, whose controller no prediction counts, and block RAM
  // alone.
  keep_least(0, [&](const Candidate& c) {
    return streams[c.stream].memory == PhotonMemory::kSdram ? 1.0 : 0.0;
  });
  keep_least(0, [](const Candidate& c) { return c.needs.blocks; });
  const Candidate* best = left.front();
  EngineSearch found;
  found.fitting = fitting.size();
  found.best = {with(plan, streams[best->stream], best->widths), best->cycles};
  found.best.plan.shared_nodes = best->shared_nodes;
  derive_plan(found.best.plan);
  if (const std::string why = engine_misfit(found.best.plan, board); !why.empty())
    throw std::logic_error("the engine for " + board.name + " " + why +
                           ", which was not so where its parts were remembered");
  if (given.photon_memory != PhotonMemory::kSdram || has_sdram)
    found.given = engine_cycles(given, global, caustic, queries, board.core_khz);
  found.misfit = engine_misfit(given, board);

  // ---- what each line's next values would do, all others as they are but those that it says ----
  const Plan& made = found.best.plan;
  const bool sdram = made.photon_memory == PhotonMemory::kSdram;
  // As the search has it: nodes are shared where it does not fit otherwise.
  const auto engine = [&](const Stream& s, const Widths& w) {
    const Plan own = with(plan, s, w);
    if (find_problem(own) || engine_misfit(own, board).empty() || !may_share_nodes(own)) return own;
    Plan shared = own;
    shared.shared_nodes = true;
    return shared;
  };
  const auto would = [&](const Plan& p) -> std::string {
    if (const auto problem = find_problem(p)) return problem->line + " " + problem->what;
    if (const std::string why = engine_misfit(p, board); !why.empty()) return why;
    return fmt::format("{:.2f} cycles a gather",
                       predict(p, load, visits, served_order(p, queries), board.core_khz).cycles);
  };
  // What else a plan with another value of a line has changed: beats and caches follow lanes,
  // photons and gatherers, and the pool follows the memory.
  const auto besides = [&](const std::string& line, const Plan& p) {
    const struct {
      const char* line;
      int Plan::*member;
    } following[] = {{"gatherer.beat_bits", &Plan::beat_bits},
                     {"gatherer.cache_bytes", &Plan::cache_bytes},
                     {"board.cache_bytes", &Plan::board_cache_bytes},
                     {"reorder.packets", &Plan::reorder_packets}};
    std::string text;
    for (const auto& one : following)
      if (line != one.line && p.*one.member != made.*one.member)
        text += fmt::format("{}{} = {}", text.empty() ? " (with " : ", ", one.line, p.*one.member);
    if (line != "board.shared_nodes" && p.shared_nodes != made.shared_nodes)
      text +=
          fmt::format("{}board.shared_nodes = {}", text.empty() ? " (with " : ", ", p.shared_nodes);
    return text.empty() ? text : text + ")";
  };
  // Other values, in rising order, each with the plan that has it.
  const auto tell = [&](const char* line, const std::vector<std::pair<std::string, Plan>>& others) {
    std::string text;
    for (const auto& [value, p] : others)
      text +=
          fmt::format("{}{}{}: {}", text.empty() ? "" : "; ", value, besides(line, p), would(p));
    found.reasons[line] = text;
  };
  // The next lower and higher of `values` in rising order; with_value(v) is the plan that has v.
  const auto tell_next = [&](const char* line, int now, const auto& values, const auto& with_value,
                             int unit = 1) {
    std::vector<std::pair<std::string, Plan>> others;
    const auto at = std::find(std::begin(values), std::end(values), now);
    if (at == std::end(values)) throw std::logic_error(std::string(line) + " has another value");
    if (at != std::begin(values))
      others.emplace_back(fmt::format("{}", unit * *(at - 1)), with_value(*(at - 1)));
    if (at + 1 != std::end(values))
      others.emplace_back(fmt::format("{}", unit * *(at + 1)), with_value(*(at + 1)));
    tell(line, others);
  };
  const auto tell_width = [&](const char* line, int Widths::*field, const std::vector<int>& values,
                              int unit = 1) {
    tell_next(
        line, best->widths.*field, values,
        [&](int value) {
          Widths changed = best->widths;
          changed.*field = value;
          return engine(streams[best->stream], changed);
        },
        unit);
  };
  tell_width("board.gatherers", &Widths::gatherers, {1, 2, 3, 4, 5, 6, 7, 8});
  tell_width("gatherer.nodes_per_cycle", &Widths::nodes, {1, 2});
  tell_width("gatherer.candidates_per_cycle", &Widths::candidates, {1, 2, 4});
  tell_width("gatherer.powers_per_cycle", &Widths::powers, {1, 2, 4});
  tell_width("gatherer.lanes", &Widths::lanes, {2, 4, 8});
  tell_width("gatherer.contexts", &Widths::contexts, {8, 16, 32, 48});
  tell_width("gatherer.cache_bytes", &Widths::cache_lines,
             {std::begin(kLeafCacheLines) + (sdram ? 1 : 0), std::end(kLeafCacheLines)},
             made.line_bytes());
  tell_width("board.lut_ram_words", &Widths::lut_words, {0, 32, 64, 128});
  if (strides(plan).size() > 1)
    tell_width("photon.photon_bytes", &Widths::stride, strides(plan));
  else if (!plan.compressed())
    found.reasons["photon.photon_bytes"] =
        "no fewer hold a photon and make lines of whole 16 bytes";
  found.reasons["gatherer.cache_ways"] = "of every engine with leaf caches";
  if (made.cache_bytes == 0)
    found.reasons["gatherer.cache_ways"] = found.reasons["gatherer.cache_misses"] =
        "used where gatherer.cache_bytes is not 0";
  if (has_sdram)
    found.reasons["board.sdram_khz"] = fmt::format(
        "of every engine; {} has {} at most{}", board.name, board.sdram->clock_khz,
        plan.sdram_khz == std::min(given.sdram_khz, board.sdram->clock_khz)
            ? ""
            : fmt::format(", and makes no {} beside its core's clock", given.sdram_khz));
  // As the search sets it, half and double of it.
  {
    std::vector<std::pair<std::string, Plan>> others;
    for (const int beat : {made.beat_bits / 2, made.beat_bits * 2}) {
      Plan p = made;
      p.beat_bits = beat;
      others.emplace_back(fmt::format("{}", beat), p);
    }
    tell("gatherer.beat_bits", others);
  }
  {
    Plan p = made;
    p.shared_nodes = !made.shared_nodes;
    tell("board.shared_nodes", {{p.shared_nodes ? "true" : "false", p}});
  }
  // Other memories and orders, with the same gatherers.
  const int cache_lines = made.board_cache_bytes / made.line_bytes();
  const auto streamed = [&](PhotonMemory memory, ReorderKey key, int packets, int lines) {
    return engine({memory, key, packets, lines, 0}, best->widths);
  };
  const auto key_of = [&](ReorderKey key) {
    return streamed(made.photon_memory, key,
                    sdram && key != ReorderKey::kNone && made.reorder_key == ReorderKey::kNone
                        ? kPools[0]
                        : made.reorder_packets,
                    cache_lines);
  };
  const ReorderKey other_key = made.reorder_key == ReorderKey::kNone ? ordered : ReorderKey::kNone;
  tell("reorder.key", {{name_of(other_key), key_of(other_key)}});
  if (made.reorder_key == ReorderKey::kNone)
    found.reasons["reorder.packets"] = "used where reorder.key is another than none";
  else if (sdram)
    tell_next("reorder.packets", made.reorder_packets, kPools, [&](int packets) {
      return streamed(made.photon_memory, made.reorder_key, packets, cache_lines);
    });
  if (sdram) {
    tell_next(
        "board.cache_bytes", cache_lines, kSharedLines,
        [&](int lines) {
          return streamed(made.photon_memory, made.reorder_key, made.reorder_packets, lines);
        },
        made.line_bytes());
    tell("board.photon_memory", {{"block_ram", streamed(PhotonMemory::kBlockRam, made.reorder_key,
                                                        plan.reorder_packets, 0)}});
  } else if (has_sdram && made.cache_bytes == 0) {
    found.reasons["board.photon_memory"] = "sdram: not tried without leaf caches";
  } else if (has_sdram) {
    tell("board.photon_memory",
         {{"sdram",
           streamed(PhotonMemory::kSdram, made.reorder_key,
                    made.reorder_key == ReorderKey::kNone ? plan.reorder_packets : kPools[0],
                    kSharedLines[0])}});
  } else {
    found.reasons["board.photon_memory"] = "the board has a top for no other";
  }
  return found;
}

}  // namespace photonloom
