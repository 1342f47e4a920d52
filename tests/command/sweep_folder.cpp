// SPDX-License-Identifier: Apache-2.0
// A sweep's folder that holds something else than the sweep would leave there now: figures of other
// settings, measures that failed, damaged images and points, files of the user's own.
#include <fmt/core.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "study/point_table.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"

using namespace photonloom;
using photonloom::test::Outcome;
using photonloom::test::run;
using photonloom::test::Scratch;
using Json = nlohmann::json;

namespace {

// Three points of few photons.
std::string three_points(const std::string& measures = "\"gather\", \"resources\"",
                         const std::string& scenes = "", int queries = 64) {
  return fmt::format(
      "[study]\nname = \"three\"\nscenes = [{}]\nseeds = [1, 2]\nsize = \"8x8\"\nmeasure = [{}]\n"
      "[references]\nspp = 2\n[gather]\nqueries = {}\n[base]\nphotons = 500\n"
      "caustic_photons = 100\nframe.spp = 1\nframe.gather_rays = 2\n"
      "[[points]]\nstrategy = \"list\"\nlines = [{{ gather.k = 8 }}, {{ gather.k = 16 }}]\n",
      scenes.empty() ? "\"" + photonloom::test::source("scenes/cornell.xml") + "\"" : scenes,
      measures, queries);
}

Outcome sweep(const Scratch& s, const std::string& more = "") {
  return run("sweep '" + s / "study.toml" + "' -o '" + s / "a" + "' " + more);
}

Json points(const Scratch& s) { return Json::parse(read_file(s / "a/summary.json"))["points"]; }

std::vector<std::string> states(const Scratch& s) {
  std::vector<std::string> all;
  for (const Json& p : points(s)) all.push_back(p["state"]);
  return all;
}
using States = std::vector<std::string>;

}  // namespace

TEST_CASE("figures of other settings and points without a measure are missing, not done") {
  const Scratch s;
  write_file(s / "study.toml", three_points());
  REQUIRE(sweep(s).status == 0);
  CHECK(states(s) == States{"done", "done", "done"});
  const double lut = points(s)[0]["values"]["resources.lut"]["mean"];
  write_file(s / "study.toml", three_points("\"gather\", \"resources\"", "", 8));
  auto o = sweep(s, "--points 1");
  INFO(o.err);
  REQUIRE(o.status == 0);
  CHECK(o.out.find("2 missing") != std::string::npos);
  CHECK(states(s) == States{"missing", "done", "missing"});
  auto all = points(s);
  CHECK_FALSE(all[0]["values"].contains("gather.cycles"));
  CHECK_FALSE(all[2]["values"].contains("gather.cycles"));
  CHECK(all[1]["values"]["gather.cycles"]["ratio"].is_null());
  // What does not depend on the setting stands.
  CHECK(all[0]["values"]["resources.lut"]["mean"] == lut);
  CHECK(all[1]["values"]["resources.lut"]["ratio"].is_number());
  write_file(s / "study.toml", three_points("\"gather\", \"resources\", \"formats\"", "", 8));
  o = sweep(s, "--points 0");
  INFO(o.err);
  REQUIRE(o.status == 0);
  CHECK(states(s) == States{"done", "missing", "missing"});
  REQUIRE(sweep(s).status == 0);
  CHECK(states(s) == States{"done", "done", "done"});
}

TEST_CASE("a sweep removes what a killed one left half-written, and no file of the user's") {
  const Scratch s;
  write_file(s / "study.toml", three_points("\"resources\""));
  REQUIRE(sweep(s).status == 0);
  const std::string plan = points(s)[0]["plan"];
  const States left = {"points.json.partial-12-0",
                       "results.csv.partial-1-3",
                       "results.sqlite.partial-sqlite",
                       "plans/" + plan + ".toml.partial-7-0",
                       "references/cornell.8x8.1.exr.partial-31-1",
                       "results/" + plan.substr(0, 2) + "/" + std::string(16, 'a') + "-" + plan +
                           "-1.json.partial-77-30"},
               kept = {"thesis.partial-2.pdf",          "thesis.md.partial-1-2",
                       "results.csv.partial-mine",      "notes/my.partial-draft.txt",
                       "notes/points.json.partial-1-2", "plans/mine.toml.partial-1-2",
                       "results/mine.partial-1-2"};
  for (const States& files : {left, kept})
    for (const std::string& file : files) {
      const std::string path = s / ("a/" + file);
      std::filesystem::create_directories(std::filesystem::path(path).parent_path());
      std::ofstream(path) << "y";
    }
  REQUIRE(sweep(s).status == 0);
  for (const std::string& file : left) {
    INFO(file);
    CHECK_FALSE(std::filesystem::exists(s / ("a/" + file)));
  }
  for (const std::string& file : kept) {
    INFO(file);
    CHECK(read_file(s / ("a/" + file)) == "y");
  }
}

