// SPDX-License-Identifier: Apache-2.0
// Numbers that are none, or of the wrong sign, are refused with the name of their option before
// anything is done.
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include <fmt/core.h>

#include "golden/numeric/random.hpp"
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
      {"sheet x.exr -o x.png", "--exposure", "101"},
      {"compare x.exr x.exr", "--max-rmse", "nan"},
      {"compare x.exr x.exr", "--max-rmse", "1e-999"},
      {"compare x.exr x.exr", "--max-rmse", "-1"},
      {"compare x.exr x.exr", "--max-relmse", "-0.001"},
      {"compare x.exr x.exr", "--max-mape", "-1e-30"},
      {"compare x.exr x.exr", "--max-mean-ratio", "-1"},
      {"compare x.exr x.exr", "--max-mean-ratio-rgb", "-1"},
      {"compare x.exr x.exr", "--max-flip", "-1"},
      {"compare x.exr x.exr", "--max-flip", "1.5"},
      {"compare x.exr x.exr", "--min-psnr", "nan"},
      {"compare x.exr x.exr", "--min-psnr", "0x10"},
      {"compare x.exr x.exr", "--max-flip", " 1"},
      {"gather --photons x --queries x -o " + out, "--radius", "nan"},
      {"gather --photons x --queries x -o " + out, "--radius", "-1"},
      {"gather --photons x --queries x -o " + out, "--radius", "1e-999"},
      {"gather --photons x --queries x -o " + out, "--radius", "5 "},
      {"board info /dev/null", "--board-wait", "0x10"},
      {"generate " + plan + " -o " + out + " --board ulx3s-85f", "--clock", " 25"},
  };
  for (const auto& r : refused) {
    INFO(r.command << " " << r.option << " " << r.value);
    const Outcome o = run(r.command + " " + r.option + "='" + r.value + "'");
    INFO(o.err);
    CHECK(o.status == 2);
    CHECK_THAT(o.err, ContainsSubstring(r.option + ":") &&
                          ContainsSubstring("'" + r.value + "', expected"));
    CHECK(s.entries() == 1);
  }
}

TEST_CASE("no seed wraps or saturates, whatever its option is called") {
  const std::string packets = "replay reorder_buffer --plan x.toml --packets x.jsonl -o y.jsonl ";
  for (const auto& [command, option] :
       {std::pair<std::string, std::string>{"cosim x.xml", "--seed"},
        {"cosim x.xml", "--rig-seed"},
        {"cosim x.xml", "--initial-seed"},
        {packets, "--seed"},
        {packets, "--initial-seed"},
        {"plan x.xml -o y.toml --error 0.1", "--check"},
        {"photons x.xml -o y.ply", "--seed"}})
    for (const std::string value : {"-1", "-5", "18446744073709551616", "99999999999999999999999",
                                    "0x10", " 5", "5 ", "1e3"}) {
      const Outcome o = run(command + " " + option + "='" + value + "'");
      INFO(command << " " << option << "='" << value << "'\n" << o.err);
      CHECK(o.status == 2);
      CHECK_THAT(o.err, ContainsSubstring(option + ": '" + value +
                                          "', expected an integer from 0 to 2^64 - 1"));
    }
}

namespace {

// An option that takes a value, and what it is of.
struct Valued {
  std::string command, option;  // " board info", "--board-wait"
  std::string shown;            // its type in --help: "N:INT in [1 - 64]", "FILE"
};

// Every option of every command that takes a value, from the completion of fish, which is made of
// CLI11's own list, hidden ones too; with its type from --help.
std::vector<Valued> valued_options() {
  std::vector<Valued> all;
  std::map<std::string, std::string> help;
  std::istringstream lines(run("manual fish").out);
  const std::regex form(
      R"(complete -c photonloom -n '__photonloom_at \\'photonloom([a-z -]*)\\''(.*))"),
      name(" -(l|s) ([A-Za-z-]+)");
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (!std::regex_match(line, match, form)) continue;
    const std::string command = match[1], rest = match[2],
                      head = rest.substr(0, rest.find(" -d '"));
    if (head.find(" -r") == head.npos && head.find(" -x") == head.npos) continue;
    std::string option;
    for (std::sregex_iterator i(head.begin(), head.end(), name), end; i != end; ++i)
      option = ((*i)[1] == "l" ? "--" : "-") + (*i)[2].str();
    if (!help.count(command)) help[command] = run(command + " --help").out;
    const std::string& text = help[command];
    std::smatch shown;
    const std::regex type(option + R"( (\S+( in \[\S+ - \S+\])?))");
    Valued v{command, option, std::regex_search(text, shown, type) ? shown[1].str() : "hidden"};
    all.push_back(v);
  }
  return all;
}

