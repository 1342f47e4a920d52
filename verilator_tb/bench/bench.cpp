// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/bench/bench.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <exception>
#include <fstream>

#include "verilator_tb/model/tools.hpp"
#include "verilator_tb/rig/rig_options.hpp"

namespace photonloom {

namespace {

// One way to run a case. Together they hold every policy on every side, short, long and random
// latencies, and two initial register values; some reset the unit in the middle of its first
// packets.
struct Policy {
  const char *in, *out, *memory, *latency;
  uint64_t initial_seed;
  bool restarts;
};
constexpr Policy kPolicies[] = {
    {"none", "none", "none", "1", 1, false},
    {"none", "none", "none", "60", 2, true},
    {"bernoulli:0.5", "none", "bernoulli:0.3", "random:30", 1, false},
    {"none", "bernoulli:0.5", "none", "20", 2, false},
    {"bursts", "bursts", "bursts", "random:60", 1, true},
    {"adversary", "adversary", "adversary", "3", 2, true},
};

struct BenchCommand {
  std::string plan, backend = "rtl";
  std::vector<std::string> only_cases;
  uint64_t seed = 1, packets = 1;
  int policy = -1;
  bool one_policy = false, list = false, soak = false;
  RigFlags rig;
  bool own_policy = false;
  std::string given;  // options as they were, that every case has
};

// How many cycles after its first packet a run is reset: any of 400.
uint64_t restart_cycle(uint64_t seed, const std::string& unit, const std::string& name,
                       int policy) {
  return 1 + BenchRandom(seed, fmt::format("{}/{}/restart {}", unit, name, policy)).below(400);
}

// All cases and policies once, with the command's seed; or each case with one policy,
// drawn for the plan, so that over plans a case meets them all.
void run_cases(const std::string& program, const Bench& bench, const BenchPlan& plan,
               const BenchCommand& command, BenchTotals& totals) {
  const std::string& unit = bench.module;
  const bool restarts = command.backend != "hls";  // a kernel has no reset
  for (const BenchCase& c : bench.cases) {
    if (!command.only_cases.empty() &&
        std::find(command.only_cases.begin(), command.only_cases.end(), c.name) ==
            command.only_cases.end())
      continue;
    const int policies = command.own_policy ? 1 : static_cast<int>(std::size(kPolicies));
    const int drawn = static_cast<int>(
        BenchRandom(command.seed, fmt::format("{}/{}/{}/policy", unit, plan.name, c.name))
            .below(std::size(kPolicies)));
    for (int p = 0; p < policies; ++p) {
      if (command.policy >= 0 && !command.own_policy && p != command.policy) continue;
      if (command.one_policy && !command.own_policy && p != drawn) continue;
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
        options.random_latency = latency.starts_with("random:");
        options.latency = std::stoi(options.random_latency ? latency.substr(7) : latency);
        options.initial_seed = kPolicies[p].initial_seed;
        if (kPolicies[p].restarts && restarts)
          options.restart_after = restart_cycle(command.seed, unit, c.name, p);
        context.rerun += fmt::format(" --policy {}", p);
      }
      if (!options.rtl_dir.empty())
        context.rerun += " --rtl " + model_tools::shell_word(options.rtl_dir);
      if (options.kind != ModelKind::kRtl) context.rerun += " --backend " + command.backend;
      if (options.yosys != "yosys")
        context.rerun += " --yosys " + model_tools::shell_word(options.yosys);
      if (!options.netlist.empty())
        context.rerun += " --netlist " + model_tools::shell_word(options.netlist);
      context.rerun += command.given;
      context.writes(options);
      options.seed = command.seed;
      BenchRandom random(command.seed, unit + "/" + c.name);
      const uint64_t cycles_before = totals.cycles;
      try {
        c.run(plan.plan, options, context, random, totals);
      } catch (const Divergence&) {
        throw;
      } catch (const ModelBuildError&) {
        throw;
      } catch (const RigError& error) {
        throw std::runtime_error(
            fmt::format("{}\n{}", error.what(), again_text(context, error.cycle)));
      } catch (const std::exception& error) {
        throw std::runtime_error(
            fmt::format("{}\n{}", error.what(), again_text(context, std::nullopt)));
      }
      totals.longest = std::max(totals.longest, totals.cycles - cycles_before);
      ++totals.runs;
      totals.restarts += options.restart_after > 0;
    }
  }
}

// Of this process, from the kernel.
uint64_t resident_kib() {
  std::ifstream status("/proc/self/statm");
  uint64_t size = 0, pages = 0;
  status >> size >> pages;
  return pages * static_cast<uint64_t>(sysconf(_SC_PAGESIZE)) / 1024;
}

// Says how a long run goes on, each tenth of it, and that its memory stays: after the first tenth
// it may grow by an eighth and 16 MiB.
class Soak {
 public:
  explicit Soak(uint64_t packets) : tenth_(std::max<uint64_t>(1, packets / 10)) {}
  void after(const BenchTotals& totals) {
    if (totals.compared < next_ * tenth_) return;
    next_ = totals.compared / tenth_ + 1;
    const uint64_t kib = resident_kib();
    if (first_ == 0) first_ = kib;
    fmt::print("  {} packets, {} cycles, 0 differences, {} MiB resident\n", totals.compared,
               totals.cycles, kib / 1024);
    std::fflush(stdout);
    if (kib > first_ + first_ / 8 + 16 * 1024)
      throw std::runtime_error(fmt::format(
          "{} KiB resident, expected about the {} KiB of the first tenth", kib, first_));
  }

