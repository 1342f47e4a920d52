// SPDX-License-Identifier: Apache-2.0
// Packets a cycle of the reorder buffer once its pool is full, for keys that are uniform,
// clustered, all in one bin, or one for each bin in turn. Input and output never stall; every
// packet is compared with golden.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "golden/numeric/output_file.hpp"
#include "golden/plan/plan_file.hpp"
#include "verilator_tb/rig/number_options.hpp"
#include "verilator_tb/unit/backends.hpp"

namespace photonloom {
namespace {

struct Options {
  int packets = 2048, bins = 512, cell_bits = 3;
  uint64_t queries = 20000, seed = 1;
  std::string json, work = "build/cosim";
};

// The cell in which query i of a pattern lies, as a place on the Hilbert curve where that matters.
std::vector<GatherQuery> make_queries(const Plan& plan, const std::string& pattern,
                                      const Options& o) {
  RoleRandom random(o.seed, pattern);
  const int rest = plan.position_bits - plan.reorder_cell_bits;
  const auto cells = uint64_t{1} << (3 * plan.reorder_cell_bits);
  const auto mask = static_cast<uint32_t>(ones(plan.reorder_cell_bits));
  uint64_t clusters[8];
  for (uint64_t& c : clusters) c = random.below(cells);
  std::vector<GatherQuery> queries;
  for (uint64_t i = 0; i < o.queries; ++i) {
    uint64_t cell = random.below(cells);
    if (pattern == "clustered" && random.chance(0.9)) cell = clusters[random.below(8)];
    if (pattern == "one bin") cell = clusters[0];
    if (pattern == "one per bin") cell = i % cells;
    GatherQuery q{};
    q.pixel = static_cast<uint32_t>(i & ones(plan.pixel_bits()));
    for (size_t c = 0; c < 3; ++c) {
      const auto coordinate =
          static_cast<uint32_t>(cell >> (static_cast<int>(c) * plan.reorder_cell_bits)) & mask;
      q.position[c] = coordinate << rest | static_cast<uint32_t>(random.bits() & ones(rest));
    }
    queries.push_back(q);
  }
  return queries;
}

int run(const Options& o) {
  nlohmann::json rows = nlohmann::json::array();
  bool all_met = true;
  fmt::print("reorder_buffer: {} packets, {} bins, {} queries\n", o.packets, o.bins, o.queries);
  fmt::print("{:<13} {:<8} {:<12} {:>13} {:>5} {}\n", "drain", "key", "keys", "packets/cycle",
             "goal", "");
  for (const std::string drain : {"pass-through", "sweep", "fullest"})
    for (const std::string key : {"hilbert", "hash"}) {
      if (drain == "pass-through" && key == "hash") continue;
      Plan plan;
      plan.reorder_key = drain == "pass-through" ? ReorderKey::kNone
                         : key == "hash"         ? ReorderKey::kHash
                                                 : ReorderKey::kHilbert;
      plan.reorder_drain = drain == "fullest" ? ReorderDrain::kFullest : ReorderDrain::kSweep;
      plan.reorder_packets = o.packets;
      plan.reorder_bins = o.bins;
      plan.reorder_cell_bits = o.cell_bits;
      check_plan(plan);
      for (const std::string pattern : {"uniform", "clustered", "one bin", "one per bin"}) {
        const std::vector<GatherQuery> queries = make_queries(plan, pattern, o);
        std::vector<GatherQuery> expected, out;
        make_golden_reorder_buffer(plan)->process(queries, expected);
        RunOptions options;
        options.work_dir = o.work;
        options.timeline = true;
        const auto rtl = make_rtl_reorder_buffer(plan, options);
        rtl->process(queries, out);
        if (out != expected)
          throw std::runtime_error(fmt::format("{}, {}: RTL and golden differ", drain, pattern));
        const auto cycles = rtl->out_cycles(0);
        const double rate = static_cast<double>(cycles.size() - 1) /
                            static_cast<double>(cycles.back() - cycles.front());
        const double goal = drain != "fullest" ? 0.98 : pattern == "uniform" ? 0.7 : 0;
        const bool met = rate >= goal;
        all_met &= met;
        fmt::print("{:<13} {:<8} {:<12} {:>13.3f} {:>5} {}\n", drain,
                   drain == "pass-through" ? "" : key, pattern, rate,
                   goal > 0 ? fmt::format("{:.2f}", goal) : "", met ? "" : "MISSED");
        std::fflush(stdout);
        rows.push_back({{"drain", drain},
                        {"key", key},
                        {"keys", pattern},
                        {"packets_per_cycle", rate},
                        {"goal", goal}});
      }
    }
  if (!o.json.empty()) write_file(o.json, nlohmann::json{{"reorder_buffer", rows}}.dump(2) + "\n");
  return all_met ? 0 : 1;
}

}  // namespace
}  // namespace photonloom

int main(int argc, char** argv) {
  photonloom::Options o;
  CLI::App app{
      "Packets a cycle of the RTL reorder buffer once full; exit status 1 where a goal is missed."};
  app.add_option("--packets", o.packets, "Pool size.");
  app.add_option("--bins", o.bins, "Bins.");
  app.add_option("--cell-bits", o.cell_bits, "Bits of each coordinate in the key.");
  app.add_option("--queries", o.queries, "Queries, more than the pool holds.")
      ->check(CLI::Range(2, 1 << 24));
  photonloom::add_seed_option(app, o.seed, "Seed.");
  app.add_option("--json", o.json, "Write the table here too.");
  app.add_option("--work", o.work, "Folder of Verilated models.");
  photonloom::check_values(app);
  try {
    app.parse(argc, argv);
    if (o.queries < static_cast<uint64_t>(o.packets) + 2)
      throw CLI::ValidationError("--queries", "expected more than --packets + 1");
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    return photonloom::run(o);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
