// SPDX-License-Identifier: Apache-2.0
// plan SCENE --error E as a user runs it, on few pixels: the plan keeps its promise in another run,
// an error out of reach is said to be, wrong command lines are refused.
#include <fmt/core.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "golden/plan/plan_file.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"

using namespace photonloom;
using photonloom::test::run;
using photonloom::test::Scratch;

namespace {

std::string cornell_box() { return " '" + photonloom::test::source("scenes/cornell.xml") + "' "; }

// A frame whose every pixel is measured, and few plans.
std::string small(const Scratch& s) {
  return "--size 16x16 --spp 4 --gather-rays 8 --photons 4000 --measure-size 16x16 --seeds 3 "
         "--points 12 --reference-spp 256 --work '" +
         s / "work" + "' ";
}

double relmse(const std::string& a, const std::string& b) {
  const auto o = run("compare '" + a + "' '" + b + "' --json");
  INFO(o.err);
  REQUIRE(o.status == 0);
  return nlohmann::json::parse(o.out)["relmse"].get<double>();
}

}  // namespace

TEST_CASE("plan --error: the plan keeps the error in a run with another seed, and costs less",
          "[slow]") {
  const Scratch s;
  const std::string file = s / "plan.toml";
  const auto o =
      run("plan" + cornell_box() + small(s) + "--error 1.6x --check 77 --json -o '" + file + "'");
  INFO(o.out << o.err);
  REQUIRE(o.status == 0);
  const auto j = nlohmann::json::parse(o.out);
  const double limit = j["limit"].get<double>();
  CHECK(limit == Approx(1.6 * j["default"]["error"].get<double>()));
  const auto number = [](const nlohmann::json& of, const char* key) {
    return of[key].get<double>();
  };
  for (const char* plan : {"best", "default"}) {
    // As docs/planner.md defines the bound of a run.
    const auto& m = j[plan];
    const double run = number(m, "from_seeds") * std::sqrt(number(m, "seeds") + 1);
    CHECK(number(m, "bound_of_a_run") ==
          Approx(number(m, "error") + 1.645 * std::hypot(run, number(m, "from_pixels"))));
    CHECK(number(m, "bound_beyond_limit") <= 0);
  }
  // Beside a factor it is that of the difference of two plans, which are measured alike.
  CHECK(number(j["best"], "bound_beyond_limit") !=
        Approx(number(j["best"], "bound_of_a_run") - limit));
  CHECK(j["best"]["standard_error"].get<double>() > 0);
  CHECK(j["best"]["cycles"].get<double>() < 0.7 * j["default"]["cycles"].get<double>());
  CHECK(j["runners_up"].size() == 3);
  for (const auto& m : j["runners_up"]) CHECK(!m["lost"].get<std::string>().empty());
  CHECK(j["error_prediction_rms"].get<double>() > 0);
  CHECK(j["check"]["error"].get<double>() <= j["check"]["limit"].get<double>());
  // Twice the paths of the 256 samples of each measured pixel, and all pixels are measured.
  CHECK(j["check"]["reference_spp"] == 512);
  const Plan plan = read_plan(file);
  CHECK(plan.width == 16);
  CHECK(plan.spp == 4);

  // The run as a user makes it. Its error has the noise of the camera's walks, which the check has
  // in the mean.
  const std::string frame = s / "frame.exr", truth = s / "truth.exr";
  REQUIRE(
      run("render" + cornell_box() + "--plan '" + file + "' --seed 77 -o '" + frame + "'").status ==
      0);
  REQUIRE(run("render" + cornell_box() + "--integrator path --size 16x16 --spp 1024 --seed 5 -o '" +
              truth + "'")
              .status == 0);
  CHECK(relmse(frame, truth) <= limit);

  // What was measured is there: the same answer without rendering a frame again.
  const auto again = run("plan" + cornell_box() + small(s) + "--error 1.6x -o -");
  INFO(again.err);
  REQUIRE(again.status == 0);
  CHECK(again.out == read_file(file));

  // Beside an error that is given as such, the bound is that of the plan alone.
  const auto given = run(
      "plan" + cornell_box() + small(s) +
      fmt::format("--error {} --json -o '{}'", 2 * number(j["default"], "error"), s / "g.toml"));
  INFO(given.err);
  REQUIRE(given.status == 0);
  const auto g = nlohmann::json::parse(given.out);
  CHECK(number(g["best"], "bound_beyond_limit") ==
        Approx(number(g["best"], "bound_of_a_run") - number(g, "limit")));

  // The command that it names writes the same plan.
  std::string command = j["command"].get<std::string>();
  command = command.substr(command.find(' ') + 1);
  const std::string same = s / "same.toml";
  command.replace(command.find("plan.toml"), 9, "'" + same + "'");
  REQUIRE(run(command).status == 0);
  CHECK(plan_hash_text(read_plan(same)) == plan_hash_text(plan));
}

