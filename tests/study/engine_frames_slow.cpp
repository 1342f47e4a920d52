// SPDX-License-Identifier: Apache-2.0
// The engines that a board gets for whole frames: their predicted cycles against simulated ones, on
// the gathers for which they were chosen.
#include <utility>

#include "golden/pipeline/prepare.hpp"
#include "study/board_room.hpp"
#include "study/engine_search.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"
#include "verilator_tb/unit/backends.hpp"

using namespace photonloom;

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
    std::vector<GatherQuery> in = engine_queries(frame, nullptr);
    const EngineSearch found = fastest_engine(frame.plan, frame.global, frame.caustic, in, board);
    const Plan& best = found.best.plan;
    RunOptions options;
    const auto rtl = make_rtl_gather_engine(best, options, true, true);
    rtl->load(frame.global, frame.caustic);
    const auto queries = static_cast<double>(in.size());
    if (best.reorder_key != ReorderKey::kNone) in.emplace_back().flush = 1;
    std::vector<GatherResult> results;
    std::vector<GatherPhoton> photons;
    const uint64_t first = rtl->cycles();
    rtl->process(in, results, photons);
    CHECK(results.size() == in.size());
    const double simulated = static_cast<double>(rtl->cycles() - first) / queries;
    CAPTURE(simulated, found.best.cycles.cycles, best.gatherers, best.lanes, best.nodes_per_cycle,
            best.contexts, found.best.cycles.gatherers, found.best.cycles.memory);
    CHECK(found.best.cycles.cycles > 0.85 * simulated);
    CHECK(found.best.cycles.cycles < 1.15 * simulated);
  }
}
