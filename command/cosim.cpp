// SPDX-License-Identifier: Apache-2.0
// photonloom cosim SCENE --backend unit=rtl,...
#include <fmt/core.h>

#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "command/backend_option.hpp"
#include "command/command_line.hpp"
#include "command/console.hpp"
#include "command/frame_options.hpp"
#include "command/json_text.hpp"
#include "command/tell.hpp"
#include "golden/image/sheet.hpp"
#include "golden/numeric/output_file.hpp"
#include "golden/pipeline/watch.hpp"
#include "verilator_tb/rig/rig_options.hpp"
#include "verilator_tb/rig/timeline.hpp"
#include "verilator_tb/unit/compare_units.hpp"

namespace photonloom {
namespace {

using Json = nlohmann::ordered_json;

// "a=rtl,b=rtl", all units.
std::string all_as_rtl() {
  std::string text;
  for (const std::string& name : unit_names())
    text += (text.empty() ? "" : ",") + name + "=" + model_kind_name(ModelKind::kRtl);
  return text;
}

struct CosimOptions {
  FrameOptions frame;
  ThreadsOption threads;
  RigFlags rig;
  std::string backends = all_as_rtl(), output;
  uint64_t timeline = 5000, packets = 1000;
  bool keep_going = false, json = false;
  BoardFlags board;
};

// The units that do not run as golden, each with its backend.
using Hardware = std::map<std::string, Backend>;

// From "a=rtl,b=golden,c=board:DEVICE".
Hardware hardware_units(const std::string& text) {
  const std::vector<std::string> units = unit_names();
  std::set<std::string> named;
  Hardware hardware;
  for (size_t at = 0; at <= text.size();) {
    const size_t end = std::min(text.find(',', at), text.size());
    const std::string item = text.substr(at, end - at);
    const size_t equals = item.find('=');
    const std::string unit = item.substr(0, equals);
    const std::optional<Backend> backend =
        parse_backend(equals == std::string::npos ? "" : item.substr(equals + 1));
    if (std::find(units.begin(), units.end(), unit) == units.end() || !backend ||
        !backend->kind.in_frames)
      throw UsageError(
          fmt::format("--backend: '{}', expected UNIT=BACKEND with UNIT {} and BACKEND {}", item,
                      unit_names_text(), backend_kinds_text(true)));
    if (!named.insert(unit).second)
      throw UsageError(fmt::format("--backend: {} stands twice", unit));
    if (!backend->kind.serves(find_unit(unit))) {
      std::string served;
      for (const UnitInfo& u : all_units())
        if (backend->kind.serves(u))
          served += (served.empty() ? "" : " and ") + std::string(u.name);
      throw UsageError(fmt::format("--backend: '{}', a {} has {} only behind its link", item,
                                   backend->kind.name, served));
    }
    if (backend->kind.source != BackendSource::kGolden) hardware[unit] = *backend;
    at = end + 1;
  }
  if (hardware.empty())
    throw UsageError(fmt::format(
        "--backend: names no unit as other than golden, there is nothing to compare; expected {}",
        backend_kinds_text(true)));
  return hardware;
}

// What the hardware is called: its backend where all units have the same.
std::string hardware_name(const Hardware& hardware) {
  for (const auto& [unit, backend] : hardware)
    if (backend.kind.name != hardware.begin()->second.kind.name) return "hardware";
  return hardware.begin()->second.kind.name;
}

// What a unit did, for the table and the summary.
struct UnitReport {
  std::string unit, first_difference;
  uint64_t compared = 0, differences = 0, packets_in = 0;
  Counters counters;

