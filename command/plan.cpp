// SPDX-License-Identifier: Apache-2.0
// photonloom plan SCENE -o plan.toml
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "command/console.hpp"
#include "command/frame_options.hpp"
#include "command/json_text.hpp"
#include "command/plan_for_board.hpp"
#include "command/plan_for_error.hpp"
#include "golden/numeric/output_file.hpp"
#include "golden/planner/resources.hpp"
#include "rtl/generate/board_file.hpp"
#include "rtl/generate/hardware.hpp"
#include "study/board_room.hpp"
#include "study/engine_search.hpp"

namespace photonloom {
namespace {

struct PlanOptions {
  FrameOptions frame;
  PlanForError for_error;
  ThreadsOption threads;
  std::string output;
  bool json = false;
};

// Memory that the plan asks for, in bits: the maps' lines, which a board keeps, and
// unit_memory_bits.
std::vector<std::pair<std::string, uint64_t>> memory_bits(const Plan& plan) {
  const auto n = [](int x) { return static_cast<uint64_t>(x); };
  std::vector<std::pair<std::string, uint64_t>> rows;
  for (const bool is_caustic : {false, true}) {
    const MapPlan& m = plan.map(is_caustic);
    if (!m.present) continue;
    rows.emplace_back(
        fmt::format("{} map, leaf lines (external)", is_caustic ? "caustic" : "global"),
        plan.memory_lines(m) * n(plan.line_bytes()) * 8);
  }
  for_each_unit([&](auto unit) {
    const UnitInfo& info = unit_info<typename decltype(unit)::type>;
    for (const auto& [what, bits] : unit_memory_bits(plan, info.name))
      rows.emplace_back(fmt::format("{}, {}", info.name, what), bits);
  });
  return rows;
}

// What the plan asks for: units, memory and an estimate of a part's resources.
void describe(const Plan& plan, const std::string& file, const PlanOptions& o,
              const nlohmann::ordered_json& further = {}) {
  const auto rows = memory_bits(plan);
  const bool gathers = plan.global.present || plan.caustic.present;
  if (o.json) {
    nlohmann::ordered_json j;
    j["plan"] = file;
    j["hash"] = plan_hash_text(plan);
    j["units"] = units_present(plan);
    for (const auto& [name, bits] : rows) j["memory_bits"][name] = bits;
    for (const std::string& unit : units_present(plan)) {
      if (!is_predicted(unit)) continue;
      const UnitResources r = estimate_resources(plan, unit);
      j["resources"][unit] = {{"lut", std::lround(r.lut)},
                              {"ff", std::lround(r.ff)},
                              {"dsp", std::lround(r.dsp)},
                              {"ebr", std::lround(r.ebr)}};
      for (const char* resource : {"lut", "ff", "dsp", "ebr"})
        for (const auto& [term, value] : resource_terms(plan, unit, resource))
          j["resource_terms"][unit][resource][term] = value;
    }
    if (gathers) {
      const BoardMemories b = board_memories(plan);
      j["board_ebr"] = {
          {"photons", b.photons}, {"replayer", b.replayer},         {"link", b.link},
          {"units", b.units},     {"shared_nodes", b.shared_nodes}, {"total", b.total()}};
      Plan other = plan;
      for (other.gatherers = 1;; ++other.gatherers) {
        const auto problem = find_problem(other);
        if (problem && problem->line == "board.gatherers") break;
        j["board_ebr_of_gatherers"].push_back(board_memories(other).total());
      }
    }
    if (!further.is_null()) j.update(further);
    fmt::print("{}\n", json_text(j));
    return;
  }
  fmt::print("  memory, words times bits; of units in block RAM or LUTs\n");
  for (const auto& [name, bits] : rows)
    fmt::print("  {:<52} {:>12.1f} KiB\n", name, static_cast<double>(bits) / 8192);
  fmt::print("  {:<40} {:>10} {:>8} {:>5} {:>7}\n", "predicted on an LFE5U", "LUT-eq", "FF", "DSP",
             "EBR");
  for (const std::string& unit : units_present(plan)) {
    if (!is_predicted(unit)) continue;
    const UnitResources r = estimate_resources(plan, unit);
    fmt::print("  {:<40} {:>10.0f} {:>8.0f} {:>5.0f} {:>7.0f}\n", unit, r.lut, r.ff, r.dsp, r.ebr);
  }
  if (!gathers) return;
  const BoardMemories b = board_memories(plan);
  const auto of_board = [](const std::string& what, int blocks) {
    fmt::print("  {:<40} {:>33}\n", what, blocks);
  };
  of_board(plan.photon_memory == PhotonMemory::kSdram ? "a board's cache before its SDRAM"
                                                      : "a board's photon memory",
           b.photons);
  of_board("its replayer and link", b.replayer + b.link);
  if (plan.shared_nodes) of_board("node memories shared, not one each", b.shared_nodes);
  of_board(
      fmt::format("its whole top, {} gatherer{}", plan.gatherers, plan.gatherers == 1 ? "" : "s"),
      b.total());
  for (const std::string& name : board_names()) {
    BoardDescription board;
    try {
      board = read_board(name);
    } catch (const std::runtime_error& error) {  // a board that was not asked for
      print_warnings({error.what()});
      continue;
    }
    if (!board.has_core()) continue;
    for (const BoardShortage& s : board_shortages(plan, board))
      fmt::print("  {} {}, more than the {} of board {}\n", s.needed, s.resource, s.has, name);
  }
}

// A plan that is there already, with lines changed.
void edit(const FrameRequest& request, const PlanOptions& o) {
  o.frame.refuse_derivation(request.scene_file);
  const std::string text = read_file(request.scene_file);
  const Plan before = parse_plan(text, request.scene_file);
  Plan plan = before;
  for (const std::string& line : request.set) set_plan_line(plan, line);
  derive_plan(plan);
  check_plan(plan, request.scene_file, request.set);
  PlanReasons reasons = kept_reasons(text, before, plan);
  for (const std::string& line : request.set)
    reasons[line.substr(0, line.find('='))] = "set by hand";
  if (o.output == "-") {
    fmt::print("{}", plan_text(plan, reasons));
    return;
  }
  if (!o.output.empty()) write_plan(plan, o.output, reasons);
  const std::string& file = o.output.empty() ? request.scene_file : o.output;
  if (!o.json)
    fmt::print("{}{} (hash {})\n", o.output.empty() ? "" : "wrote ", file, plan_hash_text(plan));
  describe(plan, file, o);
}

// The plan with the fastest gather engine that a board has room for.
void plan_a_board(const FrameRequest& request, const PlanOptions& o) {
  const std::string& board = o.for_error.board();
  const BoardPlan found = plan_for_board(request, board);
  const Plan& plan = found.engine.best.plan;
  if (o.output == "-") {
    fmt::print("{}", plan_text(plan, found.reasons));
    return;
  }
  write_plan(plan, o.output, found.reasons);
  const auto json_of = [](const EngineCycles& c) {
    return nlohmann::ordered_json{{"cycles", c.cycles},
                                  {"gatherers_cycles", c.gatherers},
                                  {"memory_cycles", c.memory},
                                  {"sdram_lines", c.memory_lines}};
  };
  nlohmann::ordered_json further;
  further["engine"] = json_of(found.engine.best.cycles);
  further["engine"]["board"] = board;
  further["engine"]["core_khz"] = found.core_khz;
  further["engine"]["fitting"] = found.engine.fitting;
  if (found.engine.given) further["engine"]["without"] = json_of(*found.engine.given);
  further["engine"]["without"]["misfit"] = found.engine.misfit;
  if (!o.json) fmt::print("wrote {} (hash {})\n", o.output, plan_hash_text(plan));
  describe(plan, o.output, o, further);
  if (!o.json) fmt::print("{}", engine_text(found, board));
}

void check_board(const std::string& board) {
  if (board.empty()) return;
  if (board_names().empty()) read_board(board);  // the folder is wrong, not the name
  as_usage("", [&] { predicted_board(board); });
}

void plan(const PlanOptions& o) {
  FrameRequest request =
      o.frame.request(o.for_error.wanted() ? SetLines::kOfStudy : SetLines::kOfPlan);
  if (o.output == "-") {
    if (o.json)
      throw UsageError("--json: with -o - standard output is the plan's; expected -o FILE");
  } else if (!o.output.empty()) {
    require_suffix("--output", o.output, ".toml");
    // A plan may take the place of the one that it is an edit of.
    std::vector<std::string> inputs = frame_inputs(request);
    if (is_plan(request.scene_file)) std::erase(inputs, request.scene_file);
    request.outputs = {o.output};
    check_outputs(request.outputs, inputs);
  }
  const std::string& board = o.for_error.board();
  check_board(board);
  o.threads.apply();
  if (o.for_error.wanted())
    return o.for_error.run(request, o.output, o.json, o.threads.threads(),
                           [&](const Plan& plan) { describe(plan, o.output, o); });
  o.for_error.refuse_alone();
  if (is_plan(request.scene_file)) {
    if (!board.empty())
      throw UsageError(
          "--board: counts the gathers of a scene; give the scene, and this plan as --plan");
    return edit(request, o);
  }
  if (!board.empty()) {
    if (!request.plan_file.empty()) request.plan = read_plan(request.plan_file);
    Plan asked = request.plan.value_or(Plan{});
    for (const std::string& line : request.set) set_plan_line(asked, line);
    refuse_decided(request.set, {"--board", engine_lines(read_board(board), asked.photon_lines)});
  }
  if (o.output.empty()) throw UsageError("a scene's plan needs -o FILE (- for standard output)");
  if (!board.empty()) return plan_a_board(request, o);
  ConsoleProgress progress;
  const PreparedFrame frame = prepare_frame(request, Arithmetic::kGolden, &progress, true);
  print_warnings(frame.warnings);
  if (!request.plan_file.empty() && !frame.plan.compressed() && o.frame.has_seed())
    print_warnings({"--seed changes nothing with --plan, whose lines of photons stay"});
  if (o.output == "-") {
    fmt::print("{}", plan_text(frame.plan, frame.reasons));
    return;
  }
  write_plan(frame.plan, o.output, frame.reasons);
  if (!o.json) fmt::print("wrote {} (hash {})\n", o.output, plan_hash_text(frame.plan));
  describe(frame.plan, o.output, o);
}

void add_plan(CLI::App& app) {
  auto o = std::make_shared<PlanOptions>();
  CLI::App* c = app.add_subcommand("plan", "A hardware plan for a scene (plan.toml), with reasons");
  c->footer(
      "Traces the photons, for their number and powers are lines of the plan, and derives\n"
      "everything else from them, the scene and the options. The file may be edited; render and\n"
      "cosim take it with --plan, generate in the place of the scene, and refuse what cannot be\n"
      "built. docs/plan.md explains every line.\n\n"
      "With --error E it measures a few plans on some pixels of the frame and writes the cheapest\n"
      "that keeps the visible error within E; docs/planner.md says what that promises.\n\n"
      "With --board alone it widens the gatherer and takes as many of them as the board has room "
      "for:\n"
      "the same packets, sooner.\n\n"
      "Of a plan.toml instead of a scene it tells the same, with --set lines changed, and writes "
      "the\n"
      "changed plan only with -o.\n\n"
      "Examples:\n"
      "  photonloom plan scenes/cornell.xml -o plan.toml --photons 50000 --k 16\n"
      "  photonloom plan scenes/cornell.xml -o - --format-error 0.001\n"
      "  photonloom plan scenes/cornell_balls.xml --error 0.005 --minimise luts -o plan.toml\n"
      "  photonloom plan scenes/cornell_balls.xml --explain gather.k\n"
      "  photonloom plan scenes/cornell.xml --photons 16384 --k 16 --board ulx3s-85f -o plan.toml\n"
      "  photonloom plan plan.toml --set gather.k=8");
  o->frame.add_to(*c);
  c->get_option("SCENE")->description("A Mitsuba XML scene, or a plan.toml to tell about");
  c->add_option("-o,--output", o->output, "The file to write, - for standard output")
      ->type_name("FILE");
  c->add_flag("--json", o->json, "Print one JSON object: hash, units, memory, predicted resources");
  o->for_error.add_to(*c);
  o->threads.add_to(*c);
  c->callback([o] { plan(*o); });
}

const Command plan_command(20, add_plan);

}  // namespace
}  // namespace photonloom
