// SPDX-License-Identifier: Apache-2.0
// Numbers that are none, or of the wrong sign, are refused with the name of their option before
// anything is done.
#include <regex>
#include <set>

#include "golden/plan/plan_file.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"

using namespace photonloom;
using namespace photonloom::test;

TEST_CASE("what is no number is refused by the name of its option") {
  const Scratch s;
  write_plan(Plan{}, s / "plan.toml");
  const std::string plan = "'" + s / "plan.toml" + "'", out = "'" + s / "out" + "'";
  const std::string scene = "'" + source("scenes/cornell.xml") + "'";
  const std::string frame = " --size 2x2 --spp 1 --photons 100 --gather-rays 1 ";
  const struct {
    std::string command, option, value;
  } refused[] = {
      {"generate " + plan + " -o " + out + " --board ulx3s-85f", "--clock", "nan"},
      {"generate " + plan + " -o " + out + " --board ulx3s-85f", "--clock", "inf"},
      {"generate " + plan + " -o " + out + " --board ulx3s-85f", "--clock", "0"},
      {"board info /dev/null", "--board-wait", "nan"},
      {"board info /dev/null", "--board-wait", "-1"},
      {"board replay /dev/null " + scene, "--board-wait", "NaN"},
      {"board replay /dev/null " + scene, "--queries", "nan"},
      {"board replay /dev/null " + scene, "--skip", "-1"},
      {"cosim " + scene + frame + "--backend photon_gatherer=board:/dev/null", "--board-wait",
       "nan"},
      {"cosim " + scene + frame + "-o " + out, "--timeline", "-1"},
      {"cosim " + scene + frame + "-o " + out, "--watchdog", "-1"},
      {"cosim " + scene + frame + "-o " + out, "--bank-cycles", "nan"},
      {"render " + scene + frame + "-o " + out, "--radius", "nan"},
      {"render " + scene + frame + "-o " + out, "--format-error", "nan"},
      {"render " + scene + " -o " + out, "--spp", "nan"},
      {"sheet x.exr -o x.png", "--exposure", "nan"},
      {"sheet x.exr -o x.png", "--exposure", "101"},
      {"compare x.exr x.exr", "--max-rmse", "nan"},
      {"compare x.exr x.exr", "--max-rmse", "1e-999"},
      {"compare x.exr x.exr", "--max-rmse", "-1"},
      {"compare x.exr x.exr", "--max-relmse", "-0.001"},
      {"compare x.exr x.exr", "--max-mape", "-1e-30"},
      {"compare x.exr x.exr", "--max-mean-ratio", "-1"},
      {"compare x.exr x.exr", "--max-mean-ratio-rgb", "-1"},
      {"compare x.exr x.exr", "--max-flip", "-1"},
      {"compare x.exr x.exr", "--max-flip", "1.5"},
      {"compare x.exr x.exr", "--min-psnr", "nan"},
      {"compare x.exr x.exr", "--min-psnr", "0x10"},
      {"compare x.exr x.exr", "--max-flip", " 1"},
      {"gather --photons x --queries x -o " + out, "--radius", "nan"},
      {"gather --photons x --queries x -o " + out, "--radius", "-1"},
      {"gather --photons x --queries x -o " + out, "--radius", "1e-999"},
      {"gather --photons x --queries x -o " + out, "--radius", "5 "},
      {"board info /dev/null", "--board-wait", "0x10"},
      {"generate " + plan + " -o " + out + " --board ulx3s-85f", "--clock", " 25"},
  };
  for (const auto& r : refused) {
    INFO(r.command << " " << r.option << " " << r.value);
    const Outcome o = run(r.command + " " + r.option + "='" + r.value + "'");
    INFO(o.err);
    CHECK(o.status == 2);
    CHECK_THAT(o.err, ContainsSubstring(r.option + ":") &&
                          ContainsSubstring("'" + r.value + "', expected"));
    CHECK(s.entries() == 1);
  }
}

TEST_CASE("no seed wraps or saturates, whatever its option is called") {
  const std::string packets = "replay reorder_buffer --plan x.toml --packets x.jsonl -o y.jsonl ";
  for (const auto& [command, option] :
       {std::pair<std::string, std::string>{"cosim x.xml", "--seed"},
        {"cosim x.xml", "--rig-seed"},
        {"cosim x.xml", "--initial-seed"},
        {packets, "--seed"},
        {packets, "--initial-seed"},
        {"plan x.xml -o y.toml --error 0.1", "--check"},
        {"photons x.xml -o y.ply", "--seed"}})
    for (const std::string value : {"-1", "-5", "18446744073709551616", "99999999999999999999999",
                                    "0x10", " 5", "5 ", "1e3"}) {
      const Outcome o = run(command + " " + option + "='" + value + "'");
      INFO(command << " " << option << "='" << value << "'\n" << o.err);
      CHECK(o.status == 2);
      CHECK_THAT(o.err, ContainsSubstring(option + ": '" + value +
                                          "', expected an integer from 0 to 2^64 - 1"));
    }
}

// The commands that `command --help` lists, itself first, and those below them.
static std::vector<std::string> commands_below(const std::string& command) {
  std::vector<std::string> all{command};
  const Outcome help = run(command + " --help");
  REQUIRE(help.status == 0);
  const size_t list = help.out.find("Subcommands:");
  if (list == std::string::npos) return all;
  std::istringstream lines(help.out.substr(list, help.out.find("\n\n", list) - list));
  const std::regex name(R"(^  ([a-z][a-z-]*) .*)");
  std::smatch match;
  for (std::string line; std::getline(lines, line);)
    if (std::regex_match(line, match, name))
      for (const std::string& below : commands_below(command + " " + match[1].str()))
        all.push_back(below);
  return all;
}

TEST_CASE("no integer option of any command wraps, saturates or cuts what it is given") {
  const std::regex integer(R"((--[a-z0-9-]+) \S*?:?(U?INT) in \[(-?\d+) - (\d+)\])");
  std::set<std::string> seen;
  for (const std::string& command : commands_below("")) {
    const std::string help = run(command + " --help").out;
    for (std::sregex_iterator i(help.begin(), help.end(), integer), end; i != end; ++i) {
      const std::string option = (*i)[1];
      const __int128 low = std::stoll((*i)[3]);
      const __int128 high = static_cast<__int128>(std::stoull((*i)[4]));
      seen.insert(option);
      std::vector<std::string> values{"-18446744073709551615",
                                      "-18446744073709551616",
                                      "18446744073709551616",
                                      "18446744073709551617",
                                      "-9223372036854775809",
                                      "340282366920938463463374607431768211457",
                                      "4294967297.0",
                                      "1e1",
                                      "0x1",
                                      "1 ",
                                      "+-1",
                                      "nan"};
      if (high < (__int128{1} << 62))
        values.push_back(std::to_string(static_cast<int64_t>(high) + 1));
      if (low > -(__int128{1} << 62))
        values.push_back(std::to_string(static_cast<int64_t>(low) - 1));
      for (const std::string& value : values) {
        const Outcome o = run(command + " " + option + "='" + value + "'");
        INFO(command << " " << option << "=" << value << "\n" << o.err);
        CHECK(o.status == 2);
        CHECK_THAT(o.err, ContainsSubstring(option + ":"));
      }
    }
  }
  for (const char* option : {"--photons", "--spp", "--gather-rays", "--threads", "--watchdog"}) {
    INFO(option << " is found as an integer option");
    CHECK(seen.count(option) == 1);
  }
}
