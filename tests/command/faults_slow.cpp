// SPDX-License-Identifier: Apache-2.0
// Faults of what a command writes to: a full disk, folders and files that are read-only, two runs
// in one folder. Each is told with a sentence and a status, nothing half written is left, and the
// same command then gives what it always gives. The rows are those of docs/faults.md.
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <linux/capability.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <map>
#include <thread>
#include <vector>

#include <fmt/core.h>

#include "golden/numeric/output_file.hpp"
#include "golden/numeric/random.hpp"
#include "golden/plan/plan_file.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"
#include "tests/fault_report.hpp"

using namespace photonloom;
using photonloom::test::FaultRow;
using photonloom::test::Outcome;
using photonloom::test::Scratch;
using photonloom::test::source;

namespace {

// The program with `before` done in its process. Standard output goes nowhere, errors through a
// pipe, so that a bound on files does not cut them.
Outcome run_after(const std::function<void()>& before, const std::string& arguments) {
  int ends[2];
  REQUIRE(pipe(ends) == 0);
  const std::string command = "exec '" + photonloom::test::environment("PHOTONLOOM") + "' " +
                              arguments + " >/dev/null </dev/null";
  const pid_t child = fork();
  if (child == 0) {
    dup2(ends[1], STDERR_FILENO);
    close(ends[0]);
    close(ends[1]);
    before();
    execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  close(ends[1]);
  Outcome o{};
  char block[4096];
  for (ssize_t n; (n = read(ends[0], block, sizeof block)) != 0;)
    if (n > 0) o.err.append(block, static_cast<size_t>(n));
  close(ends[0]);
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  o.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return o;
}

// Permission bits bind root too once it may not override them.
void obey_permissions() {
  prctl(PR_CAPBSET_DROP, CAP_DAC_OVERRIDE);
  prctl(PR_CAPBSET_DROP, CAP_DAC_READ_SEARCH);
}

// No file grows beyond so many bytes: the write that would do so fails, as on a full disk.
std::function<void()> full_after(uint64_t bytes) {
  return [bytes] {
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, bytes};
    setrlimit(RLIMIT_FSIZE, &limit);
  };
}

// A command that writes `output`, a file or folder below the folder OUT of its arguments.
struct Writer {
  std::string name, arguments, output;
  std::string in(const std::string& folder) const {
    std::string text = arguments;
    for (size_t at; (at = text.find("OUT")) != text.npos;) text.replace(at, 3, folder);
    return text;
  }
};

using Files = std::map<std::string, std::string>;

// By their names below the folder.
Files files_below(const std::string& folder) {
  Files files;
  for (const auto& e : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string name = std::filesystem::relative(e.path(), folder).string();
    if (e.is_regular_file()) files[name] = read_file(e.path().string());
  }
  return files;
}

// Seconds, process and command line are of the run.
bool is_same(const std::string& name, const std::string& a, const std::string& b) {
  const auto ends = [&](const char* end) { return name.ends_with(end); };
  const bool differs = ends("host.csv") || ends("lock") || name == "run/summary.json" ||
                       name.find("/results/") != name.npos;
  return a == b || (differs && !a.empty() && !b.empty());
}

bool has_partial(const Files& files) {
  return std::any_of(files.begin(), files.end(), [](const auto& file) {
    return file.first.find(".partial-") != std::string::npos;
  });
}

// Inputs in `scratch`, and every command that writes.
std::vector<Writer> writers(const Scratch& s) {
  const std::string scene = "'" + source("scenes/cornell.xml") + "'",
                    frame = " --size 8x8 --spp 1 --photons 500 --gather-rays 2 --k 8 ";
  const auto file = [&](const std::string& name) { return " '" + s / name + "' "; };
  const auto made = [&](const std::string& arguments) {
    const Outcome o = photonloom::test::run(arguments);
    INFO(arguments << "\n" << o.err);
    REQUIRE(o.status == 0);
  };
  made("plan " + scene + frame + "-o" + file("plan.toml"));
  made("photons " + scene + " --photons 500 -o" + file("map.ply"));
  made("render " + scene + frame + "-o" + file("a.exr"));
  made("render " + scene + frame + "--seed 2 -o" + file("b.exr"));
  made("render " + scene + frame + "--record" + file("packets") + "-o" + file("c.exr"));
  std::string queries = "ply\nformat ascii 1.0\nelement vertex 60\n";
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"})
    queries += fmt::format("property float {}\n", name);
  queries += "end_header\n";
  for (int i = 0; i < 60; ++i) queries += fmt::format("{} 1 {} 0 1 0\n", 4 * i, 3 * i);
  write_file(s / "queries.ply", queries);
  write_file(s / "study.toml", "[study]\nname = \"small\"\nscenes = [\"" +
                                   source("scenes/cornell.xml") +
                                   "\"]\nseeds = [1]\nsize = \"4x4\"\nmeasure = [\"layouts\"]\n"
                                   "[base]\nphotons = 500\ncaustic_photons = 100\nframe.spp = 1\n"
                                   "frame.gather_rays = 2\n[[points]]\nstrategy = \"list\"\n"
                                   "lines = [{ gather.k = 4 }, { gather.k = 8 }]\n");
  made("sweep" + file("study.toml") + "-o" + file("swept"));
  return {
      {"render", "render " + scene + frame + "-o 'OUT/x.exr'", "x.exr"},
      {"render --record", "render " + scene + frame + "--record 'OUT/packets' -o 'OUT/x.exr'",
       "packets"},
      {"render --integrator path",
       "render " + scene + " --integrator path --size 8x8 --spp 1 -o 'OUT/x.exr'", "x.exr"},
      {"plan", "plan " + scene + frame + "-o 'OUT/plan.toml'", "plan.toml"},
      {"photons", "photons " + scene + " --photons 500 -o 'OUT/map.ply'", "map.ply"},
      {"gather",
       "gather --photons" + file("map.ply") + "--queries" + file("queries.ply") +
           "-o 'OUT/found.jsonl'",
       "found.jsonl"},
      {"generate", "generate" + file("plan.toml") + "-o 'OUT/package'", "package"},
      {"cosim",
       "cosim " + source("scenes/cornell_balls.xml") +
           " --size 8x8 --spp 1 --gather-rays 6 --k 8 --photons 2000 --caustic-photons 800 --set "
           "gatherer.cache_bytes=2048 --work cosim -o 'OUT/run'",
       "run"},
      {"sweep", "sweep" + file("study.toml") + "-o 'OUT/swept'", "swept"},
      {"study layouts", "study layouts --study" + file("study.toml") + "-o 'OUT/layouts'",
       "layouts"},
      {"report", "report" + file("swept") + "-o 'OUT/page.html'", "page.html"},
      {"compare --error-map",
       "compare" + file("a.exr") + file("b.exr") + "--error-map 'OUT/error.png'", "error.png"},
      {"sheet", "sheet" + file("a.exr") + "-o 'OUT/sheet.png'", "sheet.png"},
      {"average", "average" + file("a.exr") + file("b.exr") + "-o 'OUT/mean.exr'", "mean.exr"},
      {"precision",
       "precision " + scene +
           " --size 4x4 --spp 1 --photons 500 --caustic-photons 100 -o "
           "'OUT/precision.csv'",
       "precision.csv"},
      {"replay",
       "replay photon_gatherer --backend golden --plan '" + s / "packets/plan.toml" +
           "' --packets '" + s / "packets/gather_query.jsonl" + "' -o 'OUT/results.jsonl'",
       "results.jsonl"},
      {"mesh", "mesh ring -o 'OUT/ring.ply'", "ring.ply"},
      {"manual", "manual man -o 'OUT/manual.1'", "manual.1"},
  };
}

// What each leaves where nothing is wrong.
Files usual(const Writer& w, const std::string& folder) {
  std::filesystem::create_directories(folder);
  const Outcome o = photonloom::test::run(w.in(folder));
  INFO(w.name << ": " << o.err);
  REQUIRE(o.status == 0);
  return files_below(folder);
}

// The sentence names what could not be written, and why.
void check_told(const Writer& w, const Outcome& o, const std::string& folder,
                const std::string& why) {
  INFO(w.name << " in " << folder << "\n" << o.err);
  CHECK(o.status == 1);
  CHECK(o.err.find(folder) != std::string::npos);
  CHECK(o.err.find(why) != std::string::npos);
}

// The same command with nothing in its way: `row` counts what is not as usual.
void check_again(const Writer& w, const std::string& folder, const Files& expected, FaultRow& row) {
  const Outcome o = photonloom::test::run(w.in(folder));
  INFO(w.name << ": " << o.err);
  CHECK(o.status == 0);
  const Files found = files_below(folder);
  for (const auto& [name, text] : expected) {
    INFO(name);
    const auto at = found.find(name);
    const bool same = at != found.end() && is_same(name, at->second, text);
    CHECK(same);
    row.wrong += !same;
  }
  CHECK(found.size() == expected.size());
}

}  // namespace

