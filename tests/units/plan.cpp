// SPDX-License-Identifier: Apache-2.0
// plan.toml: what is written reads back, what is wrong is named.
#include "golden/plan/plan_file.hpp"

#include <fmt/core.h>

#include <random>

#include "golden/numeric/output_file.hpp"
#include "golden/numeric/random.hpp"
#include "golden/numeric/shared_exponent.hpp"
#include "golden/plan/quantiser.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"

using namespace photonloom;

namespace {

Plan sample_plan() {
  Plan plan;
  plan.scene = "a \"quoted\" \\ name";
  plan.origin = {-0.1, 1e-7, 3};
  plan.extent = 1.0 / 3;
  plan.global = {true, 500003, -40, 0.01, 0};
  plan.global.r2_max = radius_to_r2_max(plan, plan.global.radius);
  return plan;
}

std::string text_of(const Plan& plan) { return plan_text(plan, {}); }

// The text with one line's value replaced.
std::string edited(const Plan& plan, const std::string& section, const std::string& key,
                   const std::string& value) {
  std::string text = text_of(plan);
  const size_t from = text.find("[" + section + "]");
  const size_t at = text.find("\n" + key + " = ", from) + 1;
  const size_t end = text.find('\n', at);
  return text.replace(at, end - at, value.empty() ? "" : key + " = " + value);
}

std::string error_of(const std::string& text) {
  try {
    parse_plan(text, "p.toml");
  } catch (const PlanError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a plan reads back to the bit, with its hash") {
  const Plan plan = sample_plan();
  const Plan again = parse_plan(text_of(plan), "p.toml");
  CHECK(text_of(again) == text_of(plan));
  CHECK(again.scene == plan.scene);
  CHECK(again.extent == plan.extent);
  CHECK(again.global.r2_max == plan.global.r2_max);
  CHECK(plan_hash(again) == plan_hash(plan));
}

TEST_CASE("docs/plan.md names the lines that may be left out, and a plan without them is read") {
  const std::string page = read_file(photonloom::test::source("docs/plan.md"));
  const size_t begin = page.find("## Lines that may be left out");
  REQUIRE(begin != std::string::npos);
  const std::string part = page.substr(begin, page.find("\n## ", begin) - begin);
  Plan plan;
  std::string shortest = text_of(plan);
  Plan::visit(plan, [&](const std::string& section, const std::string& key, auto&, auto, auto,
                        const char*) {
    const std::string line = section + "." + key;
    INFO(line);
    const bool named = part.find("`" + line + "`") != std::string::npos ||
                       (section == "cache" && part.find("`cache.*`") != std::string::npos);
    CHECK(named == may_be_left_out(line));
    if (!named) return;
    const size_t at = shortest.find("\n" + key + " = ", shortest.find("[" + section + "]")) + 1;
    shortest.erase(at, shortest.find('\n', at) + 1 - at);
  });
  CHECK(plan_hash(parse_plan(shortest, "p.toml")) == plan_hash(plan));
}

TEST_CASE("reasons stay with the lines that stay, whatever is quoted") {
  Plan from;
  from.scene = "a \\\"b\\\" # c";
  from.k = 7;
  const PlanReasons reasons{
      {"scene.name", "mine"}, {"gather.k", "few"}, {"photon.bucket", "x # y"}};
  std::string text = plan_text(from, reasons);
  const size_t own = text.find(" # ", text.find("\nspp = "));
  text.replace(own, text.find('\n', own) - own, " # by hand");
  Plan to = from;
  to.k = 8;
  CHECK(kept_reasons(text, from, from) == PlanReasons{{"scene.name", "mine"},
                                                      {"gather.k", "few"},
                                                      {"photon.bucket", "x # y"},
                                                      {"frame.spp", "by hand"}});
  CHECK(kept_reasons(text, from, to) ==
        PlanReasons{{"scene.name", "mine"}, {"photon.bucket", "x # y"}, {"frame.spp", "by hand"}});
  from.scene = "zwölf 木";
  CHECK(kept_reasons(plan_text(from, reasons), from, from) == reasons);
  // What follows a value in its line is a comment only behind '#'.
  text = plan_text(Plan(), {});
  const size_t table = text.find("[photon]\n"), end = text.find("\n\n", table);
  text.replace(table, end - table, "photon = { bucket = 8, lines = \"plain\" } # in one line");
  CHECK(kept_reasons(text, Plan(), Plan()) == PlanReasons{});
}

TEST_CASE("characters beyond ASCII stand in strings and comments alone") {
  Plan plan = sample_plan();
  plan.scene = "zwölf 木 \u00a0 \" # \u0391";
  const std::string text = text_of(plan);
  CHECK(parse_plan("\xEF\xBB\xBF# für alle\n" + text + "# ä '\n", "p.toml").scene == plan.scene);
  const auto name_of = [&](const std::string& value) {
    return parse_plan(edited(plan, "scene", "name", value), "p.toml").scene;
  };
  CHECK(name_of(R"("""
"ü"\"""" # ö)") == R"("ü"")");
  CHECK(name_of(R"('ü\' # ö)") == R"(ü\)");
  for (const char* bad : {"ȏ = 1", "x = 1ä", "x = \"\" ä", "x = ''''' ä''' ä", R"(x = "\"ä" ü)"})
    CHECK(error_of("# é\n" + std::string(bad) + "\n") ==
          "p.toml:2: not TOML: a character beyond ASCII stands outside of strings and comments");
}

TEST_CASE("a number too small for a double is no 0, and keys have few parts") {
  const Plan plan = sample_plan();
  const auto radius = [&](const std::string& value) {
    return error_of(edited(plan, "global", "radius", value));
  };
  for (const char* lost : {"1e-400", "1_0.5e-9_99", "0.1E-324"})
    CHECK_THAT(radius(lost),
               ContainsSubstring("not TOML: a number is smaller than the least above 0, 4.9e-324"));
  for (const char* held : {"5e-324", "0e-400", "0.0", "1e-300"}) CHECK(radius(held).empty());
  std::string deep = "a";
  for (int i = 0; i < 200000; ++i) deep += i % 2 ? " . a" : ".'b'";
  for (const std::string& text : {deep + " = 1\n", "[" + deep + "]\n", "x = {" + deep + " = 1}\n"})
    CHECK(error_of(text) == "p.toml:1: not TOML: a key has more than 64 parts");
  std::string numbers = "0.5";
  for (int i = 0; i < 200; ++i) numbers += ", 0.5";
  CHECK_THAT(radius("[" + numbers + "]"), ContainsSubstring("expected a finite number"));
}

TEST_CASE("a wrong value is shown, whatever it is") {
  const auto error = [](const std::string& value) {
    const std::string text = error_of(edited(sample_plan(), "scene", "origin", value));
    const size_t from = text.find(" is ") + 4;
    return text.substr(from, text.find(", expected") - from);
  };
  CHECK(error("[0.001, -0.004]") == "[0.001, -0.004]");
  CHECK(error("[[1, 2.5], true, 1e300, 'x']") == "[[1, 2.5], true, 1e+300, 'x']");
  CHECK(error("{x = 1}") == "a table");
  CHECK(error("[]") == "[]");
}

TEST_CASE("the hash sees every line but the scene's name") {
  const Plan plan = sample_plan();
  Plan other = plan;
  other.scene = "renamed";
  CHECK(plan_hash(other) == plan_hash(plan));
  int lines = 0;
  Plan::visit(plan, [&](const std::string& section, const std::string& key, const auto& value, auto,
                        auto, const char*) {
    if (section == "scene" && key == "name") return;
    ++lines;
    Plan changed = plan;
    Plan::visit(changed,
                [&](const std::string& s, const std::string& k, auto& v, auto, auto, const char*) {
                  using T = std::remove_cvref_t<decltype(v)>;
                  if (s != section || k != key) return;
                  if constexpr (std::is_same_v<T, bool>)
                    v = !v;
                  else if constexpr (std::is_same_v<T, std::array<double, 3>>)
                    v[2] += 1;
                  else if constexpr (std::is_same_v<T, double>)
                    v = v * 1.5 + 1e-3;
                  else if constexpr (std::is_enum_v<T>)
                    v = static_cast<T>(1 - static_cast<int>(v));
                  else if constexpr (!std::is_same_v<T, std::string>)
                    v += 1;
                  (void)value;
                });
    changed.global.r2_max = radius_to_r2_max(changed, changed.global.radius);
    INFO(section << "." << key);
    CHECK(plan_hash(changed) != plan_hash(plan));
  });
  CHECK(lines > 45);
}

TEST_CASE("a squared distance set by a program survives the file exactly") {
  std::mt19937_64 random(20240);
  INFO("seed 20240");
  for (int round = 0; round < 2000; ++round) {
    Plan plan = sample_plan();
    plan.position_bits = 4 + static_cast<int>(random() % 21);
    plan.extent = std::ldexp(1 + to_unit(random()), static_cast<int>(random() % 40) - 20);
    plan.global.r2_max = random() & ones(static_cast<int>(random() % 51)) & plan.r2_limit();
    const Plan again = parse_plan(text_of(plan), "p.toml");
    INFO("position_bits " << plan.position_bits << ", extent " << plan.extent);
    CHECK(again.global.r2_max == plan.global.r2_max);
    CHECK(plan_hash(again) == plan_hash(plan));
  }
}

TEST_CASE("editing the position width alone keeps the radius") {
  const Plan plan = sample_plan();
  const Plan coarse = parse_plan(edited(plan, "photon", "position_bits", "12"), "p.toml");
  CHECK(coarse.global.radius == plan.global.radius);
  CHECK(coarse.global.r2_max == radius_to_r2_max(coarse, plan.global.radius));
  CHECK(coarse.global.r2_max < plan.global.r2_max / 200);
}

TEST_CASE("each fault is one sentence with file, line, key and what was expected") {
  const Plan plan = sample_plan();
  const auto has = [](const std::string& error, const std::vector<std::string>& parts) {
    INFO(error);
    for (const std::string& part : parts) {
      INFO(part);
      CHECK(error.find(part) != std::string::npos);
    }
  };
  const std::string text = text_of(plan);
  has(error_of(edited(plan, "gather", "k", "300")),
      {"p.toml:", "gather.k is 300", "an integer from 1 to 256"});
  has(error_of(edited(plan, "gather", "k", "\"many\"")), {"gather.k is", "an integer from 1"});
  has(error_of(edited(plan, "gather", "k", "8.5")), {"gather.k is 8.5"});
  has(error_of(edited(plan, "gather", "k", "true")), {"gather.k is true"});
  has(error_of(edited(plan, "gather", "k", "")), {"gather.k is missing", "photons in an estimate"});
  has(error_of(edited(plan, "global", "present", "1")), {"global.present", "true or false"});
  has(error_of(edited(plan, "global", "radius", "nan")), {"global.radius", "finite"});
  has(error_of(edited(plan, "global", "radius", "-1.0")), {"global.radius", "not negative"});
  has(error_of(edited(plan, "scene", "origin", "[1, 2]")), {"scene.origin", "three"});
  has(error_of(edited(plan, "scene", "extent", "0.0")), {"scene.extent", "greater than 0"});
  has(error_of(edited(plan, "reorder", "key", "\"sorted\"")), {"reorder.key", "\"hilbert\""});
  has(error_of(text + "\n[extra]\nx = 1\n"), {"unknown section 'extra'"});
  has(error_of(text + "\nextra = 1\n"), {"unknown key pixel.extra", "weight_bits"});
  has(error_of("k = 3\n" + text), {"p.toml:1", "unknown key 'k'"});
  has(error_of(text.substr(0, text.find("[pixel]"))), {"section [pixel] is missing"});
  has(error_of("[scene\n"), {"p.toml:1", "not TOML"});
  Plan two_passes = plan;
  two_passes.gather_rays = 8;
  two_passes.first_rays = 4;
  two_passes.mean_rays = 6;
  has(error_of(edited(two_passes, "frame", "mean_rays", "")),
      {"p.toml: frame.mean_rays is 16, expected from first_rays, 4, to gather_rays, 8; the file "
       "leaves it out"});
  has(error_of(edited(plan, "photon", "photon_bytes", "8")), {"photon.photon_bytes", "96 bits"});
  Plan compressed = plan;
  compressed.photon_lines = PhotonLines::kCompressed;
  has(error_of(edited(compressed, "photon", "photon_bytes", "8")),
      {"photon.photon_bytes is 8", "5 bits of header", "16 for offsets", "at least 6"});
  has(error_of(edited(plan, "photon", "lines", "\"short\"")), {"photon.lines", "\"compressed\""});
  has(error_of(edited(plan, "photon", "bucket", "7")), {"photon.bucket", "power of two"});
  has(error_of(edited(plan, "gather", "reciprocal_bits", "5")), {"gather.reciprocal_bits", "8"});
  has(error_of(edited(plan, "gatherer", "lanes", "16")), {"gatherer.lanes", "bucket of 8"});
  has(error_of(edited(plan, "gatherer", "nodes_per_cycle", "3")),
      {"gatherer.nodes_per_cycle is 3", "1 to 2"});
  has(error_of(edited(plan, "gatherer", "candidates_per_cycle", "3")),
      {"gatherer.candidates_per_cycle is 3", "1, 2 or 4"});
  has(error_of(edited(plan, "gatherer", "powers_per_cycle", "2")),
      {"gatherer.powers_per_cycle is 2", "candidates_per_cycle = 1"});
  has(error_of(edited(plan, "gatherer", "cache_bytes", "5000")), {"gatherer.cache_bytes", "256"});
  {
    Plan uncached = plan;
    uncached.cache_bytes = 0;
    CHECK(!find_problem(uncached));
    has(error_of(edited(uncached, "gatherer", "beat_bits", "1024")),
        {"gatherer.beat_bits is 1024", "512 bits that 4 lanes take"});
    has(error_of(edited(compressed, "gatherer", "cache_bytes", "0")),
        {"gatherer.cache_bytes is 0", "photon.lines is compressed"});
  }
  has(error_of(edited(plan, "reorder", "bins", "1000")), {"reorder.bins", "power of two"});
  has(error_of(edited(plan, "reorder", "bins", "1024")), {"reorder.bins", "512 bins"});
  has(error_of(edited(plan, "sampler", "u_bits", "30")), {"sampler.u_bits", "which has 24"});
  has(error_of(edited(plan, "sampler", "cell_bits", "6")), {"sampler."});
  has(error_of(edited(plan, "photon", "direction_bits", "3")), {"sampler.cell_bits", "direction"});
  has(error_of(edited(plan, "pixel", "integer_bits", "96")), {"pixel.integer_bits", "128"});
  has(error_of(edited(plan, "caustic", "photons", "5")), {"caustic.photons", "not present"});
  has(error_of(edited(plan, "gather", "epsilon_shift", "2")), {"gather.epsilon_factor"});
  has(error_of(edited(plan, "photon", "channels", "2")), {"photon.channels", "1 or 3"});
}

TEST_CASE("an SDRAM holds the maps and its cache a line in each way, or the plan is refused") {
  Plan plan;
  plan.global = {.present = true, .photons = 1 << 21};
  plan.photon_memory = PhotonMemory::kSdram;
  CHECK(!find_problem(plan));
  plan.board_cache_bytes = 511;
  REQUIRE(find_problem(plan));
  CHECK(find_problem(plan)->line == "board.cache_bytes");
  plan.board_cache_bytes = 512;
  plan.beat_bits = 64;
  REQUIRE(find_problem(plan));
  CHECK(find_problem(plan)->line == "gatherer.beat_bits");
  plan.beat_bits = 256;
  ++plan.global.photons;
  REQUIRE(find_problem(plan));
  CHECK(find_problem(plan)->line == "board.photon_memory");
  plan.photon_memory = PhotonMemory::kBlockRam;
  CHECK(!find_problem(plan));
}

TEST_CASE("what golden renders with more lines than a gatherer has addresses is no hardware") {
  Plan plan;
  plan.global = {.present = true, .photons = uint64_t{8} << 23};
  CHECK(!hardware_problem(plan));
  ++plan.global.photons;
  CHECK(!find_problem(plan));
  REQUIRE(hardware_problem(plan));
  CHECK(hardware_problem(plan)->line == "global.photons");
  CHECK(board_problem(plan)->line == "global.photons");
  plan.bucket = 16;
  CHECK(!hardware_problem(plan));
  plan.caustic = {.present = true, .photons = plan.global.photons + 1};
  REQUIRE(hardware_problem(plan));
  CHECK(hardware_problem(plan)->line == "caustic.photons");
}

TEST_CASE("lines that the link of a board has no addresses for are no board's") {
  Plan plan;
  plan.bucket = 16;
  plan.photon_bytes = 32;
  // 2^28 words of 4 bytes.
  plan.global = {.present = true, .photons = uint64_t{1} << 25};
  CHECK(!hardware_problem(plan));
  REQUIRE(board_problem(plan));
  CHECK(board_problem(plan)->line == "board.photon_memory");
  plan.global.photons -= 16;
  CHECK(!board_problem(plan));
}

TEST_CASE("no plan that passes can overflow the shader's product or the pixel") {
  // All corners of the widths that meet there: whatever passes the checks has room.
  for (const int mantissa : {2, 9, 16})
    for (const int k : {1, 2, 50, 256})
      for (const int w : {0, 8, 18, 24})
        for (const int weight : {8, 18, 24}) {
          Plan plan;
          plan.position_bits = 10;
          plan.mantissa_bits = mantissa;
          plan.k = k;
          plan.reciprocal_bits = w;
          plan.weight_bits = weight;
          if (find_problem(plan)) continue;
          const UInt128 flux = static_cast<UInt128>(k) * power_max(mantissa, plan.exponent_bits);
          CHECK(flux >> plan.flux_bits() == 0);
          // flux * R * c * weight, R and c at most 2^W, and half a unit for rounding
          const int product = plan.flux_bits() + 2 * plan.shader_bits() + 1 + plan.weight_bits;
          CHECK(product <= 127);
        }
  Plan plan;
  plan.weight_bits = 24;
  plan.reciprocal_bits = 24;
  plan.mantissa_bits = 16;
  plan.position_bits = 8;
  plan.k = 256;
  const auto problem = find_problem(plan);
  REQUIRE(problem);
  CHECK(problem->line == "pixel.weight_bits");
}

TEST_CASE("one line can be set by name") {
  Plan plan = sample_plan();
  set_plan_line(plan, "photon.position_bits=10");
  CHECK(plan.position_bits == 10);
  CHECK(plan.global.r2_max == radius_to_r2_max(plan, 0.01));
  set_plan_line(plan, "reorder.drain=fullest");
  CHECK(plan.reorder_drain == ReorderDrain::kFullest);
  set_plan_line(plan, "reorder.drain=\"sweep\"");
  CHECK(plan.reorder_drain == ReorderDrain::kSweep);
  set_plan_line(plan, "scene.origin=[1, 2.5, -3]");
  CHECK(plan.origin[1] == 2.5);
  CHECK_THROWS_AS(set_plan_line(plan, "photon.position_bits=99"), PlanError);
  CHECK_THROWS_AS(set_plan_line(plan, "photon.position_bits=1\ny=2"), PlanError);
  CHECK_THROWS_AS(set_plan_line(plan, "photon.no=1"), PlanError);
  CHECK_THROWS_AS(set_plan_line(plan, "k=1"), PlanError);
}

TEST_CASE("places for the beats of a list") {
  // Five lines of four beats where there are several lists of codes.
  Plan plan;
  plan.k = 13;
  plan.bucket = 16;
  plan.lanes = 4;
  plan.candidates_per_cycle = 2;
  REQUIRE(plan.list_code_bits() != 0);
  CHECK(plan.queued_beats() == 20);
  plan.lanes = 8;
  CHECK(plan.queued_beats() == 16);
  plan.lanes = 2;
  CHECK(plan.queued_beats() == 16);
  plan.lanes = 4;
  plan.k = 12;
  REQUIRE(plan.list_code_bits() == 0);
  CHECK(plan.queued_beats() == 16);
  plan.k = 50;
  plan.candidates_per_cycle = 1;
  REQUIRE(plan.list_code_bits() != 0);
  CHECK(plan.queued_beats() == 16);
}

TEST_CASE("a gatherer has as many reciprocals as keep up with its sums, lists and few photons") {
  const struct {
    int k, nodes, candidates, powers, cache_bytes, bits;
    uint32_t leaf_limit;
    int reciprocals;
  } cases[] = {
      {8, 1, 1, 1, 4096, 18, 0, 1}, {8, 1, 1, 1, 0, 18, 0, 1},     {1, 1, 1, 1, 0, 18, 0, 2},
      {3, 2, 1, 1, 0, 18, 0, 2},    {4, 2, 1, 1, 0, 18, 0, 1},     {1, 2, 1, 1, 4096, 18, 0, 1},
      {8, 1, 1, 1, 0, 18, 4, 2},    {8, 1, 1, 1, 0, 18, 5, 1},     {8, 1, 1, 1, 4096, 18, 4, 1},
      {18, 1, 1, 1, 0, 18, 1, 2},   {19, 1, 1, 1, 0, 18, 1, 1},    {8, 2, 2, 1, 4096, 18, 0, 2},
      {8, 2, 4, 1, 4096, 18, 0, 3}, {8, 1, 2, 1, 4096, 18, 0, 1},  {8, 2, 2, 2, 4096, 18, 0, 2},
      {1, 2, 4, 4, 0, 18, 0, 8},    {50, 2, 4, 2, 4096, 18, 0, 2}, {1, 1, 1, 1, 0, 0, 0, 0},
  };
  for (const auto& c : cases) {
    Plan p;
    p.k = c.k;
    p.nodes_per_cycle = c.nodes;
    p.candidates_per_cycle = c.candidates;
    p.powers_per_cycle = c.powers;
    p.cache_bytes = c.cache_bytes;
    p.reciprocal_bits = c.bits;
    p.leaf_limit = c.leaf_limit;
    CAPTURE(c.k, c.nodes, c.candidates, c.powers, c.cache_bytes, c.bits, c.leaf_limit);
    CHECK(p.reciprocals() == c.reciprocals);
  }
}
