// SPDX-License-Identifier: Apache-2.0
// The fastest gather engine of a board: it fits, nothing that fits is faster, and it changes when
// packets come, never which.
#include "study/engine_search.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <regex>

#include "golden/numeric/output_file.hpp"
#include "golden/numeric/random.hpp"
#include "golden/pipeline/prepare.hpp"
#include "golden/plan/plan_file.hpp"
#include "golden/planner/resources.hpp"
#include "golden/unit/photon_gatherer.hpp"
#include "rtl/generate/clocks.hpp"
#include "rtl/generate/sources.hpp"
#include "study/board_room.hpp"
#include "study/gather_cost.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"
#include "tests/photon_sets.hpp"
#include "verilator_tb/unit/backends.hpp"

using namespace photonloom;

namespace {

struct Load {
  Plan plan;
  PhotonMap map;
  std::vector<GatherQuery> queries;
};

// The walls of a room. Rays from neighbouring pixels meet all of them.
UVec3 on_a_wall(uint64_t seed, uint64_t wall, uint64_t place) {
  const uint64_t bits = hash_bits(seed, place, 0, 0);
  UVec3 p{static_cast<uint32_t>(bits & 0xffff), static_cast<uint32_t>(bits >> 16 & 0xffff), 0};
  const int axis = static_cast<int>(hash_bits(seed, wall, 1, 0) % 3);
  p[2] = hash_bits(seed, wall, 2, 0) % 2 ? 0xffff : 0;
  std::swap(p[2], p[axis]);
  return p;
}

Load make_load(uint64_t photons, int k, uint64_t queries = 3000) {
  Load load;
  load.plan.global = {.present = true, .photons = photons};
  load.plan.k = k;
  load.plan.width = load.plan.height = 256;
  derive_plan(load.plan);
  std::vector<PackedPhoton> packed(photons);
  for (uint64_t i = 0; i < photons; ++i) packed[i].position = on_a_wall(1, i, i);
  load.map = build_photon_map(packed, load.plan);
  for (uint64_t i = 0; i < queries; ++i) {
    GatherQuery q{};
    q.position = on_a_wall(2, i, i);
    load.queries.push_back(q);
  }
  return load;
}

// The lines that decide when packets come.
const char* const kWhen[] = {"[gatherer]", "[board]", "[reorder]"};

// Sections of a plan's file that no engine changes, but for the padding of lines.
std::string which_packets(Plan plan) {
  plan.photon_bytes = 16;
  const std::string text = plan_text(plan);
  std::string kept;
  for (size_t at = text.find("\n["); at != std::string::npos;) {
    const size_t next = text.find("\n[", at + 1);
    const std::string section = text.substr(at + 1, next == std::string::npos ? next : next - at);
    if (std::none_of(std::begin(kWhen), std::end(kWhen),
                     [&](const char* name) { return section.rfind(name, 0) == 0; }))
      kept += section;
    at = next;
  }
  return kept;
}

struct Asked {
  uint64_t photons;
  int k;
  uint64_t queries;
};

void check_engines(const std::vector<Asked>& loads) {
  const BoardDescription board = predicted_board("ulx3s-85f");
  for (const auto& [photons, k, queries] : loads) {
    CAPTURE(photons, k, queries);
    const Load load = make_load(photons, k, queries);
    const EngineSearch found = fastest_engine(load.plan, load.map, {}, load.queries, board);
    const Plan& best = found.best.plan;
    CHECK_FALSE(find_problem(best));
    CHECK(engine_misfit(best, board) == "");
    CHECK(which_packets(best) == which_packets(load.plan));
    if (found.misfit.empty()) CHECK(found.best.cycles.cycles <= found.given->cycles);
    const EngineCycles again = engine_cycles(best, load.map, {}, load.queries, board.core_khz);
    CHECK(again.cycles == Approx(found.best.cycles.cycles));
    // A map of 65,536 photons is larger than all block RAM; before an SDRAM all engines have leaf
    // caches.
    if (photons >= 65536) CHECK(best.photon_memory == PhotonMemory::kSdram);
    if (best.photon_memory == PhotonMemory::kSdram) CHECK(best.cache_bytes != 0);
  }
}

}  // namespace

