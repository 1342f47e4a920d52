// SPDX-License-Identifier: Apache-2.0
// Sweeps as a user runs them: killed and gone on with, two on a folder, damaged results, bad
// studies, a full disk.
#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <thread>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "golden/numeric/random.hpp"
#include "study/point_table.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"
#include "tests/fault_report.hpp"

using namespace photonloom;
using photonloom::test::FaultRow;
using photonloom::test::report;
using photonloom::test::run;
using photonloom::test::Scratch;
using photonloom::test::source;

namespace {

// A few points that take a moment each.
std::string small_study(const std::string& scenes, const std::string& more = "") {
  return "[study]\nname = \"small\"\nscenes = [" + scenes +
         "]\nseeds = [1, 2]\nsize = \"12x12\"\n"
         "measure = [\"visible\", \"formats\", \"gather\", \"resources\"]\n"
         "[references]\nspp = 4\n[gather]\nqueries = 64\n"
         "[base]\nphotons = 2000\ncaustic_photons = 2000\nframe.spp = 2\nframe.gather_rays = 4\n" +
         more;
}
std::string cornell() { return "\"" + photonloom::test::source("scenes/cornell.xml") + "\""; }
const char* const kPoints =
    "[[points]]\nstrategy = \"grid\"\n"
    "lines = { gather.k = [4, 8, 16], photon.position_bits = [8, 12, 16] }\n"
    "[[points]]\nstrategy = \"latin_hypercube\"\ncount = 4\nseed = 7\n"
    "lines.gather.k = { from = 3, to = 40, log = true }\n"
    "lines.photon.mantissa_bits = { from = 4, to = 9 }\n"
    "lines.radius_scale = { from = 0.5, to = 2.0 }\n";

std::vector<std::string> tables(const std::string& folder) {
  std::vector<std::string> all;
  for (const char* name : {"results.sqlite", "results.csv", "summary.json"})
    all.push_back(read_file(folder + "/" + name));
  return all;
}

std::vector<std::string> result_files(const std::string& folder) {
  std::vector<std::string> files;
  for (const auto& e : std::filesystem::recursive_directory_iterator(folder + "/results"))
    if (e.is_regular_file()) files.push_back(e.path().string());
  std::sort(files.begin(), files.end());
  return files;
}

std::string command(const std::string& study, const std::string& folder) {
  return "sweep '" + study + "' -o '" + folder + "'";
}

}  // namespace

TEST_CASE("a sweep that was killed at random moments ends with an uninterrupted one's tables",
          "[slow]") {
  const Scratch s;
  write_file(s / "study.toml", small_study(cornell(), kPoints));
  const auto start = std::chrono::steady_clock::now();
  const auto whole = run(command(s / "study.toml", s / "whole"));
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
  INFO(whole.err);
  REQUIRE(whole.status == 0);
  // Each goes on where the one before it was killed, so that all are at work when they are.
  FaultRow row;
  row.fault = "killed (signal 9)";
  row.where = "a sweep";
  for (uint64_t round = 0; round < 10; ++round) {
    const pid_t child = fork();
    if (child == 0) {
      if (!freopen("/dev/null", "w", stdout) || !freopen("/dev/null", "w", stderr)) _exit(1);
      const std::string program = photonloom::test::environment("PHOTONLOOM"),
                        study = s / "study.toml", folder = s / "killed";
      execl(program.c_str(), "photonloom", "sweep", study.c_str(), "-o", folder.c_str(),
            static_cast<char*>(nullptr));
      _exit(127);
    }
    const auto wait = static_cast<int>(0.9 * took.count() * to_unit(hash_bits(1, round, 0, 0)));
    std::this_thread::sleep_for(std::chrono::milliseconds(wait));
    kill(child, SIGKILL);
    int status = 0;
    REQUIRE(waitpid(child, &status, 0) == child);
    ++row.injected;
    WIFSIGNALED(status) ? ++row.detected : ++row.harmless;
  }
  CHECK(row.detected > 0);
  const auto again = std::chrono::steady_clock::now();
  const auto rest = run(command(s / "study.toml", s / "killed"));
  const std::chrono::duration<double> rest_took = std::chrono::steady_clock::now() - again;
  INFO(rest.err);
  REQUIRE(rest.status == 0);
  const std::vector<std::string> expected = tables(s / "whole"), found = tables(s / "killed");
  for (size_t i = 0; i < expected.size(); ++i) row.wrong += found[i] != expected[i];
  CHECK(row.wrong == 0);
  row.recovery =
      fmt::format("{:.1f} s of the same command, which goes on: {}; a sweep of all takes {:.1f} s",
                  rest_took.count(), rest.out.substr(0, rest.out.find(';')), took.count() / 1000);
  report(row);
  CHECK(result_files(s / "killed").size() == result_files(s / "whole").size());
  for (const std::string& f : result_files(s / "killed"))
    CHECK(f.find(".partial-") == std::string::npos);
}

TEST_CASE("points of some scenes only") {
  const Scratch s;
  const std::string both =
      cornell() + ", \"" + photonloom::test::source("scenes/cornell_glossy.xml") + "\"";
  write_file(s / "study.toml",
             small_study(both,
                         "[[points]]\nstrategy = \"list\"\nscenes = [\"cornell_glossy\"]\n"
                         "lines = [{ gather.k = 4 }]\n"
                         "[[points]]\nstrategy = \"list\"\nlines = [{ gather.k = 8 }]\n"));
  const auto o = run(command(s / "study.toml", s / "a"));
  INFO(o.err);
  REQUIRE(o.status == 0);
  const auto summary = nlohmann::json::parse(read_file(s / "a/summary.json"));
  std::vector<std::string> points;
  for (const auto& p : summary["points"]) {
    points.push_back(p["scene"].get<std::string>());
    for (const auto& [line, value] : p["lines"].items())
      points.back() += " " + value.get<std::string>();
    CHECK(p["point"] == points.size() - 1);
    CHECK(p["state"] == "done");
  }
  CHECK(points == std::vector<std::string>{"cornell", "cornell 8", "cornell_glossy",
                                           "cornell_glossy 4", "cornell_glossy 8"});
}