TEST_CASE("plan --error: what cannot be met is said, with the best found and what binds") {
  const Scratch s;
  const auto o =
      run("plan" + cornell_box() + small(s) + "--error 1e-5 -o '" + s / "plan.toml" + "'");
  INFO(o.err);
  CHECK(o.status == 1);
  for (const char* part : {"no plan of cornell", "1e-05", "the best found has 0.", " ± ",
                           "what binds is samples of pixel and hemisphere", "--spp"})
    CHECK(o.err.find(part) != std::string::npos);
  CHECK(!std::filesystem::exists(s / "plan.toml"));
}

TEST_CASE(
    "plan --explain: error and cost of a line over its values; --board keeps the plan small") {
  const Scratch s;
  const auto o = run("plan" + cornell_box() + small(s) + "--explain gatherer.lanes --json");
  INFO(o.err);
  REQUIRE(o.status == 0);
  const auto points = nlohmann::json::parse(o.out)["curves"]["gatherer.lanes"];
  CHECK(points.size() == 5);
  double lanes = 0;
  for (const auto& p : points)
    if (p.contains("refused")) {
      CHECK(p["value"] == "16");  // more than a line of 8 photons
    } else {
      CHECK(p["error"] == points[0]["error"]);  // the same image
      CHECK(p["luts"].get<double>() > lanes);
      lanes = p["luts"].get<double>();
    }
}

TEST_CASE(
    "plan --explain --board: values that the board has no room for are told with the reason") {
  const Scratch s;
  const auto points = [&](const std::string& lines) {
    const auto o = run("plan" + cornell_box() + small(s) + "--json --board ulx3s-85f " + lines);
    INFO(o.err);
    REQUIRE(o.status == 0);
    return nlohmann::json::parse(o.out)["curves"].front();
  };
  for (const auto& p : points("--explain gatherer.lanes --set gatherer.cache_bytes=1048576")) {
    CAPTURE(p.dump());
    REQUIRE(p.contains("refused"));
    if (p["value"] != "16")  // more than a line of 8 photons
      CHECK(p["refused"].get<std::string>().find(" DP16KD, and ulx3s-85f has ") !=
            std::string::npos);
  }
  for (const auto& p : points("--explain board.sdram_khz --set board.photon_memory=sdram --set "
                              "board.sdram_khz=80000"))
    if (p["value"] == "120000")
      CHECK(p["refused"] ==
            "has board.sdram_khz, which is 120000, expected at most 110000, "
            "sdram.clock_khz of " +
                photonloom::test::source("fpga/boards/ulx3s-85f/board.toml"));
    else
      CHECK(p.contains("refused") !=
            (p["value"] == "60000" || p["value"] == "80000" || p["value"] == "100000"));
}

TEST_CASE(
    "plan --error --board: a line that the board cannot have is told before anything is measured") {
  const Scratch s;
  const auto o = run("plan" + cornell_box() + small(s) +
                     "--error 5x --board ulx3s-85f --set board.photon_memory=sdram --set "
                     "board.sdram_khz=120000 -o '" +
                     s / "p.toml" + "'");
  CHECK(o.status == 1);
  CHECK(o.err.find("no plan that the planner knows fits ulx3s-85f: the smallest has "
                   "board.sdram_khz, which is 120000, expected at most 110000") !=
        std::string::npos);
  CHECK(o.err.find("measured") == std::string::npos);
}