TEST_CASE(
    "the engine for a board fits it, is faster than the plan's own and gives the same packets") {
  check_engines({{8192, 8, 3000}, {16384, 16, 3000}, {65536, 8, 3000}, {20000, 50, 3000}});
}

TEST_CASE("the engine for a board of larger loads too", "[slow]") {
  check_engines({{20000, 50, 30000},
                 {30000, 8, 30000},
                 {30000, 16, 30000},
                 {65536, 16, 30000},
                 {100000, 16, 3000}});
}

TEST_CASE("a map of few photons takes no SDRAM where that is no faster") {
  const BoardDescription board = predicted_board("ulx3s-85f");
  for (const uint64_t queries : {1000, 1025, 1100}) {
    Load load = make_load(5, 50, queries);
    load.plan.exponent_bits = 2;
    const EngineSearch found = fastest_engine(load.plan, load.map, {}, load.queries, board);
    const Plan& best = found.best.plan;
    CAPTURE(queries, found.best.cycles.cycles, best.cache_bytes);
    CHECK(best.photon_memory == PhotonMemory::kBlockRam);
  }
}

TEST_CASE("which part of a frame comes first does not decide what an engine is predicted to read") {
  Load load = make_load(16384, 16, 40000);
  load.plan.reorder_key = ReorderKey::kNone;
  std::vector<GatherQuery> corner_first = load.queries, corner_last = load.queries;
  for (size_t i = 0; i < 10000; ++i)
    corner_first[i] = corner_last[corner_last.size() - 1 - i] = load.queries[0];
  const auto memory = [&](const std::vector<GatherQuery>& queries) {
    return engine_cycles(load.plan, load.map, {}, queries, 50000).memory;
  };
  CHECK(memory(corner_first) == Approx(memory(corner_last)).epsilon(0.1));
  CHECK(memory(corner_first) == Approx(0.75 * memory(load.queries)).epsilon(0.1));
}

TEST_CASE("the cache before an SDRAM has a power of two of sets") {
  Load load = make_load(16384, 16, 10000);
  load.plan.photon_memory = PhotonMemory::kSdram;
  load.plan.photon_bytes = 12;
  load.plan.cache_bytes = 16 * load.plan.line_bytes();
  load.plan.beat_bits = 4 * load.plan.line_bytes();
  REQUIRE(load.plan.line_bytes() == 96);
  const auto lines = [&](int bytes) {
    load.plan.board_cache_bytes = bytes;
    return engine_cycles(load.plan, load.map, {}, load.queries, 50000).memory_lines;
  };
  CHECK(lines(65536) == lines(128 * 4 * 96));  // room for 170
  CHECK(lines(65536) != lines(256 * 4 * 96));
}

TEST_CASE("a board's reorder buffer takes room also where no final gathers go through it") {
  Plan plan;
  plan.caustic = {.present = true, .photons = 10000};
  plan.gather_rays = 0;
  plan.board_cache_bytes = 65536;
  const double with = other_needs(plan).lut;
  plan.reorder_key = ReorderKey::kNone;
  CHECK(with > other_needs(plan).lut + 100);
}

TEST_CASE("stretches of work for the SDRAM alone and for the gatherers alone add up") {
  Load load = make_load(65536, 16, 20000);
  load.plan.reorder_key = ReorderKey::kNone;
  load.plan.photon_memory = PhotonMemory::kSdram;
  load.plan.board_cache_bytes = 512 * load.plan.line_bytes();
  load.plan.beat_bits = 8 * load.plan.line_bytes();  // so that the cache's port never binds
  // Queries of one place need lines once; of the others each needs its own.
  std::vector<GatherQuery> stretches = load.queries, mixed = load.queries;
  for (size_t i = 0; i < 10000; ++i) stretches[i] = mixed[2 * i] = load.queries[0];
  for (size_t i = 0; i < 10000; ++i) mixed[2 * i + 1] = stretches[10000 + i];
  const auto predicted = [&](const std::vector<GatherQuery>& queries) {
    return engine_cycles(load.plan, load.map, {}, queries, 50000);
  };
  const EngineCycles apart = predicted(stretches), even = predicted(mixed);
  CHECK(apart.gatherers == Approx(even.gatherers).epsilon(0.02));
  CHECK(apart.memory == Approx(even.memory).epsilon(0.02));
  REQUIRE(even.memory > even.gatherers);
  CHECK(even.cycles == Approx(even.memory).epsilon(0.02));
  CHECK(apart.cycles > apart.memory + 0.3 * apart.gatherers);
  CHECK(apart.cycles < apart.memory + 0.7 * apart.gatherers);
}

