// SPDX-License-Identifier: Apache-2.0
// photonloom cosim: equal to golden, and what happens when it is not.
#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "tests/catch.hpp"
#include "tests/command/run.hpp"

using namespace photonloom;
using namespace photonloom::test;

namespace {

std::string cosim(const std::string& more) {
  return fmt::format(
      "cosim {} --size 8x8 --spp 1 --gather-rays 6 --k 8 --photons 2000 --caustic-photons 800 "
      "--set gatherer.cache_bytes=2048 --work cosim {}",
      source("scenes/cornell_balls.xml"), more);
}

}  // namespace

TEST_CASE("a waveform has no place in the folder that the results replace") {
  const Scratch scratch;
  std::filesystem::create_directory(scratch / "out");
  const Outcome o = run(cosim("--wave " + (scratch / "out/x.fst") +
                              " --wave-unit photon_gatherer -o " + (scratch / "out")));
  CHECK(o.status == 2);
  CHECK_THAT(o.err, ContainsSubstring("out/x.fst is in the folder of the results"));
}

TEST_CASE("all units as RTL give golden's packets and render's bytes") {
  const Scratch scratch;
  const Outcome o =
      run(cosim("--stall bursts --latency random --rig-seed 5 -o " + (scratch / "out")));
  INFO(o.out << o.err);
  REQUIRE(o.status == 0);
  CHECK_THAT(o.out, ContainsSubstring("golden == rtl: ") &&
                        ContainsSubstring(" packets, 0 differences\n"));
  CHECK_THAT(o.out, ContainsSubstring("image bytes of golden and rtl are identical"));
  CHECK_THAT(o.out, ContainsSubstring("mean displacement"));
  const auto summary = nlohmann::json::parse(read_file(scratch / "out/summary.json"));
  CHECK(summary["images_identical"] == true);
  CHECK_THAT(summary["tools"]["verilator"].get<std::string>(), ContainsSubstring("Verilator 5."));
  CHECK(summary["tools"].contains("compiler"));
  CHECK_FALSE(summary["tools"].contains("yosys"));
  for (const char* unit : {"photon_gatherer", "reorder_buffer", "cdf_sampler"}) {
    INFO(unit);
    CHECK(summary["units"][unit]["packets"] > 50);
    CHECK(summary["units"][unit]["bypassed"] == 0);
    CHECK(summary["units"][unit]["busy_percent"] > 0);
  }
  CHECK(summary["units"]["reorder_buffer"]["mean_displacement"] > 1);
  CHECK(summary["units"]["photon_gatherer"]["counters"]["bytes read"] > 0);
  // Flags of the RTL's own results, and golden's of its frame.
  CHECK(summary["units"]["photon_gatherer"]["counters"]["full"] ==
        summary["golden_counts"]["full"]);
  CHECK(summary["counts"] == summary["golden_counts"]);
  CHECK(summary["golden_counts"]["full"] > 50);
  const auto timeline = nlohmann::json::parse(read_file(scratch / "out/timeline.json"));
  CHECK(timeline["traceEvents"].size() > 300);
  const auto packets = nlohmann::json::parse(read_file(scratch / "out/packets.json"));
  for (const auto& stream : packets["streams"]) {
    INFO(stream["stream"]);
    CHECK(stream["count"] > 50);
    CHECK(stream["rows"].size() == std::min<size_t>(1000, stream["count"].get<size_t>()));
  }
  const Outcome rendered = run(fmt::format(
      "render {} --size 8x8 --spp 1 --gather-rays 6 --k 8 --photons 2000 --caustic-photons 800 "
      "--set gatherer.cache_bytes=2048 -o {}",
      source("scenes/cornell_balls.xml"), scratch / "render.exr"));
  REQUIRE(rendered.status == 0);
  CHECK(read_file(scratch / "render.exr") == read_file(scratch / "out/rtl.exr"));
}