TEST_CASE("plan --error --board: what does not fit tells what lacks, not what else is refused") {
  const Scratch s;
  // Beside this cache no line can be without padding.
  const auto o = run("plan" + cornell_box() + small(s) +
                     "--error 5x --board ulx3s-85f --set gatherer.cache_bytes=1048576 -o '" +
                     s / "p.toml" + "'");
  CHECK(o.status == 1);
  CHECK(o.err.find("no plan that the planner knows fits ulx3s-85f: the smallest needs ") !=
        std::string::npos);
  CHECK(o.err.find(" DP16KD") != std::string::npos);
}

TEST_CASE("plan --error: wrong command lines name the option and what was expected") {
  const Scratch s;
  for (const std::string option : {"--error", "--explain"})
    CHECK(run("plan p.toml " + option + (option == "--error" ? " 0.1" : " gather.k"))
              .err.find(option + ": starts from a scene, not from a plan") != std::string::npos);
  const std::string end = " -o '" + s / "p.toml" + "'";
  const struct {
    std::string arguments, said;
    int status;
  } wrong[] = {
      {"--error 0" + end, "--error: '0', expected a number above 0", 2},
      {"--error nan" + end, "--error: 'nan', expected a number above 0", 2},
      {"--error 1e-999" + end, "--error: '1e-999', expected a number above 0", 2},
      {"--error 0x1" + end, "--error: '0x1', expected a number above 0", 2},
      {"--error ' 1'" + end, "--error: ' 1', expected a number above 0", 2},
      {"--error 2y" + end, "--error: '2y', expected a number above 0", 2},
      {"--explain gather.k" + end, "--explain: writes no plan without --error", 2},
      {"--explain gather.nothing", "the plan has no line gather.nothing", 2},
      {"--error 0.1", "needs -o FILE", 2},
      {"--metric flip" + end, "--metric: goes with --error", 2},
      {"--board ulx3s-85f" + end, "--work: goes with --error", 2},
      {"--advise" + end, "--advise: goes with --error", 2},
      {"--error 0.1 --metric flip" + end, "--measure-size: HDR-FLIP looks at a pixel's neighbours",
       2},
      {"--error 0.1 --metric ssim" + end, "--metric", 2},
      {"--error 0.1 --minimise money" + end, "--minimise", 2},
      {"--error 0.1 --format-error 0.1" + end, "--format-error", 2},
      {"--error 0.1 --board nowhere" + end, "there is no board nowhere, expected one of ulx3s-85f",
       2},
      {"--error 0.1 --board up5k" + end, "up5k states no ", 2},
      {"--error 0.1 --set gather.k=0" + end, "--set: 'gather.k=0': gather.k", 2},
      {"--error 0.1 --set gather.no_line=0" + end, "gather.no_line", 2},
      {"--error 0.1 --set no_line=0" + end, "--set: unknown line no_line", 2},
      // Frames of another size than the measured film's.
      {"--error 0.1 --set frame.width=64" + end, "frame.width is decided by --size", 2},
      {"--error 0.1 --set frame.height=3" + end, "frame.height is decided by --size", 2},
      {"--explain frame.width", "--explain: frame.width is decided by --size", 2},
      {"--explain frame.height", "--explain: frame.height is decided by --size", 2},
      {"--error 0.1 --explain gather.nothing" + end, "the plan has no line gather.nothing", 2},
      {"--error 0.1 --explain scene.origin" + end, "scene.origin has no values", 2},
      {"--error 0.1 --set packed=3" + end, "packed is 3, expected true or false", 2},
      {"--error 0.1 --set scene.extent=0.5" + end, "does not hold the scene", 1},
      {"--error 0.1 --set photon.channels=1" + end, "expected 3", 1},
      {"--error 0.1 --set gather.k+gather.leaf_limit=7" + end,
       "--set: 'gather.k+gather.leaf_limit=7', expected section.key=value", 2},
      {"--error 0.1 --set caustic_photons=1_000" + end,
       "caustic_photons is 1_000, expected an integer", 2},
      {"--error 0.1 --set photons=1000" + end, "photons is decided by --photons", 2},
      {"--error 0.1 --seed 18446744073709551615" + end,
       "expected an integer from 0 to 18446744073709551613", 2},
      {"--error 0.1 -o '" + s / "none/p.toml" + "'", "none/p.toml: cannot be created", 1},
  };
  for (const auto& w : wrong) {
    const auto o = run("plan" + cornell_box() + small(s) + w.arguments);
    INFO(w.arguments << "\n" << o.err);
    CHECK(o.status == w.status);
    CHECK(o.err.find(w.said) != std::string::npos);
    CHECK(o.out == "");  // no table is begun
    CHECK(o.err.find("measured") == std::string::npos);
  }
  write_file(s / "file", "");
  const auto work = run("plan" + cornell_box() + "--error 0.1 --work '" + s / "file" + "'" + end);
  CHECK(work.status == 1);
  CHECK(work.err.find("--work: " + s / "file" + " cannot be made a folder") != std::string::npos);
  const auto size = run("plan" + cornell_box() + "--error 0.1 --measure-size 16x" + end);
  CHECK(size.status == 2);
  CHECK(size.err.find("--measure-size: '16x', expected WIDTHxHEIGHT") != std::string::npos);
}

