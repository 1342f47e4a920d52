// SPDX-License-Identifier: Apache-2.0
// photonloom replay: a stranger's packets through golden, brute force and RTL.
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

#include "golden/numeric/random.hpp"
#include "golden/plan/plan_file.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"

using namespace photonloom;
using namespace photonloom::test;

namespace {

Plan small_plan() {
  Plan plan;
  plan.position_bits = 10;
  plan.k = 5;
  plan.global.present = true;
  plan.global.photons = 200;
  plan.global.r2_max = plan.r2_limit();
  plan.cache_bytes = 1024;
  plan.contexts = 4;
  plan.reorder_packets = 20;
  plan.reorder_bins = 64;
  return plan;
}

constexpr const char* kQuery =
    R"({{"pixel": {}, "sample": 0, "tag": 0, "map": 0, "flush": 0, "want_photons": {}, )"
    R"("position": [{}, {}, {}], "normal": [128, 128]}})"
    "\n";

struct Files {
  Scratch scratch;
  Files() {
    write_plan(small_plan(), scratch / "plan.toml");
    std::string photons, queries;
    for (uint64_t i = 0; i < 200; ++i)
      photons += fmt::format(
          "{{\"position\": [{}, {}, {}], \"mantissa\": [{}, 300, 511], \"exponent\": {}, "
          "\"direction\": [128, {}]}}\n",
          mix64(i) % 1024, mix64(i + 1000) % 1024, mix64(i + 2000) % 1024, i, i % 4, 120 + i % 16);
    for (uint64_t i = 0; i < 100; ++i)
      queries += fmt::format(fmt::runtime(kQuery), i, i % 2, mix64(i + 3000) % 1024,
                             mix64(i + 4000) % 1024, mix64(i + 5000) % 1024);
    write_file(scratch / "photons.jsonl", photons);
    write_file(scratch / "queries.jsonl", queries);
  }
  Outcome replay(const std::string& unit, const std::string& packets, const std::string& more) {
    // Software has no models to keep.
    const bool software =
        more.find("--backend golden") != more.npos || more.find("--backend brute") != more.npos;
    return run(fmt::format("replay {} --plan {} --packets {} -o {} {} {}", unit,
                           scratch / "plan.toml", scratch / packets, scratch / "out.jsonl",
                           software ? "" : "--work cosim", more));
  }
};

// Results without what brute force does not count.
std::string without_counts(const std::string& text) {
  std::string out;
  for (size_t at = 0; at < text.size();) {
    const size_t end = text.find('\n', at);
    const std::string line = text.substr(at, end - at);
    out += line.substr(0, line.find("\"nodes\"")) + "\n";
    at = end + 1;
  }
  return out;
}

}  // namespace

TEST_CASE("golden, brute force and RTL answer the same gathers") {
  Files f;
  const std::string photons = "--photons " + (f.scratch / "photons.jsonl");
  const Outcome golden =
      f.replay("photon_gatherer", "queries.jsonl", photons + " --backend golden");
  INFO(golden.err);
  REQUIRE(golden.status == 0);
  const std::string results = read_file(f.scratch / "out.jsonl");
  const std::string found = read_file(f.scratch / "out.photons.jsonl");
  const std::string addresses = read_file(f.scratch / "out.addresses.jsonl");
  CHECK(std::count(results.begin(), results.end(), '\n') == 100);
  CHECK(std::count(found.begin(), found.end(), '\n') == 250);
  CHECK(std::count(addresses.begin(), addresses.end(), '\n') == 200);
  REQUIRE(f.replay("photon_gatherer", "queries.jsonl", photons + " --backend brute").status == 0);
  CHECK(without_counts(read_file(f.scratch / "out.jsonl")) == without_counts(results));
  CHECK(read_file(f.scratch / "out.photons.jsonl") == found);
  const Outcome rtl = f.replay("photon_gatherer", "queries.jsonl",
                               photons + " --stall bernoulli:0.4 --latency random --seed 3");
  INFO(rtl.err);
  REQUIRE(rtl.status == 0);
  CHECK(read_file(f.scratch / "out.jsonl") == results);
  CHECK(read_file(f.scratch / "out.photons.jsonl") == found);
}