  uint64_t count(const std::string& name) const {
    const auto at = counters.find(name);
    return at == counters.end() ? 0 : at->second;
  }
  uint64_t bypassed() const { return packets_in - count("packets in"); }
  double busy() const {
    const uint64_t cycles = count("cycles");
    const uint64_t busy = counters.count("busy") ? count("busy") : count("cycles busy");
    return cycles ? 100.0 * static_cast<double>(busy) / static_cast<double>(cycles) : 0;
  }
};

// Puts a unit as hardware beside golden into the frame; the report, to be asked for once the frame
// is rendered, keeps both alive.
template <class Unit>
std::function<UnitReport()> compare_in_frame(std::unique_ptr<Unit>& in_frame, const Plan& plan,
                                             const CompareContext& context,
                                             std::unique_ptr<Unit> hardware_unit) {
  const std::shared_ptr<Unit> golden = std::move(in_frame), hardware = std::move(hardware_unit);
  auto comparing = compare_units(plan, context, *golden, *hardware);
  std::function<UnitReport()> report =
      [unit = context.unit, both = comparing.get(), golden, hardware,
       clocked = dynamic_cast<Clocked*>(hardware.get())]() -> UnitReport {
    if (clocked) clocked->finish();
    const UnitReport made{unit,
                          both->first_report(),
                          both->compared(),
                          both->differences(),
                          both->packets_in(),
                          both->counters()};
    // A board has no clock, and counts what is sent again after a link's fault too.
    if (clocked && made.differences == 0 && made.bypassed() == 0)
      check_counters(unit, golden->counters(), hardware->counters(), clocked->cycles());
    return made;
  };
  in_frame = std::move(comparing);
  return report;
}

double ratio(uint64_t a, uint64_t b) {
  return b ? static_cast<double>(a) / static_cast<double>(b) : 0;
}

// What is worth a line of one kind of unit; others have none.
template <class Unit>
void print_own(std::type_identity<Unit>, const UnitReport&) {}

void print_own(std::type_identity<PhotonGatherer>, const UnitReport& u) {
  const bool board = u.counters.count("link bytes out");
  const uint64_t hits = u.count("cache hits"), all = hits + u.count("cache misses"),
                 asked = u.count("packets in") - u.count("packets resumed");
  // The cycles of a board are those of its link.
  std::string first, second = "a gather: ";
  if (!board) {
    first = fmt::format("cache hits {} of {} ({:.1f} %), ", hits, all, 100 * ratio(hits, all));
    second = fmt::format("{:.1f} cycles a gather: ", ratio(u.count("cycles"), asked));
  }
  fmt::print("  {}{} bytes read, {:.1f} a gather\n", first, u.count("bytes read"),
             ratio(u.count("bytes read"), asked));
  fmt::print("  {}{:.1f} nodes, {:.1f} leaves, {:.1f} insertions\n", second,
             ratio(u.count("nodes"), asked), ratio(u.count("leaves"), asked),
             ratio(u.count("insertions"), asked));
  if (!board) return;
  fmt::print("  link: {} bytes out, {} in, {} frames sent again, lost {} times\n",
             u.count("link bytes out"), u.count("link bytes in"), u.count("link frames again"),
             u.count("link lost"));
  fmt::print("  {} packets were answered before; the other {} in {:.1f} s, {:.0f} a second\n",
             u.count("packets resumed"), asked,
             static_cast<double>(u.count("link milliseconds")) / 1000,
             1000 * ratio(asked, u.count("link milliseconds")));
}

double mean_displacement(const UnitReport& u) {
  return ratio(u.count("displacement"), u.count("packets matched"));
}

void print_own(std::type_identity<ReorderBuffer>, const UnitReport& u) {
  fmt::print("  mean displacement {:.1f} packets\n", mean_displacement(u));
}

void print_units(const std::vector<UnitReport>& units) {
  fmt::print("{:<16}{:>10}{:>8}{:>10}{:>12}{:>8}{:>11}{:>11}\n", "unit", "packets", "differ",
             "bypassed", "cycles", "busy %", "stalls in", "stalls out");
  for (const UnitReport& u : units) {
    fmt::print("{:<16}{:>10}{:>8}{:>10}{:>12}{:>8.1f}{:>11}{:>11}\n", u.unit, u.compared,
               u.differences, u.bypassed(), u.count("cycles"), u.busy(), u.count("stalls in"),
               u.count("stalls out"));
    with_unit(u.unit, [&](auto unit) { print_own(unit, u); });
  }
}

// Results that were there before, which a run that fails leaves as they are: told then.
class EarlierResults {
 public:
  explicit EarlierResults(const std::string& folder)
      : folder_(std::filesystem::exists(folder + "/summary.json") ? folder : "") {}
  ~EarlierResults() {
    if (!folder_.empty() && std::uncaught_exceptions() > 0)
      tell("photonloom: {}: holds the results of an earlier run, not of this one\n", folder_);
  }
  EarlierResults(const EarlierResults&) = delete;
  EarlierResults& operator=(const EarlierResults&) = delete;
  void replaced() { folder_.clear(); }

