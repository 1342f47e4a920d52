// SPDX-License-Identifier: Apache-2.0
// photonloom generate: packages that lint, follow the plan, and know when they are stale.
#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "golden/plan/plan_file.hpp"
#include "golden/planner/resources.hpp"
#include "rtl/generate/hardware.hpp"
#include "rtl/generate/sources.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"
#include "verilator_tb/bench/bench.hpp"

using namespace photonloom;
using namespace photonloom::test;

namespace {

Plan gatherer_plan() {
  Plan plan;
  plan.global.present = true;
  plan.global.photons = 4000;
  plan.global.r2_max = plan.r2_limit();
  plan.k = 16;
  plan.gather_rays = 0;
  return plan;
}

bool tool(const std::string& command) { return std::system((command + " >&2").c_str()) == 0; }

// Verilator with all warnings and Yosys must both take it.
void check_tools(const std::string& dir, const std::string& top) {
  CHECK(tool(
      fmt::format("cd {} && verilator --lint-only -Wall --top-module {} -f files.f", dir, top)));
  CHECK(
      tool(fmt::format("cd {} && yosys -q -p \"read_verilog -sv $(tr '\\n' ' ' < files.f); "
                       "hierarchy -check -top {}\"",
                       dir, top)));
}

}  // namespace

TEST_CASE("a package lints, is the same twice, and is checked") {
  const Scratch scratch;
  write_plan(gatherer_plan(), scratch / "plan.toml");
  const std::string hw = scratch / "hw";
  const Outcome made = run(fmt::format("generate {} -o {}", scratch / "plan.toml", hw));
  INFO(made.err);
  REQUIRE(made.status == 0);
  check_tools(hw, "photonloom_chip");
  CHECK(run("generate --check " + hw).status == 0);
  CHECK(generate_hardware({.plan = gatherer_plan()}) ==
        generate_hardware({.plan = gatherer_plan()}));
  const std::string all = read_file(hw + "/README.md") + read_file(hw + "/files.f") +
                          read_file(hw + "/photonloom.core");
  CHECK(all.find(environment("PHOTONLOOM_SOURCE")) == std::string::npos);
}

TEST_CASE("the lock names each source's hash, the plan and the oldest tools") {
  const Scratch scratch;
  const std::string hw = scratch / "hw";
  const auto lock_of = [&](const std::string& more) {
    const Outcome made = run(fmt::format("generate {} -o {} {}", scratch / "plan.toml", hw, more));
    INFO(made.err);
    REQUIRE(made.status == 0);
    return nlohmann::json::parse(read_file(hw + "/photonloom.lock"));
  };
  write_plan(gatherer_plan(), scratch / "plan.toml");
  const auto lock = lock_of("");
  CHECK("photonloom " + lock["photonloom"].get<std::string>() + "\n" == run("--version").out);
  CHECK(lock["plan"] == plan_hash_text(gatherer_plan()));
  CHECK(lock["tools"] == nlohmann::json{{"verilator", ">= 5.006"}, {"yosys", ">= 0.23"}});
  size_t sources = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(hw + "/rtl")) {
    if (!entry.is_regular_file()) continue;
    ++sources;
    const std::string name = std::filesystem::relative(entry.path(), hw).string();
    INFO(name);
    REQUIRE(lock["sources"].contains(name));
    // coreutils' sha256sum, not ours.
    CHECK(std::system(fmt::format("echo '{}  {}' | sha256sum --check --status",
                                  lock["sources"][name].get<std::string>(), entry.path().string())
                          .c_str()) == 0);
  }
  CHECK(lock["sources"].size() == sources);
  const auto board = lock_of("--board ulx3s-85f");
  CHECK(board["sources"].contains("board/synth.ys"));
  CHECK(board["tools"]["yosys"] == ">= 0.52");
  CHECK(board["tools"].contains("nextpnr-ecp5"));
}

