// SPDX-License-Identifier: Apache-2.0
// The model of the memory hierarchy against the RTL's own counter: the same bytes with one query in
// flight, nearly the same with sixteen; three caches, three orders.
#include <cmath>

#include "golden/pipeline/prepare.hpp"
#include "study/gather_cost.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"

using namespace photonloom;

TEST_CASE("bytes at the RTL's port are the model's") {
  FrameRequest request;
  request.scene_file = photonloom::test::source("scenes/cornell_balls.xml");
  request.size = {32, 32};
  request.spp = 1;
  request.gather_rays = 8;
  request.photons = 8000;
  request.caustic_photons = 2000;
  request.k = 8;
  PreparedFrame frame = prepare_frame(request, Arithmetic::kGolden, nullptr);
  Plan& plan = frame.plan;
  struct Order {
    FrameOrder made;
    ReorderKey key;
    ReorderDrain drain;
  };
  for (const Order order :
       {Order{FrameOrder::kPixel, ReorderKey::kNone, ReorderDrain::kSweep},
        Order{FrameOrder::kDirectionBins, ReorderKey::kHash, ReorderDrain::kFullest},
        Order{FrameOrder::kTile, ReorderKey::kHilbert, ReorderDrain::kSweep}}) {
    plan.order = order.made;
    plan.reorder_key = order.key;
    plan.reorder_drain = order.drain;
    plan.reorder_packets = 256;
    plan.reorder_bins = 64;
    plan.reorder_cell_bits = 2;
    FrameUnits units = make_golden_units(plan);
    auto watched = std::make_unique<WatchedGatherer>(plan, 4096);
    const WatchedGatherer& window = *watched;
    units.photon_gatherer = std::move(watched);
    FrameCounts counts;
    render_frame(frame.input(Arithmetic::kGolden), units, counts);
    REQUIRE(window.kept().size() > 3000);
    struct Cache {
      int sets, ways;
    };
    for (const Cache cache : {Cache{64, 2}, Cache{16, 4}, Cache{128, 1}})
      for (const int contexts : {1, 16}) {
        plan.cache_ways = cache.ways;
        plan.cache_bytes = cache.sets * cache.ways * plan.line_bytes();
        plan.contexts = contexts;
        plan.lanes = 1;
        const GatherCost model =
            gather_cost_model(plan, frame.global, frame.caustic, window.kept(), 20);
        const GatherCost rtl =
            gather_cost_rtl(plan, frame.global, frame.caustic, window.kept(), 20, "cosim");
        INFO("order " << static_cast<int>(order.made) << ", " << cache.sets << " sets of "
                      << cache.ways << " ways, " << contexts << " in flight: model " << model.bytes
                      << ", RTL " << rtl.bytes << " bytes a gather");
        if (contexts == 1)
          CHECK(rtl.bytes == model.bytes);
        else
          CHECK(std::fabs(rtl.bytes / model.bytes - 1) < 0.05);
      }
  }
}