TEST_CASE("a measure that fails leaves the stored figures of the others") {
  const Scratch s;
  write_file(s / "study.toml", three_points());
  REQUIRE(sweep(s).status == 0);
  const Json before = points(s);
  write_file(s / "study.toml", three_points("\"gather\", \"resources\", \"visible\""));
  // No image can be written there.
  std::filesystem::create_directories(s / "a/references/cornell.8x8.walks1.exr/in the way");
  const auto failed = sweep(s);
  INFO(failed.err);
  CHECK(failed.status == 1);
  CHECK(states(s) == States{"failed", "failed", "failed"});
  for (size_t i = 0; i < 3; ++i) {
    const Json p = points(s)[i];
    CHECK(p["values"] == before[i]["values"]);
    CHECK(p["reason"].get<std::string>().find("walks1.exr") != std::string::npos);
  }
  // Where nothing asks for the measure any more, nothing is missing.
  write_file(s / "study.toml", three_points());
  const auto without = sweep(s);
  CHECK(without.status == 0);
  CHECK(without.out.find("0 results computed") != std::string::npos);
  CHECK(points(s) == before);
  write_file(s / "study.toml", three_points("\"gather\", \"resources\", \"visible\""));
  std::filesystem::remove_all(s / "a/references/cornell.8x8.walks1.exr");
  const auto again = sweep(s);
  INFO(again.err);
  CHECK(again.status == 0);
  CHECK(again.err.find("failed before (") != std::string::npos);
  CHECK(states(s) == States{"done", "done", "done"});
  CHECK(points(s)[1]["values"]["gather.cycles"] == before[1]["values"]["gather.cycles"]);
}

TEST_CASE("a damaged image that the sweep made is made again, and that is said; a user's is not") {
  const Scratch s;
  write_file(s / "study.toml", three_points("\"visible\""));
  REQUIRE(sweep(s).status == 0);
  const Json before = points(s);
  const std::string reference = s / "a/references/cornell.8x8.1.exr",
                    walks = s / "a/references/cornell.8x8.walks1.exr";
  const std::string whole = read_file(reference);
  REQUIRE(whole.size() > 300);
  std::filesystem::remove_all(s / "a/results");  // or the walks are not read
  std::filesystem::resize_file(reference, 300);
  std::filesystem::resize_file(walks, 0);
  const auto o = sweep(s);
  INFO(o.err);
  CHECK(o.status == 0);
  for (const std::string& file : {reference, walks}) {
    const size_t at = o.err.find(file + ": ");
    REQUIRE(at != std::string::npos);
    CHECK(o.err.substr(at, o.err.find('\n', at) - at).ends_with("; it is made again"));
  }
  CHECK(read_file(reference) == whole);
  CHECK(points(s) == before);
  std::filesystem::copy(s / "a/references", s / "given");
  std::filesystem::resize_file(s / "given/cornell.8x8.1.exr", 300);
  std::string text = three_points("\"visible\"");
  text.replace(text.find("spp = 2"), 7, "files = \"given/{scene}.8x8.{n}.exr\"");
  write_file(s / "study.toml", text);
  const auto given = sweep(s);
  CHECK(given.status == 1);
  CHECK(given.err.find("given/cornell.8x8.1.exr: ") != std::string::npos);
  CHECK(std::filesystem::file_size(s / "given/cornell.8x8.1.exr") == 300);
}