TEST_CASE("faults: a disk that is full at any byte of what a command writes") {
  const Scratch s;
  const uint64_t seed = 7;
  INFO("seed " << seed);
  FaultRow row;
  row.fault = "disk full";
  const std::vector<Writer> all = writers(s);
  row.where = fmt::format("files and folders of {} commands", all.size());
  const char* const kSqlite = "results.sqlite: cannot be written: ";
  uint64_t number = 0;
  for (const Writer& w : all) {
    const Files expected = usual(w, s / ("usual " + w.name));
    uint64_t largest = 0;
    for (const auto& [name, text] : expected) largest = std::max<uint64_t>(largest, text.size());
    REQUIRE(largest > 0);
    for (int round = 0; round < 3; ++round, ++number) {
      const uint64_t room = round == 0 ? 0 : hash_bits(seed, number, 0, 0) % largest;
      const std::string folder = s / fmt::format("room {}", number);
      INFO(w.name << ", files of at most " << room << " bytes");
      std::filesystem::create_directories(folder);
      const Outcome o = run_after(full_after(room), w.in(folder));
      ++row.injected;
      row.detected += o.status == 1;
      // The system's reason; SQLite has words of its own.
      check_told(w, o, folder, o.err.find(kSqlite) != o.err.npos ? kSqlite : "File too large");
      const Files left = files_below(folder);
      CHECK_FALSE(has_partial(left));
      // A second output may be missing; what stands is whole.
      for (const auto& [name, text] : left) {
        INFO(name);
        const auto at = expected.find(name);
        const bool whole =
            name.ends_with("lock") || (at != expected.end() && is_same(name, text, at->second));
        CHECK(whole);
        row.wrong += !whole;
      }
      check_again(w, folder, expected, row);
    }
  }
  CHECK(row.detected == row.injected);
  row.recovery = "at once: the same command where there is room gives the usual files";
  report(row);
}