TEST_CASE("more queries in flight keep more of the cache before an SDRAM busy") {
  Load load = make_load(65536, 16, 20000);
  load.plan.photon_memory = PhotonMemory::kSdram;
  load.plan.board_cache_bytes = 256 * load.plan.line_bytes();
  const auto lines = [&](int gatherers, int contexts) {
    load.plan.gatherers = gatherers;
    load.plan.contexts = contexts;
    return engine_cycles(load.plan, load.map, {}, load.queries, 50000).memory_lines;
  };
  CHECK(lines(2, 32) > lines(1, 8));
  CHECK(lines(4, 32) > lines(2, 32));
  CHECK(lines(4, 16) == lines(2, 32));
}

TEST_CASE("no engine beside the one for a board is faster and fits") {
  const BoardDescription board = predicted_board("ulx3s-85f");
  const Load load = make_load(16384, 16);
  const EngineSearch found = fastest_engine(load.plan, load.map, {}, load.queries, board);
  int fitting = 0, uncached = 0;
  const auto any = [](uint64_t i, int line, const std::vector<int>& values) {
    return values[hash_bits(3, i, static_cast<uint64_t>(line), 0) % values.size()];
  };
  for (uint64_t i = 0; i < 700; ++i) {
    Plan p = found.best.plan;
    p.gatherers = any(i, 0, {1, 2, 3, 4, 5, 6, 7, 8});
    p.nodes_per_cycle = any(i, 1, {1, 2});
    p.candidates_per_cycle = any(i, 2, {1, 1, 2});
    p.powers_per_cycle = any(i, 3, {1, p.candidates_per_cycle});
    p.lanes = any(i, 4, {2, 4, 8});
    p.contexts = any(i, 5, {8, 16, 32});
    // Those with leaf caches have no rows.
    const int cache_lines = any(i, 6, {0, 16, 32, 64, 128});
    p.photon_bytes = cache_lines == 0 ? 12 : 16;
    p.beat_bits = cache_lines == 0 ? found.best.plan.beat_bits : 256;
    p.cache_bytes = cache_lines * p.line_bytes();
    p.lut_ram_words = any(i, 7, {0, 32, 64});
    if (find_problem(p) || !engine_misfit(p, board).empty()) continue;
    ++fitting;
    uncached += p.cache_bytes == 0;
    CHECK(engine_cycles(p, load.map, {}, load.queries, board.core_khz).cycles >=
          found.best.cycles.cycles * 0.99);
  }
  CHECK(fitting > 20);
  CHECK(uncached > 5);
  CHECK(uncached < fitting);
}

TEST_CASE("photons given without padding are searched with it too") {
  const BoardDescription board = predicted_board("ulx3s-85f");
  const Load load = make_load(8192, 8);
  const EngineSearch found = fastest_engine(load.plan, load.map, {}, load.queries, board);
  Plan packed = load.plan;
  packed.photon_bytes = 12;
  packed.cache_bytes = packed.cache_bytes / 16 * 12;
  packed.beat_bits = 8 * packed.line_bytes();
  derive_plan(packed);
  REQUIRE_FALSE(find_problem(packed));
  const EngineSearch again = fastest_engine(packed, load.map, {}, load.queries, board);
  CHECK(again.fitting == found.fitting);
  CHECK(plan_text(again.best.plan) == plan_text(found.best.plan));
  CHECK(again.reasons == found.reasons);
}

