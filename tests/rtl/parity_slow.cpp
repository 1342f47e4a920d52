// SPDX-License-Identifier: Apache-2.0
// Parity of block RAM, errors at the line port and the power-up self-test: each fault is told or
// harmless, no result that is wrong goes out without its flag, and nothing hangs. `make faults`
// takes rows of docs/faults.md from here.
#include <fmt/core.h>

#include <array>
#include <set>

#include "tests/fault_report.hpp"
#include "tests/rtl/link_bench.hpp"
#include "verilator_tb/unit/backends.hpp"

using namespace photonloom;
using namespace photonloom::test;

namespace {

Plan parity_plan() {
  Plan plan = small_plan();
  plan.gatherers = 1;
  plan.parity = true;
  plan.beat_bits = 8 * plan.photon_bytes;
  return plan;
}

using MakeUnit = std::unique_ptr<ClockedPhotonGatherer> (*)(const Plan&, const RunOptions&);

std::unique_ptr<ClockedPhotonGatherer> make_engine(const Plan& plan, const RunOptions& options) {
  return make_rtl_gather_engine(plan, options, false);
}

// A gatherer that faults are injected into, beside golden.
class Harmed {
 public:
  Harmed(const Plan& plan, MakeUnit make, const std::shared_ptr<Faults>& faults, uint64_t seed)
      : plan_(plan), faults_(faults) {
    RunOptions options;
    options.work_dir = "cosim";
    options.seed = seed;
    options.random_latency = true;
    options.stall_memory = StallPolicy::parse("bursts");
    options.faults = faults;
    global_ = build_photon_map(make_photons(plan_, PointSet::kSurfaces, plan_.global.photons, seed),
                               plan_);
    caustic_ = build_photon_map(
        make_photons(plan_, PointSet::kClustered, plan_.caustic.photons, seed + 1), plan_);
    golden_ = make_golden_photon_gatherer(plan_);
    golden_->load(global_, caustic_);
    rtl_ = make(plan_, options);
    load();
  }

  void load() { rtl_->load(global_, caustic_); }
  void finish() { rtl_->finish(); }

  struct Outcome {
    uint64_t flagged = 0, wrong = 0;
  };
  Outcome ask(const std::vector<GatherQuery>& in) {
    std::vector<GatherResult> due, results;
    std::vector<GatherPhoton> due_photons, photons;
    golden_->process(in, due, due_photons);
    rtl_->process(in, results, photons);
    REQUIRE(results.size() == due.size());
    Outcome outcome;
    size_t at = 0, due_at = 0;
    for (size_t i = 0; i < in.size(); ++i) {
      CHECK(due[i].faulty == 0);
      const bool photons_too = in[i].want_photons && !in[i].flush;
      const size_t n = photons_too ? results[i].count : 0, due_n = photons_too ? due[i].count : 0;
      REQUIRE(at + n <= photons.size());
      if (results[i].faulty) {
        ++outcome.flagged;
      } else {
        const auto from = photons.begin() + static_cast<ptrdiff_t>(at);
        const auto due_from = due_photons.begin() + static_cast<ptrdiff_t>(due_at);
        outcome.wrong +=
            results[i] != due[i] || !std::equal(from, from + static_cast<ptrdiff_t>(n), due_from,
                                                due_from + static_cast<ptrdiff_t>(due_n));
      }
      at += n;
      due_at += due_n;
    }
    REQUIRE(at == photons.size());
    return outcome;
  }
  // Words of memory that were not right, as the unit counts them.
  uint64_t counted() const { return rtl_->counters().at("faults"); }
  Faults& faults() { return *faults_; }
  const Plan& plan() const { return plan_; }