TEST_CASE("faults: folders and files that are read-only, or lie below a file") {
  const Scratch s;
  const std::vector<Writer> all = writers(s);
  const std::string probe = s / "probe";
  std::filesystem::create_directories(probe);
  REQUIRE(chmod(probe.c_str(), 0555) == 0);
  // A folder that nobody may write to, root neither, where permission bits cannot be made to bind.
  const Outcome bound = run_after(obey_permissions, "manual man -o '" + probe + "/x'");
  const bool binds = bound.status == 1;
  if (!binds) WARN("permission bits do not bind here; /sys stands for a read-only folder");
  FaultRow folders, files, below;
  folders.fault = "folder is read-only";
  files.fault = "file to be replaced is read-only";
  below.fault = "path leads through a file";
  folders.where = below.where = fmt::format("outputs of {} commands", all.size());
  write_file(s / "file", "mine");
  for (const Writer& w : all) {
    const std::string folder = s / ("folder " + w.name);
    const Files expected = usual(w, s / ("usual " + w.name));
    std::filesystem::create_directories(folder);
    const std::string closed = binds ? folder : "/sys";
    REQUIRE(chmod(folder.c_str(), 0555) == 0);
    const Outcome o = run_after(obey_permissions, w.in(closed));
    REQUIRE(chmod(folder.c_str(), 0755) == 0);
    ++folders.injected;
    folders.detected += o.status == 1;
    check_told(w, o, closed, binds ? "Permission denied" : "Operation not permitted");
    CHECK(files_below(folder).empty());
    check_again(w, folder, expected, folders);

    const Outcome through = photonloom::test::run(w.in(s / "file"));
    ++below.injected;
    below.detected += through.status == 1;
    check_told(w, through, s / "file", "Not a directory");
    const bool kept = read_file(s / "file") == "mine";
    CHECK(kept);
    below.wrong += !kept;

    // What is there already, as a file alone.
    const std::string old = folder + "/" + w.output;
    if (!binds || !std::filesystem::is_regular_file(old)) continue;
    const std::string text = read_file(old);
    REQUIRE(chmod(old.c_str(), 0444) == 0);
    const Outcome again = run_after(obey_permissions, w.in(folder));
    ++files.injected;
    files.detected += again.status == 1;
    check_told(w, again, old, "cannot be written: Permission denied");
    CHECK_FALSE(has_partial(files_below(folder)));
    files.wrong += read_file(old) != text;
    REQUIRE(chmod(old.c_str(), 0644) == 0);
    check_again(w, folder, expected, files);
  }
  folders.recovery = "at once: the same command gives the usual files when it may write";
  files.recovery = "at once: the old file is whole, and is replaced when it may be";
  below.recovery = "at once: the file is as it was";
  files.where = fmt::format("outputs of {} commands", files.injected);
  for (const FaultRow* row : {&folders, &files, &below}) {
    if (row == &files && !binds) continue;
    CHECK(row->detected == row->injected);
    CHECK(row->wrong == 0);
    report(*row);
  }
}