enum class Kind { kInteger, kFloat, kText, kUnknown };

// Values that hold numbers without being one, each of its own form; numbers in them are fuzzed too.
const std::set<std::string> kForms = {"WxH", "LIST", "E"};
// Files, names and lines: no numbers, or such as other tests fuzz (--set, -D).
const std::set<std::string> kNames = {
    "BOARD",    "DIR",  "FILE",       "FILE.exr",   "FILE.jsonl", "FILE.md",
    "FILE.png", "LINE", "LINE=VALUE", "NAME",       "NAME,...",   "NAME=VALUE",
    "OUT.html", "PLAN", "PLY",        "STUDY.toml", "UNIT=B,...", "SCENE/LABEL=FILE.exr"};
// Options whose type is TEXT.
const std::set<std::string> kTexts = {"--layer", "--netlist", "--output", "--rtl",
                                      "--wave",  "--work",    "--yosys",  "--wave-unit"};
const std::set<std::string> kTextForms = {"--latency",   "--stall",        "--stall-in",
                                          "--stall-out", "--stall-memory", "--wave-cycles"};

bool has_form(const Valued& v) { return kForms.count(v.shown) || kTextForms.count(v.option); }

Kind kind_of(const Valued& v) {
  std::string shown = v.shown.substr(0, v.shown.find('='));
  if (kNames.count(v.shown)) return Kind::kText;
  if (shown.find("INT in [") != shown.npos || shown == "S") return Kind::kInteger;
  if (shown.find("FLOAT in [") != shown.npos || shown == "X" || shown == "R") return Kind::kFloat;
  if (shown.find(":{") != shown.npos) return Kind::kText;
  if (kForms.count(shown) || kNames.count(shown)) return Kind::kText;
  if (shown == "TEXT" && (kTexts.count(v.option) || kTextForms.count(v.option))) return Kind::kText;
  return Kind::kUnknown;
}

// Low and high of "N:INT in [LOW - HIGH]"; those of a seed.
std::pair<std::string, std::string> range_of(const std::string& shown) {
  std::smatch match;
  static const std::regex range(R"(.* in \[(\S+) - (\S+)\].*)");
  if (std::regex_match(shown, match, range)) return {match[1], match[2]};
  return {"0", "18446744073709551615"};
}

__int128 integer(const std::string& text) {
  __int128 value = 0;
  for (const char c : text)
    if (c != '-') value = 10 * value + (c - '0');
  return text[0] == '-' ? -value : value;
}
std::string text_of(__int128 value) {
  std::string digits;
  for (__int128 left = value < 0 ? -value : value; left > 0 || digits.empty(); left /= 10)
    digits.insert(digits.begin(), static_cast<char>('0' + static_cast<int>(left % 10)));
  return (value < 0 ? "-" : "") + digits;
}

// What no integer of [low, high] is, from `random`: beyond the range by little or much, wrapped
// around 2^32 or 2^64 into it, or a number spelt in a way that is none.
std::string no_integer(const std::function<uint64_t(uint64_t)>& random, __int128 low,
                       __int128 high) {
  const __int128 within = low + static_cast<__int128>(random(1u << 30)) % (high - low + 1);
  switch (random(8)) {
    case 0:
      return text_of(high + 1 + static_cast<__int128>(random(1000)));
    case 1:
      return text_of(low - 1 - static_cast<__int128>(random(1000)));
    case 2:
      return text_of(within + (__int128{1} << 64) * (1 + static_cast<int>(random(9))));
    case 3:
      return text_of(within - (__int128{1} << 64) * (1 + static_cast<int>(random(9))));
    case 4: {
      const __int128 wrapped = within + (__int128{1} << 32) * (1 + static_cast<int>(random(9)));
      return wrapped > high ? text_of(wrapped) : text_of(wrapped) + ".0";
    }
    case 5:
      return text_of(within) + std::string(1, "x.eE+- ,_'"[random(9)]);
    case 6:
      return std::string(1, "x+ _,"[random(5)]) + text_of(within < 0 ? -within : within);
    default: {
      std::string digits = "9";
      for (uint64_t n = 20 + random(60); n > 0; --n) digits += static_cast<char>('0' + random(10));
      return digits;
    }
  }
}