TEST_CASE(
    "plan --error: lines of --set are spelt as in a plan, and the command told is a shell's") {
  const Scratch s;
  const std::string folder = s / "sp ace";
  std::filesystem::create_directories(folder);
  std::filesystem::create_directory_symlink(photonloom::test::source("scenes/meshes"),
                                            folder + "/meshes");
  write_file(folder + "/it's.xml", read_file(photonloom::test::source("scenes/cornell.xml")));
  const auto o = run("plan '" + s / "sp ace/it'\\''s.xml" +
                     "' --size 4x4 --photons 1000 --reference-spp 8 --points 2 --seeds 2 --work '" +
                     s / "work" +
                     "' --error 50 --set frame.spp=+2 --set frame.gather_rays=0x4 --set "
                     "gather.k=2_4 --set 'reorder.key=\"hash\"' --json -o '" +
                     s / "plan.toml" + "'");
  INFO(o.err);
  REQUIRE(o.status == 0);
  const Plan plan = read_plan(s / "plan.toml");
  CHECK(plan.spp == 2);
  CHECK(plan.gather_rays == 4);
  CHECK(plan.k == 24);
  std::string command = nlohmann::json::parse(o.out)["command"].get<std::string>();
  command = command.substr(command.find(' ') + 1);
  const std::string same = s / "same.toml";
  command.replace(command.find("plan.toml"), 9, "'" + same + "'");
  INFO(command);
  REQUIRE(run(command).status == 0);
  CHECK(plan_hash_text(read_plan(same)) == plan_hash_text(plan));
}

TEST_CASE("plan --explain: all words of a line, and both truth values", "[slow]") {
  const Scratch s;
  const auto values = [&](const std::string& line, const std::string& more = "") {
    const auto o = run("plan" + cornell_box() +
                       "--size 4x4 --spp 1 --gather-rays 2 --photons 1000 --reference-spp 8 "
                       "--points 2 --seeds 2 --work '" +
                       s / "work" + "' --json --explain " + line + more);
    INFO(line << "\n" << o.err);
    REQUIRE(o.status == 0);
    std::vector<std::string> said;
    const auto points = nlohmann::json::parse(o.out)["curves"][line];
    for (const auto& p : points) said.push_back(p["value"].get<std::string>());
    return said;
  };
  using Words = std::vector<std::string>;
  CHECK(values("sampler.combine") == Words{"sum", "product", "weighted", "photons", "cosine"});
  CHECK(values("frame.order") == Words{"pixel", "tile", "direction_bins"});
  CHECK(values("photon.lines") == Words{"plain", "compressed"});
  CHECK(values("board.photon_memory") == Words{"block_ram", "sdram"});
  CHECK(values("global.present") == Words{"false", "true"});
  CHECK(values("cache.present") == Words{"false", "true"});
  // 0 is a value of these, whether the plan has it or not.
  const auto first = [&](const std::string& line) { return values(line).front(); };
  CHECK(values("frame.first_rays") == Words{"0", "1", "2", "3", "4", "5", "6", "8", "16"});
  for (const char* line : {"gatherer.cache_bytes", "gather.reciprocal_bits", "frame.gather_rays",
                           "board.lut_ram_words", "gather.leaf_limit", "cache.radius_min"}) {
    CAPTURE(line);
    CHECK(first(line) == "0");
  }
  CHECK(first("gatherer.contexts") != "0");
  // No values that the line cannot have.
  CHECK(values("gatherer.nodes_per_cycle") == Words{"1", "2"});
}

