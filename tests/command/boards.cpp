// SPDX-License-Identifier: Apache-2.0
// A board is a folder: one added by files alone, and what is said of files that do not fit
// together.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "golden/plan/plan_file.hpp"
#include "rtl/generate/board_file.hpp"
#include "rtl/generate/clocks.hpp"
#include "rtl/generate/sources.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"

using namespace photonloom;
using namespace photonloom::test;

namespace {

namespace fs = std::filesystem;

void write_small_plan(const std::string& path, PhotonMemory memory) {
  Plan plan;
  plan.global.present = true;
  plan.global.photons = 4000;
  plan.global.r2_max = plan.r2_limit();
  plan.k = 8;
  plan.gather_rays = 4;
  plan.photon_memory = memory;
  write_plan(plan, path);
}

// All of `from` in a file becomes `to`; it must be there.
void replace(const std::string& path, const std::string& from, const std::string& to) {
  std::string text = read_file(path);
  size_t at = text.find(from);
  INFO(path << " has no " << from);
  REQUIRE(at != std::string::npos);
  for (; at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  write_file(path, text);
}

// A folder of boards with a copy of `board` in it, called `name`: the steps of docs/porting.md.
struct Boards {
  Scratch scratch;
  std::string dir, folder;
  Boards(const std::string& board, const std::string& name) : dir(scratch / "boards") {
    folder = dir + "/" + name;
    fs::create_directories(dir);
    fs::copy(source("fpga/boards/" + board), folder, fs::copy_options::recursive);
    const auto module = [](std::string s) {
      std::replace(s.begin(), s.end(), '-', '_');
      return "module " + s + "_top";
    };
    for (const auto& file : fs::recursive_directory_iterator(folder))
      if (file.path().extension() == ".sv")
        replace(file.path().string(), module(board), module(name));
    write_small_plan(scratch / "plan.toml", PhotonMemory::kBlockRam);
  }
  Outcome generate(const std::string& options) const {
    return run(fmt::format("generate {} --boards {} -o {} {}", scratch / "plan.toml", dir,
                           scratch / "hw", options));
  }
};

bool lints(const std::string& dir, const std::string& top) {
  return std::system(fmt::format("cd {} && verilator --lint-only -Wall --top-module {} -y "
                                 "board/models -f files.f >&2",
                                 dir, top)
                         .c_str()) == 0;
}

}  // namespace

TEST_CASE("a board added by files alone is generated, linted and checked") {
  const Boards boards("ulx3s-85f", "my-board");
  replace(boards.folder + "/core.lpf", "SITE \"H3\"", "SITE \"A7\"");
  replace(boards.folder + "/sdram.lpf", "SITE \"F19\"", "SITE \"B9\"");
  replace(boards.folder + "/unit.lpf", "SITE \"B2\"", "SITE \"C9\"");
  replace(boards.folder + "/board.toml", "loader = \"ulx3s\"", "loader = \"mine\"");
  replace(boards.folder + "/board.toml", "core_khz = 50000", "core_khz = 75000");
  const std::string hw = boards.scratch / "hw", plan = boards.scratch / "plan.toml";
  struct Case {
    PhotonMemory memory;
    const char *options, *top, *pin;
  };
  for (const Case& c : {Case{PhotonMemory::kBlockRam, "", "my_board_top", "A7"},
                        Case{PhotonMemory::kSdram, "", "my_board_top", "B9"},
                        Case{PhotonMemory::kBlockRam, "--unit reorder_buffer",
                             "my_board_reorder_buffer_top", "C9"}}) {
    INFO(c.top << " " << c.pin);
    write_small_plan(plan, c.memory);
    const Outcome made = boards.generate(std::string("--board my-board ") + c.options);
    INFO(made.err);
    REQUIRE(made.status == 0);
    CHECK(lints(hw, c.top));
    CHECK_THAT(read_file(hw + "/board/my_board.lpf"),
               ContainsSubstring(fmt::format("SITE \"{}\"", c.pin)));
    CHECK_THAT(read_file(hw + "/Makefile"), ContainsSubstring("openFPGALoader -b mine"));
    if (!*c.options)
      CHECK_THAT(read_file(hw + "/rtl/board_pkg.sv"), ContainsSubstring("CoreKHz = 75000;"));
    CHECK(run(fmt::format("generate --check {} --boards {}", hw, boards.dir)).status == 0);
    CHECK_THAT(run("generate --check " + hw).err, ContainsSubstring("board is my-board, expected"));
  }
  // The folder may be named by the environment, too; then help tells of its boards.
  const std::string environment = "PHOTONLOOM_BOARDS=" + boards.dir + " ";
  const std::string help = boards.scratch / "help";
  REQUIRE(std::system((environment + test::environment("PHOTONLOOM") + " generate --help >" + help)
                          .c_str()) == 0);
  CHECK_THAT(read_file(help), ContainsSubstring("For this board: my-board"));
  CHECK_THAT(boards.generate("--board ulx3s-85f").err,
             ContainsSubstring("there is no board ulx3s-85f, expected one of my-board"));
}

TEST_CASE("a board of two flows is copied the same way") {
  const Boards boards("arty-a7-100t", "other");
  replace(boards.folder + "/core.xdc", "PACKAGE_PIN T10", "PACKAGE_PIN T11");
  const Outcome made = boards.generate("--board other");
  INFO(made.err);
  REQUIRE(made.status == 0);
  CHECK(lints(boards.scratch / "hw", "other_top"));
  CHECK_THAT(read_file(boards.scratch / "hw/board/other.xdc"), ContainsSubstring("T11"));
  CHECK_THAT(read_file(boards.scratch / "hw/board/vivado.tcl"),
             ContainsSubstring("read_xdc board/other.xdc"));
  CHECK_THAT(read_file(boards.scratch / "hw/Makefile"),
             ContainsSubstring("--device xc7a100tcsg324-1"));
}

TEST_CASE("files of a board that do not fit together are named, with the key or the place") {
  struct Case {
    const char *file, *from, *to, *said;
  };
  for (const Case& c : {
           // keys of board.toml
           Case{"board.toml", "tested = ", "testet = ", "b/board.toml: tested is missing"},
           Case{"board.toml", "[serial]", "colour = 1\n[serial]",
                "the key pll.colour is unknown, expected one of detector_least_khz, feedback"},
           Case{"board.toml", "[clock]", "[clocks]", "b/board.toml: clock is missing"},
           Case{"board.toml", "[serial]", "[extra]\na = 1\n[serial]", "the key extra is unknown"},
           Case{"board.toml", "khz = 25000", "khz = 0",
                "b/board.toml: clock.khz is 0, expected a number from 1"},
           Case{"board.toml", "khz = 25000", "khz = \"25\"",
                "b/board.toml: clock.khz is of another kind, expected a number from 1"},
           Case{"board.toml", "khz = 25000\n", "", "b/board.toml: clock.khz is missing"},
           Case{"board.toml", "vco_khz = [400000, 800000]", "vco_khz = [800000, 400000]",
                "b/board.toml: pll.vco_khz is no range, expected two numbers, [least, most]"},
           Case{"board.toml", "feedback_from = \"output\"", "feedback_from = \"clkop\"",
                "b/board.toml: pll.feedback_from is clkop, expected output or vco"},
           Case{"board.toml", "LUT4 = 83640", "LUT4 = -1",
                "b/board.toml: part.resources.LUT4 is -1, expected a number from 1"},
           Case{"board.toml", "name = \"ecp5\"", "name = \"ecp6\"",
                "b/board.toml: flow.name is ecp6, expected one of ecp5, ice40, xc7"},
           Case{"board.toml", "\"core.lpf\"", "\"pins.lpf\"",
                "b/board.toml: top.block_ram names pins.lpf, expected a file of"},
           Case{"board.toml", "[clock]", "[clock", "board.toml, line 16: not TOML"},
           Case{"board.toml", "name = \"ecp5\"", "name = \"\"", "flow.name is , expected one of"},
           Case{"board.toml", "name = \"ecp5\"", "name = \"..\"", "flow.name is .., expected one"},
           Case{"board.toml", "\"clk_25mhz\"", "\"a b\"",
                "b/board.toml: clock.port is 'a b', expected the name of a port"},
           Case{"board.toml", "\"clk_25mhz\"", "\"\"", "clock.port is '', expected the name"},
           Case{"board.toml", "\"clk_25mhz\"", "\"module\"", "clock.port is 'module', expected"},
           Case{"board.toml", "unit_khz = 100000", "unit_khz = 2147483647",
                "clock.unit_khz is 2147483647, expected a number from 1 to 1000000"},
           Case{"board.toml", "loader = \"ulx3s\"", "loader = \"$(shell ls)\"",
                "flow.loader is $(shell ls), expected letters, digits"},
           Case{"board.toml", "plan = \"fpga/gatherer.toml\"", "plam = \"x\"",
                "the key measure.plam is unknown, expected one of plan, units"},
           Case{"board.toml", "[\"unit.lpf\"]", "[\"../b/unit.lpf\"]",
                "top.unit names ../b/unit.lpf, expected a file of"},
           Case{"board.toml", "baud = [", "baud = [1] # ",
                "b/board.toml: serial.baud is 1, expected a number from 300"},
           // places of the flow's files
           Case{"board.toml", "loader = \"ulx3s\"", "", "the place @LOADER@ is unknown, expected"},
           Case{"board.toml", "speed = 6", "speed = 6\nsped = 6",
                "b/board.toml: the key flow.sped is unknown, expected one with a place in"},
           Case{"board.toml", "speed = 6", "speed = 6\ntop = 6",
                "the key flow.top is unknown, expected one that is no place of every flow"},
           Case{"core.lpf", "@PIN_MHZ@", "@PIN_KHZ@",
                "b/core.lpf, line 7: the place @PIN_KHZ@ is unknown, expected one of @PIN_MHZ@, "
                "@PIN_NS@"},
           Case{"core.lpf", "@PIN_MHZ@", "@PIN_MHZ",
                "b/core.lpf, line 7: the place @PIN_MHZ is not closed, expected @PIN_MHZ@"},
           // the top
           Case{"block_ram/ulx3s_85f_top.sv", "module b_top", "module a_top",
                "block_ram/ulx3s_85f_top.sv: has no module b_top, expected the top of board b"},
           // clocks
           Case{"board.toml", "output_khz = [10000, 400000]", "output_khz = [100000, 400000]",
                "the PLL cannot make 50 MHz of 25 MHz exactly, expected --clock of for example "
                "100"},
           Case{"board.toml", "baud = [", "baud = [8000000] # ",
                "board b: a core clock of 50000 kHz is too slow for its UART"},
       }) {
    INFO(c.file << ": " << c.from << " -> " << c.to);
    const Boards boards("ulx3s-85f", "b");
    replace(boards.folder + "/" + c.file, c.from, c.to);
    const Outcome o = boards.generate("--board b");
    CHECK(o.status == 1);
    CHECK(o.one_error_line());
    CHECK_THAT(o.err, ContainsSubstring(c.said));
    CHECK(!fs::exists(boards.scratch / "hw"));
  }
}

TEST_CASE("a folder whose name begins no module's is refused") {
  for (const std::string name : {"7k", "my board's", "a.b"}) {
    INFO(name);
    const Boards boards("ulx3s-85f", name);
    const Outcome o = boards.generate("--board \"" + name + "\"");
    CHECK(o.status == 1);
    CHECK_THAT(o.err, ContainsSubstring("boards/" + name + ": the folder's name begins the names"));
    CHECK(!fs::exists(boards.scratch / "hw"));
  }
}

TEST_CASE("an SDRAM that the controller does not serve is refused") {
  for (const auto& [from, to, said] :
       {std::tuple{"clock_khz = 110000", "clock_khz = 90000",
                   "/plan.toml: board.sdram_khz is 100000, expected at most 90000, sdram.clock_khz "
                   "of"},
        std::tuple{"clock_khz = 110000", "clock_khz = 40000", "sdram.clock_khz is 40000, expected"},
        std::tuple{"row_active_ns = 44", "row_active_ns = 50",
                   "sdram.row_active_ns is 50, expected at most 44, what"},
        std::tuple{"refresh_ns = 66\n", "", "sdram.refresh_ns is missing"}}) {
    INFO(to);
    const Boards boards("ulx3s-85f", "b");
    write_small_plan(boards.scratch / "plan.toml", PhotonMemory::kSdram);
    REQUIRE(boards.generate("--board b").status == 0);
    replace(boards.folder + "/board.toml", from, to);
    const Outcome o = boards.generate("--board b");
    CHECK(o.status == 1);
    CHECK_THAT(o.err, ContainsSubstring("b/board.toml"));
    CHECK_THAT(o.err, ContainsSubstring(said));
  }
}

TEST_CASE("the SDRAM has the plan's clock") {
  const Boards boards("ulx3s-85f", "b");
  write_small_plan(boards.scratch / "plan.toml", PhotonMemory::kSdram);
  const auto made = [&](const std::string& options, const std::string& file) {
    REQUIRE(boards.generate("--board b " + options).status == 0);
    return read_file(boards.scratch / "hw/" + file);
  };
  CHECK_THAT(made("", "Makefile"), ContainsSubstring(" clk_sdram 100.000 "));
  CHECK_THAT(made("--set board.sdram_khz=87500", "Makefile"),
             ContainsSubstring(" clk_sdram 87.500 "));
  const std::string package = read_file(boards.scratch / "hw/rtl/board_pkg.sv");
  CHECK_THAT(package, ContainsSubstring("VcoKHz = 700000;"));
  CHECK_THAT(package, ContainsSubstring("SdramKHz = 87500;"));
  CHECK_THAT(read_file(boards.scratch / "hw/rtl/photonloom_pkg.sv"),
             ContainsSubstring("SdramKHz = 87500;"));
  CHECK(lints(boards.scratch / "hw", "b_top"));
  CHECK_THAT(made("--set board.refreshes_ahead=255", "rtl/photonloom_pkg.sv"),
             ContainsSubstring("RefreshesAhead = 255;"));
  CHECK(lints(boards.scratch / "hw", "b_top"));
  for (const auto& [options, said] :
       {std::pair{"--set board.refreshes_ahead=256",
                  "board.refreshes_ahead is '256', expected an integer from 0 to 255"},
        std::pair{
            "--set board.sdram_khz=93333",
            "cannot make 50 MHz beside the 93333 kHz of the plan's board.sdram_khz, expected a "
            "board.sdram_khz of for example 110000, 100000, 93750"},
        std::pair{
            "--clock 45",
            "45 MHz beside the 100000 kHz of the plan's board.sdram_khz, expected --clock of for "
            "example 25, 50, 60, 62.5, 75, 100, or a board.sdram_khz of for example 105000, "
            "101250, 97500"},
        std::pair{"--set board.sdram_khz=120001",
                  "board.sdram_khz is '120001', expected an integer from 50000 to 120000"}}) {
    INFO(options);
    const Outcome o = boards.generate(fmt::format("--board b {}", options));
    CHECK(o.status != 0);
    CHECK(o.one_error_line());
    CHECK_THAT(o.err, ContainsSubstring(said));
  }
}

TEST_CASE("a folder without boards is named") {
  const Scratch scratch;
  write_small_plan(scratch / "plan.toml", PhotonMemory::kBlockRam);
  const Outcome o = run(fmt::format("generate {} --board a --boards {} -o {}",
                                    scratch / "plan.toml", scratch.path.string(), scratch / "hw"));
  CHECK(o.status == 1);
  CHECK_THAT(o.err, ContainsSubstring(
                        fmt::format("{} has no folder with a board.toml", scratch.path.string())));
}

TEST_CASE("dividers are exact and within the PLL's limits") {
  for (const char* name : {"ulx3s-85f", "arty-a7-100t", "nexys-video"}) {
    const BoardDescription board = read_board(name);
    int made = 0;
    for (int khz = 10000; khz <= 100000; khz += 2500) {
      BoardClocks c;
      try {
        c = board_clocks(board, khz, false, default_rtl_dir());
      } catch (const std::runtime_error&) {
        continue;
      }
      ++made;
      INFO(name << " " << khz);
      const long factor = board.pll->fed_back_from_output ? c.output : 1;
      CHECK(static_cast<long>(board.oscillator_khz) * c.feedback * factor ==
            static_cast<long>(c.vco_khz) * c.reference);
      CHECK(c.vco_khz == khz * c.output);
      CHECK(c.vco_khz >= board.pll->vco_khz.least);
      CHECK(c.vco_khz <= board.pll->vco_khz.most);
      CHECK(c.clocks_per_bit >= 8);
      // The fastest rate of which whole clocks are within half a percent.
      int fastest = 0;
      for (const int baud : board.baud) {
        const double clocks = 1000.0 * khz / baud;
        if (std::round(clocks) >= 8 && std::abs(clocks - std::round(clocks)) <= 0.005 * clocks)
          fastest = std::max(fastest, baud);
      }
      CHECK(c.baud == fastest);
    }
    CHECK(made >= 5);
  }
}

TEST_CASE("docs/fpga.md tells of each board what its folder says") {
  const std::string page = read_file(source("docs/fpga.md"));
  const std::vector<std::string> names = board_names();
  CHECK(names == std::vector<std::string>{"arty-a7-100t", "nexys-video", "ulx3s-85f", "up5k"});
  for (const std::string& name : names) {
    const BoardDescription board = read_board(name);
    const size_t at = page.find(fmt::format("| `{}` | {} |", name, board.part));
    INFO(name);
    REQUIRE(at != std::string::npos);
    CHECK_THAT(page.substr(at, page.find('\n', at) - at),
               ContainsSubstring("| " + board.tested + " |"));
  }
}
