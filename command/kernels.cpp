// SPDX-License-Identifier: Apache-2.0
// photonloom kernels PLAN: cycles and state of the units as HLS kernels, beside their RTL.
#include <fmt/core.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "command/command.hpp"
#include "command/json_text.hpp"
#include "golden/plan/plan_file.hpp"
#include "rtl/generate/data_files.hpp"
#include "verilator_tb/unit/drawn_run.hpp"

namespace photonloom {
namespace {

using Json = nlohmann::ordered_json;

struct KernelsOptions {
  std::string plan, work = default_work_dir();
  bool json = false;
};

template <class Unit>
Json describe(std::type_identity<Unit> unit, const Plan& plan, const std::string& work) {
  RunOptions options;
  options.work_dir = work;
  const DrawnRun rtl = run_drawn(unit, plan, options);
  options.kind = ModelKind::kHls;
  const DrawnRun hls = run_drawn(unit, plan, options);
  Json j;
  j["unit"] = unit_name<Unit>;
  j["packets"] = hls.packets;
  j["model_cycles"] = modelled_cycles(kernel_loops(unit, plan), hls.trips);
  j["hls_cycles"] = hls.cycles;
  j["rtl_cycles"] = rtl.cycles;
  if (hls.in_flight > 0) j["in_flight"] = hls.in_flight;
  j["hls_bits"] = hls.counters.at("bits of state");
  for (const TurnTerm& term : hls.trips.terms) j["turns"][term.what] = term.turns;
  j["loops"] = Json::array();
  for (const KernelLoop& loop : kernel_loops(unit, plan))
    j["loops"].push_back({{"process", loop.process}, {"interval", loop.interval()}});
  return j;
}

void kernels(const KernelsOptions& o) {
  const Plan plan = read_plan(o.plan);
  Json all = Json::array();
  for_each_unit([&](auto unit) {
    if (unit_info<typename decltype(unit)::type>.lacks(plan).empty())
      all.push_back(describe(unit, plan, o.work));
  });
  if (o.json) {
    fmt::print("{}\n", json_text(all));
    return;
  }
  fmt::print("{:<16}{:>9}{:>24}{:>10}{:>10}{:>15}\n", "unit", "packets", "cycles a packet: model",
             "kernel", "RTL", "bits of state");
  for (const Json& j : all) {
    const auto each = [&](const char* name) {
      return j[name].get<double>() / j["packets"].get<double>();
    };
    fmt::print("{:<16}{:>9}{:>24.2f}{:>10.2f}{:>10.2f}{:>15}\n", j["unit"].get<std::string>(),
               j["packets"].get<uint64_t>(), each("model_cycles"), each("hls_cycles"),
               each("rtl_cycles"), j["hls_bits"].get<uint64_t>());
  }
}

void add_kernels(CLI::App& app) {
  auto o = std::make_shared<KernelsOptions>();
  CLI::App* c = app.add_subcommand("kernels", "Cycles of the units as HLS kernels, beside the RTL");
  c->footer(
      "Runs packets drawn for the plan through the instrumented kernels and through the RTL in\n"
      "Verilator, whose line memory answers after 20 cycles, and compares them with golden. The\n"
      "model derives cycles from initiation intervals and trip counts (docs/hls.md).\n\n"
      "Example:\n"
      "  photonloom kernels plan.toml");
  c->add_option("PLAN", o->plan, "A plan.toml")->required()->type_name("FILE");
  c->add_option("--work", o->work, "Folder where models are kept")->type_name("DIR");
  c->add_flag("--json", o->json, "As JSON");
  c->callback([o] { kernels(*o); });
}

const Command kernels_command(63, add_kernels);

}  // namespace
}  // namespace photonloom
