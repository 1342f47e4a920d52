// SPDX-License-Identifier: Apache-2.0
// photonloom plan SCENE -o plan.toml
#include <fmt/core.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "golden/command/console.hpp"
#include "golden/command/frame_options.hpp"
#include "golden/numeric/output_file.hpp"

namespace photonloom {
namespace {

struct PlanOptions {
  FrameOptions frame;
  ThreadsOption threads;
  std::string output;
  bool json = false;
};

// Memory that the plan asks for, by place; exact, from the widths of the plan.
std::vector<std::pair<std::string, uint64_t>> memory_bits(const Plan& plan) {
  const auto n = [](int x) { return static_cast<uint64_t>(x); };
  std::vector<std::pair<std::string, uint64_t>> rows;
  for (const bool is_caustic : {false, true}) {
    const MapPlan& m = plan.map(is_caustic);
    if (!m.present) continue;
    const std::string name = is_caustic ? "caustic map" : "global map";
    rows.emplace_back(name + ", leaf lines (external)", plan.lines(m) * n(plan.line_bytes()) * 8);
    rows.emplace_back(name + ", inner nodes", (plan.lines(m) - 1) * n(2 + plan.position_bits));
  }
  if (!rows.empty()) {
    rows.emplace_back("photon_gatherer, leaf cache", n(plan.cache_bytes) * 8);
    rows.emplace_back("photon_gatherer, candidate lists",
                      n(plan.contexts) * n(plan.k) * n(plan.r2_bits() + plan.index_bits()));
    rows.emplace_back(
        "photon_gatherer, powers and directions of candidates",
        n(plan.contexts) * n(plan.k) * n(plan.photon_bits() - 3 * plan.position_bits));
  }
  if (plan.global.present) {
    int query = 0;
    GatherQuery::fields(plan, [&](auto, const FieldInfo& f) { query += f.elements * f.bits; });
    if (plan.reorder_key != ReorderKey::kNone) {
      const int link = clog2(n(plan.reorder_packets));
      rows.emplace_back("reorder_buffer, pool", n(plan.reorder_packets) * n(query + link));
      rows.emplace_back("reorder_buffer, bins", n(plan.reorder_bins) * n(2 * link + 1));
    }
    rows.emplace_back("cdf_sampler, two tables",
                      2 * (uint64_t{1} << (2 * plan.cell_bits)) * n(plan.total_bits()));
  }
  return rows;
}

void plan(const PlanOptions& o) {
  const FrameRequest request = o.frame.request();
  o.threads.apply();
  ConsoleProgress progress;
  const PreparedFrame frame = prepare_frame(request, Arithmetic::kGolden, &progress, true);
  print_warnings(frame.warnings);
  if (o.output == "-") {
    fmt::print("{}", plan_text(frame.plan, frame.reasons));
    return;
  }
  write_plan(frame.plan, o.output, frame.reasons);
  const auto rows = memory_bits(frame.plan);
  if (o.json) {
    nlohmann::ordered_json j;
    j["plan"] = o.output;
    j["hash"] = plan_hash_text(frame.plan);
    for (const auto& [name, bits] : rows) j["memory_bits"][name] = bits;
    fmt::print("{}\n", j.dump(2));
    return;
  }
  fmt::print("wrote {} (hash {})\n", o.output, plan_hash_text(frame.plan));
  for (const auto& [name, bits] : rows)
    fmt::print("  {:<52} {:>12.1f} KiB\n", name, static_cast<double>(bits) / 8192);
}

void add_plan(CLI::App& app) {
  auto o = std::make_shared<PlanOptions>();
  CLI::App* c = app.add_subcommand("plan", "A hardware plan for a scene (plan.toml), with reasons");
  c->footer(
      "Traces the photons, for their number and powers are lines of the plan, and derives\n"
      "everything else from them, the scene and the options. The file may be edited; render,\n"
      "generate and cosim take it with --plan and refuse what cannot be built. docs/plan.md\n"
      "explains every line.\n\n"
      "Examples:\n"
      "  photonloom plan scenes/cornell.xml -o plan.toml --photons 50000 --k 16\n"
      "  photonloom plan scenes/cornell.xml -o - --error 0.001");
  o->frame.add_to(*c);
  c->add_option("-o,--output", o->output, "The file to write, - for standard output")
      ->required()
      ->type_name("FILE");
  c->add_flag("--json", o->json, "Print one JSON object: hash and memory");
  o->threads.add_to(*c);
  c->callback([o] { plan(*o); });
}

const Command registered(20, add_plan);

}  // namespace
}  // namespace photonloom
