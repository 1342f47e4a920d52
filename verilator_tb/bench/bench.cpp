// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/bench/bench.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <exception>
#include <optional>

#include "golden/packet/trace.hpp"
#include "verilator_tb/rig/rig_options.hpp"
#include "verilator_tb/unit/backends.hpp"
#include "verilator_tb/unit/compare_units.hpp"

namespace photonloom {

namespace {

// One way to run a case. Together they hold every policy on every side, short, long and random
// latencies, and two initial register values.
struct Policy {
  const char *in, *out, *memory, *latency;
  uint64_t initial_seed;
};
constexpr Policy kPolicies[] = {
    {"none", "none", "none", "1", 1},
    {"none", "none", "none", "60", 2},
    {"bernoulli:0.5", "none", "bernoulli:0.3", "random:30", 1},
    {"none", "bernoulli:0.5", "none", "20", 2},
    {"bursts", "bursts", "bursts", "random:60", 1},
    {"adversary", "adversary", "adversary", "3", 2},
};

struct BenchCommand {
  std::string plan, backend = "rtl";
  std::vector<std::string> only_cases;
  uint64_t seed = 1, packets = 1;
  int policy = -1;
  bool list = false;
  RigFlags rig;
  bool own_policy = false;
};

struct Totals {
  uint64_t runs = 0, compared = 0, cycles = 0;
};

// Feeds `in` in pieces of random length: how calls cut the stream must not matter.
template <class In, class F>
void feed(const std::vector<In>& in, BenchRandom& random, F&& process) {
  for (size_t at = 0; at < in.size();) {
    const size_t n = std::min<size_t>(in.size() - at, 1 + random.below(4096));
    process(std::span<const In>(in).subspan(at, n));
    at += n;
  }
}

void run_case(const Plan& plan, const StreamCase<GatherQuery>& c, const RunOptions& options,
              const CompareContext& context, BenchRandom& random, Totals& totals) {
  const std::vector<GatherQuery> in = c.make(plan, random);
  const auto golden = make_golden_reorder_buffer(plan);
  const auto rtl = make_rtl_reorder_buffer(plan, options);
  const auto both = compare_units(plan, context, *golden, *rtl);
  std::vector<GatherQuery> out;
  feed(in, random, [&](std::span<const GatherQuery> piece) { both->process(piece, out); });
  rtl->finish();
  totals.compared += both->compared();
  totals.cycles += rtl->cycles();
}

void run_case(const Plan& plan, const StreamCase<SamplerInput>& c, const RunOptions& options,
              const CompareContext& context, BenchRandom& random, Totals& totals) {
  const std::vector<SamplerInput> in = c.make(plan, random);
  const auto golden = make_golden_cdf_sampler(plan);
  const auto rtl = make_rtl_cdf_sampler(plan, options);
  const auto both = compare_units(plan, context, *golden, *rtl);
  std::vector<Sample> out;
  feed(in, random, [&](std::span<const SamplerInput> piece) { both->process(piece, out); });
  rtl->finish();
  totals.compared += both->compared();
  totals.cycles += rtl->cycles();
}

void run_case(const Plan& bench_plan, const GatherCase& c, const RunOptions& options,
              const CompareContext& context, BenchRandom& random, Totals& totals) {
  const GatherStimulus in = c.make(bench_plan, random);
  Plan plan = bench_plan;
  if (in.r2_max) {
    plan.global.r2_max = (*in.r2_max)[0];
    plan.caustic.r2_max = (*in.r2_max)[1];
  }
  const PhotonMap global = build_photon_map(in.global, plan);
  const PhotonMap caustic = build_photon_map(in.caustic, plan);
  const auto golden = make_golden_photon_gatherer(plan);
  const auto rtl = make_rtl_photon_gatherer(plan, options);
  const auto both = compare_units(plan, context, *golden, *rtl);
  both->load(global, caustic);
  std::vector<GatherResult> results;
  std::vector<GatherPhoton> photons;
  const auto ask = [&] {
    feed(in.queries, random,
         [&](std::span<const GatherQuery> piece) { both->process(piece, results, photons); });
  };
  ask();
  PhotonMap other_global, other_caustic;
  if (in.reload) {
    other_global = build_photon_map((*in.reload)[0], plan);
    other_caustic = build_photon_map((*in.reload)[1], plan);
    both->load(other_global, other_caustic);
    ask();
  }
  rtl->finish();
  totals.compared += both->compared();
  totals.cycles += rtl->cycles();
}

void run_case(const Plan& bench_plan, const ClusterCase& c, const RunOptions& options,
              const CompareContext& context, BenchRandom& random, Totals& totals) {
  const GatherStimulus in = c.gather.make(bench_plan, random);
  Plan plan = bench_plan;
  if (in.r2_max) {
    plan.global.r2_max = (*in.r2_max)[0];
    plan.caustic.r2_max = (*in.r2_max)[1];
  }
  PhotonMap global = build_photon_map(in.global, plan);
  PhotonMap caustic = build_photon_map(in.caustic, plan);
  const auto golden = make_golden_photon_gatherer(plan);
  const auto order = make_golden_reorder_buffer(plan);
  // The SDRAM's clock from less than half the core's frequency to three times as much.
  RunOptions with_clock = options;
  with_clock.photon_pause = c.photon_pause;
  with_clock.sdram_period = 0.33 + static_cast<double>(random.below(2000)) / 1000;
  const auto rtl = make_rtl_gather_engine(plan, with_clock, c.reordered);
  StreamComparer compare_results(PacketLayout::of<GatherResult>(plan), "result", context);
  StreamComparer compare_photons(PacketLayout::of<GatherPhoton>(plan), "photon", context);
  golden->load(global, caustic);
  rtl->load(global, caustic);

  const auto ask = [&](std::span<const GatherQuery> queries) {
    std::vector<GatherQuery> ordered;
    if (c.reordered)
      order->process(queries, ordered);
    else
      ordered.assign(queries.begin(), queries.end());
    std::vector<GatherResult> expected, results;
    std::vector<GatherPhoton> expected_photons, photons;
    golden->process(ordered, expected, expected_photons);
    rtl->process(queries, results, photons);
    const auto result_input = [&](size_t i) {
      return packet_to_json(PacketLayout::of<GatherQuery>(plan), &ordered[i]);
    };
    compare_results.compare<GatherResult>(expected, results, rtl->out_cycles(0), result_input);
    compare_photons.compare<GatherPhoton>(
        expected_photons, photons, rtl->out_cycles(1), [&](size_t i) {
          size_t q = 0;
          for (; !ordered[q].want_photons || ordered[q].flush || i >= expected[q].count; ++q)
            if (ordered[q].want_photons && !ordered[q].flush) i -= expected[q].count;
          return result_input(q);
        });
  };
  // Whatever waits in the reorder buffer comes out at the end.
  std::vector<GatherQuery> queries = in.queries;
  if (c.reordered) {
    queries.push_back({});
    queries.back().flush = 1;
  }
  const auto ask_all = [&] { feed(queries, random, ask); };
  ask_all();
  if (in.reload) {
    global = build_photon_map((*in.reload)[0], plan);
    caustic = build_photon_map((*in.reload)[1], plan);
    golden->load(global, caustic);
    rtl->load(global, caustic);
    ask_all();
  }
  rtl->finish();
  totals.compared += compare_results.compared() + compare_photons.compared();
  totals.cycles += rtl->cycles();
}

// All cases and policies once, with the command's seed.
template <class Bench>
void run_cases(const std::string& program, const std::string& unit, const Bench& bench,
               const BenchPlan& plan, const BenchCommand& command, Totals& totals) {
  for (const auto& c : bench.cases) {
    if (!command.only_cases.empty() &&
        std::find(command.only_cases.begin(), command.only_cases.end(), c.name) ==
            command.only_cases.end())
      continue;
    const int policies = command.own_policy ? 1 : static_cast<int>(std::size(kPolicies));
    for (int p = 0; p < policies; ++p) {
      if (command.policy >= 0 && !command.own_policy && p != command.policy) continue;
      RunOptions options = command.rig.options(unit);
      options.kind = *model_kind(command.backend);
      CompareContext context;
      context.unit = unit;
      context.backend = command.backend;
      context.waveform = waveform_extension(options.kind);
      context.seed = command.seed;
      context.plan = plan.name;
      context.rerun =
          fmt::format("{} --plan {} --case {} --seed {}", program, plan.name, c.name, command.seed);
      if (command.own_policy) {
        context.rerun += fmt::format(
            " --stall-in {} --stall-out {} --stall-memory {} --latency {}{} --initial-seed {}",
            options.stall_in.text(), options.stall_out.text(), options.stall_memory.text(),
            options.random_latency ? "random:" : "", options.latency, options.initial_seed);
      } else {
        options.stall_in = StallPolicy::parse(kPolicies[p].in);
        options.stall_out = StallPolicy::parse(kPolicies[p].out);
        options.stall_memory = StallPolicy::parse(kPolicies[p].memory);
        const std::string latency = kPolicies[p].latency;
        options.random_latency = latency.rfind("random:", 0) == 0;
        options.latency = std::stoi(options.random_latency ? latency.substr(7) : latency);
        options.initial_seed = kPolicies[p].initial_seed;
        context.rerun += fmt::format(" --policy {}", p);
      }
      if (!options.rtl_dir.empty()) context.rerun += " --rtl " + options.rtl_dir;
      if (options.kind != ModelKind::kRtl) context.rerun += " --backend " + command.backend;
      if (options.yosys != "yosys") context.rerun += " --yosys " + options.yosys;
      if (!options.netlist.empty()) context.rerun += " --netlist " + options.netlist;
      options.seed = command.seed;
      BenchRandom random(command.seed, unit + "/" + c.name);
      try {
        run_case(plan.plan, c, options, context, random, totals);
      } catch (const Divergence&) {
        throw;
      } catch (const ModelBuildError&) {
        throw;
      } catch (const std::exception& error) {
        throw std::runtime_error(fmt::format("{}\n  again, with a waveform:\n    {} --wave {}.{}",
                                             error.what(), context.rerun, unit, context.waveform));
      }
      ++totals.runs;
    }
  }
}

template <class Bench>
void run_plan(const std::string& program, const std::string& unit, const Bench& bench,
              const BenchPlan& plan, const BenchCommand& command) {
  const auto started = std::chrono::steady_clock::now();
  Totals totals;
  BenchCommand round = command;
  do {
    const uint64_t before = totals.compared;
    run_cases(program, unit, bench, plan, round, totals);
    ++round.seed;
    if (totals.compared == before) break;
  } while (totals.compared < command.packets);
  if (totals.compared == 0)
    throw std::runtime_error(fmt::format("{}, plan {}: no packet was checked", unit, plan.name));
  fmt::print(
      "{} plan {}: golden == {}: {} packets in {} runs, 0 differences, {} cycles, {:.1f} "
      "s\n",
      unit, plan.name, command.backend, totals.compared, totals.runs, totals.cycles,
      std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count());
  std::fflush(stdout);
}

template <class Bench>
int run_bench(int argc, char** argv, const std::string& unit, const Bench& bench) {
  CLI::App app{"The hardware of " + unit + " beside golden, packet by packet."};
  BenchCommand command;
  app.add_option("--plan", command.plan,
                 "A plan of --list, random:N, or random:N-M for a range. Default: all of --list.");
  app.add_option("--case", command.only_cases,
                 "Cases of --list, with commas between. Default: all.")
      ->delimiter(',');
  app.add_option("--backend", command.backend,
                 "What runs: rtl (default), netlist or cxxrtl (docs/netlist.md).")
      ->check(CLI::IsMember({"rtl", "netlist", "cxxrtl"}));
  app.add_option("--policy", command.policy, "Only this entry of the list of policies.")
      ->check(CLI::Range(0, static_cast<int>(std::size(kPolicies)) - 1));
  app.add_option("--packets", command.packets,
                 "Check at least so many packets per plan: repeats everything with the next seed.");
  app.add_flag("--list", command.list, "List plans, cases and policies.");
  command.rig.add_to(app, "--seed");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  for (const char* flag : {"--stall", "--stall-in", "--stall-out", "--stall-memory", "--latency"})
    command.own_policy |= app.count(flag) > 0;
  if (command.list) {
    for (const BenchPlan& p : bench.plans) fmt::print("plan {}\n", p.name);
    for (const auto& c : bench.cases) fmt::print("case {}\n", c.name);
    for (size_t p = 0; p < std::size(kPolicies); ++p)
      fmt::print("policy {}: in {}, out {}, memory {}, latency {}\n", p, kPolicies[p].in,
                 kPolicies[p].out, kPolicies[p].memory, kPolicies[p].latency);
    return 0;
  }
  try {
    command.seed = command.rig.options(unit).seed;
    command.rig.check_netlist(command.backend == "netlist");
    std::vector<BenchPlan> plans;
    unsigned long long from = 0, to = 0;
    char extra = 0;
    if (command.plan.rfind("random:", 0) == 0) {
      const int n = std::sscanf(command.plan.c_str() + 7, "%llu-%llu%c", &from, &to, &extra);
      if (n == 1) to = from;
      if (n < 1 || n > 2 || from > to)
        throw std::runtime_error(
            fmt::format("--plan {}: expected random:N or random:N-M", command.plan));
      for (uint64_t i = from; i <= to; ++i)
        plans.push_back({fmt::format("random:{}", i), random_plan(i)});
    } else {
      for (const BenchPlan& p : bench.plans)
        if (command.plan.empty() || p.name == command.plan) plans.push_back(p);
    }
    if (plans.empty())
      throw std::runtime_error(fmt::format("--plan {}: not a plan of --list", command.plan));
    for (const BenchPlan& p : plans) run_plan(argv[0], unit, bench, p, command);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}

}  // namespace

int bench_main(int argc, char** argv, const ReorderBufferBench& bench) {
  return run_bench(argc, argv, "reorder_buffer", bench);
}
int bench_main(int argc, char** argv, const CdfSamplerBench& bench) {
  return run_bench(argc, argv, "cdf_sampler", bench);
}
int bench_main(int argc, char** argv, const PhotonGathererBench& bench) {
  return run_bench(argc, argv, "photon_gatherer", bench);
}
int bench_main(int argc, char** argv, const GatherClusterBench& bench) {
  return run_bench(argc, argv, "gather_engine", bench);
}

}  // namespace photonloom
