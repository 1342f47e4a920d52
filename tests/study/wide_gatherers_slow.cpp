// SPDX-License-Identifier: Apache-2.0
// The cycles that the model predicts of the wide gatherers of fpga/fast, of which its fit has none
// (study/cycles.csv has one node, candidate and power a cycle, and leaf caches), and of gatherers
// without leaf caches, against their RTL.
#include "golden/pipeline/prepare.hpp"
#include "golden/plan/plan_file.hpp"
#include "study/engine_search.hpp"
#include "study/gather_cost.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"

using namespace photonloom;

TEST_CASE("predicted cycles of wide gatherers are within 15 % of the RTL's") {
  for (const char* name : {"k8", "k16", "k50"}) {
    FrameRequest request;
    request.scene_file = photonloom::test::source("scenes/cornell.xml");
    request.plan_file = photonloom::test::source(std::string("fpga/fast/") + name + ".toml");
    PreparedFrame frame = prepare_frame(request, Arithmetic::kGolden, nullptr);
    std::vector<GatherQuery> queries = engine_queries(frame, nullptr);
    REQUIRE(queries.size() > 5000);
    for (const int latency : {20, 60}) {
      const double predicted =
          gather_cost_model(frame.plan, frame.global, frame.caustic, queries, latency).cycles;
      const double simulated =
          gather_cost_rtl(frame.plan, frame.global, frame.caustic, queries, latency, "cosim")
              .cycles;
      CAPTURE(name, latency, queries.size(), predicted, simulated);
      CHECK(predicted > 0.85 * simulated);
      CHECK(predicted < 1.15 * simulated);
    }
  }
}

TEST_CASE("predicted cycles of gatherers without leaf caches are within 10 % of the RTL's") {
  for (const char* scene : {"cornell", "atrium", "cornell_glossy"}) {
    FrameRequest request;
    request.scene_file = photonloom::test::source(std::string("scenes/") + scene + ".xml");
    request.photons = 16000;
    request.k = 16;
    const PreparedFrame frame = prepare_frame(request, Arithmetic::kGolden, nullptr);
    std::vector<GatherQuery> queries = engine_queries(frame, nullptr);
    REQUIRE(queries.size() > 16384);
    queries.resize(16384);
    for (const int nodes : {1, 2})
      for (const int contexts : {2, 8, 16, 32}) {
        Plan plan = frame.plan;
        plan.photon_bytes = 12;
        plan.lanes = 4;
        plan.beat_bits = 8 * plan.photon_bytes * plan.lanes;
        plan.cache_bytes = 0;
        plan.nodes_per_cycle = nodes;
        plan.contexts = contexts;
        derive_plan(plan);
        REQUIRE_FALSE(find_problem(plan));
        const double predicted =
            gather_cost_model(plan, frame.global, frame.caustic, queries, 5).cycles;
        const double simulated =
            gather_cost_rtl(plan, frame.global, frame.caustic, queries, 5, "cosim").cycles;
        CAPTURE(scene, nodes, contexts, predicted, simulated);
        CHECK(predicted > 0.9 * simulated);
        CHECK(predicted < 1.1 * simulated);
      }
  }
}