TEST_CASE("photons that an earlier run wrote do not stay beside results that have none") {
  Files f;
  const std::string golden = "--backend golden --photons " + (f.scratch / "photons.jsonl");
  REQUIRE(f.replay("photon_gatherer", "queries.jsonl", golden).status == 0);
  CHECK(std::filesystem::exists(f.scratch / "out.photons.jsonl"));
  write_file(f.scratch / "none.jsonl", fmt::format(fmt::runtime(kQuery), 1, 0, 5, 6, 7));
  const Outcome removed = f.replay("photon_gatherer", "none.jsonl", golden);
  REQUIRE(removed.status == 0);
  CHECK_THAT(removed.out, ContainsSubstring("removed " + (f.scratch / "out.photons.jsonl") + ": "));
  CHECK_FALSE(std::filesystem::exists(f.scratch / "out.photons.jsonl"));
}

TEST_CASE("addresses that an earlier run wrote do not stay beside results without a map") {
  Files f;
  const std::string photons = " --photons " + (f.scratch / "photons.jsonl");
  REQUIRE(f.replay("photon_gatherer", "queries.jsonl", "--backend golden" + photons).status == 0);
  CHECK(std::filesystem::exists(f.scratch / "out.addresses.jsonl"));
  const Outcome removed = f.replay("photon_gatherer", "queries.jsonl", "--backend golden");
  REQUIRE(removed.status == 0);
  CHECK_THAT(removed.out,
             ContainsSubstring("removed " + (f.scratch / "out.addresses.jsonl") + ": "));
  CHECK_FALSE(std::filesystem::exists(f.scratch / "out.addresses.jsonl"));
  write_file(f.scratch / "out.addresses.jsonl", "{\"index\": 1, \"mine\": 2}\n");
  REQUIRE(f.replay("photon_gatherer", "queries.jsonl", "--backend golden").status == 0);
  CHECK(std::filesystem::exists(f.scratch / "out.addresses.jsonl"));
}

TEST_CASE("photons that are given are not taken for addresses of an earlier run") {
  Files f;
  const std::string photons = read_file(f.scratch / "photons.jsonl");
  for (const auto& [option, name] : {std::pair{"--caustics", "out.addresses.jsonl"},
                                     {"--photons", "out.caustic_addresses.jsonl"}}) {
    write_file(f.scratch / name, photons);
    const Outcome o = f.replay("photon_gatherer", "queries.jsonl",
                               fmt::format("--backend golden {} {}", option, f.scratch / name));
    CHECK(o.status == 1);
    CHECK_THAT(o.err, ContainsSubstring("is the input, which would be lost"));
    CHECK(read_file(f.scratch / name) == photons);
    // Nor do those of nobody.
    CHECK(f.replay("photon_gatherer", "queries.jsonl", "--backend golden").status == 0);
    CHECK(read_file(f.scratch / name) == photons);
  }
}

TEST_CASE("a file that no replay wrote stays where the photons would be") {
  Files f;
  write_file(f.scratch / "none.jsonl", fmt::format(fmt::runtime(kQuery), 1, 0, 5, 6, 7));
  for (const std::string text : {"", "mine\n", "[]\n", "{}\n", "{\"index\": 1, \"mine\": 2}\n"}) {
    write_file(f.scratch / "out.photons.jsonl", text);
    const Outcome o = f.replay("photon_gatherer", "none.jsonl", "--backend golden");
    INFO(text << o.err);
    CHECK(o.status == 0);
    CHECK_THAT(o.out, !ContainsSubstring("removed"));
    CHECK(read_file(f.scratch / "out.photons.jsonl") == text);
  }
}

TEST_CASE("addresses follow the photons, not their order") {
  Files f;
  const std::string lines = read_file(f.scratch / "photons.jsonl");
  REQUIRE(f.replay("photon_gatherer", "queries.jsonl",
                   "--backend golden --photons " + (f.scratch / "photons.jsonl"))
              .status == 0);
  // A line of the address file is the photon's own line with its index in front.
  const std::string addresses = read_file(f.scratch / "out.addresses.jsonl");
  CHECK(addresses.find("{\"index\": ") == 0);
  const std::string first = lines.substr(1, lines.find('\n') - 1);
  CHECK(addresses.substr(0, addresses.find('\n')).find(first) != std::string::npos);
}