TEST_CASE("lines of fewer photons than the lanes that are searched have engines and reasons") {
  const BoardDescription board = predicted_board("ulx3s-85f");
  for (const int bucket : {2, 4}) {
    Load load = make_load(4096, 8);
    load.plan.bucket = load.plan.lanes = bucket;
    load.plan.photon_bytes = 16;
    load.plan.cache_bytes = 64 * load.plan.line_bytes();
    load.plan.beat_bits = 8 * load.plan.line_bytes();
    derive_plan(load.plan);
    REQUIRE_FALSE(find_problem(load.plan));
    std::vector<PackedPhoton> packed(4096);
    for (uint64_t i = 0; i < packed.size(); ++i) packed[i].position = on_a_wall(1, i, i);
    load.map = build_photon_map(packed, load.plan);
    const EngineSearch found = fastest_engine(load.plan, load.map, {}, load.queries, board);
    CHECK(found.best.plan.lanes <= bucket);
    if (2 * found.best.plan.lanes > bucket)
      CHECK(found.reasons.at("gatherer.lanes").find("expected a power of two up to the bucket") !=
            std::string::npos);
  }
}

TEST_CASE("beats wider together than in any routed top are no engine for a board") {
  const BoardDescription board = predicted_board("ulx3s-85f");
  Plan plan = make_load(2048, 8).plan;
  plan.gatherers = 2;
  plan.beat_bits = 512;
  CHECK(engine_misfit(plan, board) == "");
  plan.gatherers = 3;
  plan.cache_bytes = 2048;
  plan.lut_ram_words = 64;
  CHECK(engine_misfit(plan, board) ==
        "needs beats of 1536 bits together, and no faster top with leaf caches with more than 1152 "
        "was routed");
  plan.cache_bytes = 0;
  CHECK(engine_misfit(plan, board) == "");
  plan.gatherers = 4;
  CHECK(engine_misfit(plan, board) ==
        "needs beats of 2048 bits together, and no faster top without leaf caches with more than "
        "1920 was routed");
}

TEST_CASE("the limits of an engine's wires are those of the headline's widest of three or more") {
  int widest = 0, widest_uncached = 0;
  for (const char* name :
       {"block_ram_k8", "block_ram_k16", "block_ram_k50", "sdram_k8", "sdram_k16", "sdram_k50"}) {
    const Plan plan = read_plan(test::source(std::string("fpga/headline/") + name + ".toml"));
    int& of = plan.cache_bytes == 0 ? widest_uncached : widest;
    if (plan.gatherers > 2) of = std::max(of, plan.gatherers * plan.beat_bits);
  }
  CHECK(widest == kEngineWires);
  CHECK(widest_uncached == kUncachedWires);
}

TEST_CASE("the limit of an engine's block RAM is that of the headline's fullest top") {
  const auto headline =
      nlohmann::json::parse(read_file(photonloom::test::source("fpga/headline.json")));
  double most = 0;
  for (const auto& row : headline["rows"])
    if (row["binding"]["resource"] == kBlockRam)
      most = std::max(most, row["binding"]["used"].get<double>());
  const double limit =
      std::floor(kEngineShare.blocks * predicted_board("ulx3s-85f").resources.at(kBlockRam));
  CHECK(most == limit);
}

TEST_CASE("the block RAMs of the gatherers of fpga/fast are those of the synthesized ones") {
  const auto fast = nlohmann::json::parse(read_file(test::source("fpga/fast.json")));
  int compared = 0;
  for (const auto& row : fast["rows"]) {
    const auto name = row["plan"].get<std::string>();
    CAPTURE(name);
    const Plan plan = read_plan(test::source("fpga/fast/" + name + ".toml"));
    CHECK(estimate_resources(plan, "photon_gatherer").ebr ==
          row["resources"][kBlockRam].get<double>());
    compared++;
  }
  CHECK(compared == 6);
}