TEST_CASE("a stale package names what is stale") {
  const Scratch scratch;
  write_plan(gatherer_plan(), scratch / "plan.toml");
  const std::string hw = scratch / "hw";
  const auto fresh = [&] {
    REQUIRE(run(fmt::format("generate {} -o {}", scratch / "plan.toml", hw)).status == 0);
  };
  const auto check = [&] {
    const Outcome o = run("generate --check " + hw);
    CHECK(o.status == 1);
    CHECK(o.one_error_line());
    return o.err;
  };
  fresh();
  Plan other = gatherer_plan();
  other.position_bits = 15;
  other.global.r2_max = other.r2_limit();
  write_plan(other, hw + "/plan.toml");
  CHECK_THAT(check(), ContainsSubstring("photonloom_pkg.sv: is stale, made from plan"));
  fresh();
  const std::string module = hw + "/rtl/photon_gatherer/photon_gatherer.sv";
  write_file(module, read_file(module) + "\n");
  CHECK_THAT(check(), ContainsSubstring("photon_gatherer.sv: is stale"));
  fresh();
  std::filesystem::remove(module);
  CHECK_THAT(check(), ContainsSubstring("photon_gatherer.sv: is missing"));
  fresh();
  const std::string lock = hw + "/photonloom.lock";
  write_file(lock, read_file(lock) + "\n");
  CHECK_THAT(check(), ContainsSubstring("photonloom.lock: is stale"));
  std::filesystem::remove(lock);
  CHECK_THAT(check(), ContainsSubstring("photonloom.lock: is missing"));
  fresh();
  write_file(hw + "/rtl/old.sv", "");
  CHECK_THAT(check(), ContainsSubstring("old.sv: does not belong to the package"));
  CHECK(run("generate --check " + (scratch / "nothing")).status == 1);
}

TEST_CASE("a scene's package lints as a whole and has its maps as images") {
  const Scratch scratch;
  const std::string hw = scratch / "hw";
  const Outcome made =
      run(fmt::format("generate {} --photons 1000 --caustic-photons 300 --k 8 -o {}",
                      source("scenes/cornell_balls.xml"), hw));
  INFO(made.err);
  REQUIRE(made.status == 0);
  check_tools(hw, "photonloom_chip");
  CHECK(run("generate --check " + hw).status == 0);
  const Plan plan = read_plan(hw + "/plan.toml");
  const auto lines = [&](const std::string& file) {
    const std::string text = read_file(hw + "/images/" + file);
    return static_cast<uint64_t>(std::count(text.begin(), text.end(), '\n'));
  };
  const uint64_t beats = static_cast<uint64_t>(plan.line_bytes()) / 16;
  CHECK(lines("global_lines.hex") == plan.lines(plan.global) * beats);
  CHECK(lines("caustic_lines.hex") == plan.lines(plan.caustic) * beats);
  CHECK(lines("cfg.hex") == plan.lines(plan.global) - 1 + plan.lines(plan.caustic) - 1 + 4);

  const std::string image = hw + "/images/cfg.hex", text = read_file(image);
  const auto stale = [&] { return run("generate --check " + hw).err; };
  write_file(image, text + "\n");
  CHECK_THAT(stale(), ContainsSubstring("images/cfg.hex: is not the image that was generated"));
  std::filesystem::remove(image);
  CHECK_THAT(stale(), ContainsSubstring("images/cfg.hex: is missing"));
  write_file(image, text);
  write_file(hw + "/images/more.hex", "");
  CHECK_THAT(stale(), ContainsSubstring("images/more.hex: does not belong to the package"));
}