 private:
  std::string folder_;
};

void cosim(const CosimOptions& o) {
  FrameRequest request = o.frame.request();
  Hardware hardware = hardware_units(o.backends);
  const std::string name = hardware_name(hardware);
  for (const std::string& unit : unit_names()) o.rig.options(unit);  // bad values before long work
  std::set<std::string> units_with_waves;
  std::set<ModelKind> models;
  size_t netlists = 0, boards = 0;
  for (const auto& [unit, backend] : hardware) {
    if (backend.kind.model) models.insert(*backend.kind.model);
    boards += !backend.device.empty();
    if (!waveform_of(backend).empty()) units_with_waves.insert(unit);
    netlists += backend.kind.model == ModelKind::kNetlist;
  }
  o.rig.refuse_unread(models);
  if (boards == 0) o.board.refuse_alone();
  o.rig.check_netlist(netlists);
  o.rig.check_waveform(units_with_waves);
  const std::string stem = std::filesystem::path(request.scene_file).stem().string();
  const std::string output = o.output.empty() ? o.rig.results_dir() + "/" + stem : o.output;
  if (!o.rig.waveform().empty() && stands_in(o.rig.waveform(), output))
    throw UsageError(
        fmt::format("--wave: {} is in the folder of the results, which is replaced as a whole; "
                    "expected another folder",
                    o.rig.waveform()));
  request.outputs = {o.rig.waveform()};
  std::vector<std::string> inputs = frame_inputs(request);
  inputs.push_back(o.rig.netlist());
  check_outputs(request.outputs, inputs);
  o.threads.apply();
  OutputFolder folder(output, {"summary.json",
                               "\"plan_hash\"",
                               {"*.exr", "*.png", "*.html", "*.fst", "*.vcd", "packets.json",
                                "plan.toml", "timeline.json"}});

  ConsoleProgress progress;
  PreparedFrame frame = prepare_frame(request, Arithmetic::kReference, &progress);
  print_warnings(frame.warnings);
  if (o.backends == all_as_rtl())
    std::erase_if(hardware, [&](const auto& unit) {
      return !find_unit(unit.first).lacks(frame.plan).empty();
    });
  for (const auto& [unit, backend] : hardware)
    if (const std::string lacks = find_unit(unit).lacks(frame.plan); !lacks.empty())
      throw std::runtime_error(
          fmt::format("--backend: {}: gets no packet, the plan has no {}", unit, lacks));
  if (!o.rig.wave_unit().empty())
    if (const std::string lacks = find_unit(o.rig.wave_unit()).lacks(frame.plan); !lacks.empty())
      throw std::runtime_error(fmt::format("--wave-unit {}: gets no packet, the plan has no {}",
                                           o.rig.wave_unit(), lacks));
  if (hardware.empty())
    throw std::runtime_error("the plan of this scene has no unit that could be hardware");
  for (const auto& [unit, backend] : hardware)  // a wrong board is refused before long work
    if (!backend.device.empty()) o.board.check(frame.plan, backend.device);
  PacketWatch watch(frame.plan, o.packets);
  FrameUnits golden_units = watch.wrap(make_golden_units(frame.plan)),
             reference_units = make_golden_units(frame.plan);
  GatherWatch golden_gathers(frame.plan), hardware_gathers(frame.plan);
  golden_units.photon_gatherer = golden_gathers.wrap(std::move(golden_units.photon_gatherer));
  FrameCounts reference_counts, golden_counts, counts;
  Image reference_image = render_frame(frame.input(Arithmetic::kReference), reference_units,
                                       reference_counts, &progress);
  Image golden_image =
      render_frame(frame.input(Arithmetic::kGolden), golden_units, golden_counts, &progress);

  Timeline timeline(o.timeline);
  CompareContext context;
  context.plan = plan_hash_text(frame.plan);
  context.rerun = command_line(RigFlags::waveform_options());
  context.keep_going = o.keep_going;
  context.timeline = &timeline;
  FrameUnits units = make_golden_units(frame.plan);
  std::vector<std::function<UnitReport()>> reports_of_units;
  Image hardware_image;
  std::vector<UnitReport> reports;
  std::map<std::string, std::string> tools;  // versions of what made the models
  EarlierResults earlier(output);
  try {
    {
      const ProgressPhase phase(&progress, "models", hardware.size(), "units");
      for_each_unit([&](auto unit) {
        context.unit = unit_name<typename decltype(unit)::type>;
        const auto chosen = hardware.find(context.unit);
        if (chosen == hardware.end()) return;
        const Backend& backend = chosen->second;
        RunOptions run = o.rig.options(context.unit);
        run.timeline = o.timeline > 0;
        context.backend = backend.kind.name;
        context.waveform = waveform_of(backend);
        if (backend.kind.model) tools.merge(tool_versions(*backend.kind.model, run.yosys));
        context.seed = run.seed;
        context.writes(run);
        reports_of_units.push_back(
            compare_in_frame(units.of(unit), frame.plan, context,
                             make_backend(unit, backend, frame.plan, run, o.board)));
        phase.advance(1);
      });
    }
    units.photon_gatherer = hardware_gathers.wrap(std::move(units.photon_gatherer));
    hardware_image = render_frame(frame.input(Arithmetic::kGolden), units, counts, &progress);
    for (const auto& report : reports_of_units) reports.push_back(report());
  } catch (const RigError& error) {
    context.unit = error.unit;
    context.waveform = waveform_of(hardware.at(error.unit));
    context.writes(o.rig.options(error.unit));
    throw std::runtime_error(fmt::format("{}\n{}", error.what(), again_text(context, error.cycle)));
  }

  describe_frame(reference_image, frame, request, "reference");
  describe_frame(golden_image, frame, request, "golden");
  describe_frame(hardware_image, frame, request, "golden");
  const GatherDiagnosis diagnosis = diagnose_into(golden_image, golden_gathers, frame, request);
  diagnose_into(hardware_image, hardware_gathers, frame, request);
  print_warnings(diagnosis_messages(diagnosis, request));
  print_warnings(count_messages(counts));
  const std::string golden_file = folder.temporary() + "/golden.exr",
                    hardware_file = folder.temporary() + "/" + name + ".exr";
  write_exr(reference_image, folder.temporary() + "/reference.exr");
  write_exr(golden_image, golden_file);
  write_exr(hardware_image, hardware_file);
  const auto exposure = exposure_for(golden_image, golden_file);
  write_png(golden_image, folder.temporary() + "/golden.png", exposure);
  write_png(hardware_image, folder.temporary() + "/" + name + ".png", exposure);
  const bool same = read_file(golden_file) == read_file(hardware_file);
  write_file(folder.temporary() + "/timeline.json", timeline.json());
  write_file(folder.temporary() + "/packets.json", watch.json());
  write_plan(frame.plan, folder.temporary() + "/plan.toml", frame.reasons);

  uint64_t compared = 0, differences = 0, bypassed = 0;
  std::string idle;
  Json summary;
  summary["scene"] = request.scene_file;
  summary["command"] = command_line();
  summary["plan_hash"] = context.plan;
  summary["program"] = PHOTONLOOM_VERSION;
  summary["tools"] = tools;
  summary["hardware"] = name;  // NAME.exr
  summary["camera_samples"] = counts.camera_samples;
  summary["caustic_queries"] = counts.caustic_queries;
  summary["table_gathers"] = counts.table_gathers;
  summary["directions"] = counts.directions;
  summary["final_gathers"] = counts.final_gathers;
  summary["counts"] = counts_json(counts);
  summary["golden_counts"] = counts_json(golden_counts);
  summary.update(packed_json(frame));
  summary["diagnosis"] = diagnosis_json(diagnosis);
  for (const UnitReport& u : reports) {
    compared += u.compared;
    differences += u.differences;
    bypassed += u.bypassed();
    if (u.compared == 0 && idle.empty()) idle = u.unit;
    Json entry = {{"backend", hardware.at(u.unit).kind.name},
                  {"packets", u.compared},
                  {"differences", u.differences},
                  {"bypassed", u.bypassed()},
                  {"busy_percent", u.busy()},
                  {"counters", u.counters}};
    if (!u.first_difference.empty()) entry["first_difference"] = u.first_difference;
    if (u.counters.count("displacement")) entry["mean_displacement"] = mean_displacement(u);
    summary["units"][u.unit] = entry;
  }
  summary["packets"] = compared;
  summary["differences"] = differences;
  summary["images_identical"] = same;
  summary["output"] = output;
  summary["phases"] = Json::array();
  for (const PhaseTime& t : progress.times())
    summary["phases"].push_back({{"phase", t.phase}, {"wall", t.wall}, {"cpu", t.cpu}});
  write_file(folder.temporary() + "/summary.json", json_text(summary) + "\n");
  folder.commit();
  earlier.replaced();

  if (o.json) {
    fmt::print("{}\n", json_text(summary));
  } else {
    fmt::print("{}", progress.table());
    fmt::print("{} caustic queries, {} table gathers, {} directions, {} final gathers\n",
               counts.caustic_queries, counts.table_gathers, counts.directions,
               counts.final_gathers);
    print_units(reports);
    fmt::print("at the ends of ranges: {} of {}, {} of golden\n", range_counts_text(counts), name,
               range_counts_text(golden_counts));
    for (const UnitReport& u : reports)
      if (!u.first_difference.empty()) fmt::print("{}\n", u.first_difference);
    fmt::print("golden {} {}: {} packets, {} differences\n", differences ? "!=" : "==", name,
               compared, differences);
    fmt::print("image bytes of golden and {} are {}\n", name, same ? "identical" : "different");
    fmt::print(
        "wrote {}: reference.exr, golden.exr, {}.exr, timeline.json (Perfetto), packets.json,\n"
        "summary.json, plan.toml; photonloom report {} -o report.html shows them\n",
        output, name, output);
  }
  if (!idle.empty())
    throw CheckFailed(
        fmt::format("{} saw no packet: the plan of this scene gives it no work", idle));
  if (differences) throw CheckFailed(fmt::format("{} packets differ from golden", differences));
  if (bypassed) throw CheckFailed(fmt::format("{} packets bypassed the hardware", bypassed));
  if (counts_json(counts) != counts_json(golden_counts))
    throw CheckFailed(fmt::format("the counts of {} are not those of the golden frame: {} and {}",
                                  name, counts_json(counts).dump(),
                                  counts_json(golden_counts).dump()));
  if (!same) throw CheckFailed(fmt::format("the image of {} is not the golden image", name));
  for (const UnitReport& u : reports)
    if (units_with_waves.count(u.unit)) o.rig.check_cycles_came(u.unit, u.count("cycles"));
}

void add_cosim(CLI::App& app) {
  auto o = std::make_shared<CosimOptions>();
  CLI::App* c = app.add_subcommand("cosim", "A frame through the hardware, compared with golden");
  std::string kinds;
  for (const BackendKind& k : backend_kinds())
    if (k.in_frames) kinds += fmt::format("  {:<22}{}\n", k.name + k.argument, k.meaning);
  c->footer(fmt::format(
      "Renders the frame twice: with golden units, and with the named units as hardware:\n{1}"
      "(docs/netlist.md, docs/board.md; docs/units.md says which unit has which).\n"
      "Every packet of those is compared with golden's; the frame goes on with what they gave.\n"
      "Models are built once per plan and RTL source and kept in --work.\n"
      "Exit status 0 when all packets and the image's bytes are equal.\n\n"
      "Examples:\n"
      "  photonloom cosim scenes/cornell.xml --size 64x64 --spp 1 --gather-rays 16 --k 16 \\\n"
      "      --photons 50000\n"
      "  photonloom cosim scenes/cornell.xml --size 32x32 --backend {0}=netlist\n"
      "  photonloom cosim scenes/cornell.xml --size 32x32 --backend {2}=rtl \\\n"
      "      --stall adversary --rig-seed 7\n"
      "  photonloom cosim scenes/cornell.xml --plan plan.toml \\\n"
      "      --backend {0}=board:/dev/ttyUSB0",
      unit_name<PhotonGatherer>, kinds, unit_name<ReorderBuffer>));
  o->frame.add_to(*c);
  c->add_option(
       "--backend", o->backends,
       fmt::format("Units and what stands for them, UNIT=BACKEND with commas between: UNIT "
                   "{}, BACKEND {} (default: those that the plan has as rtl)",
                   unit_names_text(), backend_kinds_text(true)))
      ->type_name("UNIT=B,...");
  c->add_flag("--keep-going", o->keep_going,
              "Render to the end with the hardware's packets although they differ");
  o->board.add_to(*c);
  c->add_option(
       "-o,--output", o->output,
       "Folder for images, timeline and summary (default: SCENE in --work, else in build/cosim; "
       "of an installed program cosim/SCENE)")
      ->type_name("DIR");
  c->add_option("--timeline", o->timeline, "Packets of each unit in timeline.json (default 5000)")
      ->check(CLI::Range(uint64_t{0}, uint64_t{1} << 48))
      ->type_name("N");
  c->add_option("--packets", o->packets, "Packets of each stream in packets.json (default 1000)")
      ->check(CLI::Range(uint64_t{0}, uint64_t{1} << 48))
      ->type_name("N");
  c->add_flag("--json", o->json, "Print the summary as one JSON object");
  o->rig.add_to(*c, "--rig-seed");
  o->threads.add_to(*c);
  c->callback([o] { cosim(*o); });
}

const Command cosim_command(51, add_cosim);

}  // namespace
}  // namespace photonloom