TEST_CASE("the reason of a line that the engine search decides is what its next values would do") {
  const BoardDescription board = predicted_board("ulx3s-85f");
  for (const auto& [photons, k] : {std::pair<uint64_t, int>{4000, 8}, {65536, 8}}) {
    CAPTURE(photons, k);
    Load load = make_load(photons, k);
    load.plan.reorder_key = ReorderKey::kNone;
    const EngineSearch found = fastest_engine(load.plan, load.map, {}, load.queries, board);
    const Plan& best = found.best.plan;
    const auto reason = [&](const std::string& line) {
      CAPTURE(line);
      const auto at = found.reasons.find(line);
      REQUIRE(at != found.reasons.end());
      INFO(at->second);
      CHECK((at->second.find(" cycles a gather") != std::string::npos ||
             at->second.find("needs ") != std::string::npos ||
             at->second.find("expected ") != std::string::npos ||
             at->second.find("not tried ") != std::string::npos));
      return at->second;
    };
    for (const char* line :
         {"board.gatherers", "board.photon_memory", "board.lut_ram_words", "board.shared_nodes",
          "reorder.key", "gatherer.nodes_per_cycle", "gatherer.candidates_per_cycle",
          "gatherer.powers_per_cycle", "gatherer.lanes", "gatherer.contexts",
          "gatherer.cache_bytes", "gatherer.beat_bits", "photon.photon_bytes"})
      reason(line);
    const auto begins = [](const std::string& text, const std::string& with) {
      return text.rfind(with, 0) == 0;
    };
    CHECK(begins(reason("reorder.key"),
                 best.reorder_key == ReorderKey::kNone ? "hilbert: " : "none: "));
    CHECK(begins(reason("gatherer.beat_bits"), std::to_string(best.beat_bits / 2) + ": "));
    CHECK(reason("gatherer.beat_bits").find(std::to_string(2 * best.beat_bits) + ": ") !=
          std::string::npos);
    const std::string other = best.photon_memory == PhotonMemory::kSdram ? "block_ram" : "sdram";
    CHECK((begins(reason("board.photon_memory"), other + ": ") ||
           begins(reason("board.photon_memory"), other + " (with ")));
    // Each value, with the lines that its reason says follow it and no others, does what is said.
    int values = 0;
    for (const auto& [line, text] : found.reasons) {
      static const std::regex kValue(R"((\w+)(?: \(with ([^)]*)\))?: ([^;]+)(?:; |$))");
      for (std::sregex_iterator at(text.begin(), text.end(), kValue), end; at != end; ++at) {
        const std::smatch& told = *at;
        CAPTURE(line, text, told.str());
        Plan changed = best;
        set_plan_line(changed, line + "=" + told[1].str());
        static const std::regex kFollows(R"(([\w.]+) = (\w+))");
        const std::string follow = told[2];
        for (std::sregex_iterator one(follow.begin(), follow.end(), kFollows); one != end; ++one)
          set_plan_line(changed, (*one)[1].str() + "=" + (*one)[2].str());
        std::string does;
        if (const auto problem = find_problem(changed))
          does = problem->line + " " + problem->what;
        else if (does = engine_misfit(changed, board); does.empty())
          does = fmt::format(
              "{:.2f} cycles a gather",
              engine_cycles(changed, load.map, {}, load.queries, board.core_khz).cycles);
        CHECK(does == told[3].str());
        ++values;
      }
    }
    CHECK(values >= 12);
    if (best.photon_memory == PhotonMemory::kSdram) {
      reason("board.cache_bytes");
      reason("reorder.packets");
      // A beat is as many photons as lanes, so the reason says that it follows.
      CHECK(reason("gatherer.lanes").find(" (with gatherer.beat_bits = ") != std::string::npos);
    }
    // The next plan is predicted as the search predicts: no faster, where it fits.
    Plan fewer = best;
    if (--fewer.gatherers > 0) {
      const double cycles = engine_cycles(fewer, load.map, {}, load.queries, board.core_khz).cycles;
      if (fewer.beat_bits == best.beat_bits && photons == 65536)
        CHECK(reason("board.gatherers")
                  .find(fmt::format("{}: {:.2f} cycles a gather", fewer.gatherers, cycles)) == 0);
    }
  }
}

