// SPDX-License-Identifier: Apache-2.0
// The engines that a board gets for whole frames, and beside each one with leaf caches, without and
// with a reorder buffer: their predicted cycles against simulated ones, on the gathers for which
// they were chosen.
#include <utility>

#include "golden/pipeline/prepare.hpp"
#include "study/board_room.hpp"
#include "study/engine_search.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"
#include "tests/study/predictions.hpp"
#include "verilator_tb/unit/backends.hpp"

using namespace photonloom;

namespace {

// Cycles of the core a gather, of a plan's whole engine on all of these.
double simulated_cycles(const Plan& plan, const PreparedFrame& frame,
                        const std::vector<GatherQuery>& queries, const RunOptions& options) {
  const auto rtl = make_rtl_gather_engine(plan, options, true, true);
  rtl->load(frame.global, frame.caustic);
  std::vector<GatherQuery> asked = queries;
  if (plan.reorder_key != ReorderKey::kNone) asked.emplace_back().flush = 1;
  std::vector<GatherResult> results;
  std::vector<GatherPhoton> photons;
  const uint64_t first = rtl->cycles();
  rtl->process(asked, results, photons);
  CHECK(results.size() == asked.size());
  return static_cast<double>(rtl->cycles() - first) / static_cast<double>(queries.size());
}

}  // namespace

TEST_CASE("predicted cycles of a frame's engine are within 15 % of simulated ones") {
  BoardDescription board = predicted_board("ulx3s-85f");
  board.tops.erase("sdram");
  for (const char* scene : {"cornell", "atrium", "cornell_glossy"}) {
    CAPTURE(scene);
    FrameRequest request;
    request.scene_file = photonloom::test::source(std::string("scenes/") + scene + ".xml");
    request.photons = 16000;
    request.k = 16;
    const PreparedFrame frame = prepare_frame(request, Arithmetic::kGolden, nullptr);
    const std::vector<GatherQuery> in = engine_queries(frame, nullptr);
    const EngineSearch found = fastest_engine(frame.plan, frame.global, frame.caustic, in, board);
    // With leaf caches too, which the fastest engines of these maps have not.
    Plan cached = found.best.plan;
    cached.gatherers = 3;
    cached.nodes_per_cycle = 2;
    cached.contexts = 16;
    cached.photon_bytes = 16;
    cached.beat_bits = 256;
    cached.lut_ram_words = 64;
    cached.cache_bytes = 64 * cached.line_bytes();
    derive_plan(cached);
    REQUIRE(engine_misfit(cached, board) == "");
    CHECK(found.best.plan.cache_bytes == 0);
    CHECK(found.best.plan.reorder_key == ReorderKey::kNone);
    Plan ordered = cached;
    ordered.reorder_key = ReorderKey::kHilbert;
    derive_plan(ordered);
    // Fewer with more contexts each, whose lines keep the photon memory's ports busy all the time.
    Plan crowded = cached;
    crowded.gatherers = 2;
    crowded.contexts = 32;
    derive_plan(crowded);
    REQUIRE(engine_misfit(crowded, board) == "");
    Plan alone = crowded;
    alone.gatherers = alone.nodes_per_cycle = 1;
    derive_plan(alone);
    for (const Plan& plan : {found.best.plan, cached, ordered, crowded, alone}) {
      const EngineCycles predicted =
          engine_cycles(plan, frame.global, frame.caustic, in, board.core_khz);
      const double simulated = simulated_cycles(plan, frame, in, {});
      CAPTURE(predicted.gatherers, predicted.memory);
      photonloom::test::check_prediction({{"table", "frames"},
                                          {"scene", scene},
                                          {"gatherers", plan.gatherers},
                                          {"nodes", plan.nodes_per_cycle},
                                          {"contexts", plan.contexts},
                                          {"cache_bytes", plan.cache_bytes},
                                          {"reordered", plan.reorder_key != ReorderKey::kNone}},
                                         predicted.cycles, simulated);
    }
  }
}

TEST_CASE("predicted cycles of engines before an SDRAM are within 15 % of simulated ones") {
  BoardDescription board = predicted_board("ulx3s-85f");
  struct Asked {
    const char* scene;
    int photons, k;
  };
  for (const Asked& asked :
       {Asked{"cornell", 65536, 16}, Asked{"atrium", 200000, 8}, Asked{"lampshade", 100000, 24},
        Asked{"cornell_glossy", 500000, 50}, Asked{"water_pool", 150000, 16},
        Asked{"doorway", 80000, 32}, Asked{"table", 400000, 8}}) {
    FrameRequest request;
    request.scene_file = photonloom::test::source(std::string("scenes/") + asked.scene + ".xml");
    request.photons = static_cast<uint64_t>(asked.photons);
    request.k = asked.k;
    const PreparedFrame frame = prepare_frame(request, Arithmetic::kGolden, nullptr);
    const std::vector<GatherQuery> in = engine_queries(frame, nullptr);
    const EngineSearch found = fastest_engine(frame.plan, frame.global, frame.caustic, in, board);
    const Plan& plan = found.best.plan;
    CHECK(plan.photon_memory == PhotonMemory::kSdram);
    const EngineCycles& predicted = found.best.cycles;
    RunOptions options;
    options.sdram_period = static_cast<double>(board.core_khz) / plan.sdram_khz;
    const double simulated = simulated_cycles(plan, frame, in, options);
    CAPTURE(in.size(), plan.contexts, plan.cache_bytes, plan.board_cache_bytes, predicted.gatherers,
            predicted.memory);
    photonloom::test::check_prediction({{"table", "sdram"},
                                        {"scene", asked.scene},
                                        {"photons", asked.photons},
                                        {"k", asked.k},
                                        {"gatherers", plan.gatherers},
                                        {"pool", plan.reorder_packets}},
                                       predicted.cycles, simulated);
  }
}