TEST_CASE("only what the plan needs") {
  Plan plan = gatherer_plan();
  plan.gather_rays = 4;
  const auto files = [&] { return generate_hardware({.plan = plan}); };
  const auto all = files();
  CHECK(all.count("rtl/reorder_buffer/reorder_sweep.sv") == 1);
  CHECK(all.count("rtl/reorder_buffer/reorder_fullest.sv") == 0);
  CHECK(all.count("rtl/common/reciprocal.sv") == 1);
  plan.reciprocal_bits = 0;
  CHECK(files().count("rtl/common/reciprocal.sv") == 0);
  plan.reorder_drain = ReorderDrain::kFullest;
  CHECK(files().count("rtl/reorder_buffer/reorder_fullest.sv") == 1);
  CHECK(files().count("rtl/reorder_buffer/reorder_sweep.sv") == 0);
  plan.reorder_key = ReorderKey::kNone;
  CHECK(files().count("rtl/reorder_buffer/reorder_buffer.sv") == 0);
  plan.gather_rays = 0;
  CHECK(files().count("rtl/cdf_sampler/cdf_sampler.sv") == 0);
  plan.global = {};
  CHECK_THROWS_WITH(files(), ContainsSubstring("there is no hardware to generate"));
}

TEST_CASE("packages of every way to reorder lint", "[slow]") {
  Plan plan = gatherer_plan();
  plan.gather_rays = 4;
  for (const ReorderKey key : {ReorderKey::kNone, ReorderKey::kHilbert, ReorderKey::kHash})
    for (const ReorderDrain drain : {ReorderDrain::kSweep, ReorderDrain::kFullest}) {
      const Scratch scratch;
      plan.reorder_key = key;
      plan.reorder_drain = drain;
      INFO("key " << static_cast<int>(key) << ", drain " << static_cast<int>(drain));
      for (const auto& [name, text] : generate_hardware({.plan = plan})) {
        std::filesystem::create_directories((scratch.path / name).parent_path());
        write_file(scratch / name, text);
      }
      check_tools(scratch.path.string(), "photonloom_chip");
    }
}

TEST_CASE("packages of many plans lint", "[slow]") {
  for (const RandomPlans which : {RandomPlans::kUsual, RandomPlans::kEnds})
    for (uint64_t seed = 1; seed <= 5; ++seed) {
      const Scratch scratch;
      INFO((which == RandomPlans::kEnds ? "ends:" : "random:") << seed);
      for (const auto& [name, text] : generate_hardware({.plan = random_plan(seed, which)})) {
        std::filesystem::create_directories((scratch.path / name).parent_path());
        write_file(scratch / name, text);
      }
      check_tools(scratch.path.string(), "photonloom_chip");
    }
}

TEST_CASE("packages of the narrowest weights lint", "[slow]") {
  Plan plan = gatherer_plan();
  plan.gather_rays = 4;
  plan.mantissa_bits = 2;
  plan.exponent_bits = plan.channels = plan.cell_bits = 1;
  plan.normal_bits = 2;
  derive_plan(plan);
  const Scratch scratch;
  for (const auto& [name, text] : generate_hardware({.plan = plan})) {
    std::filesystem::create_directories((scratch.path / name).parent_path());
    write_file(scratch / name, text);
  }
  check_tools(scratch.path.string(), "photonloom_chip");
}

TEST_CASE("the packet tables in docs are what the command prints") {
  const std::string page = read_file(source("docs/packets.md"));
  const size_t end = page.rfind("-->\n\n");
  REQUIRE(end != std::string::npos);
  const Outcome o = run("packets");
  CHECK(o.status == 0);
  INFO("refresh with: photonloom packets --update docs/packets.md");
  CHECK(page.substr(end + 5) == o.out);
}

TEST_CASE("the list of units in docs is what the command prints, and goes to scripts as JSON") {
  const std::string page = read_file(source("docs/units.md"));
  const size_t end = page.rfind("-->\n\n");
  REQUIRE(end != std::string::npos);
  const Outcome o = run("units");
  CHECK(o.status == 0);
  INFO("refresh with: photonloom units --update docs/units.md");
  CHECK(page.substr(end + 5) == o.out);
  const Outcome json = run("units --json");
  REQUIRE(json.status == 0);
  const auto j = nlohmann::json::parse(json.out);
  std::vector<std::string> names;
  for (const auto& unit : j["units"]) {
    names.push_back(unit["name"]);
    CHECK(!unit["rtl_counters"].empty());
  }
  CHECK(names == unit_names());
  CHECK(run("units --json --update x.md").status == 2);
  CHECK_THAT(run("units --update " + source("README.md")).err,
             ContainsSubstring("has no line <!--"));
}