TEST_CASE("points and measures with the first seeds alone") {
  const Scratch s;
  std::string text =
      small_study(cornell(),
                  "[[points]]\nstrategy = \"list\"\nseeds = 2\nlines = [{ gather.k = 8 }]\n"
                  "[[points]]\nstrategy = \"list\"\nseeds = 1\nlines = [{ gather.k = 16 }]\n");
  text.replace(text.find("[1, 2]"), 6, "[1, 2, 3]");
  text.replace(text.find("queries = 64"), 12, "queries = 64\nseeds = 1\n[formats]\nseeds = 1");
  write_file(s / "study.toml", text);
  const auto o = run(command(s / "study.toml", s / "a"));
  INFO(o.err);
  REQUIRE(o.status == 0);
  const std::string host = read_file(s / "a/host.csv");
  std::vector<std::string> rows;
  for (size_t at = host.find('\n') + 1; at < host.size(); at = host.find('\n', at) + 1)
    rows.push_back(host.substr(at, host.find(',', host.find(',', at) + 1) - at));
  CHECK(rows == std::vector<std::string>{"0,1", "0,2", "1,1", "1,2", "2,1"});
  for (const std::string& file : result_files(s / "a")) {
    const std::string result = read_file(file);
    const bool first = file.ends_with("-1.json");
    CHECK((result.find("\"gather\"") != std::string::npos) == first);
    CHECK((result.find("\"formats\"") != std::string::npos) == first);
    CHECK(result.find("\"visible\"") != std::string::npos);
  }
}

TEST_CASE("figures of seeds that a study does not ask for are no part of its tables") {
  const Scratch s;
  const std::string all =
      small_study(cornell(), "[[points]]\nstrategy = \"list\"\nlines = [{ gather.k = 8 }]\n");
  std::string fewer = all;
  fewer.replace(fewer.find("queries = 64"), 12, "queries = 4\nseeds = 1");
  for (const auto& [text, folder] :
       {std::pair(all, "a"), std::pair(fewer, "a"), std::pair(fewer, "b")}) {
    write_file(s / "study.toml", text);
    const auto o = run(command(s / "study.toml", s / folder));
    INFO(o.err);
    REQUIRE(o.status == 0);
  }
  CHECK(tables(s / "a") == tables(s / "b"));
}

TEST_CASE("a point of fewer seeds is on no front by the luck of these") {
  // One distance a cycle is the same image in more cycles. In one of both orders the first seed has
  // less error than the mean of both.
  for (const char* seeds : {"[1, 2]", "[2, 1]"}) {
    const Scratch s;
    std::string text = small_study(
        cornell(),
        "[[points]]\nstrategy = \"list\"\nlines = [{ gather.k = 8 }]\n"
        "[[points]]\nstrategy = \"list\"\nseeds = 1\nlines = [{ gatherer.lanes = 1 }]\n");
    text.replace(text.find("[1, 2]"), 6, seeds);
    write_file(s / "study.toml", text);
    const auto o = run(command(s / "study.toml", s / "a"));
    INFO(o.err);
    REQUIRE(o.status == 0);
    const auto summary = nlohmann::json::parse(read_file(s / "a/summary.json"));
    const auto& point = summary["points"][2];
    REQUIRE(point["lines"]["gatherer.lanes"] == "1");
    CHECK(point["seeds"] == 1);
    CHECK(point["values"]["gather.cycles"]["ratio"] > 1);
    // Fewer lanes take less logic, so that front is its own.
    CHECK(point["front"] == nlohmann::json({"lut"}));
  }
}

TEST_CASE("array jobs without Slurm are refused before anything is written") {
  const Scratch s;
  write_file(s / "study.toml", small_study(cornell(), kPoints));
  const std::string path = getenv("PATH");
  setenv("PATH", s.path.c_str(), 1);
  const auto refused = run(command(s / "study.toml", s / "a") + " --on slurm");
  setenv("PATH", path.c_str(), 1);
  CHECK(refused.status == 1);
  CHECK(refused.err.find("--on slurm needs sbatch, which is not in PATH") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(s / "a"));

  // Nor is anything written into one that is there; without a missing point there are no jobs.
  REQUIRE(run(command(s / "study.toml", s / "a") + " --points 3").status == 0);
  setenv("PATH", s.path.c_str(), 1);
  const auto some = run(command(s / "study.toml", s / "a") + " --on slurm");
  const auto none = run(command(s / "study.toml", s / "a") + " --points 3 --on slurm");
  setenv("PATH", path.c_str(), 1);
  CHECK(some.status == 1);
  CHECK(some.err.find("--on slurm needs sbatch") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(s / "a/slurm"));
  INFO(none.err);
  CHECK(none.status == 0);
}

TEST_CASE("what Slurm's commands say beside a job's number is no part of it") {
  const Scratch s;
  write_file(s / "study.toml", small_study(cornell(), kPoints));
  std::filesystem::create_directory(s / "bin");
  const auto tool = [&](const std::string& name, const std::string& text) {
    write_file(s / ("bin/" + name), "#!/bin/sh\n" + text);
    std::filesystem::permissions(s / ("bin/" + name), std::filesystem::perms::owner_all);
  };
  // The job is done when it is asked for the first time.
  tool("sbatch",
       "echo 'news of the site' >&2\nfor job; do :; done\nn=$(wc -l <\"$(dirname "
       "\"$job\")/points\")\n"
       "i=0; while [ $i -lt $n ]; do SLURM_ARRAY_TASK_ID=$i sh \"$job\" >&2; i=$((i + 1)); done\n"
       "echo '4242;here'\n");
  tool("squeue",
       "echo 'more news' >&2\ncase \"$*\" in *--jobs=4242\\ *) ;; *) echo 'no such job' ;; esac\n");
  const std::string path = getenv("PATH");
  setenv("PATH", (s / "bin" + ":" + path).c_str(), 1);
  const auto done = run(command(s / "study.toml", s / "a") + " --on slurm");
  tool("sbatch", "echo 'welcome'\n");
  const auto odd = run(command(s / "study.toml", s / "b") + " --on slurm");
  setenv("PATH", path.c_str(), 1);
  INFO(done.err);
  CHECK(done.status == 0);
  CHECK(odd.status == 1);
  CHECK(odd.err.find("sbatch: 'welcome' is not the number of a job") != std::string::npos);
}