TEST_CASE("plan --explain: the plan's own value and those around it are among a line's") {
  const Scratch s;
  const auto o = run("plan" + cornell_box() +
                     "--size 4x4 --spp 1 --gather-rays 2 --photons 1000 --reference-spp 8 "
                     "--points 2 --seeds 2 --k 100 --work '" +
                     s / "work" + "' --json --explain gather.k");
  INFO(o.err);
  REQUIRE(o.status == 0);
  std::set<std::string> said;
  const auto points = nlohmann::json::parse(o.out)["curves"]["gather.k"];
  for (const auto& p : points) CHECK(said.insert(p["value"].get<std::string>()).second);
  for (const char* k : {"3", "50", "75", "100", "200"}) {
    CAPTURE(k);
    CHECK(said.count(k) == 1);
  }
}

TEST_CASE("plan --points: no more plans are measured in a search, each told once", "[slow]") {
  const Scratch s;
  const std::string options = small(s);
  const size_t at = options.find("--points 12 ");
  const auto plans_told = [&](int points, const std::string& error, const char* done) {
    const auto o =
        run("plan" + cornell_box() + options.substr(0, at) + fmt::format("--points {} ", points) +
            options.substr(at + 12) + "--error " + error + " -o '" + s / "plan.toml" + "'");
    INFO(o.err);
    CHECK(o.status == (error == "2x" ? 0 : 1));
    std::vector<std::string> plans;
    for (size_t line = 0; line < o.err.size(); line = o.err.find('\n', line) + 1) {
      const std::string begin = std::string("photonloom: ") + done + " ";
      if (o.err.compare(line, begin.size(), begin) != 0) continue;
      const size_t from = line + begin.size();
      plans.push_back(o.err.substr(from, o.err.find(" seeds: ", from) - 3 - from));
    }
    const std::set<std::string> different(plans.begin(), plans.end());
    CHECK(different.size() == plans.size());
    return different;
  };
  for (const int points : {1, 2, 4}) {
    CAPTURE(points);
    const auto measured = plans_told(points, "2x", "measured");
    CHECK(measured.size() <= static_cast<size_t>(points));
    CHECK(measured.count("the default plan") == 1);
    // Of those that were measured.
    for (const std::string& plan : plans_told(points, "2x", "confirmed"))
      CHECK(measured.count(plan) == 1);
    // And the two that tell what would help.
    CHECK(plans_told(points, "1e-5", "measured").size() <= static_cast<size_t>(points) + 2);
  }
}

TEST_CASE("plan --board: lines that it decides are refused") {
  const Scratch s;
  for (const std::string line :
       {"board.gatherers=1", "board.photon_memory=sdram", "board.cache_bytes=8192",
        "board.lut_ram_words=32", "gatherer.nodes_per_cycle=1", "gatherer.candidates_per_cycle=1",
        "gatherer.powers_per_cycle=1", "gatherer.lanes=2", "gatherer.contexts=8",
        "gatherer.cache_bytes=4096", "gatherer.cache_ways=2", "gatherer.beat_bits=512",
        "reorder.key=none", "reorder.packets=512", "board.sdram_khz=110000"}) {
    const auto o = run("plan" + cornell_box() + "--board ulx3s-85f --set " + line + " -o '" +
                       s / "p.toml" + "'");
    INFO(line << ": " << o.err);
    CHECK(o.status == 2);
    CHECK(o.one_error_line());
    CHECK(o.err.find(" is decided by --board") != std::string::npos);
  }
  CHECK(s.entries() == 0);
  const auto with = [&](const std::string& lines) {
    return run("plan" + cornell_box() +
               "--size 16x16 --photons 2000 --k 4 --board ulx3s-85f --set "
               "photon.photon_bytes=12 --set photon.lines=" +
               lines + " -o '" + s / "p.toml" + "'");
  };
  CHECK(with("plain").err.find("photon.photon_bytes is decided by --board") != std::string::npos);
  // Compressed lines keep theirs.
  const auto kept = with("compressed");
  INFO(kept.err);
  CHECK(kept.status == 0);
  CHECK(read_plan(s / "p.toml").photon_bytes == 12);
}

