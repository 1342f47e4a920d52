// SPDX-License-Identifier: Apache-2.0
// photonloom generate PLAN|SCENE -o DIR
#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>

#include "command/console.hpp"
#include "command/frame_options.hpp"
#include "golden/numeric/output_file.hpp"
#include "golden/planner/resources.hpp"
#include "golden/unit/photon_gatherer_image.hpp"
#include "hls_kernels/generate/kernel_package.hpp"
#include "rtl/generate/board.hpp"
#include "rtl/generate/board_file.hpp"
#include "rtl/generate/hardware.hpp"
#include "rtl/generate/sources.hpp"
#include "study/board_room.hpp"

namespace photonloom {
namespace {

struct GenerateOptions {
  FrameOptions frame;
  std::string output, unit, board, boards, rtl;
  double clock_mhz = 0;
  bool check = false, hls = false;
};

// The scene's photon maps as the hardware takes them, in hexadecimal: configuration words as
// "address data", line memory as a beat a line, for $readmemh or a loader.
std::map<std::string, std::string> images(const PreparedFrame& frame) {
  std::map<std::string, std::string> files;
  const PhotonGathererImage image = photon_gatherer_image(frame.plan, frame.global, frame.caustic);
  const auto beat_bytes = static_cast<size_t>(frame.plan.beat_bits / 8);
  std::string& cfg = files["images/cfg.hex"];
  for (const CfgWrite& w : image.cfg) cfg += fmt::format("{:06x} {:016x}\n", w.address, w.data);
  for (const bool is_caustic : {false, true}) {
    const std::vector<uint8_t>& bytes = image.lines[is_caustic ? 1 : 0];
    if (bytes.empty()) continue;
    std::string& lines = files[is_caustic ? "images/caustic_lines.hex" : "images/global_lines.hex"];
    for (size_t beat = 0; beat < bytes.size(); beat += beat_bytes) {
      for (size_t i = beat_bytes; i-- > 0;)
        lines += fmt::format("{:02x}", beat + i < bytes.size() ? bytes[beat + i] : 0);
      lines += '\n';
    }
  }
  return files;
}

// Warns where the board's whole top takes more of something than its part has.
void warn_of_room(const std::string& source, const Plan& plan, const BoardDescription& board) {
  // What of this plan takes some.
  std::vector<std::string> blocks;
  if (plan.gatherers > 1) blocks.push_back("fewer board.gatherers");
  std::vector<std::string> logic = blocks;
  blocks.push_back(plan.photon_memory == PhotonMemory::kSdram ? "a smaller board.cache_bytes"
                                                              : "fewer photons in block RAM");
  if (plan.reorder_key != ReorderKey::kNone) blocks.push_back("a smaller reorder.packets");
  if (plan.cache_bytes != 0) blocks.push_back("a smaller gatherer.cache_bytes");
  for (const auto& [line, width] : {std::pair{"nodes_per_cycle", plan.nodes_per_cycle},
                                    {"candidates_per_cycle", plan.candidates_per_cycle},
                                    {"powers_per_cycle", plan.powers_per_cycle},
                                    {"lanes", plan.lanes}})
    if (width > 1) logic.push_back(fmt::format("a smaller gatherer.{}", line));
  if (logic.empty()) logic.push_back("a smaller gather.k");
  std::vector<std::string> warnings;
  for (const BoardShortage& s : board_shortages(plan, board))
    warnings.push_back(
        fmt::format("{}: the top takes {} {}, {} has {}; expected {} (photonloom plan tells what "
                    "takes them)",
                    source, s.needed, s.resource, board.name, s.has,
                    fmt::join(s.resource == "block RAMs" ? blocks : logic, " or ")));
  print_warnings(warnings);
}

// Throws where the package in `dir` has kernels that are not what its plan and the sources give.
void check_kernels(const std::string& dir) {
  namespace fs = std::filesystem;
  if (!fs::is_directory(dir + "/hls")) return;
  const auto files = write_kernel_package(read_plan(dir + "/plan.toml"));
  for (const auto& [name, text] : files) {
    const std::string path = dir + "/hls/" + name;
    if (!fs::is_regular_file(path) || read_file(path) != text)
      throw std::runtime_error(
          path +
          ": is stale, differs from what its plan and the HLS sources give; generate it again");
  }
  for (const char* folder : {"/hls/data", "/hls/hls_kernels"})
    for (const auto& entry : fs::recursive_directory_iterator(dir + folder))
      if (entry.is_regular_file() &&
          !files.count(fs::relative(entry.path(), dir + "/hls").string()))
        throw std::runtime_error(entry.path().string() + ": does not belong to the package");
}

void generate(const GenerateOptions& o) {
  const FrameRequest asked = o.frame.request();
  const std::string& source = asked.scene_file;
  if (o.check) {
    if (!o.output.empty() || !o.unit.empty() || !o.board.empty() || o.clock_mhz != 0 || o.hls)
      throw UsageError(
          "--check looks at the package in a folder; -o, --unit, --board, --clock and --hls do not "
          "go with it");
    o.frame.refuse_all("--check looks at the package in a folder, whose plan is there");
    check_hardware(source, o.rtl.empty() ? default_rtl_dir() : o.rtl, o.boards);
    check_kernels(source);
    fmt::print("{}: is what its plan and the RTL sources give\n", source);
    return;
  }
  if (o.output.empty()) throw UsageError("generate needs -o DIR, or --check");
  if (o.clock_mhz != 0 && o.board.empty()) throw UsageError("--clock is a board's; give --board");
  if (!o.boards.empty() && o.board.empty())
    throw UsageError("--boards is where --board is looked for; give --board");
  if (!o.unit.empty()) as_usage("--unit: ", [&] { find_unit(o.unit); });
  const std::vector<std::string> boards = board_names(o.boards);
  if (!o.board.empty() && std::find(boards.begin(), boards.end(), o.board) == boards.end()) {
    if (boards.empty()) read_board(o.board, o.boards);  // the folder is wrong, not the name
    as_usage("--board: ", [&] { read_board(o.board, o.boards); });
  }
  if (is_plan(source)) o.frame.refuse_derivation(source);
  OutputFolder folder(o.output,  // here, so that one that cannot be is told before the work
                      {"package.json",
                       "\"clock_khz\"",
                       {"Makefile", "README.md", "board", "build", "files.f", "hls", "images",
                        "photonloom.core", "photonloom.lock", "plan.toml", "rtl"}});
  HardwareRequest request;
  request.unit = o.unit;
  request.board = o.board;
  request.clock_khz = static_cast<int>(std::lround(1000 * o.clock_mhz));
  request.rtl_dir = o.rtl;
  request.boards_dir = o.boards;
  std::map<std::string, std::string> files;
  const auto check_for_board = [&](const Plan& plan, const std::string& file) {
    throw_problem(hardware_problem(plan), file, asked.set);
    if (!o.board.empty() && o.unit.empty())
      throw_problem(board_problem(plan, read_board(o.board, o.boards)), file, asked.set);
  };
  if (is_plan(source)) {
    request.plan = read_plan(source);
    for (const std::string& line : asked.set) set_plan_line(request.plan, line);
    check_plan(request.plan, source, asked.set);
    check_for_board(request.plan, source);
    files = generate_hardware(request);
  } else {
    ConsoleProgress progress;
    const PreparedFrame frame = prepare_frame(asked, Arithmetic::kGolden, &progress);
    print_warnings(frame.warnings);
    request.plan = frame.plan;
    request.reasons = frame.reasons;
    check_for_board(frame.plan, asked.plan_file.empty() ? "plan" : asked.plan_file);
    const UnitInfo& gatherer = unit_info<PhotonGatherer>;
    if (o.unit == gatherer.name || (o.unit.empty() && gatherer.lacks(frame.plan).empty()))
      request.images = images(frame);
    files = generate_hardware(request);
  }
  if (!o.board.empty() && o.unit.empty())
    warn_of_room(source, request.plan, read_board(o.board, o.boards));
  if (o.hls)
    for (auto& [name, text] : write_kernel_package(request.plan)) files["hls/" + name] = text;
  for (const auto& [name, text] : files) {
    const std::filesystem::path path = std::filesystem::path(folder.temporary()) / name;
    std::filesystem::create_directories(path.parent_path());
    write_file(path.string(), text);
  }
  folder.commit();
  fmt::print("wrote {}: {} files, plan {}\n", o.output, files.size(), plan_hash_text(request.plan));
}

void add_generate(CLI::App& app) {
  auto o = std::make_shared<GenerateOptions>();
  CLI::App* c = app.add_subcommand("generate", "A hardware package: RTL for one plan");
  c->footer(fmt::format(
      "From a plan.toml, or from a scene: then the plan is derived as `photonloom plan` does, and\n"
      "the scene's photon maps are added as memory images. The package holds the RTL that the "
      "plan\n"
      "uses, photonloom_pkg.sv with the plan's constants and packets, the wired top\n"
      "photonloom_chip, a file list, a FuseSoC core and a README with ports, packets and budget.\n"
      "With --board the top is that board's, with pins, clock, host link and a Makefile down to "
      "the\n"
      "bitstream; with --unit too, that unit alone on the board's part, to read its size and "
      "speed.\n"
      "Equal plans give equal packages.\n\n"
      "Examples:\n"
      "  photonloom generate plan.toml -o hw\n"
      "  photonloom generate scenes/cornell.xml --photons 50000 --k 16 -o hw\n"
      "  photonloom generate plan.toml -o gatherer --unit {}\n"
      "  photonloom generate plan.toml -o ulx3s --board ulx3s-85f\n"
      "  photonloom generate plan.toml -o hw --hls\n"
      "  photonloom generate --check hw",
      unit_name<PhotonGatherer>));
  o->frame.add_to(*c);
  c->get_option("SCENE")->description(
      "A plan.toml, or a Mitsuba XML scene; with --check the folder of a package");
  c->add_option("-o,--output", o->output,
                "Folder to write; an older package there is replaced, with what was built in it")
      ->type_name("DIR");
  c->add_option("--unit", o->unit,
                "This unit alone, to be built into another system: " + unit_names_text())
      ->type_name("NAME");
  std::string boards;
  for (const std::string& b : board_names()) boards += (boards.empty() ? "" : ", ") + b;
  c->add_option("--board", o->board, "For this board: " + boards)->type_name("NAME");
  c->add_option("--boards", o->boards,
                "Folder of the boards, if not those of this build or of PHOTONLOOM_BOARDS")
      ->type_name("DIR");
  c->add_option("--clock", o->clock_mhz, "The board's clock, if not its default")
      ->type_name("MHZ")
      ->check(number_range(1, 400));
  c->add_flag("--hls", o->hls,
              "Add the units as HLS C++ with testbenches and scripts (docs/hls.md)");
  c->add_flag("--check", o->check, "Only tell whether the package in a folder is stale");
  c->add_option("--rtl", o->rtl, "Folder of the RTL sources, if not those of this build")
      ->type_name("DIR");
  c->callback([o] { generate(*o); });
}

const Command generate_command(40, add_generate);

}  // namespace
}  // namespace photonloom