TEST_CASE("one unit alone") {
  const Scratch scratch;
  write_plan(gatherer_plan(), scratch / "plan.toml");
  const std::string hw = scratch / "hw";
  REQUIRE(run(fmt::format("generate {} -o {} --unit photon_gatherer", scratch / "plan.toml", hw))
              .status == 0);
  CHECK(!std::filesystem::exists(hw + "/rtl/photonloom_chip.sv"));
  check_tools(hw, "photon_gatherer");
  CHECK(run("generate --check " + hw).status == 0);
  const Outcome none =
      run(fmt::format("generate {} -o {} --unit cdf_sampler", scratch / "plan.toml", hw));
  CHECK(none.status == 1);
  CHECK(none.err.find("the plan has no cdf_sampler") != std::string::npos);
  CHECK(run(fmt::format("generate {} -o {} --unit shader", scratch / "plan.toml", hw))
            .err.find("there is no unit shader") != std::string::npos);
}

TEST_CASE("packages for boards lint and are checked") {
  Plan plan = gatherer_plan();
  plan.gather_rays = 4;
  // An empty unit is the whole board; "sdram" is that with its photons in SDRAM.
  for (const char* board : {"ulx3s-85f", "up5k", "arty-a7-100t", "nexys-video"})
    for (const char* unit : {"sdram", "", "reorder_buffer", "cdf_sampler", "photon_gatherer"}) {
      plan.photon_memory =
          std::string(unit) == "sdram" ? PhotonMemory::kSdram : PhotonMemory::kBlockRam;
      if (plan.photon_memory == PhotonMemory::kSdram) unit = "";
      const bool ulx3s = std::string(board) == "ulx3s-85f", up5k = std::string(board) == "up5k";
      if (!ulx3s && *unit && std::string(unit) != "reorder_buffer") continue;
      if (!*unit && (up5k || (!ulx3s && plan.photon_memory == PhotonMemory::kSdram))) continue;
      const Scratch scratch;
      INFO(board << " " << unit);
      write_plan(plan, scratch / "plan.toml");
      const std::string hw = scratch / "hw";
      const Outcome made =
          run(fmt::format("generate {} --board {}{}{} -o {}", scratch / "plan.toml", board,
                          *unit ? " --unit " : "", unit, hw));
      INFO(made.err);
      REQUIRE(made.status == 0);
      std::string top = std::string(board) + (*unit ? "_" : "") + unit + "_top";
      std::replace(top.begin(), top.end(), '-', '_');
      CHECK(tool(fmt::format("cd {} && verilator --lint-only -Wall --top-module {} {} -f files.f",
                             hw, top, *unit ? "" : "-y board/models")));
      CHECK(run("generate --check " + hw).status == 0);
      const std::string file = fmt::format("{}/rtl/{}.sv", hw, top);
      write_file(file, read_file(file) + "\n");
      CHECK_THAT(run("generate --check " + hw).err, ContainsSubstring(top + ".sv: is stale"));
    }
}

TEST_CASE("a board's README has the reorder buffer that its top has") {
  for (const ReorderKey key : {ReorderKey::kHilbert, ReorderKey::kNone}) {
    Plan plan = gatherer_plan();
    plan.gather_rays = 0;  // nothing of the frame goes through it
    plan.reorder_key = key;
    const auto files = generate_hardware({.plan = plan, .board = "ulx3s-85f"});
    const bool there = key != ReorderKey::kNone;
    CHECK((files.at("README.md").find("reorder_buffer") != std::string::npos) == there);
  }
}

