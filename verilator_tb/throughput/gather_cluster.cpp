// SPDX-License-Identifier: Apache-2.0
// Cycles per gather of a board's whole gather engine: all gatherers of a plan at work on the one
// photon memory, fill and drain included. Photons and final-gather queries of a scene; every result
// is compared with golden. Plans are those of fpga/headline, at the clocks to which
// fpga/headline.json says that they were routed, or files that are named.
//
// From block RAM the queries come in a frame's order and pass the engine's reorder buffer. From
// SDRAM the same, and once more as they come, without it: the same queries, all of them, since
// fewer of them would be reordered less well. They are many times what the buffer holds: while it
// fills and while a flush empties it, a line of photons serves fewer queries than in a frame's
// middle.
//
// The roofline of the SDRAM is what its chip allows for the lines that it had to read: the cycles
// of a line's halfwords, tRP and tRCD where a row is left for another one of the bank that was just
// read, and the share of refreshes. All other rows are opened and closed beside the data of another
// bank and cost nothing. Without row changes it is what the data pins allow, in whatever order
// lines are read. What binds is what needs the most cycles, the gatherers or the SDRAM, before
// anything is judged.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "golden/numeric/output_file.hpp"
#include "golden/plan/plan_file.hpp"
#include "rtl/generate/data_files.hpp"
#include "verilator_tb/throughput/gather_load.hpp"
#include "verilator_tb/throughput/roofline.hpp"

