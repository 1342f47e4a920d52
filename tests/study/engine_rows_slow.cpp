// SPDX-License-Identifier: Apache-2.0
// The rows of docs/headline.md from an SDRAM, which `make headline` simulated at their routed
// clocks: what the engine search predicts of their plans, queries and clocks. No figure of the
// prediction was chosen on them.
#include <nlohmann/json.hpp>

#include "golden/numeric/output_file.hpp"
#include "golden/unit/pack_photons.hpp"
#include "study/engine_search.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"
#include "tests/study/predictions.hpp"
#include "verilator_tb/throughput/gather_load.hpp"

using namespace photonloom;

TEST_CASE("predicted cycles of the headline's rows from an SDRAM are within 15 % of theirs") {
  LoadOptions options;  // those of throughput_gather_cluster
  options.samples = 8;
  options.scene = test::source("scenes/cornell.xml");
  const SceneGathers load(options);
  const nlohmann::json data = nlohmann::json::parse(read_file(test::source("fpga/headline.json")));
  int rows = 0;
  for (const nlohmann::json& row : data.at("rows")) {
    if (row.at("memory") != "sdram" || row.at("rejected") != "" || !row.at("coarse").is_null())
      continue;
    const auto name = row.at("plan").get<std::string>();
    const bool within_mean = row.at("within_mean");
    Plan plan = read_plan(test::source("fpga/headline/" + name + ".toml"));
    const std::vector<Photon> photons = load.stored_photons(plan.global.photons);
    const PhotonMap map = build_photon_map(pack_photons(photons, plan, plan.global, nullptr), plan);
    const std::vector<GatherQuery> queries = load.queries(plan);
    if (within_mean) plan.global.r2_max = plan.caustic.r2_max = mean_r2(plan, map, queries);
    plan.sdram_khz = static_cast<int>(1000 * row.at("sdram").at("mhz").get<double>());
    const int core_khz = static_cast<int>(1000 * row.at("fmax_mhz").at("median").get<double>());
    const double predicted = engine_cycles(plan, map, {}, queries, core_khz).cycles;
    const auto simulated = row.at("cycles_per_gather").get<double>();
    test::check_prediction({{"table", "headline"}, {"plan", name}, {"within_mean", within_mean}},
                           predicted, simulated);
    ++rows;
  }
  CHECK(rows >= 6);
}