TEST_CASE("compressed maps of any size have recorded packets for HLS kernels") {
  for (const uint64_t photons : {1, 40, 500, 3000}) {
    Plan plan = gatherer_plan();
    plan.photon_lines = PhotonLines::kCompressed;
    plan.position_bits = 16;
    plan.photon_bytes = 10;
    plan.cache_bytes = 16 * plan.line_bytes();
    plan.beat_bits = 80;
    plan.global = {.present = true, .photons = photons, .r2_max = plan.r2_limit()};
    plan.caustic = {.present = true, .photons = photons, .r2_max = plan.r2_limit()};
    REQUIRE_FALSE(find_problem(plan));
    INFO(photons << " photons");
    const Scratch scratch;
    write_plan(plan, scratch / "plan.toml");
    const Outcome made =
        run(fmt::format("generate {} -o {} --hls", scratch / "plan.toml", scratch / "hw"));
    INFO(made.err);
    CHECK(made.status == 0);
    // Beats of bytes that are no whole words: the testbench reads what was recorded.
    if (photons == 500)
      CHECK(tool(fmt::format("make -s -C {} UNITS=photon_gatherer", scratch / "hw/hls")));
  }
}

TEST_CASE("a photon map too large for the board's block RAM is told before synthesis") {
  const Scratch scratch;
  Plan plan = gatherer_plan();
  plan.gather_rays = 4;
  write_plan(plan, scratch / "plan.toml");
  const std::string board =
      fmt::format("generate {} --board ulx3s-85f -o {}", scratch / "plan.toml", scratch / "hw");
  const std::string tell = "plan " + (scratch / "plan.toml");
  CHECK(run(board).err == "");
  CHECK_THAT(run(tell).out, !ContainsSubstring("more than"));
  plan.global.photons = 65536;
  write_plan(plan, scratch / "plan.toml");
  const int blocks = board_memories(plan).total();
  REQUIRE(blocks > 300);  // 65,536 photons of 96 bits are 342 times 18 Kibit
  const Outcome made = run(board);
  CHECK(made.status == 0);
  CHECK_THAT(made.err, ContainsSubstring(fmt::format(
                           "warning: {}: the top takes {} block RAMs, ulx3s-85f has 208",
                           scratch / "plan.toml", blocks)));
  CHECK_THAT(made.err, ContainsSubstring("fewer photons in block RAM"));
  CHECK_THAT(made.err, !ContainsSubstring("gatherers"));
  const std::string wide = " --set board.gatherers=16 --set reorder.key=none";
  const Outcome sixteen = run(board + wide);
  CHECK_THAT(sixteen.err, ContainsSubstring("expected fewer board.gatherers or fewer photons"));
  CHECK_THAT(sixteen.err, !ContainsSubstring("reorder.packets"));
  const Outcome before_sdram =
      run(board + wide + " --set board.photon_memory=sdram --set gatherer.beat_bits=128");
  CHECK_THAT(before_sdram.err, ContainsSubstring("a smaller board.cache_bytes"));
  CHECK_THAT(before_sdram.err, !ContainsSubstring("photons in block RAM"));
  REQUIRE(run(board).status == 0);
  CHECK_THAT(read_file(scratch / "hw" + "/README.md"),
             ContainsSubstring(fmt::format("| all of the top | | | | {} |", blocks)));
  CHECK_THAT(run(tell).out,
             ContainsSubstring(" block RAMs, more than the 208 of board ulx3s-85f\n"));
  // Those of another family, by its own name for them.
  CHECK_THAT(
      run(fmt::format("generate {} --board arty-a7-100t -o {}", scratch / "plan.toml",
                      scratch / "arty"))
          .err,
      ContainsSubstring(fmt::format("the top takes {} block RAMs, arty-a7-100t has 270", blocks)));
  CHECK_THAT(run(tell).out,
             ContainsSubstring(" block RAMs, more than the 270 of board arty-a7-100t\n"));
  CHECK_THAT(run(tell).out, !ContainsSubstring("nexys-video"));
  CHECK_THAT(run(tell + " --json").out, ContainsSubstring(fmt::format("\"total\": {}", blocks)));
}