TEST_CASE("points by hand, then the rest") {
  const Scratch s;
  write_file(s / "study.toml", small_study(cornell(), kPoints));
  const auto some = run(command(s / "study.toml", s / "a") + " --points 3,5-6");
  INFO(some.err);
  REQUIRE(some.status == 0);
  CHECK(result_files(s / "a").size() == 6);
  CHECK(some.out.find("11 missing") != std::string::npos);
  REQUIRE(run(command(s / "study.toml", s / "a")).status == 0);
  REQUIRE(run(command(s / "study.toml", s / "b")).status == 0);
  CHECK(tables(s / "a") == tables(s / "b"));
  for (const char* folder : {"a", "new"}) {
    const auto beyond = run(command(s / "study.toml", s / folder) + " --points 14");
    CHECK(beyond.status == 2);
    CHECK(beyond.one_error_line());
    CHECK(beyond.err.find("expected 0 to 13") != std::string::npos);
  }
  for (const char* list : {"-1", "1-", "", ",", "1,", "2-1", "x", "1.5", "4294967296",
                           "18446744073709551616", "-18446744073709551616", "0x1", "1 "}) {
    const auto wrong = run(command(s / "study.toml", s / "new") + " --points='" + list + "'");
    INFO(list << ": " << wrong.err);
    CHECK(wrong.status == 2);
    CHECK(wrong.err.find("--points: ") != std::string::npos);
  }
  CHECK_FALSE(std::filesystem::exists(s / "new"));
}

TEST_CASE("a measure that compares with references has them whichever measures stand beside it") {
  const Scratch s;
  for (const char* measures : {"\"lot\"", "\"lot\", \"gather\"", "\"gather\", \"lot\""}) {
    CAPTURE(measures);
    std::string text = small_study(cornell());
    const size_t from = text.find("\"visible\""), to = text.find(']', from);
    text.replace(from, to - from, measures);
    write_file(s / "study.toml", text);
    const auto o = run(command(s / "study.toml", s / "a"));
    INFO(o.err);
    CHECK(o.status == 0);
    CHECK(read_file(s / "a/results.csv").find("lot.relmse") != std::string::npos);
    text.erase(text.find("[references]"), std::string("[references]\nspp = 4\n").size());
    write_file(s / "study.toml", text);
    const auto without = run(command(s / "study.toml", s / "b"));
    CHECK(without.status == 1);
    CHECK(without.one_error_line());
    CHECK(without.err.find("measure lot needs [references]") != std::string::npos);
  }
}

TEST_CASE("lines of the scene that do not fit it are refused, as render refuses such a plan") {
  const Scratch s;
  write_file(s / "study.toml",
             small_study(cornell(),
                         "[[points]]\nstrategy = \"list\"\n"
                         "lines = [{ scene.extent = 0.5 }, { photon.channels = 1 }]\n"));
  const auto o = run(command(s / "study.toml", s / "a"));
  INFO(o.err);
  CHECK(o.status == 0);
  CHECK(o.out.find("3 points, 2 refused, 0 failed") != std::string::npos);
  const std::string points = read_file(s / "a/points.json");
  CHECK(points.find("does not hold the scene, which goes from ") != std::string::npos);
  CHECK(points.find("; expected a plan made for it") != std::string::npos);
  CHECK(points.find("the scene's photons have other colours") != std::string::npos);
}

TEST_CASE("a folder of other files is refused and left as it is") {
  const Scratch s;
  write_file(s / "study.toml", small_study(cornell()));
  std::filesystem::create_directories(s / "docs");
  write_file(s / "docs/sampling.md", "mine");
  std::filesystem::create_directories(s / "empty");
  const auto refused = [&](const std::string& arguments, const std::string& expected) {
    const auto o = run(arguments);
    INFO(arguments << "\n" << o.err);
    CHECK(o.status == 1);
    CHECK(o.one_error_line());
    CHECK(o.err.find(expected) != std::string::npos);
  };
  const std::string study = " --study '" + s / "study.toml" + "' -o '";
  refused(command(s / "study.toml", s / "docs"), "docs: is no sweep's folder");
  refused("study system" + study + s / "docs" + "'", "docs: is no sweep's folder");
  refused("study sampling cornell -o '" + s / "docs" + "'", "docs: is no study's folder");
  for (const char* name : {"system", "sampling"})
    refused(std::string("study ") + name + " cornell -o '" + s / "study.toml" + "'",
            "study.toml: is not a folder");
  refused(command(s / "study.toml", s / "study.toml"), "study.toml: is not a folder");
  // Neither a file's name makes a sweep's folder, nor a folder's.
  const std::vector<std::vector<std::string>> others = {{"points.json", "results.csv"},
                                                        {"results/mine.csv"},
                                                        {"plans/mine.toml"},
                                                        {"results/ab/mine.json"},
                                                        {"results.csv"},
                                                        {"results/ab/mine.json", "points.json"}};
  for (const auto& files : others) {
    std::filesystem::remove_all(s / "foreign");
    for (const std::string& file : files) {
      std::filesystem::create_directories(
          std::filesystem::path(s / ("foreign/" + file)).parent_path());
      write_file(s / ("foreign/" + file), "{\"points\": []}\n");
    }
    refused(command(s / "study.toml", s / "foreign"), "foreign: is no sweep's folder");
    for (const std::string& file : files)
      CHECK(read_file(s / ("foreign/" + file)) == "{\"points\": []}\n");
    CHECK_FALSE(std::filesystem::exists(s / "foreign/lock"));
  }
  CHECK(std::distance(std::filesystem::directory_iterator(s / "docs"), {}) == 1);
  CHECK(read_file(s / "docs/sampling.md") == "mine");
  CHECK(run(command(s / "study.toml", s / "empty")).status == 0);
}