TEST_CASE("textured scenes and films with a filter: render's bytes by RTL", "[slow]") {
  const Scratch scratch;
  std::filesystem::create_directory_symlink(source("scenes/meshes"), scratch / "meshes");
  const auto filtered = [&](const std::string& scene, const std::string& filter) {
    std::string text = read_file(source("scenes/" + scene));
    const std::string box = "<rfilter type=\"box\"/>";
    REQUIRE(text.find(box) != std::string::npos);
    text.replace(text.find(box), box.size(), "<rfilter type=\"" + filter + "\"/>");
    const std::string path = scratch / (filter + "_" + scene);
    write_file(path, text);
    return path;
  };
  std::vector<std::string> images;
  for (const std::string& scene :
       {source("scenes/table.xml"), source("scenes/sunroom.xml"), source("scenes/lampshade.xml"),
        filtered("table.xml", "gaussian"), filtered("lampshade.xml", "mitchell")}) {
    INFO(scene);
    const std::string frame = "'" + scene +
                              "' --size 10x10 --spp 2 --gather-rays 6 --k 8 --photons 2000 " +
                              "--caustic-photons 800 --set gatherer.cache_bytes=2048";
    const Outcome o = run("cosim " + frame + " --stall bursts --latency random --work cosim -o " +
                          (scratch / "out"));
    INFO(o.out << o.err);
    REQUIRE(o.status == 0);
    const auto summary = nlohmann::json::parse(read_file(scratch / "out/summary.json"));
    CHECK(summary["images_identical"] == true);
    for (const char* unit : {"photon_gatherer", "reorder_buffer", "cdf_sampler"})
      CHECK(summary["units"][unit]["packets"] > 50);
    REQUIRE(run("render " + frame + " -o " + (scratch / "render.exr")).status == 0);
    images.push_back(read_file(scratch / "render.exr"));
    CHECK(images.back() == read_file(scratch / "out/rtl.exr"));
    std::filesystem::remove_all(scratch / "out");
  }
  CHECK(images[0] != images[3]);
  CHECK(images[2] != images[4]);
}

TEST_CASE("units by different simulators", "[slow]") {
  const Scratch scratch;
  const Outcome o = run(cosim("--backend reorder_buffer=cxxrtl,cdf_sampler=rtl --stall bursts -o " +
                              (scratch / "out")));
  INFO(o.out << o.err);
  REQUIRE(o.status == 0);
  CHECK_THAT(o.out, ContainsSubstring("golden == hardware: ") &&
                        ContainsSubstring("image bytes of golden and hardware are identical"));
  const auto summary = nlohmann::json::parse(read_file(scratch / "out/summary.json"));
  CHECK(summary["units"]["reorder_buffer"]["backend"] == "cxxrtl");
  CHECK(summary["units"]["cdf_sampler"]["backend"] == "rtl");
  CHECK(std::filesystem::exists(scratch / "out/hardware.exr"));
}

TEST_CASE("a planted bug is reported with a command that shows it, and reaches the image") {
  const Scratch scratch;
  std::filesystem::copy(source("rtl"), scratch / "rtl", std::filesystem::copy_options::recursive);
  const std::string file = scratch / "rtl/photon_gatherer/photon_gatherer_results.sv";
  std::string text = read_file(file);
  for (const auto& [right, wrong] :
       {std::pair<std::string, std::string>{"result.flux = flux;", "result.flux = ~flux;"},
        {"result.clamped = clamped;", "result.clamped = !clamped;"}}) {
    REQUIRE(text.find(right) != std::string::npos);
    text.replace(text.find(right), right.size(), wrong);
  }
  write_file(file, text);
  const std::string bug = cosim("--backend photon_gatherer=rtl --rtl " + (scratch / "rtl") +
                                " -o " + (scratch / "out"));

  const Outcome stopped = run(bug);
  CHECK(stopped.status == 1);
  CHECK(!std::filesystem::exists(scratch / "out"));
  CHECK_THAT(stopped.err,
             ContainsSubstring("photon_gatherer, stream result: packet") &&
                 ContainsSubstring(" matched before)") && ContainsSubstring("\n  cycle ") &&
                 ContainsSubstring("\n  input  {\"pixel\": ") &&
                 ContainsSubstring("\n  golden 0x") && ContainsSubstring("\n  rtl    0x") &&
                 ContainsSubstring("\n  * flux[0]") && !ContainsSubstring("earlier run"));

  // The command in the report runs as it stands.
  const size_t at = stopped.err.find("    " + environment("PHOTONLOOM"));
  REQUIRE(at != std::string::npos);
  const std::string command = stopped.err.substr(at, stopped.err.find('\n', at) - at);
  CHECK_THAT(command, ContainsSubstring("--wave photon_gatherer.fst"));
  CHECK_THAT(stopped.err, ContainsSubstring("\n    gtkwave photon_gatherer.fst"));
  std::filesystem::create_directory_symlink(std::filesystem::current_path() / "cosim",
                                            scratch / "cosim");
  const auto again = [&](const std::string& line) {
    CHECK(std::system(
              fmt::format("cd {} && {} >/dev/null 2>err", scratch.path.string(), line).c_str()) !=
          0);
    CHECK(std::filesystem::file_size(scratch / "photon_gatherer.fst") > 1000);
    return read_file(scratch / "err");
  };
  CHECK_THAT(again(command), ContainsSubstring("\n  in the waveform that is written:\n    gtkwave "
                                               "photon_gatherer.fst\n"));
  // Where the waveform missed it, it prints itself again: what it adds replaces what is there.
  const size_t cycles = command.find("--wave-cycles ");
  const std::string missed = again(command.substr(0, cycles) + "--wave-cycles 0:50");
  CHECK_THAT(missed, ContainsSubstring("\n  not in the waveform, which has cycles 0 to 50: ") &&
                         ContainsSubstring("\n" + command + "\n"));

  const Outcome kept = run(bug + " --keep-going");
  CHECK(kept.status == 1);
  CHECK_THAT(kept.out, ContainsSubstring("golden != rtl") &&
                           ContainsSubstring("image bytes of golden and rtl are "
                                             "different"));
  CHECK_THAT(kept.err, ContainsSubstring("packets differ from golden"));
  CHECK(read_file(scratch / "out/golden.exr") != read_file(scratch / "out/rtl.exr"));
  const auto summary = nlohmann::json::parse(read_file(scratch / "out/summary.json"));
  CHECK_THAT(summary["units"]["photon_gatherer"]["first_difference"].get<std::string>(),
             ContainsSubstring("* flux[0]"));
  // Flags are counted of what the RTL gave.
  const auto clamped = summary["units"]["photon_gatherer"]["counters"]["clamped"];
  CHECK(clamped > 50);
  CHECK(summary["counts"]["clamped"] == clamped);
  CHECK(summary["golden_counts"]["clamped"] == 0);
  CHECK_THAT(kept.out, ContainsSubstring(fmt::format("at the ends of ranges: clamped {} of rtl, "
                                                     "none of golden\n",
                                                     clamped.get<uint64_t>())));
  CHECK_FALSE(summary["command"].get<std::string>().empty());

  // A run that ends at a difference writes nothing, and says so where results are there already.
  const Outcome repeated = run(bug);
  CHECK(repeated.status == 1);
  CHECK_THAT(repeated.err,
             ContainsSubstring(fmt::format(
                 "{}: holds the results of an earlier run, not of this one", scratch / "out")));
}