TEST_CASE("logic that a board lacks is told before synthesis") {
  const Scratch scratch;
  Plan plan = gatherer_plan();
  write_plan(plan, scratch / "plan.toml");
  const std::string wide =
      " --set board.gatherers=8 --set gatherer.nodes_per_cycle=2 --set gatherer.lanes=8 --set "
      "gatherer.candidates_per_cycle=4 --set gatherer.powers_per_cycle=4 --set "
      "gatherer.cache_bytes=0";
  const Outcome made = run(fmt::format("generate {} --board ulx3s-85f -o {} {}",
                                       scratch / "plan.toml", scratch / "hw", wide));
  INFO(made.err);
  CHECK(made.status == 0);
  CHECK_THAT(made.err, ContainsSubstring(" LUT-equivalents, ulx3s-85f has 83640; expected fewer "
                                         "board.gatherers or a smaller gatherer.nodes_per_cycle"));
  CHECK_THAT(made.err, ContainsSubstring(" multipliers, ulx3s-85f has 156; expected fewer "));
  const std::string told = run("plan '" + scratch / "plan.toml" + "'" + wide).out;
  CHECK_THAT(told, ContainsSubstring(" LUT-equivalents, more than the 83640 of board ulx3s-85f\n"));
  CHECK_THAT(told, ContainsSubstring(" multipliers, more than the 156 of board ulx3s-85f\n"));
}

TEST_CASE("a board that cannot hold the plan is refused") {
  Plan plan = gatherer_plan();
  const auto refused = [&](const std::string& board, const std::string& unit, int clock_khz,
                           const std::string& why) {
    CHECK_THROWS_WITH(generate_hardware({plan, {}, unit, "", board, clock_khz, {}}),
                      ContainsSubstring(why));
  };
  refused("nexys", "", 0,
          "there is no board nexys, expected one of arty-a7-100t, nexys-video, ulx3s-85f, up5k");
  refused("up5k", "", 0, "room for one unit alone");
  refused("ulx3s-85f", "", 51300,
          "the PLL cannot make 51.3 MHz of 25 MHz exactly, expected --clock of for example 25, ");
  refused("arty-a7-100t", "", 51300,
          "the PLL cannot make 51.3 MHz of 100 MHz exactly, expected --clock of for example ");
  plan.photon_memory = PhotonMemory::kSdram;
  refused("arty-a7-100t", "", 0, "has no SDRAM");
  CHECK(run("generate --check a --board up5k").status == 2);
  CHECK(run("generate a.toml -o b --clock 50").status == 2);
}

TEST_CASE("a beat that a board's block RAM cannot store is refused, with the line that has it") {
  const Scratch s;
  Plan plan = gatherer_plan();
  plan.photon_bytes = 12;
  plan.cache_bytes = 16 * plan.line_bytes();
  plan.beat_bits = 48;
  write_plan(plan, s / "p.toml");
  const std::string from = "generate " + s / "p.toml" + " -o " + s / "hw";
  CHECK(run(from).status == 0);
  std::filesystem::remove_all(s / "hw");
  for (const char* board : {"ulx3s-85f", "arty-a7-100t"}) {
    const Outcome refused = run(from + " --board " + board);
    CHECK(refused.status == 1);
    CHECK(
        refused.err.find(s / "p.toml" + ": gatherer.beat_bits is 48, expected a multiple of 32") !=
        std::string::npos);
    CHECK(!std::filesystem::exists(s / "hw"));
  }
  CHECK(run(from + " --board ulx3s-85f --set gatherer.beat_bits=24").status == 2);
  CHECK(run(from + " --board ulx3s-85f --set gatherer.beat_bits=96").status == 0);
}