TEST_CASE("a Latin hypercube's points follow from its printed seed") {
  const Scratch s;
  write_file(s / "study.toml", small_study(cornell(), kPoints));
  REQUIRE(run(command(s / "study.toml", s / "a") + " --points 0").status == 0);
  REQUIRE(run(command(s / "study.toml", s / "b") + " --points 0").status == 0);
  const std::string points = read_file(s / "a/points.json");
  CHECK(points == read_file(s / "b/points.json"));
  CHECK(points.find("latin_hypercube seed 7") != std::string::npos);
}

TEST_CASE("a second sweep on a folder is refused with a sentence, or waits") {
  const Scratch s;
  write_file(s / "study.toml", small_study(cornell()));
  std::filesystem::create_directories(s / "a");
  const std::string lock = s / "a/lock";
  const int held = open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  REQUIRE(flock(held, LOCK_EX) == 0);
  const auto second = run(command(s / "study.toml", s / "a"));
  CHECK(second.status == 1);
  CHECK(second.one_error_line());
  CHECK(second.err.find("another sweep is at work in this folder") != std::string::npos);
  std::thread release([held] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    close(held);
  });
  CHECK(run(command(s / "study.toml", s / "a") + " --wait").status == 0);
  release.join();
}

TEST_CASE("a damaged result is computed again, and that is said") {
  const Scratch s;
  write_file(s / "study.toml", small_study(cornell(), kPoints));
  REQUIRE(run(command(s / "study.toml", s / "a")).status == 0);
  const auto before = tables(s / "a");
  const auto files = result_files(s / "a");
  REQUIRE(files.size() > 3);
  const std::string text = read_file(files[0]);
  std::ofstream(files[0]) << text.substr(0, text.size() / 2);
  std::ofstream(files[1]) << "";
  std::string flipped = read_file(files[2]);
  flipped[flipped.size() / 3] ^= 1;
  std::ofstream(files[2]) << flipped;
  const auto again = run(command(s / "study.toml", s / "a"));
  CHECK(again.status == 0);
  for (size_t i = 0; i < 3; ++i) {
    INFO(again.err);
    CHECK(again.err.find(files[i] + ": is ") != std::string::npos);
  }
  CHECK(again.err.find("it is computed again") != std::string::npos);
  CHECK(again.out.find("3 results computed") != std::string::npos);
  CHECK(tables(s / "a") == before);
}

TEST_CASE("a sweep whose points or plans were lost or damaged goes on") {
  const Scratch s;
  write_file(s / "study.toml", small_study(cornell(),
                                           "[[points]]\nstrategy = \"list\"\n"
                                           "lines = [{ gather.k = 4 }]\n"));
  const std::string a = s / "a", points = a + "/points.json";
  REQUIRE(run(command(s / "study.toml", a)).status == 0);
  const auto before = tables(a);
  const std::string table = read_file(points);
  const auto goes_on = [&] {
    const auto o = run(command(s / "study.toml", a));
    INFO(o.err);
    CHECK(o.status == 0);
    CHECK(o.out.find("0 results computed") != std::string::npos);
    CHECK(tables(a) == before);
    CHECK(read_file(points) == table);
    return o;
  };
  for (const size_t length : {table.size() / 2, size_t{15}, size_t{0}}) {
    write_file(points, table.substr(0, length));
    goes_on();
  }
  std::filesystem::remove(points);
  write_file(a + "/layouts.md", "a study's page");
  goes_on();
  // Points of a program that plans otherwise: what the message says to do does it.
  const std::string plan = nlohmann::json::parse(table)["points"][1]["plan"], other(16, 'b');
  PointTable changed = parse_point_table(table);
  changed.points.at(1).plan = other;
  write_file(points, point_table_text(changed));
  const auto refused = run(command(s / "study.toml", a));
  INFO(refused.err);
  CHECK(refused.status == 1);
  CHECK(refused.err.find("has plan " + other + ", expected " + plan) != std::string::npos);
  CHECK(refused.err.find("remove the file") != std::string::npos);
  CHECK(refused.err.find("cannot be read") == std::string::npos);
  std::filesystem::remove(points);
  goes_on();
  // Plans: cut short, a digit of a number or of the last line's checksum changed, another's.
  const std::string file = a + "/plans/" + plan + ".toml", text = read_file(file);
  const size_t last = text.rfind("\n# plan " + plan + ", check ");
  REQUIRE(last != std::string::npos);
  std::string digit = text, baseline;
  char& k = digit[text.find("\nk = ") + 5];
  k = k == '4' ? '5' : '4';
  const std::string first = nlohmann::json::parse(table)["points"][0]["plan"];
  REQUIRE(first != plan);
  baseline = read_file(a + "/plans/" + first + ".toml");
  for (const std::string& damaged : {text.substr(0, text.size() / 2), digit,
                                     digit.substr(0, last + 1), baseline, std::string()}) {
    write_file(file, damaged);
    const auto mended = goes_on();
    CHECK(mended.err.find(plan + ".toml: is not there or damaged; it is written again") !=
          std::string::npos);
    CHECK(read_file(file) == text);
  }
  // The plan itself without that line, or with a wrong one, is left as it is.
  std::string wrong = text;
  wrong[text.size() - 2] = text[text.size() - 2] == '0' ? '1' : '0';
  for (const std::string& whole : {text.substr(0, last + 1), wrong}) {
    write_file(file, whole);
    CHECK(goes_on().err.find("it is written again") == std::string::npos);
    CHECK(read_file(file) == whole);
  }
  write_file(file, text);
  std::filesystem::remove(file);
  std::filesystem::remove(points);
  goes_on();
  CHECK(read_file(file) == text);
}

TEST_CASE("results of other settings are computed again, those of other points are not") {
  const Scratch s;
  write_file(s / "study.toml", small_study(cornell(), kPoints));
  REQUIRE(run(command(s / "study.toml", s / "a")).status == 0);
  std::string text = small_study(cornell(), kPoints);
  write_file(s / "study.toml",
             text + "[[points]]\nstrategy = \"list\"\nlines = [{ gather.k = 20 }]\n");
  const auto more = run(command(s / "study.toml", s / "a"));
  CHECK(more.out.find("2 results computed") != std::string::npos);
  text.replace(text.find("queries = 64"), 12, "queries = 32");
  write_file(s / "study.toml", text);
  const auto other = run(command(s / "study.toml", s / "a"));
  CHECK(other.out.find("28 results computed") != std::string::npos);
  CHECK(other.err.find("28 results are computed again") != std::string::npos);
}