TEST_CASE("faults: two sweeps that start in one folder") {
  const Scratch s;
  const std::vector<Writer> all = writers(s);
  const auto is_sweep = [](const Writer& w) { return w.name == "sweep"; };
  const Writer sweep = *std::find_if(all.begin(), all.end(), is_sweep);
  const Files expected = usual(sweep, s / "usual");
  FaultRow row;
  row.fault = "two runs in one folder";
  row.where = "a sweep";
  for (int round = 0; round < 10; ++round) {
    const std::string folder = s / fmt::format("two {}", round);
    std::filesystem::create_directories(folder);
    Outcome both[2];
    std::thread first([&] { both[0] = photonloom::test::run(sweep.in(folder)); });
    both[1] = photonloom::test::run(sweep.in(folder));
    first.join();
    ++row.injected;
    int refused = 0;
    for (const Outcome& o : both) {
      INFO(o.err);
      if (o.status == 0) continue;
      ++refused;
      CHECK(o.status == 1);
      CHECK(o.one_error_line());
      CHECK(o.err.find(folder) != std::string::npos);
      CHECK(o.err.find("another sweep is at work in this folder") != std::string::npos);
    }
    CHECK(refused < 2);
    refused ? ++row.detected : ++row.harmless;
    const Files found = files_below(folder);
    CHECK_FALSE(has_partial(found));
    check_again(sweep, folder, expected, row);
  }
  row.recovery = "at once: the first goes on to its end; with `--wait` the second does too";
  report(row);
}