TEST_CASE("a CXXRTL model leaves the same packets as golden", "[slow]") {
  Files f;
  REQUIRE(f.replay("reorder_buffer", "queries.jsonl", "--backend golden").status == 0);
  const std::string golden = read_file(f.scratch / "out.jsonl");
  const Outcome o = f.replay("reorder_buffer", "queries.jsonl", "--backend cxxrtl --stall bursts");
  INFO(o.err);
  REQUIRE(o.status == 0);
  CHECK(read_file(f.scratch / "out.jsonl") == golden);
  const Outcome netlist =
      f.replay("reorder_buffer", "queries.jsonl", "--backend rtl --netlist netlist.v");
  CHECK(netlist.status == 2);
  CHECK_THAT(netlist.err, ContainsSubstring("--netlist netlist.v: is of one unit, but 0 run with "
                                            "backend netlist"));
}

TEST_CASE("a model that Clang compiled leaves the same packets as golden", "[slow]") {
  Files f;
  REQUIRE(f.replay("photon_gatherer", "queries.jsonl", "--backend golden").status == 0);
  const std::string golden = read_file(f.scratch / "out.jsonl");
  setenv("CXX", "clang++", 1);
  const Outcome o = f.replay("photon_gatherer", "queries.jsonl",
                             "--backend rtl --stall bursts --wave " + (f.scratch / "y.fst"));
  unsetenv("CXX");
  INFO(o.err);
  REQUIRE(o.status == 0);
  CHECK(read_file(f.scratch / "out.jsonl") == golden);
}

TEST_CASE("a waveform that cannot be written is an error, not silence") {
  Files f;
  const std::string wave = f.scratch / "y.fst";
  const auto refused = [&](const std::string& unit, const std::string& more, int status) {
    const Outcome o = f.replay(unit, "queries.jsonl", "--wave " + wave + " " + more);
    INFO(unit << " " << more << ": " << o.err);
    CHECK(o.status == status);
    CHECK(o.one_error_line());
    CHECK_FALSE(std::filesystem::exists(wave));
    return o.err;
  };
  CHECK_THAT(refused("reorder_buffer", "--backend golden", 2),
             ContainsSubstring("--wave: no unit runs by a backend that writes a waveform"));
  CHECK_THAT(refused("photon_gatherer", "--wave-unit reorder_buffer", 2),
             ContainsSubstring("--wave-unit reorder_buffer: no such unit runs as hardware"));
  CHECK_THAT(refused("reorder_buffer", "--wave-cycles 999999:9999999", 1),
             ContainsSubstring("--wave-cycles 999999:9999999: reorder_buffer ran for "));
  CHECK(std::filesystem::exists(f.scratch / "out.jsonl"));
}

TEST_CASE("packets that no flush follows stay held") {
  Files f;
  const Outcome o = f.replay("reorder_buffer", "queries.jsonl", "--backend golden");
  CHECK(o.status == 0);
  CHECK(o.out.find("19 packets are still held") != std::string::npos);
}