TEST_CASE("a scene that cannot be used does not stop the others") {
  const Scratch s;
  write_file(s / "broken.xml", "<scene version=\"0.6.0\"><shape type=\"teapot\"/></scene>\n");
  write_file(s / "study.toml", small_study("\"broken.xml\", " + cornell(), kPoints));
  const auto o = run(command(s / "study.toml", s / "a"));
  CHECK(o.status == 1);
  CHECK(o.err.find("scene broken: ") != std::string::npos);
  CHECK(o.out.find("28 results computed") != std::string::npos);
  CHECK(o.out.find("14 failed, 0 missing") != std::string::npos);
}

TEST_CASE("lines that no plan can have are listed as refused") {
  const Scratch s;
  write_file(
      s / "study.toml",
      small_study(cornell(),
                  "[[points]]\nstrategy = \"list\"\nlines = [{ photon.photon_bytes = 5 }]\n"));
  const auto o = run(command(s / "study.toml", s / "a"));
  CHECK(o.status == 0);
  CHECK(o.out.find("2 points, 1 refused") != std::string::npos);
  CHECK(read_file(s / "a/results.csv").find(",refused,") != std::string::npos);
  size_t plans = 0;
  for (const auto& e : std::filesystem::directory_iterator(s / "a/plans")) {
    CHECK(read_file(s / "a/results.csv").find(e.path().stem().string()) != std::string::npos);
    ++plans;
  }
  CHECK(plans == 1);
}

TEST_CASE("a wrong study is refused with file, line and what was expected") {
  const Scratch s;
  const auto refused = [&](const std::string& text, const std::string& line,
                           const std::string& expected) {
    write_file(s / "study.toml", text);
    const auto o = run(command(s / "study.toml", s / "a"));
    INFO(text);
    INFO(o.err);
    CHECK(o.status == 1);
    CHECK(o.one_error_line());
    CHECK(o.err.find(s / "study.toml" + ":" + line + ":") != std::string::npos);
    CHECK(o.err.find(expected) != std::string::npos);
  };
  const std::string good = small_study(cornell());
  const auto with = [&](const std::string& points) { return good + points; };
  const std::string list = "[[points]]\nstrategy = \"list\"\n";
  refused(with(list + "lines = [{ gather.kk = 3 }]\n"), "18", "expected one of the keys of gather");
  refused(with(list + "lines = [{ gather.k = 300 }]\n"), "18", "expected an integer from 1 to 256");
  refused(with(list + "lines = [{ gather.k = \"many\" }]\n"), "18", "expected an integer");
  refused(with(list + "lines = [{ foton = 3 }]\n"), "18", "unknown line foton");
  refused(with(list + "lines = [{ photons = 0 }]\n"), "18", "expected an integer from 1");
  refused(with(list + "lines = [{ frame.width = 5 }]\n"), "18", "study.size");
  refused(with(list + "lines = [{ \"photon.direction_bits+\" = 6 }]\n"), "18",
          "'photon.direction_bits+' has a + without a line beside it");
  refused(with(list + "lines = [{ \"+photon.direction_bits\" = 6 }]\n"), "18", "has a + without");
  refused(with(list + "lines = [{ packed = 1 }]\n"), "18", "expected true or false");
  refused(with(list + "lines = [{ packed = \"true\" }]\n"), "18",
          "packed is \"true\" in quotes, expected true without");
  refused(with(list + "lines = [{ gather.k = \"8\" }]\n"), "18",
          "gather.k is \"8\" in quotes, expected 8 without");
  refused(with("[[points]]\nstrategy = \"spiral\"\n"), "17", "expected list, grid");
  refused(with("[[points]]\nstrategy = \"grid\"\nlines = { gather.k = { from = 1, to = 3 } }\n"),
          "18", "expected an array of values in a grid");
  refused(with("[[points]]\nstrategy = \"latin_hypercube\"\nlines = { gather.k = [2] }\n"), "16",
          "points.count is missing");
  refused(with(list + "scenes = [\"kitchen\"]\nlines = [{ gather.k = 3 }]\n"), "18",
          "expected one of cornell");
  refused(with(list + "scenes = [\"cornell\", \"cornell\"]\nlines = [{ gather.k = 3 }]\n"), "18",
          "twice");
  refused(with("[bounds]\nseeds = 3\n"), "17",
          "bounds.seeds is 3, expected an integer from 1 to 2");
  refused(with("[bounds]\n"), "16", "bounds.seeds is missing");
  refused(with("[extra]\n"), "16", "expected one of study, references");
  refused("[study]\nname = 3\n", "2", "expected a text");
  std::string text = good;
  text.replace(text.find("\"gather\", "), 10, "\"gathre\", ");
  refused(text, "6", "expected one of visible, ");
  refused("[study\n", "1", "");
  for (const char* size : {"4294967300x4", "4x4294967300", " 4x4", "4x 4", "+4x+4", "4x", "0x4",
                           "4x4097", "4x4x", "4"}) {
    text = good;
    text.replace(text.find("12x12"), 5, size);
    refused(text, "5", std::string("study.size is '") + size + "', expected \"WIDTHxHEIGHT\"");
  }
  text = good;
  text.replace(text.find("[1, 2]"), 6, "[\"1\"]");
  refused(text, "4", "study.seeds is '1', expected an integer");
  const std::string range =
      "[[points]]\nstrategy = \"latin_hypercube\"\ncount = 2\nlines.gather.k = ";
  refused(with(range + "{ to = 8 }\n"), "19", "gather.k.from is missing, expected a number");
  refused(with(range + "{ from = 8, log = true }\n"), "19", "gather.k.to is missing");
  refused(with(range + "{ from = \"1\", to = 8 }\n"), "19",
          "gather.k.from is '1', expected a number");
  for (const char* lines : {"gather.k = 8, \"gather.k\" = 8", "\"gather.k+gather.k\" = 8",
                            "gather.k = 8, \"gather.leaf_limit+gather.k\" = 9"})
    refused(with(list + "lines = [{ " + lines + " }]\n"), "18", "gather.k is set twice");
  refused(with("[[points]]\nstrategy = \"grid\"\nlines = { gather.k = [8], \"gather.k\" = [9] }\n"),
          "18", "gather.k is set twice");
  // More points than can be counted one by one.
  std::string values = "1";
  for (int i = 2; i <= 256; ++i) values += fmt::format(", {}", i);
  std::string grid;
  for (const char* key : {"gather.k", "gather.leaf_limit", "reorder.packets", "gatherer.contexts",
                          "photons", "caustic_photons", "frame.spp", "frame.tile"})
    grid += fmt::format("lines.{} = [{}]\n", key,
                        key == std::string("gatherer.contexts") ? "1, 2, 4"
                        : key == std::string("frame.tile")      ? "8, 16"
                                                                : values);
  refused(with("[[points]]\nstrategy = \"grid\"\n" + grid), "16", "expected at most 1000000");
  refused(with("[[points]]\nstrategy = \"search\"\npopulation = 10000\ngenerations = 10000\n"
               "objectives = [\"gather.cycles\"]\nlines = { gather.k = [8, 9] }\n"),
          "16", "expected at most 1000000");
}

