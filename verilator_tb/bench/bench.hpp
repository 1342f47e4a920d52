// SPDX-License-Identifier: Apache-2.0
// The thin benches' common part. A bench names plans and cases of its unit; here every case runs
// under several stall policies, memory latencies and initial register values, golden beside RTL (or
// its netlist, or its CXXRTL model).
//
// A bench program: --list; --plan NAME (a name of the bench, random:N or ends:N), --case NAME,
// --seed S, --policy N, --one-policy (one drawn for each case), --packets N, --soak, --backend
// NAME, and the rig's flags, which replace the list of policies when --stall* or --latency is
// given. Exit status 0 when packets were checked and all were equal.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "golden/unit/backend.hpp"
#include "verilator_tb/rig/stall.hpp"
#include "verilator_tb/unit/backends.hpp"
#include "verilator_tb/unit/compare_units.hpp"

namespace photonloom {

using BenchRandom = RoleRandom;

struct BenchPlan {
  std::string name;
  Plan plan;
};

// What was checked so far.
struct BenchTotals {
  uint64_t runs = 0, restarts = 0, compared = 0, cycles = 0;
  uint64_t longest = 0;  // cycles of a run
};

// A case makes its stimulus, runs it beside golden and adds to the totals; a difference throws.
struct BenchCase {
  std::string name;
  std::function<void(const Plan&, const RunOptions&, const CompareContext&, BenchRandom&,
                     BenchTotals&)>
      run;
};

struct Bench {
  std::string module;  // of RTL that runs
  std::vector<BenchPlan> plans;
  std::vector<BenchCase> cases;
  bool on_board = false;  // it is a part of a board, for which random plans are drawn
  // Cycles without a handshake after which it counts as stuck, unless --watchdog says otherwise.
  uint64_t watchdog = RunOptions{}.watchdog;
};
int bench_main(int argc, char** argv, const Bench& bench);

// Whether nothing holds the hardware's streams back and no reset comes. A kernel has no cycles.
bool runs_freely(const RunOptions& options);

// Each of these the hardware has, and counted exactly so.
void check_promised(const std::string& unit, const Counters& promised, const Counters& hardware);

// Feeds `in` in pieces of random length: how calls cut the stream must not matter.
template <class In, class F>
void feed(const std::vector<In>& in, BenchRandom& random, F&& process) {
  for (size_t at = 0; at < in.size();) {
    const size_t n = std::min<size_t>(in.size() - at, 1 + random.below(4096));
    process(std::span<const In>(in).subspan(at, n));
    at += n;
  }
}

// A case of a unit of one stream in and one out.
template <class In>
struct StreamCase {
  std::string name;
  std::function<std::vector<In>(const Plan&, BenchRandom&)> make;
  // What the unit's page says that it counts for this input when nobody holds it back; optional.
  Counters (*unstalled)(const Plan&, const std::vector<In>&) = nullptr;
  // Throws where what golden and the hardware count then does not go together; optional.
  void (*together)(const Plan&, const Counters& golden, const Counters& hardware) = nullptr;
};

template <class Unit>
int stream_bench_main(int argc, char** argv, std::vector<BenchPlan> plans,
                      const std::vector<StreamCase<typename Unit::In>>& cases) {
  using In = typename Unit::In;
  Bench bench{unit_name<Unit>, std::move(plans), {}};
  for (const StreamCase<In>& c : cases)
    bench.cases.push_back(
        {c.name, [make = c.make, unstalled = c.unstalled, together = c.together](
                     const Plan& plan, const RunOptions& options, const CompareContext& context,
                     BenchRandom& random, BenchTotals& totals) {
           const std::vector<In> in = make(plan, random);
           const std::type_identity<Unit> unit;
           const auto golden = make_golden(unit, plan);
           const auto rtl = make_rtl(unit, plan, options);
           const auto both = compare_units(plan, context, *golden, *rtl);
           std::vector<typename Unit::FirstOut> out;
           feed(in, random, [&](std::span<const In> piece) { both->process(piece, out); });
           rtl->finish();
           check_counters(context.unit, golden->counters(), rtl->counters(), rtl->cycles());
           if (unstalled && runs_freely(options))
             check_promised(context.unit, unstalled(plan, in), rtl->counters());
           if (together && runs_freely(options))
             together(plan, golden->counters(), rtl->counters());
           totals.compared += both->compared();
           totals.cycles += rtl->cycles();
         }});
  return bench_main(argc, argv, bench);
}

enum class RandomPlans {
  kUsual,
  kEnds,  // lists, lines, formats, contexts or maps at the ends of their ranges
};

// A random plan that check_plan() would pass, small enough to simulate: for `make test-full`.
// on_board: one that board_problem() has nothing against either.
Plan random_plan(uint64_t seed, RandomPlans which = RandomPlans::kUsual, bool on_board = false);

}  // namespace photonloom