TEST_CASE("bad packets, photons and plans are one clear error each") {
  Files f;
  const auto error = [&](const std::string& unit, const std::string& text,
                         const std::string& more) {
    write_file(f.scratch / "bad.jsonl", text);
    std::filesystem::remove(f.scratch / "out.jsonl");
    const Outcome o = f.replay(unit, "bad.jsonl", "--backend golden " + more);
    CHECK(o.status == 1);
    CHECK(o.one_error_line());
    CHECK(!std::filesystem::exists(f.scratch / "out.jsonl"));
    return o.err;
  };
  const std::string good = fmt::format(fmt::runtime(kQuery), 1, 0, 1, 2, 3);
  CHECK_THAT(
      error("reorder_buffer", good + fmt::format(fmt::runtime(kQuery), 1, 0, 1, 1024, 3), ""),
      ContainsSubstring(
          "bad.jsonl, line 2: field position is 1024, which does not fit its 10 bits"));
  CHECK_THAT(
      error("photon_gatherer", "{\"pixel\": 1}", ""),
      ContainsSubstring("bad.jsonl, line 1: field sample of a gather_query packet is missing"));
  CHECK_THAT(error("photon_gatherer", good, "--photons " + (f.scratch / "none.jsonl")),
             ContainsSubstring("none.jsonl: cannot be opened for reading"));
  CHECK_THAT(error("photon_gatherer", good, "--caustics " + (f.scratch / "photons.jsonl")),
             ContainsSubstring("the plan has no caustic map"));
  std::string many = read_file(f.scratch / "photons.jsonl");
  write_file(f.scratch / "many.jsonl", many + many.substr(0, many.find('\n') + 1));
  CHECK_THAT(error("photon_gatherer", good, "--photons " + (f.scratch / "many.jsonl")),
             ContainsSubstring("many.jsonl, line 201: is one photon too many"));
}

TEST_CASE("a sampler's stream has its order") {
  Files f;
  const auto line = [](int kind) {
    return fmt::format(
        "{{\"kind\": {}, \"pixel\": 0, \"sample\": 0, \"tag\": 0, \"normal\": [128, 128], "
        "\"mantissa\": [0, 0, 0], \"exponent\": 0, \"direction\": [0, 0], \"u\": 0, \"v\": [0, "
        "0]}}\n",
        kind);
  };
  const auto run_lines = [&](std::initializer_list<int> kinds) {
    std::string text;
    for (const int kind : kinds) text += line(kind);
    write_file(f.scratch / "in.jsonl", text);
    return f.replay("cdf_sampler", "in.jsonl", "--backend golden");
  };
  CHECK(run_lines({0, 1, 2, 2, 0, 2}).status == 0);
  CHECK(run_lines({1}).err.find("line 1: field kind is 1, expected 0") != std::string::npos);
  CHECK(run_lines({0, 2, 1}).err.find("line 3: field kind is 1, but a photon cannot follow") !=
        std::string::npos);
  CHECK(run_lines({0, 1, 1, 1, 1, 1, 1}).err.find("line 7: is photon 6 of its table") !=
        std::string::npos);
  CHECK(run_lines({3}).err.find("expected 0 header, 1 photon or 2 request") != std::string::npos);
}

TEST_CASE("wrong use ends with status 2") {
  Files f;
  CHECK(f.replay("reorder_buffer", "queries.jsonl", "--backend brute").status == 2);
  const Outcome work = f.replay("reorder_buffer", "queries.jsonl", "--backend golden --work cosim");
  CHECK(work.status == 2);
  CHECK_THAT(work.err, ContainsSubstring("--work: has no effect"));
  const std::string plan = f.scratch / "plan.toml";
  const Outcome no_folder =
      run(fmt::format("replay reorder_buffer --plan {} --packets {} -o {} --work {}", plan,
                      f.scratch / "queries.jsonl", f.scratch / "out.jsonl", plan));
  CHECK(no_folder.status == 1);
  CHECK_THAT(no_folder.err, ContainsSubstring("--work " + plan + ": is a file, expected a folder"));
  CHECK(f.replay("reorder_buffer", "queries.jsonl", "--photons x").status == 2);
  CHECK(f.replay("ray_caster", "queries.jsonl", "").status == 2);
  // What the backend does not read.
  for (const std::string option :
       {"--stall bursts", "--latency 5", "--seed 3", "--initial-seed 3", "--rtl .", "--yosys x",
        "--banks 3", "--watchdog 9", "--board-wait 3", "--no-resume", "--netlist x"})
    for (const char* backend : {"golden", "brute"}) {
      const Outcome o = f.replay("photon_gatherer", "queries.jsonl",
                                 fmt::format("--backend {} {}", backend, option));
      INFO(backend << " " << option << ": " << o.err);
      CHECK(o.status == 2);
      CHECK(o.one_error_line());
      CHECK_THAT(o.err, ContainsSubstring(option.substr(0, option.find(' '))));
    }
}