 private:
  Plan plan_;
  std::shared_ptr<Faults> faults_;
  PhotonMap global_, caustic_;
  std::unique_ptr<PhotonGatherer> golden_;
  std::unique_ptr<ClockedPhotonGatherer> rtl_;
};

struct FlipKind {
  const char* where;
  Plan plan;
  MakeUnit make;
  std::vector<std::string> memories;
  bool heals;  // by itself
  uint64_t flips;
};

// Bits flipped one at a time at any cycle while queries are in flight.
void flip_bits(const FlipKind& kind) {
  INFO(kind.where);
  const auto faults = std::make_shared<Faults>();
  faults->memories = kind.memories;
  faults->within = 400;
  Harmed unit(kind.plan, kind.make, faults, 3);
  FaultRow row;
  row.fault = "one bit flipped";
  row.where = kind.where;
  uint64_t flagged = 0;
  for (uint64_t n = 0; n < kind.flips; ++n) {
    INFO("flip " << n);
    const std::vector<GatherQuery> in = queries(unit.plan(), 12, n, true);
    const uint64_t before = unit.counted();
    faults->flips = 1;
    while (faults->flips > 0) {
      const Harmed::Outcome first = unit.ask(in);
      row.wrong += first.wrong;
      flagged += first.flagged;
    }
    const Harmed::Outcome again = unit.ask(in);
    row.wrong += again.wrong;
    flagged += again.flagged;
    const bool told = unit.counted() != before;
    ++row.injected;
    ++(told ? row.detected : row.harmless);
    if (!told) CHECK(again.flagged == 0);
    // Where it does not heal, the map is loaded again.
    if (!kind.heals) unit.load();
    const Harmed::Outcome healed = unit.ask(in);
    CHECK(healed.flagged == 0);
    row.wrong += healed.wrong;
    if (kind.heals) unit.load();  // what nobody read is not to be read in the next round
  }
  unit.finish();
  CHECK(row.injected == kind.flips);
  CHECK(row.injected == faults->flipped);
  CHECK(row.wrong == 0);
  CHECK(row.detected >= 15);
  row.recovery = kind.heals ? fmt::format(
                                  "at the line's next lookup, which fetches it; {} results "
                                  "were flagged",
                                  flagged)
                            : fmt::format(
                                  "when the map is loaded again; {} results were flagged "
                                  "until then",
                                  flagged);
  report(row);
}

// A line port that tells of errors, one query at a time: it is flagged where one of its lines came
// with an error, and there alone.
void harm_replies(const Plan& plan, const char* fault, const char* where, bool beyond) {
  INFO(fault << ", " << where);
  const auto faults = std::make_shared<Faults>();
  Harmed unit(plan, make_rtl_photon_gatherer, faults, 5);
  if (beyond)
    for (const bool is_caustic : {false, true})
      faults->lines[is_caustic] = 2 * plan.lines(plan.map(is_caustic)) / 3;
  else
    faults->error_of = 40;
  FaultRow row;
  row.fault = fault;
  row.where = where;
  for (const GatherQuery& q : queries(plan, 500, 6, true)) {
    const uint64_t before = faults->errors, counted = unit.counted();
    const Harmed::Outcome one = unit.ask({q});
    const uint64_t errors = faults->errors - before;
    row.injected += errors;
    CHECK(one.flagged == (errors > 0 ? 1 : 0));
    CHECK(unit.counted() - counted >= errors);
    if (one.flagged) row.detected += errors;
    row.wrong += one.wrong;
  }
  CHECK(row.injected > 50);
  CHECK(row.detected == row.injected);
  // All in flight at once.
  const Harmed::Outcome all = unit.ask(queries(plan, 500, 7, true));
  CHECK(all.flagged > 0);
  CHECK(all.flagged < 500);
  row.wrong += all.wrong;
  CHECK(row.wrong == 0);
  unit.finish();
  row.recovery = beyond ? "when memory has the lines" : "at once: the next query is golden's";
  report(row);
}

}  // namespace