TEST_CASE("an engine serves final gathers, and of a frame without them its gathers of caustics") {
  Load load = make_load(4096, 8, 4000);
  load.plan.caustic = load.plan.global;
  derive_plan(load.plan);
  for (GatherQuery& q : load.queries) q.map = 1;
  std::vector<GatherQuery> tables = load.queries;
  for (GatherQuery& q : tables) {
    q.map = 0;
    q.want_photons = 1;
  }
  const auto kept = [&](std::initializer_list<std::span<const GatherQuery>> streams) {
    WatchedGatherer watched(load.plan, 100000);
    watched.load(load.map, load.map);
    std::vector<GatherResult> results;
    std::vector<GatherPhoton> photons;
    for (const auto& stream : streams) watched.process(stream, results, photons);
    return watched.kept();
  };
  CHECK(kept({tables}).empty());
  CHECK(kept({tables, load.queries}) == load.queries);
  std::vector<GatherQuery> finals = tables;
  for (GatherQuery& q : finals) q.want_photons = 0;
  CHECK(kept({load.queries, tables, finals}) == finals);
}

TEST_CASE("engines are chosen for the gathers of a frame as it asks for them") {
  const auto asked = [](const std::vector<std::string>& set) {
    FrameRequest request;
    request.scene_file = photonloom::test::source("scenes/cornell.xml");
    request.size = {16, 16};
    request.photons = 2000;
    request.k = 8;
    request.set = set;
    const PreparedFrame frame = prepare_frame(request, Arithmetic::kGolden, nullptr);
    return engine_queries(frame, nullptr);
  };
  const std::vector<GatherQuery> unordered = asked({"reorder.key=none"});
  CHECK(unordered.size() > 1000);
  // A buffer is searched for; that of the plan has not been passed.
  CHECK((asked({"reorder.key=hilbert", "reorder.packets=512"}) == unordered));
  CHECK((asked({"reorder.key=hash", "reorder.packets=64"}) == unordered));
}

TEST_CASE("a frame whose first samples ask for nothing has the gathers of its others") {
  FrameRequest request;
  request.scene_file = photonloom::test::source("scenes/cornell.xml");
  request.size = {1, 1};
  request.spp = 16;
  request.photons = 4000;
  request.k = 8;
  PreparedFrame frame = prepare_frame(request, Arithmetic::kGolden, nullptr);
  CHECK(engine_queries(frame, nullptr).size() > 100);
  // That there are such first samples.
  frame.plan.spp = 1;
  CHECK(engine_queries(frame, nullptr).empty());
}

TEST_CASE("a board without room for one gatherer, and a frame without gathers, say so") {
  BoardDescription board = predicted_board("ulx3s-85f");
  const Load load = make_load(8192, 8);
  CHECK_THROWS_WITH(fastest_engine(load.plan, load.map, {}, {}, board),
                    "--board: the frame asks for no gather but those for tables, so no engine is "
                    "faster than another");
  BoardDescription unit_alone = board;
  unit_alone.tops = {};
  CHECK_THROWS_WITH(fastest_engine(load.plan, load.map, {}, load.queries, unit_alone),
                    Catch::Matchers::StartsWith("--board: ulx3s-85f has no top for gathers, "));
  BoardDescription sdram_alone = board;
  sdram_alone.tops.erase("block_ram");
  Plan large = load.plan;
  large.global.photons = 8000000;
  CHECK_THROWS_WITH(
      fastest_engine(large, load.map, {}, load.queries, sdram_alone),
      Catch::Matchers::StartsWith("--board: no engine for ulx3s-85f can be planned: "));
  board.resources["DP16KD"] = 10;
  CHECK_THROWS_WITH(
      fastest_engine(load.plan, load.map, {}, load.queries, board),
      Catch::Matchers::StartsWith("--board: no engine fits ulx3s-85f: the smallest needs ") &&
          ContainsSubstring(" DP16KD, and ulx3s-85f has 9 for it"));
  // Of what lacks that which lacks most.
  CHECK(misfit(BoardNeeds{.lut = 84000, .blocks = 300}, board, {}) ==
        "needs 300 DP16KD, and ulx3s-85f has 10 for it");
  board.resources["DP16KD"] = 299;
  CHECK(misfit(BoardNeeds{.lut = 90000, .blocks = 300}, board, {}) ==
        "needs 90000 LUT-equivalents, and ulx3s-85f has 83640 for it");
  CHECK(misfit(BoardNeeds{.lut = 83640, .blocks = 299}, board, {}) == "");
}