std::string shell_quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

}  // namespace

TEST_CASE("every option that takes a value is known as a number or as none") {
  const std::vector<Valued> all = valued_options();
  CHECK(all.size() > 150);
  for (const Valued& v : all) {
    INFO("photonloom" << v.command << " " << v.option << " takes '" << v.shown
                      << "': expected a type that this test fuzzes, or one of its lists of texts");
    CHECK(kind_of(v) != Kind::kUnknown);
  }
}

namespace {

// One option of each range, of the first command that has it, or each option of every command.
void check_numbers(bool every_command) {
  const uint64_t seed =
      std::getenv("PHOTONLOOM_SEED") ? std::stoull(std::getenv("PHOTONLOOM_SEED")) : 1;
  uint64_t drawn = 0;
  const auto random = [&](uint64_t below) { return hash_bits(seed, drawn++, 0, 0) % below; };
  const auto refused = [&](const Valued& v, const std::string& value) {
    const std::string command = v.command + " " + v.option + "=" + shell_quoted(value);
    INFO("PHOTONLOOM_SEED=" << seed << "; again: photonloom" << command);
    const Outcome o = run(command);
    INFO(o.err);
    CHECK(o.status == 2);
    CHECK_THAT(o.err, ContainsSubstring(v.option + ":"));
  };
  std::set<std::string> done, ranges;
  uint64_t numbers = 0;
  for (const Valued& v : valued_options()) {
    const Kind kind = kind_of(v);
    if (kind != Kind::kInteger && kind != Kind::kFloat) continue;
    const bool first = done.insert(v.option + v.shown).second;
    if (!ranges.insert(v.shown).second && !every_command) continue;
    ++numbers;
    const auto [low, high] = range_of(v.shown);
    std::vector<std::string> values;
    if (kind == Kind::kInteger) {
      for (int i = 0; i < 3; ++i) values.push_back(no_integer(random, integer(low), integer(high)));
      // Its ends are taken: what is wrong then is something else.
      if (v.option != "--threads")
        for (const std::string& end : {low, high}) {
          const Outcome o = run(v.command + " " + v.option + "=" + end);
          INFO("photonloom" << v.command << " " << v.option << "=" << end << "\n" << o.err);
          CHECK_THAT(o.err, !ContainsSubstring(v.option + ":"));
        }
      values.push_back(text_of(integer(high) + 1));
      values.push_back(text_of(integer(low) - 1));
    } else {
      values = {"nan",
                "1e-999",
                "1e999",
                fmt::format("{}x", random(100)),
                fmt::format("0x{}", random(100)),
                fmt::format(" {}", random(100))};
      if (v.shown.find(" in [") != v.shown.npos)
        values.push_back(
            fmt::format("{}", std::stod(high) * (1.5 + static_cast<double>(random(9)))));
    }
    // The same option of several commands has one parser: the fixed list once.
    if (kind == Kind::kInteger && first)
      for (const char* value : {"-18446744073709551615", "-18446744073709551616",
                                "18446744073709551616", "18446744073709551617",
                                "-9223372036854775809", "340282366920938463463374607431768211457",
                                "4294967297.0", "1e1", "0x1", "1 ", "+-1", "nan"})
        values.push_back(value);
    for (const std::string& value : values) refused(v, value);
  }
  CHECK(numbers > (every_command ? 60 : 10));
}

}  // namespace

TEST_CASE("no number of any option wraps, saturates or is cut") { check_numbers(false); }

TEST_CASE("no number of any option of any command wraps, saturates or is cut", "[slow]") {
  check_numbers(true);
}