TEST_CASE("faults: flipped bits of memories with parity") {
  Plan board = parity_plan();
  Plan sdram = board;
  sdram.photon_memory = PhotonMemory::kSdram;
  sdram.board_cache_bytes = 8 * sdram.line_bytes();
  sdram.cache_bytes = 4 * sdram.line_bytes();
  sdram.cache_ways = 2;
  const Plan lines = compressed(parity_plan());
  // More than 2,048 beats, the two of a line side by side.
  Plan rows = board;
  rows.bucket = rows.lanes = 2;
  rows.global.photons = 2048;
  rows.cache_bytes = 4 * rows.line_bytes();
  REQUIRE(rows.photon_ram_row() == 2);
  // One of three gatherers uses both ports.
  Plan both_ports = rows;
  both_ports.gatherers = 3;
  both_ports.nodes_per_cycle = 2;
  // As many, of more than four a line: banks behind one another.
  Plan banks = board;
  banks.bucket = 8;
  banks.global.photons = 2048;
  REQUIRE(banks.photon_ram_is_divided());
  REQUIRE(banks.photon_ram_row() == 1);
  const FlipKind kinds[] = {
      {"`photon_gatherer`, nodes", board, make_rtl_photon_gatherer, {"node_memory"}, false, 400},
      {"`photon_gatherer`, cached lines",
       board,
       make_rtl_photon_gatherer,
       {"leaf_cache.lines"},
       true,
       1500},
      {"`photon_gatherer`, cached lines, compressed",
       lines,
       make_rtl_photon_gatherer,
       {"leaf_cache.lines"},
       true,
       400},
      {"`photon_gatherer`, tags of the cache",
       board,
       make_rtl_photon_gatherer,
       {"leaf_cache.gen_tags"},
       true,
       400},
      {"`photon_ram`", board, make_engine, {"memory.gen_one"}, false, 60},
      {"`photon_ram`, rows", rows, make_engine, {"memory.gen_rows"}, false, 150},
      {"`photon_ram`, rows, both ports", both_ports, make_engine, {"memory.gen_rows"}, false, 150},
      {"`photon_ram`, banks", banks, make_engine, {"memory.gen_banks"}, false, 150},
      {"`photon_sdram`, cache", sdram, make_engine, {"memory.lines"}, true, 250},
  };
  for (const FlipKind& kind : kinds) {
    SECTION(kind.where) { flip_bits(kind); }
  }
}

TEST_CASE("faults: errors at the line port") {
  // Four beats are what the lanes take a cycle.
  Plan uncached = parity_plan();
  uncached.cache_bytes = 0;
  const Plan plans[] = {parity_plan(), compressed(parity_plan()), uncached};
  const char* const where[] = {"memory port", "memory port, compressed lines",
                               "memory port, no leaf cache"};
  for (const size_t i : {0, 1, 2}) {
    harm_replies(plans[i], "error in a beat of a reply", where[i], false);
    harm_replies(plans[i], "line beyond memory", where[i], true);
  }
}

TEST_CASE("a board counts wrong words, and its results tell of them") {
  Plan plan = parity_plan();
  test::Bench bench(plan, {.work_dir = "cosim", .open_memories = true});
  bench.load(1);
  REQUIRE(bench.write(kSession, {5}) == 0);
  CHECK(bench.reg(26) == 0);
  CHECK(bench.reg(27) == 0);
  size_t stores = 0;
  for (const ModelMemory& m : bench.board().memories()) {
    if (m.name.find("memory.gen_one") == std::string::npos) continue;
    ++stores;
    for (size_t w = 0; w < m.words; ++w) m.data[w * m.stride] ^= 1;
  }
  REQUIRE(stores == 1);
  const std::vector<GatherQuery> list = queries(plan, 1, 1, false);
  const Words in = packed(plan, list);
  CHECK(bench.push(0, in).next == in.size());
  bench.run(20000);
  const PacketLayout layout = PacketLayout::of<GatherResult>(plan);
  const test::Bench::Pulled out = bench.pull(0, static_cast<uint8_t>(1 + layout.words()), 0);
  REQUIRE(out.words.size() == 1 + layout.words());
  GatherResult result{};
  layout.unpack(out.words.data() + 1, &result);
  CHECK(result.faulty == 1);
  CHECK(bench.reg(27) > 0);
}