TEST_CASE("points that were edited or damaged are planned again, and that is said") {
  const Scratch s;
  write_file(s / "study.toml", three_points("\"resources\""));
  REQUIRE(sweep(s).status == 0);
  const std::string file = s / "a/points.json", table = read_file(file);
  const Json before = points(s);
  const auto goes_on = [&](const std::string& text) {
    INFO(text);
    write_file(file, text);
    const auto o = sweep(s);
    INFO(o.err);
    CHECK(o.status == 0);
    CHECK(o.err.find("points.json: cannot be read; points are planned again") != std::string::npos);
    CHECK(read_file(file) == table);
    CHECK(points(s) == before);
  };
  const auto with = [&](const std::string& from, const std::string& to) {
    const size_t at = table.find(from);
    REQUIRE(at != std::string::npos);
    return table.substr(0, at) + to + table.substr(at + from.size());
  };
  goes_on(with("\"point\": 1", "\"point\": 99999"));
  goes_on(with("\"scene\": 0", "\"scene\": 7"));
  goes_on(with("\"refused\": \"\"", "\"refused\": \"why\""));
  goes_on(with("\"16\"", "\"17\""));
  goes_on(Json::parse(table).dump());
  Json fewer = Json::parse(table);
  fewer.erase("check");  // as written before there was one
  goes_on(fewer.dump(1) + "\n");
  fewer["points"].erase(2);
  goes_on(fewer.dump(1) + "\n");
  // With a checksum that fits, bounds hold all the same.
  PointTable changed = parse_point_table(table);
  changed.points[1].point.number = 99999;
  goes_on(point_table_text(changed));
  changed = parse_point_table(table);
  changed.points[2].point.scene = 7;
  goes_on(point_table_text(changed));
  changed = parse_point_table(table);
  changed.points.pop_back();
  goes_on(point_table_text(changed));
}

TEST_CASE("scenes of equal content share results, and are refused with different references") {
  const Scratch s;
  std::filesystem::create_directory_symlink(photonloom::test::source("scenes/meshes"),
                                            s / "meshes");
  for (const char* name : {"one", "two"})
    write_file(s / (std::string(name) + ".xml"),
               read_file(photonloom::test::source("scenes/cornell.xml")));
  std::string text = three_points("\"visible\"", "\"one.xml\", \"two.xml\"");
  write_file(s / "study.toml", text);
  const auto shared = sweep(s);
  INFO(shared.err);
  REQUIRE(shared.status == 0);
  CHECK(shared.out.find("6 results computed") != std::string::npos);
  CHECK(points(s)[0]["values"] == points(s)[3]["values"]);
  for (const char* n : {"1", "2"})
    std::filesystem::copy_file(s / ("a/references/one.8x8." + std::string(n) + ".exr"),
                               s / ("one." + std::string(n) + ".exr"));
  std::filesystem::copy_file(s / "one.1.exr", s / "two.2.exr");
  std::filesystem::copy_file(s / "one.2.exr", s / "two.1.exr");
  text.replace(text.find("spp = 2"), 7, "files = \"{scene}.{n}.exr\"");
  write_file(s / "study.toml", text);
  const auto other = sweep(s);
  INFO(other.err);
  CHECK(other.status == 1);
  CHECK(other.err.find("scene two: " + s / "two.xml" + " has the same content as " + s / "one.xml" +
                       " but other references") != std::string::npos);
  CHECK(states(s) == States{"done", "done", "done", "failed", "failed", "failed"});
}

TEST_CASE("commands of a study that was moved with its scene name the scene where it is") {
  const Scratch s;
  std::filesystem::create_directories(s / "m1");
  std::filesystem::create_directory_symlink(photonloom::test::source("scenes/meshes"),
                                            s / "m1/meshes");
  write_file(s / "m1/box.xml", read_file(photonloom::test::source("scenes/cornell.xml")));
  write_file(s / "m1/study.toml", three_points("\"resources\"", "\"box.xml\""));
  const auto swept = [&](const std::string& folder) {
    const auto o = run("sweep '" + s / (folder + "/study.toml") + "' -o '" + s / "a" + "'");
    INFO(o.err);
    REQUIRE(o.status == 0);
    for (const Json& p : points(s))
      CHECK(p["command"].get<std::string>().find(s / (folder + "/box.xml")) != std::string::npos);
    return o;
  };
  swept("m1");
  std::filesystem::rename(s / "m1", s / "m2");
  CHECK(swept("m2").out.find("0 results computed") != std::string::npos);
}

