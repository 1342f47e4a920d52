// SPDX-License-Identifier: Apache-2.0
// What a study file's lines become in its points.
#include <set>
#include <string>

#include "study/measures.hpp"
#include "study/points.hpp"
#include "tests/catch.hpp"

using namespace photonloom;

namespace {

std::vector<Point> points_of(const std::string& sets, const std::string& seeds = "[1]") {
  const std::string head = "[study]\nname = \"lines\"\nscenes = [\"no.xml\"]\nseeds = " + seeds +
                           "\nsize = \"4x4\"\n"
                           "measure = [\"resources\"]\n";
  return fixed_points(parse_study(head + sets, "study.toml", measure_names()), 0);
}

}  // namespace

TEST_CASE("whether a range is of integers follows from the line, however its ends are written") {
  const auto values = [](const std::string& line) {
    std::set<std::string> all;
    for (const Point& p :
         points_of("[[points]]\nstrategy = \"latin_hypercube\"\ncount = 6\n" + line))
      if (!p.lines.empty()) all.insert(p.lines[0].second);
    return all;
  };
  const auto same = [&](const std::string& line, const std::string& integers,
                        const std::string& reals) {
    const auto found = values("lines." + line + " = { " + integers + " }\n");
    CHECK(found == values("lines." + line + " = { " + reals + " }\n"));
    CHECK(found.size() == 6);
    for (const std::string& value : found) CHECK(value.find('.') != std::string::npos);
  };
  same("radius_scale", "from = 1, to = 3", "from = 1.0, to = 3.0");
  same("global.radius", "from = 1, to = 3, log = true", "from = 1.0, to = 3.0, log = true");
  using Values = std::set<std::string>;
  CHECK(values("lines.gather.k = { from = 1, to = 3 }\n") == Values{"1", "2", "3"});
  CHECK(values("lines.photons = { from = 1, to = 2 }\n") == Values{"1", "2"});
  CHECK(values("lines.\"photon.direction_bits+gather.normal_bits\" = { from = 5, to = 6 }\n") ==
        Values{"5", "6"});
}

TEST_CASE("an integer may be written as TOML allows in any line, and is kept in decimal digits") {
  const auto points = points_of(
      "[base]\nphotons = 0x200\n[[points]]\nstrategy = \"list\"\n"
      "lines = [{ photons = 0x200, gather.k = 0x8 }, { caustic_photons = 1_000 }, { photons = "
      "0b11 }]\n[[points]]\nstrategy = \"grid\"\nlines = { radius_scale = [0x2], gather.k = [0o17] "
      "}\n");
  REQUIRE(points.size() == 5);
  CHECK(points[1].lines == LineValues{{"photons", "512"}, {"gather.k", "8"}});
  CHECK(points[2].lines == LineValues{{"caustic_photons", "1000"}});
  CHECK(points[3].lines == LineValues{{"photons", "3"}});
  CHECK(points[4].lines == LineValues{{"radius_scale", "2"}, {"gather.k", "15"}});
}

TEST_CASE("a baseline has the seeds that a point of its scene has, and no more") {
  const std::string set = "[[points]]\nstrategy = \"list\"\nlines = [{ gather.k = 8 }]\n";
  const auto baseline = [&](const std::string& sets) {
    return points_of(sets, "[1, 2, 3, 4]")[0].seeds;
  };
  CHECK(baseline(set + "seeds = 2\n") == 2);
  CHECK(baseline(set + "seeds = 1\n" + set + "seeds = 3\n") == 3);
  CHECK(baseline(set + "seeds = 2\n" + set) == 0);  // all
  CHECK(baseline("") == 0);
}