TEST_CASE("thousands of points are planned, and those that no plan can have are counted") {
  const Scratch s;
  std::string values;
  for (int i = 1; i <= 60; ++i) values += fmt::format("{}{}", i == 1 ? "" : ", ", i);
  // No plan has photons of 5 bytes.
  write_file(s / "study.toml",
             small_study(cornell(),
                         "[[points]]\nstrategy = \"grid\"\n"
                         "lines.photon.photon_bytes = [5]\nlines.gather.k = [" +
                             values + "]\nlines.gather.leaf_limit = [" + values + "]\n"));
  const auto o = run(command(s / "study.toml", s / "a") + " --points 0");
  INFO(o.err);
  CHECK(o.status == 0);
  CHECK(o.out.find("3601 points, 3600 refused") != std::string::npos);
}

TEST_CASE("a full disk stops the sweep with a sentence and loses nothing") {
  const Scratch s;
  const std::string disk = s / "disk";
  std::filesystem::create_directories(disk);
  // In a mount namespace of its own, so that the file system goes with the test however it ends.
  if (getuid() != 0 || unshare(CLONE_NEWNS) != 0 ||
      mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
      mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=96k") != 0) {
    WARN("skipped: a small file system cannot be mounted here");
    return;
  }
  struct Unmount {
    const std::string& disk;
    ~Unmount() { umount(disk.c_str()); }
  } const unmount{disk};
  write_file(s / "study.toml", small_study(cornell(), kPoints));
  const auto full = run(command(s / "study.toml", disk + "/a"));
  INFO(full.err);
  CHECK(full.status == 1);
  CHECK(full.err.find("No space left on device") != std::string::npos);
  // What is there is whole, and goes on elsewhere.
  const size_t kept = result_files(disk + "/a").size();
  std::filesystem::copy(disk + "/a", s / "b", std::filesystem::copy_options::recursive);
  const auto rest = run(command(s / "study.toml", s / "b"));
  CHECK(rest.status == 0);
  CHECK(rest.err.find("computed again") == std::string::npos);
  CHECK(rest.out.find(std::to_string(kept) + " there before") != std::string::npos);
  REQUIRE(run(command(s / "study.toml", s / "c")).status == 0);
  CHECK(tables(s / "b") == tables(s / "c"));
}

TEST_CASE("the command beside a point writes its plan") {
  const Scratch s;
  write_file(s / "study.toml",
             small_study(cornell(),
                         "[[points]]\nstrategy = \"list\"\n"
                         "lines = [{ radius_scale = 1.5, packed = true, gather.k = 7 }]\n"));
  REQUIRE(run(command(s / "study.toml", s / "a") + " --points 1").status == 0);
  const std::string json = read_file(s / "a/points.json");
  const auto text_after = [&](const std::string& key) {
    const size_t at = json.rfind("\"" + key + "\": \"") + key.size() + 5;
    return json.substr(at, json.find('"', at) - at);
  };
  std::string plan = text_after("command");
  REQUIRE(plan.rfind("photonloom plan ", 0) == 0);
  plan.replace(plan.find(" -o plan.toml"), 13, " -o '" + s / "plan.toml" + "'");
  const auto o = run(plan.substr(11));
  INFO(plan);
  INFO(o.err);
  REQUIRE(o.status == 0);
  CHECK(o.out.find("(hash " + text_after("plan") + ")") != std::string::npos);
}

TEST_CASE("seeds that store more photons than a plan's lines hold take fewer paths") {
  const Scratch s;
  write_file(s / "study.toml",
             "[study]\nname = \"few\"\nscenes = [\"" + source("scenes/cornell_balls.xml") +
                 "\"]\nseeds = [1, 2, 3, 4, 5, 6, 7, 8]\nsize = \"8x8\"\n"
                 "measure = [\"layouts\"]\n[gather]\ncycles = \"model\"\nqueries = 20\n"
                 "[base]\nphotons = 45\ncaustic_photons = 200\nframe.spp = 1\n"
                 "frame.gather_rays = 4\ngather.k = 8\n");
  const auto o = run(command(s / "study.toml", s / "a"));
  INFO(o.out << o.err);
  CHECK(o.status == 0);
}

TEST_CASE("the command beside a point is a shell's") {
  const Scratch s;
  std::filesystem::create_directory_symlink(photonloom::test::source("scenes/meshes"),
                                            s / "meshes");
  write_file(s / "it's a box.xml", read_file(photonloom::test::source("scenes/cornell.xml")));
  write_file(s / "study.toml", small_study("\"it's a box.xml\"",
                                           "[[points]]\nstrategy = \"list\"\n"
                                           "lines = [{ scene.extent = 8.0 }]\n"));
  REQUIRE(run(command(s / "study.toml", s / "a") + " --points 0").status == 0);
  const auto points = nlohmann::json::parse(read_file(s / "a/points.json"))["points"];
  CHECK(points[0]["command"].get<std::string>().starts_with(
      "photonloom plan '" + s / "it'\\''s a box.xml" + "' -o plan.toml --size 12x12 "));
}