TEST_CASE("a counter of the RTL that is not golden's fails the run") {
  const Scratch scratch;
  std::filesystem::copy(source("rtl"), scratch / "rtl", std::filesystem::copy_options::recursive);
  const std::string file = scratch / "rtl/irradiance_cache/irradiance_cache.sv";
  std::string text = read_file(file);
  const std::string right = ".event_i(wanted && !room)";
  REQUIRE(text.find(right) != std::string::npos);
  text.replace(text.find(right), right.size(), ".event_i(wanted && !wanted)");
  write_file(file, text);
  const std::string cached =
      "--set cache.present=true --set cache.records=3 --backend irradiance_cache=rtl ";
  const Outcome o = run(cosim(cached + "--rtl " + (scratch / "rtl") + " -o " + (scratch / "out")));
  INFO(o.out << o.err);
  CHECK(o.status == 1);
  CHECK_THAT(o.err,
             ContainsSubstring("photonloom: unit irradiance_cache: counts 0 full, expected ") &&
                 ContainsSubstring(" as golden\n  again, with a waveform:\n"));
  // Sources that the environment chose are part of the command that runs it again.
  setenv("PHOTONLOOM_RTL", (scratch / "rtl").c_str(), 1);
  const Outcome chosen = run(cosim(cached + " -o " + (scratch / "out")));
  unsetenv("PHOTONLOOM_RTL");
  CHECK(chosen.status == 1);
  CHECK_THAT(chosen.err, ContainsSubstring("\n    PHOTONLOOM_RTL=" + (scratch / "rtl") + " "));
  CHECK(!std::filesystem::exists(scratch / "out"));
}

TEST_CASE("a waveform never replaces what the frame is made of") {
  const Scratch scratch;
  const std::string plan = scratch / "plan.toml", scene = source("scenes/cornell_balls.xml");
  REQUIRE(run(fmt::format("plan {} --size 4x4 --spp 1 --gather-rays 2 --photons 300 -o {}", scene,
                          plan))
              .status == 0);
  const std::string before = read_file(plan);
  const Outcome o =
      run(fmt::format("cosim {} --plan {} --work cosim -o {} --wave {} --wave-unit reorder_buffer",
                      scene, plan, scratch / "out", plan));
  CHECK(o.status == 1);
  CHECK(o.one_error_line());
  CHECK_THAT(o.err, ContainsSubstring(plan + ": is the input"));
  CHECK(read_file(plan) == before);
}