TEST_CASE("an engine before an SDRAM has a clock that its board's PLL makes") {
  BoardDescription board = predicted_board("ulx3s-85f");
  board.tops.erase("block_ram");
  Load load = make_load(8192, 8);
  load.plan.photon_memory = PhotonMemory::kSdram;
  load.plan.sdram_khz = 105000;
  const std::string why =
      "has board.sdram_khz, which is 105000, expected a board.sdram_khz of for "
      "example 110000, 100000, ";
  CHECK_THAT(engine_misfit(load.plan, board), Catch::Matchers::StartsWith(why));
  const EngineSearch found = fastest_engine(load.plan, load.map, {}, load.queries, board);
  CHECK_THAT(found.misfit, Catch::Matchers::StartsWith(why));
  CHECK(found.best.plan.sdram_khz == 100000);
  CHECK(
      found.reasons.at("board.sdram_khz") ==
      "of every engine; ulx3s-85f has 110000 at most, and makes no 105000 beside its core's clock");
  for (const int most : {50000, 72000, 100000, 105000, 109999, 110000, 133000}) {
    INFO(most);
    const int khz = sdram_clock(board, most);
    CHECK(khz <= std::min(most, board.sdram->clock_khz));
    CHECK_NOTHROW(board_clocks(board, board.core_khz, khz, default_rtl_dir()));
  }
}

TEST_CASE("predicted cycles of engines on block RAM are within 15 % of simulated ones", "[slow]") {
  BoardDescription board = predicted_board("ulx3s-85f");
  board.tops.erase("sdram");
  for (const int k : {8, 16, 50}) {
    CAPTURE(k);
    const Load load = make_load(8192, k, 24000);
    const EngineSearch found = fastest_engine(load.plan, load.map, {}, load.queries, board);
    const Plan& best = found.best.plan;
    RunOptions options;
    const auto rtl = make_rtl_gather_engine(best, options, true, true);
    const auto golden = make_golden_photon_gatherer(best);
    PhotonMap none;
    none.bucket = best.bucket;
    rtl->load(load.map, none);
    golden->load(load.map, none);
    std::vector<GatherQuery> in = load.queries;
    if (best.reorder_key != ReorderKey::kNone) in.emplace_back().flush = 1;
    std::vector<GatherResult> results, expected;
    std::vector<GatherPhoton> photons;
    const uint64_t first = rtl->cycles();
    rtl->process(in, results, photons);
    golden->process(load.queries, expected, photons);
    CHECK(results.size() == in.size());
    if (best.reorder_key == ReorderKey::kNone) CHECK(results == expected);
    const double simulated =
        static_cast<double>(rtl->cycles() - first) / static_cast<double>(load.queries.size());
    CAPTURE(simulated, best.gatherers, best.lanes, best.nodes_per_cycle, best.candidates_per_cycle,
            best.powers_per_cycle, best.contexts, best.lut_ram_words, found.best.cycles.gatherers,
            found.best.cycles.memory);
    CHECK(found.best.cycles.cycles > 0.85 * simulated);
    CHECK(found.best.cycles.cycles < 1.15 * simulated);
  }
}

TEST_CASE("no gather takes fewer cycles than its sum reads powers") {
  Plan plan;
  plan.k = 50;
  plan.contexts = 64;
  plan.lanes = 8;
  plan.nodes_per_cycle = 2;
  plan.candidates_per_cycle = 4;
  const GatherLoad load{.nodes = 30, .leaves = 10, .insertions = 80};
  plan.powers_per_cycle = 1;
  CHECK(modelled_cycles(plan, load, 1) == 51);
  plan.powers_per_cycle = 4;
  CHECK(modelled_cycles(plan, load, 1) < 51);
  CHECK(modelled_cycles(plan, load, 1) > 51 / 4.0);
  plan.powers_per_cycle = 1;
  CHECK(modelled_cycles(plan, {.nodes = 30, .leaves = 10, .insertions = 20}, 1) < 51);
}
