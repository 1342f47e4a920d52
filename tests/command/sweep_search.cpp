// SPDX-License-Identifier: Apache-2.0
// The strategy `search`: Optuna's NSGA-II where there is one, a sentence where there is none.
#include "tests/catch.hpp"
#include "tests/command/run.hpp"

using namespace photonloom;
using photonloom::test::run;
using photonloom::test::Scratch;

TEST_CASE("a search proposes the same points again, or says that Optuna is missing") {
  const Scratch s;
  write_file(s / "study.toml",
             "[study]\nname = \"search\"\nscenes = [\"" +
                 photonloom::test::source("scenes/cornell.xml") +
                 "\"]\nseeds = [1]\nsize = \"8x8\"\nmeasure = [\"formats\", \"resources\"]\n"
                 "[base]\nphotons = 1000\nframe.spp = 1\nframe.gather_rays = 4\n"
                 "[[points]]\nstrategy = \"search\"\npopulation = 4\ngenerations = 3\nseed = 5\n"
                 "objectives = [\"formats.relmse\", \"resources.gatherer_lut\"]\n"
                 "lines.gather.k = { from = 2, to = 40 }\n"
                 "lines.photon.position_bits = { from = 8, to = 16 }\n");
  const std::string sweep = "sweep '" + s / "study.toml" + "' -o '";
  const auto a = run(sweep + s / "a" + "'");
  INFO(a.err);
  if (a.status == 1 && a.err.find("needs Optuna") != std::string::npos) {
    REQUIRE(a.one_error_line());
    WARN("the whole test is skipped: there is no Optuna here");
    return;
  }
  REQUIRE(a.status == 0);
  CHECK(a.out.find("13 points") != std::string::npos);
  const std::string csv = read_file(s / "a/results.csv");
  CHECK(csv.find(",search seed 5,done,") != std::string::npos);
  // Some of it lost, as where it was killed: the same points come again.
  REQUIRE(run(sweep + s / "b" + "' --points 0").status == 0);
  REQUIRE(run(sweep + s / "b" + "'").status == 0);
  for (const char* table : {"/results.csv", "/results.sqlite", "/summary.json"})
    CHECK(read_file(s / ("a" + std::string(table))) == read_file(s / ("b" + std::string(table))));
}