TEST_CASE(
    "plan: an error of lines that do not go together names the one that was set, or the file") {
  const Scratch s;
  const std::string plan = photonloom::test::source("fpga/gatherer.toml");
  const auto error_of = [](const std::string& arguments) {
    const auto o = run("plan" + arguments);
    CHECK(o.status == 1);
    CHECK(o.one_error_line());
    return o.err;
  };
  const auto has = [](const std::string& text, const std::string& part) {
    CAPTURE(text, part);
    CHECK(text.find(part) != std::string::npos);
  };
  has(error_of(" " + plan + " --set gatherer.cache_bytes=100"),
      "photonloom: --set: 'gatherer.cache_bytes=100': gatherer.cache_bytes is 100, expected ");
  has(error_of(" " + plan + " --set gather.k=4 --set photon.bucket=2"),
      "photonloom: " + plan + " with --set gather.k=4, photon.bucket=2: gatherer.lanes is ");
  has(error_of(cornell_box() + "--photons 2000 --set gatherer.powers_per_cycle=2 -o '" +
               s / "p.toml" + "'"),
      "photonloom: --set: 'gatherer.powers_per_cycle=2': gatherer.powers_per_cycle is 2, expected");
  has(error_of(cornell_box() + "--photons 2000 --set photon.channels=2 -o '" + s / "p.toml" + "'"),
      "photonloom: --set: 'photon.channels=2': photon.channels is 2, expected 1 or 3");
  has(error_of(cornell_box() + "--photons 2000 --set 'photon.channel_color=[0, 0, 0]' -o '" +
               s / "p.toml" + "'"),
      "photonloom: --set: 'photon.channel_color=[0, 0, 0]': photon.channel_color must be [1.0, ");
  has(error_of(cornell_box() + "--plan " + plan + " --set photon.bucket=2 -o '" + s / "p.toml" +
               "'"),
      "photonloom: " + plan + " with --set photon.bucket=2: gatherer.lanes is ");
  has(error_of(" " + plan + " --set photon.lines=compressed --set gatherer.cache_bytes=100"),
      ": gatherer.cache_bytes is 100, expected ");
  CHECK(error_of(" " + plan + " --set photon.lines=compressed --set gatherer.cache_bytes=100")
            .find("0 for none") == std::string::npos);
  CHECK(s.entries() == 0);
}

namespace {

// PHOTONLOOM_BOARDS for as long as it stands.
struct BoardsAt {
  explicit BoardsAt(const std::string& dir) { setenv("PHOTONLOOM_BOARDS", dir.c_str(), 1); }
  ~BoardsAt() { unsetenv("PHOTONLOOM_BOARDS"); }
  BoardsAt(const BoardsAt&) = delete;
  BoardsAt& operator=(const BoardsAt&) = delete;
};

}  // namespace

TEST_CASE("plan --board: a plan whose memory the board lacks has no cycles there") {
  const Scratch s;
  const std::string folder = s / "boards" + "/b";
  std::filesystem::create_directories(s / "boards");
  std::filesystem::copy(photonloom::test::source("fpga/boards/ulx3s-85f"), folder,
                        std::filesystem::copy_options::recursive);
  std::string text = read_file(folder + "/board.toml");
  const auto erase = [&](const std::string& from, const std::string& to) {
    const size_t at = text.find(from), end = text.find(to, at);
    REQUIRE(end != std::string::npos);
    text.erase(at, end - at);
  };
  erase("[sdram]", "# speed");
  erase("[top.sdram]", "[top.unit]");
  write_file(folder + "/board.toml", text);
  const BoardsAt boards(s / "boards");
  const std::string scene = cornell_box() + "--photons 500 --size 8x8 --spp 1 --gather-rays 4 ";
  const std::string plan = s / "sdram.toml";
  REQUIRE(run("plan" + scene + "--set board.photon_memory=sdram -o '" + plan + "'").status == 0);
  const auto of_plan = cornell_box() + "--plan '" + plan + "' --board b -o '" + s / "b.toml" + "'";
  const auto o = run("plan" + of_plan);
  INFO(o.err);
  REQUIRE(o.status == 0);
  CHECK(o.out.find("the plan without --board: has board.photon_memory, which is sdram, expected "
                   "block_ram: board b has no SDRAM") != std::string::npos);
  const auto json = nlohmann::json::parse(run("plan" + of_plan + " --json").out);
  CHECK(json["engine"]["without"].size() == 1);
  CHECK(json["engine"]["without"].contains("misfit"));
}