TEST_CASE("an assertion of the RTL that fails is reported like a difference") {
  const Scratch scratch;
  std::filesystem::copy(source("rtl"), scratch / "rtl's", std::filesystem::copy_options::recursive);
  const std::string file = scratch / "rtl's/reorder_buffer/reorder_buffer.sv";
  std::string text = read_file(file);
  const std::string right = "assign out_taken = out_valid_o && out_ready_i";
  REQUIRE(text.find(right) != std::string::npos);
  text.replace(text.find(right), right.size(), "assign out_taken = out_valid_o");
  write_file(file, text);
  const Outcome o =
      run(cosim("--backend reorder_buffer=rtl --stall-out bernoulli:0.5 --rig-seed 3 "
                "--rtl \"" +
                (scratch / "rtl's") + "\" -o " + (scratch / "out")));
  INFO(o.err);
  CHECK(o.status == 1);
  CHECK_THAT(o.err, ContainsSubstring("photonloom: unit reorder_buffer stopped in cycle ") &&
                        ContainsSubstring(", seed 3: an assertion failed") &&
                        ContainsSubstring("\n  in: valid ") &&
                        ContainsSubstring("\n  out: valid ") &&
                        ContainsSubstring(" --rtl '" + scratch.path.string() + "/rtl'\\''s' ") &&
                        ContainsSubstring(" --wave reorder_buffer.fst --wave-unit reorder_buffer "
                                          "--wave-cycles ") &&
                        ContainsSubstring("\n    gtkwave reorder_buffer.fst"));
}

TEST_CASE("a unit that the plan has not is no unit to compare") {
  const Scratch scratch;
  for (const auto& [unit, more] : {std::pair{"cdf_sampler", "--gather-rays 0"},
                                   {"reorder_buffer", "--set reorder.key=none"},
                                   {"irradiance_cache", ""}}) {
    const Outcome o = run(fmt::format(
        "cosim {} --size 4x4 --spp 1 --k 8 --photons 500 --work cosim --backend {}=rtl {} -o {}",
        source("scenes/cornell.xml"), unit, more, scratch / "out"));
    INFO(o.err);
    CHECK(o.status == 1);
    CHECK_THAT(o.err, ContainsSubstring(
                          fmt::format("--backend: {}: gets no packet, the plan has no ", unit)));
    CHECK(scratch.entries() == 0);
  }
}

TEST_CASE("wrong use") {
  CHECK(run(cosim("--backend photon_gatherer=fpga")).status == 2);
  CHECK(run(cosim("--backend shader=rtl")).status == 2);
  CHECK(run(cosim("--backend cdf_sampler=golden")).status == 2);
  CHECK(run(cosim("--backend cdf_sampler=rtl,cdf_sampler=rtl")).status == 2);
  for (const char* bad :
       {"--stall sometimes", "--stall-memory sometimes", "--latency 0", "--wave x.fst",
        "--wave-cycles 3:4", "--wave x.fst --wave-unit reorder_buffer --wave-cycles 9:3",
        "--wave x.fst --wave-unit reorder_buffer --wave-cycles -1:3", "--stall bernoulli",
        "--stall 'bernoulli: 0.5'", "--stall bernoulli:0x0.8", "--latency ' 5'", "--yosys x",
        "--board-wait 3", "--no-resume", "--backend photon_gatherer=board:/dev/null --stall bursts",
        "--backend photon_gatherer=board:/dev/null --initial-seed 3",
        "--backend cdf_sampler=hls --rtl /nowhere", "--backend cdf_sampler=hls --latency 50",
        "--backend cdf_sampler=hls --watchdog 5"}) {
    INFO(bad);
    const Outcome o = run(cosim(bad));
    CHECK(o.status == 2);
    CHECK(o.one_error_line());
    const std::string text = bad, option = text.substr(text.rfind("--"));
    CHECK_THAT(o.err, ContainsSubstring(option.substr(0, option.find(' '))) ||
                          ContainsSubstring("--wave"));
  }
  const Outcome yosys = run(cosim("--backend reorder_buffer=netlist --yosys no-such-yosys"));
  CHECK(yosys.status == 1);
  CHECK(yosys.one_error_line());
  const Outcome absent = run(cosim("--wave x.fst --wave-unit irradiance_cache"));  // of this plan
  CHECK(absent.status == 1);
  CHECK(absent.one_error_line());
  for (const std::string option : {"--rig-seed", "--initial-seed", "--stall-out", "--latency",
                                   "--banks", "--bank-cycles", "--watchdog", "--wave"}) {
    const Outcome o = run(cosim(option + " 3 " + option + " 4"));
    INFO(option << ": " << o.err);
    CHECK(o.status == 2);
    CHECK_THAT(o.err, ContainsSubstring(option));
  }
}