TEST_CASE("a board's results tell of lines beyond their map") {
  Plan one = parity_plan();
  one.bucket = one.lanes = 2;
  one.global.photons = 2052;  // the last lines, of so many, are near the tree's lowest corner
  one.cache_bytes = 4 * one.line_bytes();
  Plan three = one, both_ports = one, sdram = one;
  sdram.photon_memory = PhotonMemory::kSdram;
  sdram.board_cache_bytes = 8 * sdram.line_bytes();
  three.gatherers = both_ports.gatherers = 3;
  both_ports.nodes_per_cycle = 2;
  REQUIRE(both_ports.photon_ram_row() == 2);  // else no gatherer uses both
  const uint32_t lines = one.lines(one.global);
  // Two in three stand in that corner.
  std::vector<GatherQuery> list = queries(one, 60, 1, false);
  for (uint32_t i = 0; i < list.size(); ++i)
    if (i % 3) list[i].position = {i % 4, i % 5, i % 7};
  const PacketLayout layout = PacketLayout::of<GatherResult>(one);
  const auto results = [&](const Plan& plan) {
    test::Bench bench(plan, {.work_dir = "cosim"});
    bench.load(1);
    // A line more than there are, behind a node where the caustic map's have a word that none uses.
    // It is read from the caustic map's first.
    REQUIRE(bench.write(kCfg + 2 * lines, {0, 0}) == 0);
    REQUIRE(bench.write(kCfg + 2 * 0x800000, {lines + 1, 0}) == 0);
    REQUIRE(bench.write(kSession, {5}) == 0);
    std::vector<GatherResult> got;
    uint32_t place = 0, from = 0;
    for (const GatherQuery& q : list) {
      place = bench.push(place, packed(plan, q)).next;
      bench.run(4000);
      const auto size = static_cast<uint8_t>(1 + layout.words());
      const test::Bench::Pulled out = bench.pull(from, size, from);
      REQUIRE(out.words.size() == size);
      from += size;
      layout.unpack(out.words.data() + 1, &got.emplace_back());
    }
    CHECK(bench.reg(27) > 0);
    return got;
  };
  const std::vector<GatherResult> due = results(one);
  std::array<int, 2> flagged{}, right{};  // of the global map and the caustic one
  for (size_t i = 0; i < due.size(); ++i) ++(due[i].faulty ? flagged : right)[list[i].map];
  INFO(flagged[0] << " flagged, " << right[0] << " not, " << flagged[1] << " of the caustic map");
  CHECK(flagged[0] > 10);
  CHECK(flagged[1] == 0);
  CHECK(results(three) == due);
  CHECK(results(both_ports) == due);
  CHECK(results(sdram) == due);
}

TEST_CASE("faults: a board tries itself when it is switched on") {
  Plan plan = parity_plan();
  plan.self_test = true;
  FaultRow row;
  row.fault = "one bit stuck in a word of a memory";
  row.where = "board, self-test";
  BoardRun run{.work_dir = "cosim", .open_memories = true};
  const auto tried = [](test::Bench& bench) {
    for (int i = 0; bench.board().leds() == 0xff; ++i) {
      REQUIRE(i < 3000000);
      bench.board().cycle();
    }
    return bench.reg(26);
  };
  test::Bench bench(plan, run);
  CHECK(tried(bench) == 2);
  CHECK(bench.reg(27) == 0);
  // A session as ever afterwards.
  soak_on(bench, 2, 12, [](Bytes wire, RoleRandom&) { return wire; });

  // Bits that a photon's word, a node's or a query's cannot keep.
  std::vector<const ModelMemory*> memories;
  for (const ModelMemory& m : bench.board().memories())
    for (const char* part : {"memory.store", "node_memory", "replayer"})
      if (m.name.find(part) != std::string::npos) memories.push_back(&m);
  REQUIRE(memories.size() > 2);
  RoleRandom random(1, "stuck bits");
  for (int n = 0; n < 40; ++n) {
    const ModelMemory& m = *memories[random.below(memories.size())];
    const size_t bit = random.below(m.bits);
    const bool high = random.below(2) != 0;
    const auto stick = [&] {
      for (size_t w = 0; w < m.words; ++w) {
        uint8_t& byte = m.data[w * m.stride + bit / 8];
        const auto mask = static_cast<uint8_t>(1u << (bit % 8));
        byte = static_cast<uint8_t>(high ? byte | mask : byte & ~mask);
      }
    };
    INFO(m.name << ", bit " << bit << " always " << high);
    bench.board().set("rst_i", 1);
    for (int i = 0; i < 8; ++i) bench.board().cycle();
    bench.board().set("rst_i", 0);
    bench.board().cycle();
    for (int i = 0; i < 3000000; ++i) {
      if (i > 16 && bench.board().leds() != 0xff) break;
      stick();
      bench.board().cycle();
    }
    const uint32_t state = bench.reg(26);
    ++row.injected;
    if (state == 3) {
      ++row.detected;
      // All LEDs blink together.
      std::set<uint8_t> seen;
      for (int i = 0; i < 40000; ++i) {
        bench.board().cycle();
        seen.insert(bench.board().leds());
      }
      CHECK(seen == std::set<uint8_t>{0, 0xff});
    } else {
      CHECK(state == 2);
      ++row.harmless;
    }
  }
  CHECK(row.detected > row.injected / 2);
  row.recovery = "shown until the next reset";
  report(row);
}