TEST_CASE("numbers within a value of its own form are read as strictly") {
  const std::string cosim = "cosim '" + source("scenes/cornell.xml") + "'",
                    plan = "plan '" + source("scenes/cornell.xml") + "' -o -";
  const struct {
    std::string command, option;
    std::vector<std::string> values;
  } forms[] = {
      {"render '" + source("scenes/cornell.xml") + "' -o x.exr",
       "--size",
       {"0x1", "1x0", "-1x1", "16385x1", "18446744073709551617x1", "4294967297x1", "1x", "1x1 "}},
      {"precision '" + source("scenes/cornell.xml") + "' -o x.csv",
       "--size",
       {"0x1", "18446744073709551617x1", "1x1x1"}},
      {plan + " --error 0.1", "--measure-size", {"0x1", "4294967297x1", "1x"}},
      {plan, "--error", {"-1", "nan", "0", "1e-999", "0x1", "1xx", "-0.5x"}},
      {"sweep x.toml -o x", "--points", {"-1", "1-", "4294967296", "18446744073709551617", "2-1"}},
      {cosim, "--latency", {"-1", "18446744073709551617", "4294967297", "1.5", "nan", "1 "}},
      {cosim, "--stall", {"bernoulli:nan", "bernoulli:-1", "bernoulli:2", "bernoulli:0x1"}},
      {cosim, "--stall-in", {"bernoulli:nan", "bernoulli:1e-999", "bernoulli:"}},
      {cosim, "--stall-out", {"bernoulli:nan", "bernoulli:2"}},
      {cosim, "--stall-memory", {"bernoulli:nan", "bernoulli:-0.1"}},
      {cosim + " --wave w.fst --wave-unit photon_gatherer",
       "--wave-cycles",
       {"-1:2", "1:", "2:1", "18446744073709551616:18446744073709551617", "0x1:5"}},
  };
  std::set<std::string> done;
  for (const auto& f : forms)
    for (const std::string& value : f.values) {
      done.insert(f.option);
      const Outcome o = run(f.command + " " + f.option + "='" + value + "'");
      INFO(f.command << " " << f.option << "='" << value << "'\n" << o.err);
      CHECK(o.status == 2);
      CHECK_THAT(o.err, ContainsSubstring(f.option));
    }
  for (const Valued& v : valued_options())
    if (has_form(v)) {
      INFO(v.command << " " << v.option);
      // --format-error has its own cases above.
      CHECK((done.count(v.option) || v.option == "--format-error"));
    }
}

TEST_CASE("no integer line of a plan wraps in its file or by --set") {
  const uint64_t seed =
      std::getenv("PHOTONLOOM_SEED") ? std::stoull(std::getenv("PHOTONLOOM_SEED")) : 1;
  INFO("PHOTONLOOM_SEED=" << seed);
  uint64_t drawn = 0, lines = 0;
  const auto random = [&](uint64_t below) { return hash_bits(seed, drawn++, 1, 0) % below; };
  const std::string text = plan_text(Plan{}, {});
  std::string section;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with("[")) section = line.substr(1, line.find(']') - 1);
    const size_t equals = line.find(" = ");
    if (line.starts_with("#") || equals == std::string::npos) continue;
    const std::string key = line.substr(0, equals), value = line.substr(equals + 3);
    if (value.empty() || value.find_first_not_of("-0123456789", 0) != value.find_first_of(" \n#") ||
        value.find('.') < value.find(' '))
      continue;
    ++lines;
    std::vector<std::string> values = {"18446744073709551616",
                                       "-18446744073709551615",
                                       "9223372036854775808",
                                       "4294967297.0",
                                       "nan",
                                       "1e1"};
    // Wrapped around 2^64, or beyond any line's range.
    for (int i = 0; i < 4; ++i)
      values.push_back(
          text_of((__int128{1} << 64) * (1 + static_cast<int>(random(9))) * (random(2) ? 1 : -1) +
                  static_cast<__int128>(random(256))));
    for (const std::string& wrong : values) {
      INFO(section << "." << key << " = " << wrong);
      std::string changed = text;
      const size_t at = changed.find("\n" + key + " = ", changed.find("[" + section + "]"));
      REQUIRE(at != std::string::npos);
      changed.replace(at + key.size() + 4,
                      changed.find_first_of(" \n", at + key.size() + 4) - at - key.size() - 4,
                      wrong);
      CHECK_THROWS_AS(parse_plan(changed, "plan.toml"), PlanError);
      Plan plan;
      CHECK_THROWS_AS(set_plan_line(plan, section + "." + key + "=" + wrong), PlanError);
    }
  }
  CHECK(lines > 40);
}

