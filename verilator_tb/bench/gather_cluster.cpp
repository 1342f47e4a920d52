// SPDX-License-Identifier: Apache-2.0
// The bench of gather_engine: a cluster of gatherers on its photon memory, with the gatherer's
// cases, each as it is and through the reorder buffer.
#include "verilator_tb/bench/bench.hpp"
#include "verilator_tb/bench/gather_cases.hpp"

namespace photonloom {
namespace {

std::vector<BenchPlan> plans() {
  std::vector<BenchPlan> list;
  const auto add = [&](const char* name, auto&& change) {
    Plan p;
    p.position_bits = 12;
    p.k = 8;
    p.global = {.present = true, .photons = 600};
    p.caustic = {.present = true, .photons = 100};
    p.cache_bytes = 512;
    p.width = p.height = 64;
    p.beat_bits = 8 * p.line_bytes();
    p.gatherers = 3;
    p.reorder_packets = 64;
    p.reorder_bins = 64;
    change(p);
    for (MapPlan* m : {&p.global, &p.caustic}) m->r2_max = p.r2_limit();
    list.push_back({name, p});
  };
  add("three", [](Plan&) {});
  add("one", [](Plan& p) {
    p.gatherers = 1;
    p.contexts = 2;
    p.beat_bits = 128;
    p.caustic = {};
    p.reorder_key = ReorderKey::kNone;
  });
  // Photons of 12 bytes in a stride of 14, lines of 28 words in two beats.
  add("eight", [](Plan& p) {
    p.gatherers = 8;
    p.contexts = 4;
    p.photon_bytes = 14;
    p.cache_bytes = 4 * p.line_bytes();
    p.beat_bits = 4 * p.line_bytes();
    p.reorder_key = ReorderKey::kHash;
    p.reorder_drain = ReorderDrain::kFullest;
  });
  add("sdram", [](Plan& p) {
    p.photon_memory = PhotonMemory::kSdram;
    p.board_cache_bytes = 16 * p.line_bytes();
  });
  // Lines of 96 bytes, a beat a photon, a cache of four lines.
  add("sdram_narrow", [](Plan& p) {
    p.photon_memory = PhotonMemory::kSdram;
    p.gatherers = 2;
    p.photon_bytes = 12;
    p.cache_bytes = 4 * p.line_bytes();
    p.beat_bits = p.line_bytes();
    p.board_cache_bytes = 4 * p.line_bytes();
  });
  return list;
}

std::vector<ClusterCase> cases() {
  std::vector<ClusterCase> list;
  for (const GatherCase& c : gather_cases()) {
    // Results go on while nobody takes photons, until every place for them is full.
    if (c.name == "all_want_photons") list.push_back({"photons_wait", c, false, 3000});
    list.push_back({c.name, c, false});
    list.push_back({c.name + "_reordered", c, true});
  }
  return list;
}

}  // namespace
}  // namespace photonloom

int main(int argc, char** argv) {
  return photonloom::bench_main(
      argc, argv, photonloom::GatherClusterBench{photonloom::plans(), photonloom::cases()});
}