TEST_CASE(
    "plan --board: the line's bytes and the frame's order are told of what the search takes") {
  const Scratch s;
  const std::string plan = s / "p.toml";
  const auto o =
      run("plan" + cornell_box() +
          "--photons 8000 --k 16 --size 8x8 --spp 1 --gather-rays 4 --board ulx3s-85f -o '" + plan +
          "'");
  INFO(o.err);
  REQUIRE(o.status == 0);
  const Plan p = read_plan(plan);
  CHECK(p.photon_bytes == 12);  // derived with 16
  CHECK(read_file(plan).find(fmt::format("a line of {} bytes", p.bucket * p.photon_bytes)) !=
        std::string::npos);
  CHECK(p.reorder_key == ReorderKey::kNone);  // derived with a buffer
  CHECK(read_file(plan).find("no reorder buffer follows") != std::string::npos);
}

TEST_CASE("plan: a board that cannot be read does not stand in another's way") {
  const Scratch s;
  const std::string boards = s / "boards", plan = s / "p.toml";
  std::filesystem::create_directories(boards);
  for (const char* name : {"a", "b"})
    std::filesystem::copy(photonloom::test::source("fpga/boards/ulx3s-85f"), boards + "/" + name,
                          std::filesystem::copy_options::recursive);
  write_file(boards + "/a/board.toml", "tested = 1\n");
  const std::string scene = cornell_box() + "--photons 300 --size 4x4 --spp 1 --gather-rays 2 ";
  {
    const BoardsAt at(boards);
    const auto o = run("plan" + scene + "-o '" + plan + "'");
    CHECK(o.status == 0);
    CHECK(o.err.find("warning: " + boards + "/a/board.toml: tested") != std::string::npos);
    const auto wrong = run("plan" + scene + "--board nope -o '" + plan + "'");
    CHECK(wrong.status == 2);
    CHECK(wrong.err.find("there is no board nope, expected one of b") != std::string::npos);
  }
  const BoardsAt nowhere(s / "none");
  const auto o = run("plan" + scene + "--board b -o '" + plan + "'");
  CHECK(o.status == 1);
  CHECK(o.err.find("there is no board b: " + (s / "none") + " has no folder with a board.toml") !=
        std::string::npos);
}

TEST_CASE("plan --board: the fastest engine, the same image") {
  const Scratch s;
  const std::string scene = cornell_box() + "--photons 2000 --size 12x12 --spp 1 --gather-rays 8 ";
  const auto plain = run("plan" + scene + "-o '" + s / "plain.toml" + "'");
  REQUIRE(plain.status == 0);
  const auto o = run("plan" + scene + "--board ulx3s-85f --json -o '" + s / "board.toml" + "'");
  INFO(o.err);
  REQUIRE(o.status == 0);
  const auto engine = nlohmann::json::parse(o.out)["engine"];
  CHECK(engine["board"] == "ulx3s-85f");
  CHECK(engine["cycles"].get<double>() < engine["without"]["cycles"].get<double>());
  const auto image = [&](const std::string& name) {
    const auto r = run("render" + cornell_box() + "--plan '" + s / (name + ".toml") +
                       "' --json -o '" + s / (name + ".exr") + "'");
    INFO(r.err);
    REQUIRE(r.status == 0);
    return nlohmann::json::parse(r.out)["pixels_sha256"];
  };
  CHECK(image("plain") == image("board"));

  const struct {
    std::string arguments, said;
    int status;
  } wrong[] = {
      {scene + "--board nowhere -o -", "there is no board nowhere, expected one of ulx3s-85f", 2},
      {scene + "--board up5k -o -", "up5k states no ", 2},
      {scene + "--board ulx3s-85f", "needs -o FILE", 2},
      {" '" + s / "plain.toml" + "' --board ulx3s-85f", "--board: counts the gathers of a scene",
       2},
  };
  for (const auto& w : wrong) {
    const auto r = run("plan" + w.arguments);
    INFO(w.arguments << "\n" << r.err);
    CHECK(r.status == w.status);
    CHECK(r.err.find(w.said) != std::string::npos);
  }
}