TEST_CASE("a shipped study's conclusion: tables from the stored results, goals, plots") {
  const Scratch s;
  write_file(
      s / "study.toml",
      "[study]\nname = \"small\"\nscenes = [" + cornell() +
          "]\nseeds = [1]\nsize = \"16x16\"\nmeasure = [\"traffic\", \"layouts\"]\n"
          "[base]\nphotons = 4000\ncaustic_photons = 100\nframe.spp = 1\n"
          "frame.gather_rays = 4\ngather.k = 8\ngatherer.contexts = 1\n"
          "reorder.cell_bits = 3\nreorder.bins = 512\n"
          "[[points]]\nstrategy = \"grid\"\n"
          "lines = { reorder.key = \"none\", frame.order = [\"pixel\", \"direction_bins\"], "
          "gatherer.cache_bytes = [4096, 131072] }\n"
          "[[points]]\nstrategy = \"grid\"\n"
          "lines = { reorder.key = \"hilbert\", frame.order = \"tile\", reorder.packets = 128, "
          "gatherer.cache_bytes = [4096, 131072] }\n");
  const std::string command =
      "study reordering cornell --study '" + s / "study.toml" + "' -o '" + s / "out" + "'";
  const auto first = run(command);
  INFO(first.err);
  REQUIRE(first.status == 0);
  const std::string page = read_file(s / "out/reordering.md"),
                    summary = read_file(s / "out/summary.json");
  CHECK(page.find("| pixel (naive) | 1.00×") != std::string::npos);
  CHECK(page.find("| tile, Hilbert bins, sweep |") != std::string::npos);
  CHECK(std::filesystem::exists(s / "out/reordering_cornell.gp"));
  // Goes on, and says the same.
  const auto again = run(command);
  REQUIRE(again.status == 0);
  CHECK(again.out.find("0 results computed") != std::string::npos);
  CHECK(read_file(s / "out/reordering.md") == page);
  CHECK(read_file(s / "out/summary.json") == summary);
  CHECK(run("study reordering no_such_scene -o '" + s / "other" + "'").status == 2);
  CHECK(run("study no_such_study -o '" + s / "other" + "'").status == 2);
}

TEST_CASE("a shipped study of scenes that the user names, and of files that are none of its own") {
  const Scratch s;
  const auto study = [](const std::string& name, const std::string& measure) {
    return "[study]\nname = \"" + name + "\"\nscenes = [" + cornell() + ", \"" +
           photonloom::test::source("scenes/cornell_glossy.xml") +
           "\"]\nseeds = [1]\nsize = \"4x4\"\nmeasure = [\"" + measure +
           "\"]\n[base]\nphotons = 500\ncaustic_photons = 100\nframe.spp = 1\n"
           "frame.gather_rays = 2\n[[points]]\nstrategy = \"list\"\nscenes = [\"cornell_glossy\"]\n"
           "lines = [{ gather.k = 4 }]\n[[points]]\nstrategy = \"list\"\nscenes = [\"cornell\"]\n"
           "lines = [{ gather.k = 8 }]\n";
  };
  write_file(s / "study.toml", study("some", "layouts"));
  // Sets of points keep to the scenes of their names, whatever place those have.
  const std::string layouts = " --study '" + s / "study.toml" + "' -o '";
  const auto o = run("study layouts cornell_glossy" + layouts + s / "a" + "'");
  INFO(o.err);
  REQUIRE(o.status == 0);
  const auto summary = nlohmann::json::parse(read_file(s / "a/summary.json"));
  REQUIRE(summary["points"].size() == 2);
  CHECK(summary["points"][1]["lines"]["gather.k"] == "4");
  // Those of other scenes go, which is said.
  CHECK(
      o.err.find("study.toml:16: these [[points]] are left out, none of their scenes (cornell) is "
                 "asked for") != std::string::npos);
  // A page of no row is none.
  std::string no_rows = study("some", "layouts");
  no_rows.resize(no_rows.rfind("[[points]]"));
  write_file(s / "no_rows.toml", no_rows);
  const auto empty =
      run("study layouts cornell --study '" + s / "no_rows.toml" + "' -o '" + s / "empty" + "'");
  INFO(empty.err);
  CHECK(empty.status == 1);
  CHECK(empty.err.find("layouts.md: is not written: no scene has the points that study layouts "
                       "concludes from") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(s / "empty/layouts.md"));
  CHECK(std::filesystem::exists(s / "empty/results.csv"));
  const auto refused = [&](const std::string& arguments, const std::string& expected) {
    const auto r = run(arguments + s / "b" + "'");
    INFO(arguments << "\n" << r.err);
    CHECK(r.status == 1);
    CHECK(r.one_error_line());
    CHECK(r.err.find(expected) != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(s / "b"));
  };
  std::filesystem::create_directories(s / "other");
  std::filesystem::create_directory_symlink(photonloom::test::source("scenes/meshes"),
                                            s / "other/meshes");
  write_file(s / "other/cornell.xml", read_file(photonloom::test::source("scenes/cornell.xml")));
  refused("study layouts cornell cornell" + layouts,
          "a scene of the name cornell is there already");
  refused("study layouts cornell '" + s / "other/cornell.xml" + "'" + layouts,
          "a scene of the name cornell is there already");
  for (const char* name : {"reordering", "caching", "sampling", "adaptive", "system"})
    refused(std::string("study ") + name + " cornell" + layouts,
            name == std::string("reordering") ? "study.measure has no \"traffic\""
                                              : "study.name is some, expected one of");
  write_file(s / "study.toml", study("caching_converged", "caching"));
  refused("study caching" + layouts, "study.measure has no \"visible\"");
}

