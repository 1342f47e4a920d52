// SPDX-License-Identifier: Apache-2.0
#include "rtl/generate/board.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <optional>
#include <regex>
#include <stdexcept>

#include "golden/numeric/output_file.hpp"
#include "golden/plan/units.hpp"
#include "rtl/generate/clocks.hpp"
#include "rtl/generate/data_files.hpp"
#include "rtl/generate/sources.hpp"
#include "rtl/generate/unit_top.hpp"

namespace photonloom {
namespace {

namespace fs = std::filesystem;

std::string mhz(int khz) { return fmt::format("{:.3f}", khz / 1000.0); }

// Which of the board's tops is asked for.
std::string kind_of(const Plan& plan, const BoardRequest& request) {
  if (!request.unit.empty()) return "unit";
  return plan.photon_memory == PhotonMemory::kSdram ? "sdram" : "block_ram";
}

void check(const Plan& plan, const BoardDescription& b, const std::string& kind) {
  if (kind == "unit" && !b.tops.count(kind))
    throw std::runtime_error(
        fmt::format("board {} takes no unit alone, expected [top.unit] in {}", b.name, b.file));
  if (kind == "unit") return;
  if (!b.has_core())
    throw std::runtime_error(fmt::format(
        "board {} has room for one unit alone, expected --unit with it ({} of a small plan "
        "fits)",
        b.name, unit_name<ReorderBuffer>));
  throw_problem(board_problem(plan, b), "plan", {});
}

// The hand-written top around board_core with its constants, and stubs of the cells that it names.
void add_core(const BoardDescription& b, const BoardTop& top, const BoardClocks& clocks,
              BoardFiles& out) {
  const std::string file = b.folder + "/" + top.file;
  std::string& text = out.files["rtl/" + out.top + ".sv"] = read_file(file);
  if (!std::regex_search(text, std::regex("\\bmodule\\s+" + out.top + "\\b")))
    throw std::runtime_error(
        fmt::format("{}: has no module {}, expected the top of board {}", file, out.top, b.name));
  out.files["rtl/board_pkg.sv"] =
      fill_template("board_pkg.sv", {{"BOARD", b.name},
                                     {"CORE_KHZ", fmt::format("{}", clocks.core_khz)},
                                     {"CLOCKS_PER_BIT", fmt::format("{}", clocks.clocks_per_bit)},
                                     {"BAUD", fmt::format("{}", clocks.baud)},
                                     {"PLL_REFERENCE", fmt::format("{}", clocks.reference)},
                                     {"PLL_FEEDBACK", fmt::format("{}", clocks.feedback)},
                                     {"PLL_OUTPUT", fmt::format("{}", clocks.output)},
                                     {"VCO_KHZ", fmt::format("{}", clocks.vco_khz)},
                                     {"SDRAM_KHZ", fmt::format("{}", clocks.sdram_khz)}});
  out.sources.push_back("rtl/board_pkg.sv");
  const std::string models = data_dir() + "/fpga/models";
  for (const std::string& cell : modules_named(text, models)) {
    out.files["board/models/" + cell + ".sv"] = read_file(models + "/" + cell + ".sv");
    out.lint = " -y board/models";
  }
}

// The board's files of constraints as one; its path in the package.
std::string add_constraints(const BoardDescription& b, const BoardTop& top, int pin_khz,
                            BoardFiles& out) {
  const Places places = {{"PIN_MHZ", mhz(pin_khz)},
                         {"PIN_NS", fmt::format("{:.3f}", 1e6 / pin_khz)}};
  const std::string extension = fs::path(top.constraints.front()).extension().string();
  const std::string path = "board/" + b.prefix + extension;
  for (const std::string& file : top.constraints)
    out.files[path] += fill(b.folder + "/" + file, {}, places);
  return path;
}

// Fills the files of the board's flow; that of the README is returned. A key of [flow] that fills
// no place of them is an error.
std::string add_flow(const BoardDescription& b, const Places& common, BoardFiles& out) {
  const std::string dir = data_dir() + "/fpga/flows/" + b.flow;
  Places may = common;
  const auto refuse = [&](std::string place, const std::string& expected) {
    std::transform(place.begin(), place.end(), place.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    throw std::runtime_error(
        fmt::format("{}: the key flow.{} is unknown, expected {}", b.file, place, expected));
  };
  for (const auto& [place, value] : b.flow_places)
    if (place == "TOP" || !may.emplace(place, value).second)
      refuse(place, "one that is no place of every flow");
  std::string readme, all;
  for (const auto& entry : fs::recursive_directory_iterator(dir)) {
    if (!entry.is_regular_file()) continue;
    const std::string name = fs::relative(entry.path(), dir).string();
    all += read_file(dir + "/" + name);
    const std::string text = fill(dir + "/" + name, {{"TOP", out.top}}, may);
    (name == "README.md" ? readme : out.files[name]) = text;
  }
  for (const auto& [place, value] : b.flow_places)
    if (all.find("@" + place + "@") == std::string::npos)
      refuse(place, "one with a place in " + dir);
  if (all.find("@CONSTRAINTS@") == std::string::npos)
    throw std::runtime_error(dir + ": has no place @CONSTRAINTS@, expected the pins to be read");
  return readme;
}

}  // namespace

std::optional<PlanProblem> board_problem(const Plan& plan, const BoardDescription& board) {
  if (!board.has_core()) return std::nullopt;
  const bool sdram = plan.photon_memory == PhotonMemory::kSdram;
  if (!board.tops.count(sdram ? "sdram" : "block_ram"))
    return PlanProblem{
        "board.photon_memory",
        sdram
            ? fmt::format("is sdram, expected block_ram: board {} has no SDRAM that photon_sdram "
                          "serves",
                          board.name)
            : fmt::format("is block_ram, expected sdram: board {} has no top for photons in block "
                          "RAM",
                          board.name)};
  if (sdram && plan.sdram_khz > board.sdram->clock_khz)
    return PlanProblem{"board.sdram_khz",
                       fmt::format("is {}, expected at most {}, sdram.clock_khz of {}",
                                   plan.sdram_khz, board.sdram->clock_khz, board.file)};
  return board_problem(plan);
}

void check_board(const Plan& plan, const BoardRequest& request) {
  check(plan, read_board(request.name, request.boards_dir), kind_of(plan, request));
}

BoardFiles board_files(const Plan& plan, const BoardRequest& request, const std::string& rtl_dir,
                       const std::vector<std::string>& sources) {
  const BoardDescription b = read_board(request.name, request.boards_dir);
  const std::string kind = kind_of(plan, request);
  check(plan, b, kind);
  const BoardTop& top = b.tops.at(kind);
  const bool unit = kind == "unit";
  BoardFiles out;
  out.inner = unit ? request.unit : "board_core";
  out.top = unit ? fmt::format("{}_{}_top", b.prefix, request.unit) : b.prefix + "_top";
  out.clock_khz = request.clock_khz ? request.clock_khz : unit ? b.unit_khz : b.core_khz;

  BoardClocks clocks;
  if (unit) {
    out.files["rtl/" + out.top + ".sv"] =
        write_unit_top(out.top, request.unit, b.clock_port, rtl_dir);
  } else {
    clocks = board_clocks(b, out.clock_khz, kind == "sdram" ? plan.sdram_khz : 0, rtl_dir);
    add_core(b, top, clocks, out);
  }
  out.sources.push_back("rtl/" + out.top + ".sv");

  std::string list;
  for (const std::string& file : sources) list += file + " ";
  for (const std::string& file : out.sources)
    list += file + (file == out.sources.back() ? "" : " ");
  // The nets that a top calls its clocks.
  std::string nets = "clk " + mhz(out.clock_khz);
  if (clocks.sdram_khz) nets += " clk_sdram " + mhz(clocks.sdram_khz);
  const std::string constraints =
      add_constraints(b, top, unit ? out.clock_khz : b.oscillator_khz, out);
  Places places = {{"BOARD", b.name},
                   {"CLOCK_MHZ", mhz(out.clock_khz)},
                   {"CLOCKS", nets},
                   {"CONSTRAINTS", constraints},
                   {"SOURCES", list}};
  const std::string build = add_flow(b, places, out);

  places = {{"BOARD", b.name},
            {"PART", b.part},
            {"CLOCK_MHZ", mhz(out.clock_khz)},
            {"TESTED", b.tested},
            {"BUILD", build}};
  if (unit) {
    places["UNIT"] = request.unit;
    out.readme = fill_template("unit.md", places);
  } else {
    places["BAUD"] = fmt::format("{}", clocks.baud);
    places["SERIAL_PORT"] = b.serial_port;
    places["LEDS"] = b.leds;
    out.readme = fill_template("board.md", places);
  }
  return out;
}

}  // namespace photonloom
