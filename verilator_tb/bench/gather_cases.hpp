// SPDX-License-Identifier: Apache-2.0
// The corners of the search, as stimuli for whatever answers gather queries.
#pragma once
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "verilator_tb/bench/bench.hpp"

namespace photonloom {

constexpr uint64_t kFetchAnew = uint64_t{1} << 63;  // of leaf_cache: no line is found in the cache

struct GatherStimulus {
  std::vector<PackedPhoton> global, caustic;
  std::vector<GatherQuery> queries;
  std::optional<std::array<uint64_t, 2>> r2_max;  // of the maps, instead of the plan's
  // Then these are loaded instead, while the unit keeps running, and the same queries come again.
  std::optional<std::array<std::vector<PackedPhoton>, 2>> reload;
  // How much of its cache the unit uses, as docs/photon_gatherer.md has it at 0x800004.
  std::optional<uint64_t> leaf_cache;
};

struct GatherCase {
  std::string name;
  std::function<GatherStimulus(const Plan&, BenchRandom&)> make;
};

std::vector<GatherCase> gather_cases();

}  // namespace photonloom