TEST_CASE("a photon memory that a board has not is refused, with the file or --set that has it") {
  const Scratch s;
  Plan plan = gatherer_plan();
  const std::string board = " -o " + s / "hw" + " --board arty-a7-100t";
  write_plan(plan, s / "block_ram.toml");
  const Outcome set =
      run("generate " + s / "block_ram.toml" + board + " --set board.photon_memory=sdram");
  CHECK(set.status == 1);
  CHECK_THAT(set.err,
             ContainsSubstring("--set: 'board.photon_memory=sdram': board.photon_memory is sdram, "
                               "expected block_ram: board arty-a7-100t has no SDRAM"));
  plan.photon_memory = PhotonMemory::kSdram;
  write_plan(plan, s / "sdram.toml");
  const Outcome file = run("generate " + s / "sdram.toml" + board);
  CHECK(file.status == 1);
  CHECK_THAT(file.err,
             ContainsSubstring(s / "sdram.toml" + ": board.photon_memory is sdram, expected"));
  CHECK(!std::filesystem::exists(s / "hw"));
}

TEST_CASE("bad plans and wrong use") {
  const Scratch scratch;
  CHECK(run("generate").status == 2);
  CHECK(run("generate " + (scratch / "none.toml") + " -o " + (scratch / "hw")).status == 1);
  CHECK(run("generate --check a --unit b").status == 2);
  for (const std::string option :
       {"--set gather.k=8", "--photons 5", "--load-photons p.ply", "--plan p.toml", "--seed 3"}) {
    const Outcome o = run("generate --check a " + option);
    INFO(o.err);
    CHECK(o.status == 2);
    CHECK_THAT(o.err, ContainsSubstring("--check looks at the package in a folder"));
  }
  for (const auto& [option, said] :
       {std::pair{"--unit foo", "--unit: there is no unit foo, expected "},
        {"--board foo", "--board: there is no board foo, expected one of "},
        {"--boards /nowhere", "--boards is where --board is looked for; give --board"}}) {
    const Outcome o = run("generate a.toml -o b " + std::string(option));
    INFO(o.err);
    CHECK(o.status == 2);
    CHECK_THAT(o.err, ContainsSubstring(said));
  }
  CHECK(run("generate a.toml -o b --k 5").status == 2);
  std::string text = plan_text(gatherer_plan());
  const auto refused = [&](const std::string& from, const std::string& to) {
    std::string bad = text;
    bad.replace(bad.find(from), from.size(), to);
    write_file(scratch / "bad.toml", bad);
    const Outcome o = run("generate " + (scratch / "bad.toml") + " -o " + (scratch / "hw"));
    CHECK(o.status == 1);
    CHECK(o.one_error_line());
    CHECK(!std::filesystem::exists(scratch / "hw"));
    return o.err;
  };
  CHECK(refused("\nk = 16", "\nk = 16\ncolour = 2").find("colour") != std::string::npos);
  CHECK(refused("position_bits = 16", "position_bits = 40").find("position_bits") !=
        std::string::npos);
  CHECK(refused("\nk = 16", "\nk = 5000").find("gather.k") != std::string::npos);
}

TEST_CASE("the list of files follows instances, whatever stands in comments") {
  const Scratch scratch;
  std::filesystem::create_directories(scratch / "common");
  std::filesystem::create_directories(scratch / "top");
  write_file(scratch / "common/leaf.sv",
             "module leaf (\n    input  logic clk_i  // clock\n);\nendmodule\n");
  write_file(scratch / "common/unused.sv", "module unused;\nendmodule\n");
  write_file(
      scratch / "top/top.sv",
      "// not unused\nmodule top (\n    input  logic clk_i,\n    // a group\n"
      "    output logic [3:0] a_o  // it (with ports);\n);\n  leaf leaf (.clk_i);\nendmodule\n");
  CHECK(module_files(scratch.path.string(), "top") ==
        std::vector<std::string>{"common/leaf.sv", "top/top.sv"});
  const auto ports = module_ports(scratch.path.string(), "top");
  REQUIRE(ports.size() == 2);
  CHECK(ports[1].name == "a_o");
  CHECK(ports[1].type == "logic [3:0]");
  CHECK(ports[1].output);
  CHECK(ports[1].meaning == "it (with ports);");
  CHECK_THROWS_WITH(module_files(scratch.path.string(), "nothing"),
                    ContainsSubstring("has no module nothing"));
}