namespace photonloom {
namespace {

namespace fs = std::filesystem;

constexpr double kUnroutedMHz = 60;  // of a core whose plan has no routed clock
constexpr double kReorderGoal = 4;   // docs/gather_cluster.md

struct Options {
  Options() { load.samples = 8; }
  LoadOptions load;
  std::vector<std::string> plans;
  std::string dump, write_plans, clocks = data_dir() + "/fpga/headline.json";
  uint64_t queries = 0;
  std::optional<double> core_mhz, sdram_mhz;
  bool radius = false;
};

// What a plan is simulated at, in MHz, and whether it was routed to that.
struct Clocks {
  double core, sdram;
  bool routed;
};

// What `make headline` wrote.
nlohmann::json read_rows(const std::string& path) {
  try {
    return nlohmann::json::parse(read_file(path)).at("rows");
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(
        fmt::format("{}: expected what make headline writes: {}", path, error.what()));
  }
}

// The clock for which the controller counts its times.
double planned_mhz(const Plan& plan) { return plan.sdram_khz / 1000.0; }

// The clocks of a plan of fpga/headline: the medians of its row in the data that `make headline`
// writes. The SDRAM runs at the clock of its constraint, or at the one that was reached where that
// is slower. Options go before; a plan without a row has the clocks of none.
Clocks clocks_of(const fs::path& file, const Plan& plan, const nlohmann::json& rows,
                 const Options& o) {
  Clocks found{kUnroutedMHz, planned_mhz(plan), false};
  std::error_code other;
  if (fs::equivalent(fs::absolute(file).parent_path(), data_dir() + "/fpga/headline", other))
    for (const nlohmann::json& row : rows) {
      if (row.at("plan") != file.stem().string()) continue;
      found.core = row.at("fmax_mhz").at("median").get<double>();
      if (const nlohmann::json& sdram = row.at("sdram"); !sdram.is_null())
        found.sdram = sdram.at("mhz").get<double>();
      found.routed = true;
    }
  if (o.core_mhz) found.core = *o.core_mhz;
  if (o.sdram_mhz) found.sdram = *o.sdram_mhz;
  if (!(found.sdram > 0 && found.sdram <= planned_mhz(plan)))
    throw std::runtime_error(fmt::format(
        "{}: an SDRAM of {} MHz by {}, expected up to {:g}, the plan's board.sdram_khz: the "
        "controller's cycles are too short for its chip at more",
        file.string(), found.sdram, o.sdram_mhz ? "--sdram-mhz" : o.clocks, planned_mhz(plan)));
  return found;
}

constexpr int kPhotonBytes = 12;  // of each plan here, without padding

// What a plan's board has of an SDRAM.
struct SdramOfBoard {
  int khz;
  bool shared_nodes;
  int refreshes_ahead;
};
constexpr SdramOfBoard kSdramK8{110000, true, 255}, kSdramK16{100000, true, 255},
    kSdramK50{110000, false, 255};

// What the command line's plans are: a memory and a k each, with as many gatherers as nextpnr finds
// wires and block RAM for. Where the map lies in block RAM, shallow memories of more than 32 words
// are block RAM too: it costs none of the wires that LUT RAM does.
// There the beats of a line stand side by side, so that two ports bring all lines that are visited:
// neither leaf caches nor a reorder buffer save a cycle, and without them there is room for more
// gatherers, each of one candidate a cycle and as many lanes as a beat has photons. Five of k = 16
// lie so far away that two nodes a cycle are two levels of one descent, which is a block RAM more.
// Before an SDRAM two gatherers of k = 50 with one candidate a cycle use half of its time at most,
// and so seldom wait for it; a beat is half of their line, and needs no leaf cache. The pool is
// what block RAM is best spent on: each sweep over it takes every line once or twice, however many
// queries it serves. A pool of 16 places less than its memories have words wastes none of them.
// Where a query visits many leaves, 16 contexts hide what a leaf takes from there if leaves are
// few and large. With k = 16, where the SDRAM binds, 32 contexts hide more of it, with node
// memories that are shared to make room for them; at k = 8 that room is the pool's. The clock of
// the SDRAM is one that the routed top reaches and, with that of its core, one PLL makes. Bins of
// 0: no reorder buffer.
struct PlanOfBoard {
  const char* name;
  PhotonMemory memory;
  uint64_t photons;
  int k, gatherers, contexts, nodes, candidates, powers, bucket, lanes, beat_bits, leaf_photons,
      pool, bins, cache_kb, lut_ram_words, replay;
  SdramOfBoard sdram{100000, false, 0};
};
constexpr PlanOfBoard kPlans[] = {
    {"block_ram_k8", PhotonMemory::kBlockRam, 16384, 8, 5, 16, 1, 1, 1, 8, 4, 384, 0, 512, 0, 48,
     32, 1024},
    {"block_ram_k16", PhotonMemory::kBlockRam, 16384, 16, 5, 16, 2, 1, 1, 8, 4, 384, 0, 512, 0, 48,
     32, 1024},
    {"block_ram_k50", PhotonMemory::kBlockRam, 16384, 50, 4, 16, 1, 1, 1, 16, 4, 384, 0, 2032, 0,
     48, 32, 512},
    {"sdram_k8", PhotonMemory::kSdram, 65536, 8, 3, 16, 1, 1, 1, 8, 4, 384, 256, 13296, 1024, 48,
     64, 512, kSdramK8},
    {"sdram_k16", PhotonMemory::kSdram, 65536, 16, 3, 32, 1, 1, 1, 8, 4, 384, 256, 11248, 512, 48,
     64, 512, kSdramK16},
    {"sdram_k50", PhotonMemory::kSdram, 65536, 50, 2, 16, 1, 1, 1, 16, 8, 768, 0, 11760, 512, 96,
     64, 512, kSdramK50},
};

Plan make_plan(const PlanOfBoard& p, const SceneGathers& load) {
  Plan plan = load.plan(load.stored_photons(p.photons), p.photons);
  plan.scene = "";
  plan.k = p.k;
  plan.contexts = p.contexts;
  plan.nodes_per_cycle = p.nodes;
  plan.candidates_per_cycle = p.candidates;
  plan.powers_per_cycle = p.powers;
  plan.bucket = p.bucket;
  plan.reorder_packets = p.pool;
  if (p.bins == 0) plan.reorder_key = ReorderKey::kNone;
  plan.reorder_bins = p.bins == 0 ? 512 : p.bins;
  plan.reorder_cell_bits = p.bins > 512 ? 4 : 3;
  plan.photon_memory = p.memory;
  plan.gatherers = p.gatherers;
  plan.photon_bytes = kPhotonBytes;
  plan.lanes = p.lanes;
  plan.beat_bits = p.beat_bits;
  plan.cache_bytes = p.leaf_photons * plan.photon_bytes;
  plan.board_cache_bytes = p.cache_kb * 1024;
  plan.sdram_khz = p.sdram.khz;
  plan.shared_nodes = p.sdram.shared_nodes;
  plan.refreshes_ahead = p.sdram.refreshes_ahead;
  plan.lut_ram_words = p.lut_ram_words;
  plan.replay_queries = p.replay;
  check_plan(plan);
  return plan;
}

// Cycles per gather in which a photon memory in block RAM (rtl/board/photon_ram.sv) brings so many
// lines: each port reads a row a cycle, a beat or all of a line's, which then go to each gatherer
// one after the other.
double ports_cycles(const Plan& plan, double lines) {
  const int ports = plan.gatherers > 1 ? 2 : 1, row = plan.photon_ram_row();
  const double beats = lines * plan.line_beats();
  return std::max(beats / row / ports, row > 1 ? beats / plan.gatherers : 0);
}

GatherRun measure(const Plan& plan, const PhotonMap& map, const std::vector<GatherQuery>& queries,
                  bool through_buffer, const Clocks& clocks, const Options& o) {
  std::vector<GatherQuery> in = queries;
  std::vector<GatherQuery> order = queries;
  if (through_buffer) {
    in.push_back({});
    in.back().flush = 1;
    order = reordered(plan, queries);
    order.push_back(in.back());
  }
  RunOptions options;
  options.seed = o.load.seed;
  options.work_dir = o.load.work;
  options.sdram_period = clocks.core / clocks.sdram;
  const auto rtl = make_rtl_gather_engine(plan, options, through_buffer, true);
  return run_gathers(*rtl, plan, map, in, order, queries.size());
}

// Whether gathers from SDRAM are as quick as they are to be, and the arithmetic of it.
struct Verdict {
  bool bound_by_gatherers, met;
  std::string text;
};

Verdict judge(const Plan& plan, const GatherRun& m, double memory_lines, double row_changes,
              const Roof& gatherers, const Roof& roofline, double pins_cycles,
              const Clocks& clocks) {
  const bool bound_by_gatherers = binds(gatherers, roofline);
  const bool met = reaches_its_bound(gatherers, roofline);
  return {
      bound_by_gatherers, met,
      fmt::format(
          "SDRAM: ({:.3f} lines * {} cycles + {:.3f} row changes * {:g}) / {:.4f} * {:.1f} / "
          "{:.1f} MHz = {:.2f} cycles, {:.2f} without row changes; gatherers: {:.2f} / {} = {:.2f} "
          "cycles; bound by the {}: {:.1f} % of {} bound, goal {:.0f} %{}",
          memory_lines, plan.line_bytes() / 2, row_changes, row_change_cycles(plan.sdram_khz),
          kRefreshLeaves, clocks.core, clocks.sdram, roofline.cycles, pins_cycles, m.cost.bound,
          plan.gatherers, gatherers.cycles, bound_by_gatherers ? "gatherers" : "SDRAM",
          100 * (bound_by_gatherers ? gatherers : roofline).reached,
          bound_by_gatherers ? "their" : "its",
          100 * (bound_by_gatherers ? kGatherersGoal : kRooflineGoal), met ? "" : "; MISSED")};
}

void dump(const std::string& path, const std::vector<UVec3>& points) {
  std::string bytes(points.size() * 12, '\0');
  for (size_t i = 0; i < points.size(); ++i)
    for (size_t axis = 0; axis < 3; ++axis)
      for (size_t byte = 0; byte < 4; ++byte)
        bytes[12 * i + 4 * axis + byte] =
            static_cast<char>(points[i][static_cast<int>(axis)] >> (8 * byte) & 255);
  write_file(path, bytes);
}

int run(Options o) {
  if (o.core_mhz && !(*o.core_mhz > 0 && *o.core_mhz <= 1000))
    throw std::runtime_error(fmt::format("--core-mhz: {}, expected up to 1000", *o.core_mhz));
  const SceneGathers load(o.load);
  if (!o.write_plans.empty()) {
    for (const PlanOfBoard& p : kPlans)
      write_file(fmt::format("{}/{}.toml", o.write_plans, p.name), plan_text(make_plan(p, load)));
    return 0;
  }
  if (o.plans.empty())
    for (const PlanOfBoard& p : kPlans)
      o.plans.push_back(fmt::format("{}/fpga/headline/{}.toml", data_dir(), p.name));

  const nlohmann::json routed = read_rows(o.clocks);
  fmt::print(
      "gather engine: cycles of its core, at the clocks in MHz to which {} says that the plan was "
      "routed\n",
      fs::path(o.clocks).filename().string());
  fmt::print(
      "{:<16} {:>3} {:>2} {:>5} {:>5} {:>6} {:<9} {:>6} {:>6} {:>13} {:>7} {:>6} {:>6} {:>9} "
      "{:>8} {:>6} {:>9}\n",
      "plan", "k", "N", "core", "SDRAM", "radius", "order", "bound", "leaves", "cycles/gather",
      "bound/N", "of it", "lines", "mem lines", "roofline", "of it", "kcycles/s");
  nlohmann::json rows = nlohmann::json::array();
  std::vector<std::string> missed;
  for (const std::string& file : o.plans) {
    Plan plan = read_plan(file);
    const std::string name = fs::path(file).stem().string();
    const Clocks clocks = clocks_of(file, plan, routed, o);
    const std::vector<Photon> photons = load.stored_photons(plan.global.photons);
    const std::vector<PackedPhoton> packed = pack_photons(photons, plan, plan.global, nullptr);
    const PhotonMap map = build_photon_map(packed, plan);
    std::vector<GatherQuery> queries = load.queries(plan);
    if (queries.empty()) throw std::runtime_error(o.load.scene + ": no final-gather query");
    if (o.queries && queries.size() > o.queries) queries.resize(o.queries);

    // Without a radius, then within the mean r^2 of the exact search: where leaves are limited, the
    // k-th photon found may lie far away, and a mean of those would bound nothing.
    std::vector<uint64_t> radii = {plan.r2_limit()};
    if (o.radius) {
      Plan open = plan;
      open.global.r2_max = open.caustic.r2_max = plan.r2_limit();
      open.leaf_limit = 0;
      open.epsilon_factor = uint32_t{1} << plan.epsilon_shift;
      radii.push_back(mean_r2(open, map, queries));
    }
    if (!o.dump.empty()) {
      std::vector<UVec3> points, places;
      for (const PackedPhoton& p : packed) points.push_back(p.position);
      for (const GatherQuery& q : reordered(plan, queries)) places.push_back(q.position);
      dump(fmt::format("{}/{}.photons", o.dump, name), points);
      dump(fmt::format("{}/{}.queries", o.dump, name), places);
    }

    const bool sdram = plan.photon_memory == PhotonMemory::kSdram;
    if (!clocks.routed && !o.core_mhz)
      fmt::print("{}: no plan of fpga/headline that was routed; a core of {:g} MHz is assumed\n",
                 file, clocks.core);
    for (const uint64_t r2_max : radii) {
      plan.global.r2_max = plan.caustic.r2_max = r2_max;
      double with_order = 0;
      for (const bool through_buffer : {true, false}) {
        if (!through_buffer && !sdram) continue;
        const GatherRun m = measure(plan, map, queries, through_buffer, clocks, o);
        const auto n = static_cast<double>(m.queries);
        const double lines = m.counted("lines") / n, memory_lines = m.counted("memory lines") / n;
        const double row_changes = sdram ? m.counted("memory row changes") / n : 0;
        const auto roof = [&](double cycles) { return Roof{cycles, cycles / m.cycles}; };
        const Roof gatherers = roof(m.cost.bound / plan.gatherers);
        std::optional<Roof> roofline;
        std::optional<Verdict> verdict;
        std::optional<double> gain;
        const auto of_sdram = [&](double cycles) {
          return cycles / kRefreshLeaves * clocks.core / clocks.sdram;
        };
        const double data = memory_lines * plan.line_bytes() / 2, pins_cycles = of_sdram(data);
        if (sdram)
          roofline = roof(of_sdram(data + row_changes * row_change_cycles(plan.sdram_khz)));
        if (through_buffer) {
          with_order = m.cycles;
          if (sdram)
            verdict = judge(plan, m, memory_lines, row_changes, gatherers, *roofline, pins_cycles,
                            clocks);
        } else {
          gain = m.cycles / with_order;
        }
        fmt::print(
            "{:<16} {:>3} {:>2} {:>5.1f} {:>5} {:>6} {:<9} {:>6.1f} {:>6.1f} {:>13.2f} {:>7.2f} "
            "{:>6} {:>6.2f} {:>9.3f} {:>8} {:>6} {:>9.0f}\n",
            name, plan.k, plan.gatherers, clocks.core,
            sdram ? fmt::format("{:.1f}", clocks.sdram) : "",
            r2_max == plan.r2_limit() ? "none" : "mean", through_buffer ? "reordered" : "pixels",
            m.cost.bound, m.cost.leaves, m.cycles, gatherers.cycles,
            fmt::format("{:.0f} %", 100 * gatherers.reached), lines, memory_lines,
            roofline ? fmt::format("{:.2f}", roofline->cycles) : "",
            roofline ? fmt::format("{:.0f} %", 100 * roofline->reached) : "",
            m.cycles_per_second / 1000);
        if (verdict) fmt::print("  {}\n", verdict->text);
        if (gain)
          fmt::print("  reordering gains {:.2f}, goal {:g}{}\n", *gain, kReorderGoal,
                     *gain < kReorderGoal ? "; MISSED" : "");
        std::fflush(stdout);
        if (verdict && !verdict->met) missed.push_back(name + ": " + verdict->text);
        if (gain && *gain < kReorderGoal)
          missed.push_back(
              fmt::format("{}: reordering gains {:.2f}, goal {:g}", name, *gain, kReorderGoal));
        nlohmann::json row = m.row();
        row.update(
            {{"plan", name},
             {"plan_hash", plan_hash_text(plan)},
             {"memory", sdram ? "sdram" : "block_ram"},
             {"photons", map.count},
             {"k", plan.k},
             {"gatherers", plan.gatherers},
             {"r2_max", r2_max == plan.r2_limit() ? nlohmann::json() : nlohmann::json(r2_max)},
             {"order", through_buffer ? "reordered" : "pixels"},
             {"core_mhz", clocks.core},
             {"sdram_mhz", clocks.sdram},
             {"lines_per_gather", lines},
             {"memory_lines_per_gather", memory_lines},
             {"row_changes_per_gather", row_changes},
             {"row_change_cycles", row_change_cycles(plan.sdram_khz)},
             {"ports_cycles", sdram ? nlohmann::json() : nlohmann::json(ports_cycles(plan, lines))},
             {"memory_busy", m.counted("memory busy") / (m.cycles * n)},
             {"gatherers_cycles", gatherers.cycles},
             {"of_gatherers", gatherers.reached},
             {"roofline_cycles", roofline ? nlohmann::json(roofline->cycles) : nlohmann::json()},
             {"pins_cycles", sdram ? nlohmann::json(pins_cycles) : nlohmann::json()},
             {"of_roofline", roofline ? nlohmann::json(roofline->reached) : nlohmann::json()},
             {"roofline_goal", kRooflineGoal},
             {"gatherers_goal", kGatherersGoal},
             {"bound_by_gatherers",
              verdict ? nlohmann::json(verdict->bound_by_gatherers) : nlohmann::json()},
             {"roofline_met", verdict ? nlohmann::json(verdict->met) : nlohmann::json()},
             {"roofline_verdict", verdict ? nlohmann::json(verdict->text) : nlohmann::json()},
             {"reorder_gain", gain ? nlohmann::json(*gain) : nlohmann::json()},
             {"reorder_goal", kReorderGoal},
             {"line_bytes", plan.line_bytes()}});
        rows.push_back(row);
      }
    }
  }
  return report("gather_cluster", o.load, rows, missed);
}

}  // namespace
}  // namespace photonloom