TEST_CASE("points of a search that has not run are refused by number") {
  const Scratch s;
  std::string text = three_points("\"resources\"");
  text = text.substr(0, text.find("[[points]]")) +
         "[[points]]\nstrategy = \"search\"\npopulation = 2\ngenerations = 2\n"
         "objectives = [\"resources.lut\"]\nlines.gather.k = { from = 2, to = 40 }\n";
  write_file(s / "study.toml", text);
  // Nothing is proposed here, so that a library which is there suffices.
  std::filesystem::create_directories(s / "bin");
  write_file(s / "bin/python3", "#!/bin/sh\nexit 0\n");
  std::filesystem::permissions(s / "bin/python3", std::filesystem::perms::owner_all);
  const std::string path = photonloom::test::environment("PATH");
  setenv("PATH", (s / "bin:" + path).c_str(), 1);
  const auto baseline = sweep(s, "--points 0"), proposed = sweep(s, "--points 0,3");
  setenv("PATH", path.c_str(), 1);
  CHECK(baseline.status == 0);
  CHECK(proposed.status == 1);
  CHECK(proposed.one_error_line());
  CHECK(proposed.err.find("--points: 3 is a point of a search, which has not proposed it yet; "
                          "expected a sweep without --points first") != std::string::npos);
}

TEST_CASE("references: marks in a scene's name are the name's, and equal files are named") {
  const Scratch s;
  std::filesystem::create_directory_symlink(photonloom::test::source("scenes/meshes"),
                                            s / "meshes");
  write_file(s / "a{scene}b{n}.xml", read_file(photonloom::test::source("scenes/cornell.xml")));
  std::string text = three_points("\"visible\"", "\"a{scene}b{n}.xml\"");
  write_file(s / "study.toml", text);
  REQUIRE(sweep(s).status == 0);
  text.replace(text.find("spp = 2"), 7, "files = \"{scene}.{n}.exr\"");
  write_file(s / "study.toml", text);
  const auto missing = sweep(s);
  INFO(missing.err);
  CHECK(missing.status == 1);
  CHECK(missing.err.find(s / "a{scene}b{n}.1.exr" + ": cannot be read") != std::string::npos);
  for (const char* n : {"1", "2"})
    std::filesystem::copy_file(s / "a/references/a{scene}b{n}.8x8.1.exr",
                               s / ("a{scene}b{n}." + std::string(n) + ".exr"));
  const auto equal = sweep(s);
  INFO(equal.err);
  CHECK(equal.status == 1);
  CHECK(equal.err.find(s / "a{scene}b{n}.2.exr" + ": is the same image as " +
                       s / "a{scene}b{n}.1.exr" + ", expected two references of different seeds") !=
        std::string::npos);
}

TEST_CASE("what stands in a sweep's way in its folder is named, with what was expected") {
  const Scratch s;
  write_file(s / "study.toml", three_points("\"resources\""));
  REQUIRE(sweep(s).status == 0);
  std::filesystem::rename(s / "a/plans", s / "plans");
  write_file(s / "a/plans", "");
  const auto plans = sweep(s);
  INFO(plans.err);
  CHECK(plans.status == 1);
  CHECK(plans.err.find("photonloom: " + s / "a/plans" + ": cannot be made a folder (") !=
        std::string::npos);
  std::filesystem::remove(s / "a/plans");
  std::filesystem::rename(s / "plans", s / "a/plans");
  std::filesystem::remove(s / "a/results.sqlite");
  std::filesystem::create_directories(s / "a/results.sqlite/in the way");
  const auto database = sweep(s);
  CHECK(database.status == 1);
  CHECK(database.one_error_line());
  CHECK(database.err.find(s / "a/results.sqlite" + ": cannot be put in place (") !=
        std::string::npos);
  std::filesystem::remove_all(s / "a/results.sqlite");
  write_file(s / "study.toml", three_points("\"visible\""));
  write_file(s / "a/references", "");
  const auto references = sweep(s);
  CHECK(references.status == 1);
  CHECK(references.err.find(s / "a/references" + ": cannot be made a folder (") !=
        std::string::npos);
}

TEST_CASE("study files of one name would share a folder, and are refused") {
  const Scratch s;
  for (const char* folder : {"d1", "d2"}) {
    std::filesystem::create_directories(s / folder);
    std::string text = three_points("\"layouts\"");
    write_file(s / (std::string(folder) + "/s.toml"), text);
  }
  const auto o = run("study layouts --study '" + s / "d1/s.toml" + "' --study '" + s / "d2/s.toml" +
                     "' -o '" + s / "a" + "'");
  INFO(o.err);
  CHECK(o.status == 1);
  CHECK(o.one_error_line());
  CHECK(o.err.find("--study " + s / "d2/s.toml" +
                   ": a study file of the name s is there already") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(s / "a"));
}
