// SPDX-License-Identifier: Apache-2.0
// Numbers that are none, or of the wrong sign, are refused with the name of their option before
// anything is done.
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
      {"compare x.exr x.exr", "--max-rmse", "nan"},
  };
  for (const auto& r : refused) {
    INFO(r.command << " " << r.option << " " << r.value);
    const Outcome o = run(r.command + " " + r.option + " " + r.value);
    CHECK(o.status == 2);
    CHECK_THAT(o.err, ContainsSubstring(r.option + ":"));
    CHECK(s.entries() == 1);
  }
}