int main(int argc, char** argv) {
  photonloom::Options o;
  CLI::App app{
      "Cycles per gather of all gatherers of a plan on their photon memory, with photons and "
      "final-gather queries of a scene; exit status 1 where a goal is missed."};
  app.add_option("plans", o.plans, "Plan files. Default: those of fpga/headline.");
  o.load.add_to(app, "--scene");
  app.add_option("--queries", o.queries, "Queries at most; 0: all of the pixels.");
  app.add_option("--clocks", o.clocks,
                 "What `make headline` wrote: the clocks of the plans of fpga/headline.");
  app.add_option("--core-mhz", o.core_mhz,
                 "Frequency of the core, instead: what a cycle is beside the SDRAM's clock.");
  app.add_option("--sdram-mhz", o.sdram_mhz,
                 "Frequency of the SDRAM, instead, at most the plan's board.sdram_khz.");
  app.add_flag("--radius", o.radius,
               "Once more within the mean r^2 of the queries, found exactly.");
  app.add_option("--dump", o.dump,
                 "Folder for positions of photons and queries, PLAN.photons, ...");
  app.add_option("--write-plans", o.write_plans,
                 "Write the plans to this folder, do nothing else.");
  return photonloom::bench_program(app, argc, argv, [&] { return photonloom::run(o); });
}