namespace {

// Each value that is no count, or some of them: of each count others.
void check_counts(size_t step) {
  const Scratch s;
  const std::map<std::string, std::string> right = {
      {"seeds", "[1]"},     {"size", "\"2x2\""},   {"spp", "8"},       {"queries", "16"},
      {"latency", "5"},     {"format_seeds", "1"}, {"photons", "200"}, {"caustic", "10"},
      {"frame.spp", "1"},   {"rays", "1"},         {"count", "2"},     {"point_seed", "7"},
      {"point_seeds", "1"}, {"from", "4"}};
  const auto study = [&](const std::string& key, const std::string& value) {
    const auto at = [&](const std::string& k) { return k == key ? value : right.at(k); };
    return fmt::format(
        "[study]\nname = \"counts\"\nscenes = [\"no.xml\"]\nseeds = {}\nsize = {}\nmeasure = "
        "[\"visible\", \"gather\", \"formats\"]\n[references]\nspp = {}\nfiles = "
        "\"x.{{scene}}.{{n}}.exr\"\n[gather]\ncycles = \"model\"\nqueries = {}\nlatency = {}\n"
        "[formats]\nseeds = {}\n[base]\nphotons = {}\ncaustic_photons = {}\nframe.spp = {}\n"
        "frame.gather_rays = {}\n[[points]]\nstrategy = \"latin_hypercube\"\ncount = {}\nseed = "
        "{}\nseeds = {}\nlines = {{ gather.k = {{ from = {}, to = 64, log = true }} }}\n",
        at("seeds"), at("size"), at("spp"), at("queries"), at("latency"), at("format_seeds"),
        at("photons"), at("caustic"), at("frame.spp"), at("rays"), at("count"), at("point_seed"),
        at("point_seeds"), at("from"));
  };
  const std::string file = s / "study.toml";
  const auto swept = [&](const std::string& key, const std::string& value) {
    write_file(file, study(key, value));
    return run("sweep '" + file + "' -o '" + s / "out" + "'");
  };
  // What is wrong with the study as it stands is its scene alone.
  CHECK_THAT(swept("", "").err, ContainsSubstring("no.xml") && !ContainsSubstring("study.toml:"));
  const std::string wrongs[] = {"-1",
                                "-18446744073709551615",
                                "18446744073709551616",
                                "18446744073709551617",
                                "9223372036854775808",
                                "1.5",
                                "nan",
                                "inf",
                                "true",
                                "1e3",
                                "+-1",
                                "4294967297.0"};
  size_t begin = 0;
  for (const auto& [key, value] : right) {
    for (size_t i = begin++ % step; i < std::size(wrongs); i += step) {
      const std::string& wrong = wrongs[i];
      const std::string put = key == "seeds"  ? "[" + wrong + "]"
                              : key == "size" ? "\"" + wrong + "x2\""
                                              : wrong;
      INFO(key << " = " << put);
      const Outcome o = swept(key, put);
      INFO(o.err);
      CHECK(o.status == 1);
      CHECK_THAT(o.err, ContainsSubstring("study.toml:"));
    }
  }
}

}  // namespace

TEST_CASE("no count of a study file wraps") { check_counts(5); }

TEST_CASE("no count of a study file is any number that is none", "[slow]") { check_counts(1); }

TEST_CASE("no number of a packet's JSON wraps") {
  const Scratch s;
  const auto made = run("render '" + source("scenes/cornell.xml") +
                        "' --size 2x2 --spp 1 --gather-rays 1 --photons 100 --k 4 --record '" +
                        s / "packets" + "' -o '" + s / "x.exr" + "'");
  INFO(made.err);
  REQUIRE(made.status == 0);
  const std::string text = read_file(s / "packets/gather_query.jsonl"),
                    packet = text.substr(0, text.find('\n'));
  const std::regex field("\"(\\w+)\": \\[?(\\d+)");
  size_t fields = 0;
  for (std::sregex_iterator i(packet.begin(), packet.end(), field), end; i != end; ++i, ++fields)
    for (const std::string wrong :
         {"-1", "-18446744073709551615", "18446744073709551616", "18446744073709551617",
          "340282366920938463463374607431768211457", "1.5", "1e3", "true", "null"}) {
      std::string changed = packet;
      changed.replace(static_cast<size_t>(i->position(2)), static_cast<size_t>(i->length(2)),
                      wrong);
      write_file(s / "wrong.jsonl", changed + "\n");
      const Outcome o =
          run("replay photon_gatherer --backend golden --plan '" + s / "packets/plan.toml" +
              "' --packets '" + s / "wrong.jsonl" + "' -o '" + s / "found.jsonl" + "'");
      INFO(changed << "\n" << o.err);
      CHECK(o.status == 1);
      CHECK_THAT(o.err, ContainsSubstring("wrong.jsonl, line 1") &&
                            ContainsSubstring("field " + (*i)[1].str()));
    }
  CHECK(fields == 8);
}
