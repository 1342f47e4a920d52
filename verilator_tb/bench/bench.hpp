// SPDX-License-Identifier: Apache-2.0
// The thin benches' common part. A bench names plans and cases of its unit; here every case runs
// under several stall policies, memory latencies and initial register values, golden beside RTL (or
// its netlist, or its CXXRTL model).
//
// A bench program: --list; --plan NAME (a name of the bench, or random:N), --case NAME, --seed S,
// --policy N, --packets N, --backend NAME, and the rig's flags, which replace the list of policies
// when --stall* or --latency is given. Exit status 0 when packets were checked and all were equal.
#pragma once
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "golden/unit/backend.hpp"
#include "verilator_tb/rig/stall.hpp"

namespace photonloom {

using BenchRandom = RoleRandom;

struct BenchPlan {
  std::string name;
  Plan plan;
};

template <class In>
struct StreamCase {
  std::string name;
  std::function<std::vector<In>(const Plan&, BenchRandom&)> make;
};

struct GatherStimulus {
  std::vector<PackedPhoton> global, caustic;
  std::vector<GatherQuery> queries;
  std::optional<std::array<uint64_t, 2>> r2_max;  // of the maps, instead of the plan's
  // Then these are loaded instead, while the unit keeps running, and the same queries come again.
  std::optional<std::array<std::vector<PackedPhoton>, 2>> reload;
};

struct GatherCase {
  std::string name;
  std::function<GatherStimulus(const Plan&, BenchRandom&)> make;
};

struct ReorderBufferBench {
  std::vector<BenchPlan> plans;
  std::vector<StreamCase<GatherQuery>> cases;
};
struct CdfSamplerBench {
  std::vector<BenchPlan> plans;
  std::vector<StreamCase<SamplerInput>> cases;
};
struct PhotonGathererBench {
  std::vector<BenchPlan> plans;
  std::vector<GatherCase> cases;
};

// A cluster of gatherers with its photon memory: the gatherer's cases, some of them through the
// reorder buffer.
struct ClusterCase {
  std::string name;
  GatherCase gather;
  bool reordered = false;
  uint64_t photon_pause = 0;  // of the receiver of photons, RunOptions
};
struct GatherClusterBench {
  std::vector<BenchPlan> plans;
  std::vector<ClusterCase> cases;
};

int bench_main(int argc, char** argv, const ReorderBufferBench& bench);
int bench_main(int argc, char** argv, const CdfSamplerBench& bench);
int bench_main(int argc, char** argv, const PhotonGathererBench& bench);
int bench_main(int argc, char** argv, const GatherClusterBench& bench);

// A random plan that check_plan() would pass, small enough to simulate: for `make test-full`.
Plan random_plan(uint64_t seed);

}  // namespace photonloom