 private:
  uint64_t tenth_, next_ = 1, first_ = 0;
};

// The cycles of the longest run.
uint64_t run_plan(const std::string& program, const Bench& bench, const BenchPlan& plan,
                  const BenchCommand& command) {
  const std::string& unit = bench.module;
  const auto started = std::chrono::steady_clock::now();
  BenchTotals totals;
  BenchCommand round = command;
  Soak soak(command.packets);
  do {
    const uint64_t before = totals.compared;
    run_cases(program, bench, plan, round, totals);
    ++round.seed;
    if (command.soak) soak.after(totals);
    if (totals.compared == before) break;
  } while (totals.compared < command.packets);
  if (totals.compared == 0)
    throw std::runtime_error(fmt::format("{}, plan {}: no packet was checked", unit, plan.name));
  fmt::print(
      "{} plan {}: golden == {}: {} packets in {} runs, {} with a reset in the middle, 0 "
      "differences, {} cycles, {:.1f} s\n",
      unit, plan.name, command.backend, totals.compared, totals.runs, totals.restarts,
      totals.cycles,
      std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count());
  std::fflush(stdout);
  return totals.longest;
}

}  // namespace

bool runs_freely(const RunOptions& options) {
  const auto free = [](const StallPolicy& policy) {
    return policy.kind == StallPolicy::Kind::kNone;
  };
  return options.kind != ModelKind::kHls && free(options.stall_in) && free(options.stall_out) &&
         options.restart_after == 0;
}

void check_promised(const std::string& unit, const Counters& promised, const Counters& hardware) {
  for (const auto& [name, due] : promised) {
    const auto counted = hardware.find(name);
    if (counted == hardware.end())
      throw std::runtime_error(fmt::format("unit {}: has no counter {}", unit, name));
    if (counted->second != due)
      throw std::runtime_error(
          fmt::format("unit {}: counts {} {} without stalls, docs/{}.md says {}", unit,
                      counted->second, name, unit, due));
  }
}