TEST_CASE("a plan takes no option that derives one") {
  const Scratch scratch;
  const std::string plan = scratch / "plan.toml";
  write_plan(gatherer_plan(), plan);
  for (const char* option :
       {"--size 8x8", "--spp 4", "--k 8", "--seed 3", "--define a=b", "--format-error 0.1",
        "--photons 9", "--gather-rays 2", "--radius 1", "--load-photons x.ply"}) {
    INFO(option);
    const std::string name = std::string(option).substr(0, std::string(option).find(' '));
    for (const char* command : {"generate", "plan"}) {
      const Outcome refused =
          run(fmt::format("{} {} {} -o {}", command, plan, option, scratch / "out.toml"));
      CHECK(refused.status == 2);
      CHECK(refused.err.find(name + ": " + plan +
                             " already is a plan; change its lines with --set") !=
            std::string::npos);
    }
  }
  CHECK(run(fmt::format("plan {0} --plan {0}", plan)).status == 2);
  CHECK(run(fmt::format("plan {} --set gather.k=8 -o {}", plan, scratch / "k8.toml")).status == 0);
}

TEST_CASE("a line that no plan has is answered with those that there are") {
  const Scratch scratch;
  const std::string plan = scratch / "plan.toml";
  write_plan(gatherer_plan(), plan);
  const auto said = [&](const char* line) {
    return run(fmt::format("plan {} --set {}", plan, line)).err;
  };
  CHECK(said("gather.kk=3")
            .find("the plan has no line gather.kk, expected one of the keys of gather k, ") !=
        std::string::npos);
  CHECK(said("gathr.k=3")
            .find("the plan has no line gathr.k, expected one of the sections scene, photon, ") !=
        std::string::npos);
  CHECK(said("global.photons=0")
            .find("global.photons is 0, expected at least 1 in a map that is present") !=
        std::string::npos);
}

TEST_CASE("generate leaves folders alone that are no packages") {
  const Scratch scratch;
  const std::string plan = scratch / "plan.toml", hw = scratch / "hw";
  write_plan(gatherer_plan(), plan);
  std::filesystem::create_directory(hw);
  write_file(hw + "/notes.txt", "mine");
  const Outcome refused = run(fmt::format("generate {} -o {}", plan, hw));
  CHECK(refused.status == 1);
  CHECK(refused.err.find(hw + ": is not replaced: it holds files but no package.json") !=
        std::string::npos);
  CHECK(read_file(hw + "/notes.txt") == "mine");
  std::filesystem::remove(hw + "/notes.txt");
  write_file(hw + "/package.json", R"({"name": "somebody's"})");
  CHECK(run(fmt::format("generate {} -o {}", plan, hw)).err.find("package.json is another one") !=
        std::string::npos);
  std::filesystem::remove(hw + "/package.json");
  for (int i = 0; i < 2; ++i) CHECK(run(fmt::format("generate {} -o {}", plan, hw)).status == 0);
}

TEST_CASE("a package of a board that there is not names the file") {
  const Scratch scratch;
  const std::string plan = scratch / "plan.toml", hw = scratch / "hw";
  write_plan(gatherer_plan(), plan);
  REQUIRE(run(fmt::format("generate {} -o {}", plan, hw)).status == 0);
  std::string text = read_file(hw + "/package.json");
  const size_t at = text.find("\"board\": \"\"");
  REQUIRE(at != std::string::npos);
  write_file(hw + "/package.json", text.replace(at, 11, "\"board\": \"foo\""));
  CHECK(run("generate --check " + hw)
            .err.find(hw + "/package.json: board is foo, expected one of arty-a7-100t, "
                           "nexys-video, ulx3s-85f, up5k") != std::string::npos);
  CHECK_THAT(run("generate --check " + hw + " --boards " + scratch / "none").err,
             ContainsSubstring("there is no board foo: " + scratch / "none" +
                               " has no folder with a board.toml"));
}