namespace {

// A few pixels, and as few plans as are asked for.
std::string tiny(const Scratch& s, const std::string& rest) {
  return "plan" + cornell_box() +
         "--size 4x4 --spp 1 --photons 1000 --reference-spp 8 --seeds 2 --work '" + s / "work" +
         "' " + rest;
}

}  // namespace

TEST_CASE("plan --error: a frame without gathers has none to make cheaper") {
  const Scratch s;
  const auto o = run(tiny(s, "--gather-rays 0 --points 2 --error 50 -o '" + s / "p.toml" + "'"));
  INFO(o.out << o.err);
  CHECK(o.status == 1);
  CHECK(o.err.find("cornell: the default plan's frame asks for no gathers, so no plan makes them "
                   "cheaper; expected --gather-rays above 0") != std::string::npos);
  CHECK(o.err.find("nan") == std::string::npos);
  CHECK(o.out == "");
  CHECK_FALSE(std::filesystem::exists(s / "p.toml"));
}

TEST_CASE("plan --error: where nothing meets it, more rays than a plan can have are no advice",
          "[slow]") {
  const Scratch s;
  const auto o =
      run(tiny(s, "--gather-rays 40000 --points 1 --error 1e-9 -o '" + s / "p.toml" + "'"));
  INFO(o.err);
  CHECK(o.status == 1);
  CHECK(o.err.find("no plan of cornell is known to stay within 1e-09") != std::string::npos);
  CHECK(o.err.find("80000") == std::string::npos);
}

TEST_CASE("plan --error tells how many plans were predicted, and makes a damaged image again") {
  const Scratch s;
  const auto told = [&](int points) {
    const auto o = run(tiny(
        s, fmt::format("--gather-rays 4 --points {} --error 50 -o '{}'", points, s / "p.toml")));
    INFO(o.err);
    REQUIRE(o.status == 0);
    const std::string begin = "predicted before they were measured, of ";
    const size_t at = o.out.find(begin);
    REQUIRE(at != std::string::npos);
    const size_t from = at + begin.size();
    return std::make_pair(o.out.substr(from, o.out.find(';', from) - from), o.err);
  };
  CHECK(told(1).first == "1 plans: the error of 0, the cycles of 0");
  // The one that the model chose.
  CHECK(told(2).first == "2 plans: the error of 1, the cycles of 1");
  const std::string file = s / "work/cornell.4x4of4x4/references/cornell.4x4.1.exr";
  std::filesystem::resize_file(file, 100);
  // And one to learn from, whose cost is known.
  const auto [three, said] = told(3);
  CHECK(three == "3 plans: the error of 1, the cycles of 2");
  INFO(said);
  CHECK(said.find("photonloom: " + file + ": ") != std::string::npos);
  CHECK(said.find("; it is made again") != std::string::npos);
}

TEST_CASE("plan --explain: each number of photons once, however few there are") {
  const Scratch s;
  const std::string options = tiny(s, "--gather-rays 2 --points 2 --json --explain photons");
  const auto values = [&](const std::string& photons) {
    std::string asked = options;
    asked.replace(asked.find("--photons 1000"), 14, "--photons " + photons);
    const auto o = run(asked);
    INFO(o.err);
    REQUIRE(o.status == 0);
    std::vector<std::string> said;
    const auto points = nlohmann::json::parse(o.out)["curves"]["photons"];
    for (const auto& p : points) said.push_back(p["value"].get<std::string>());
    return said;
  };
  using Values = std::vector<std::string>;
  CHECK(values("50") == Values{"16", "19", "25", "38", "50", "100", "200"});
  CHECK(values("3") == Values{"3", "6", "12"});
}