int bench_main(int argc, char** argv, const Bench& bench) {
  const std::string& unit = bench.module;
  CLI::App app{"The hardware of " + unit + " beside golden, packet by packet."};
  BenchCommand command;
  command.rig = RigFlags(bench.watchdog);
  app.add_option("--plan", command.plan,
                 "A plan of --list, random:N, or random:N-M for a range, or ends:N of plans at the "
                 "ends of ranges. Default: all of --list.");
  app.add_option("--case", command.only_cases,
                 "Cases of --list, with commas between. Default: all.")
      ->delimiter(',');
  app.add_option(
         "--backend", command.backend,
         "What runs: " + model_kinds_text() + " (docs/netlist.md, docs/hls.md); default rtl.")
      ->check(CLI::IsMember(model_kind_names()));
  auto* policy =
      app.add_option("--policy", command.policy, "Only this entry of the list of policies.")
          ->check(CLI::Range(0, static_cast<int>(std::size(kPolicies)) - 1));
  app.add_flag("--one-policy", command.one_policy,
               "Each case with one policy, drawn from seed, plan and case.")
      ->excludes(policy);
  app.add_option("--packets", command.packets,
                 "Check at least so many packets per plan: repeats everything with the next seed.");
  app.add_flag("--soak", command.soak,
               "Tell of each tenth of --packets; memory that grows after the first is an error.");
  app.add_flag("--list", command.list, "List plans, cases and policies.");
  command.rig.add_to(app, "--seed");
  check_values(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  for (const char* flag : {"--stall", "--stall-in", "--stall-out", "--stall-memory", "--latency"})
    command.own_policy |= app.count(flag) > 0;
  for (const char* flag : {"--banks", "--bank-cycles", "--watchdog", "--work"})
    if (app.count(flag) > 0)
      command.given += fmt::format(
          " {} {}", flag, model_tools::shell_word(app.get_option(flag)->as<std::string>()));
  if (command.list) {
    for (const BenchPlan& p : bench.plans) fmt::print("plan {}\n", p.name);
    for (const BenchCase& c : bench.cases) fmt::print("case {}\n", c.name);
    for (size_t p = 0; p < std::size(kPolicies); ++p)
      fmt::print("policy {}: in {}, out {}, memory {}, latency {}\n", p, kPolicies[p].in,
                 kPolicies[p].out, kPolicies[p].memory, kPolicies[p].latency);
    return 0;
  }
  try {
    command.seed = command.rig.options(unit).seed;
    command.rig.check_netlist(command.backend == "netlist");
    if (waveform_extension(*model_kind(command.backend)).empty())
      command.rig.check_waveform({});
    else
      command.rig.check_waveform({unit});
    for (const std::string& name : command.only_cases)
      if (std::none_of(bench.cases.begin(), bench.cases.end(),
                       [&](const BenchCase& c) { return c.name == name; }))
        throw std::runtime_error(fmt::format("--case {}: not a case of --list", name));
    std::vector<BenchPlan> plans;
    const std::string family = command.plan.substr(0, command.plan.find(':'));
    if (family != command.plan && (family == "random" || family == "ends")) {
      const std::string range = command.plan.substr(family.size() + 1);
      const size_t dash = range.find('-');
      const auto from = strict_number<uint64_t>(range.substr(0, dash)),
                 to = dash == std::string::npos ? from
                                                : strict_number<uint64_t>(range.substr(dash + 1));
      if (!from || !to || *from > *to)
        throw std::runtime_error(
            fmt::format("--plan {}: expected {}:N or {}:N-M", command.plan, family, family));
      const RandomPlans which = family == "ends" ? RandomPlans::kEnds : RandomPlans::kUsual;
      for (uint64_t i = *from; i <= *to; ++i)
        plans.push_back({fmt::format("{}:{}", family, i), random_plan(i, which, bench.on_board)});
    } else {
      for (const BenchPlan& p : bench.plans)
        if (command.plan.empty() || p.name == command.plan) plans.push_back(p);
    }
    if (plans.empty())
      throw std::runtime_error(fmt::format("--plan {}: not a plan of --list", command.plan));
    uint64_t longest = 0;
    for (const BenchPlan& p : plans)
      longest = std::max(longest, run_plan(argv[0], bench, p, command));
    command.rig.check_cycles_came(unit, longest);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}

}  // namespace photonloom