TEST_CASE("plots are drawn whatever folder and scene are called, and told of where they were") {
  const Scratch s;
  std::filesystem::create_directories(s / "bin");
  std::filesystem::create_directories(s / "scenes");
  std::filesystem::create_directory_symlink(photonloom::test::source("scenes/meshes"),
                                            s / "scenes/meshes");
  write_file(s / "bin/gnuplot", "#!/bin/sh\nprintf '%s|' \"$@\"\ntest -f \"$3\"\n");
  std::filesystem::permissions(s / "bin/gnuplot", std::filesystem::perms::owner_all);
  const std::string scene = "it's`touch ran`\"$(touch ran)";
  write_file(s / ("scenes/" + scene + ".xml"),
             read_file(photonloom::test::source("scenes/cornell.xml")));
  write_file(s / "study.toml",
             "[study]\nname = \"small\"\nscenes = ['''scenes/" + scene +
                 ".xml''']\nseeds = [1]\nsize = \"4x4\"\nmeasure = [\"layouts\"]\n"
                 "[base]\nphotons = 500\ncaustic_photons = 100\nframe.spp = 1\n"
                 "frame.gather_rays = 2\n[[points]]\nstrategy = \"list\"\n"
                 "lines = [{ gather.k = 4 }]\n");
  const std::string study = "study layouts --study study.toml -o 'o'\\''\"$(touch ran)'",
                    out = s / "o'\"$(touch ran)";
  const auto path = std::filesystem::current_path();
  const std::string old = photonloom::test::environment("PATH");
  const auto studied = [&](const std::string& programs) {
    std::filesystem::current_path(s.path);
    setenv("PATH", programs.c_str(), 1);
    const auto o = run(study);
    setenv("PATH", old.c_str(), 1);
    std::filesystem::current_path(path);
    INFO(o.err);
    CHECK(o.status == 0);
    CHECK_FALSE(std::filesystem::exists(s / "ran"));
    return o;
  };
  const auto drawn = studied(s / "bin" + ":" + old);
  CHECK(drawn.err.find("did not draw") == std::string::npos);
  CHECK(drawn.out.find(".md, plots, and") != std::string::npos);
  for (const char* kind : {"svg", "png"})
    CHECK(read_file(out + "/layouts_" + scene + "." + kind) ==
          fmt::format("-e|set terminal {} size 900,420 background \"white\"|{}|", kind,
                      out + "/layouts_" + scene + ".gp"));
  CHECK(read_file(out + "/layouts_" + scene + ".gp")
            .find("set title 'it''s`touch ran`\"$(touch ran): layouts") != std::string::npos);
  write_file(s / "bin/gnuplot", "#!/bin/sh\nexit 1\n");
  std::filesystem::permissions(s / "bin/gnuplot", std::filesystem::perms::owner_all);
  const auto none = studied(s / "bin" + ":" + old);
  CHECK(none.err.find("gnuplot did not draw it") != std::string::npos);
  CHECK(none.out.find("plots") == std::string::npos);
}

TEST_CASE("the means of the sampling study come again at the same points") {
  const auto points = [](const std::string& name) {
    const std::string text = read_file(source("studies/" + name));
    const size_t base = text.find("[base]");
    REQUIRE(base != std::string::npos);
    return text.substr(base);
  };
  CHECK(points("sampling_again.toml") == points("sampling_means.toml"));
}

TEST_CASE("a study of several files: a folder each, one page") {
  const Scratch s;
  const std::string head = "\nscenes = [" + cornell() + "]\nseeds = [1]\n",
                    base =
                        "[base]\nphotons = 2000\ncaustic_photons = 100\nframe.spp = 1\n"
                        "gather.k = 8\nsampler.combine = \"cosine\"\n[[points]]\n"
                        "strategy = \"grid\"\n";
  write_file(s / "sampling.toml", "[study]\nname = \"sampling\"" + head +
                                      "size = \"8x8\"\nmeasure = [\"noise\"]\n" + base +
                                      "lines = { frame.gather_rays = [4, 16], sampler.combine = "
                                      "[\"cosine\", \"sum\"] }\n");
  write_file(s / "means.toml", "[study]\nname = \"sampling_means\"" + head +
                                   "size = \"4x4\"\nmeasure = [\"ray_means\"]\n" + base +
                                   "lines = { frame.gather_rays = [4], sampler.combine = "
                                   "[\"cosine\", \"sum\"] }\n");
  std::string again_file = read_file(s / "means.toml");
  again_file.replace(again_file.find("sampling_means"), 14, "sampling_again");
  again_file.replace(again_file.find("[1]"), 3, "[2, 3]");
  write_file(s / "again.toml", again_file);
  const std::string command = "study sampling --study '" + s / "sampling.toml" + "' --study '" +
                              s / "means.toml" + "' --study '" + s / "again.toml" + "' -o '" +
                              s / "out" + "'";
  const auto first = run(command);
  INFO(first.err);
  REQUIRE(first.status == 0);
  const std::string page = read_file(s / "out/sampling.md");
  CHECK(page.find("| cosine | – | – | 1 |") != std::string::npos);
  CHECK(page.find("| sum | 1 | all |") != std::string::npos);
  CHECK(page.find("farthest mean over 64 ray seeds, of 2 settings") != std::string::npos);
  CHECK(page.find("farthest mean over 2 × 64 ray seeds, of 2 settings") != std::string::npos);
  // Their z together, of the means that the folder keeps.
  const std::string wanted =
      "cornell: farthest mean over 2 × 64 ray seeds, of 2 settings, in standard errors: ";
  const auto summary = nlohmann::json::parse(read_file(s / "out/again/summary.json"));
  double z = 0;
  for (const auto& point : summary.at("points"))
    if (!point.at("lines").empty())
      z = std::max(z, std::sqrt(2.0) *
                          std::fabs(point.at("values").at("ray_means.z").at("mean").get<double>()));
  CHECK(page.find(fmt::format("{}{:.4g}, goal", wanted, z)) != std::string::npos);
  for (const char* file : {"out/sampling_cornell.gp", "out/sampling/results.csv",
                           "out/means/results.csv", "out/again/results.csv"})
    CHECK(std::filesystem::exists(s / file));
  const auto again = run(command);
  REQUIRE(again.status == 0);
  CHECK(again.out.find("0 results computed") != std::string::npos);
  CHECK(read_file(s / "out/sampling.md") == page);
}
