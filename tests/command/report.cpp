// SPDX-License-Identifier: Apache-2.0
// photonloom report: the page holds what the folders hold, and says what is wrong with one.
#include <fmt/core.h>
#include <zlib.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "golden/image/image.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"

using namespace photonloom;
using namespace photonloom::test;
using Json = nlohmann::json;

namespace {

std::string base64_bytes(const std::string& text) {
  static const std::string kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  uint32_t bits = 0;
  int held = 0;
  for (const char c : text) {
    if (c == '=') break;
    REQUIRE(kDigits.find(c) != std::string::npos);
    bits = bits << 6 | static_cast<uint32_t>(kDigits.find(c));
    if ((held += 6) >= 8) bytes += static_cast<char>(bits >> (held -= 8) & 255);
  }
  return bytes;
}

// A block of the page, unpacked.
std::string block(const std::string& page, const std::string& id) {
  const std::string open = "<script type=\"text/plain\" id=\"" + id + "\">";
  const size_t at = page.find(open);
  REQUIRE(at != std::string::npos);
  const size_t from = at + open.size();
  const std::string packed = base64_bytes(page.substr(from, page.find('<', from) - from));
  std::string bytes(64 << 20, '\0');
  uLongf size = bytes.size();
  REQUIRE(uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size,
                     reinterpret_cast<const Bytef*>(packed.data()), packed.size()) == Z_OK);
  bytes.resize(size);
  return bytes;
}
std::string payload(const std::string& page, const Json& number) {
  return block(page, fmt::format("p{}", number.get<size_t>()));
}

float half_value(uint32_t h) {
  const int exponent = static_cast<int>(h >> 10 & 31);
  const auto mantissa = static_cast<float>(h & 1023);
  const float size =
      exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(1024 + mantissa, exponent - 25);
  return h & 0x8000 ? -size : size;
}

// A channel of a layer as the page's reader finds it.
std::vector<float> channel(const std::string& bytes, size_t number, size_t width, size_t pixels,
                           int exponent, std::vector<uint32_t>& before, bool chained) {
  std::vector<float> out;
  before.resize(pixels);
  uint32_t bits = 0, above = 0;
  for (size_t i = 0; i < pixels; ++i) {
    const auto low = static_cast<uint8_t>(bytes[2 * number * pixels + i]),
               high = static_cast<uint8_t>(bytes[(2 * number + 1) * pixels + i]);
    if (i % width == 0) bits = above;
    bits = (bits + low + (uint32_t{high} << 8)) & 0xffff;
    if (i % width == 0) above = bits;
    before[i] = chained && number > 0 ? (bits + before[i]) & 0xffff : bits;
    out.push_back(std::ldexp(half_value(before[i]), exponent));
  }
  return out;
}

// One small run for all tests.
const std::string& small_run() {
  static const Scratch scratch;
  static const std::string folder = [] {
    const Outcome o = run(fmt::format(
        "cosim {} --size 8x8 --spp 1 --gather-rays 6 --k 8 --photons 2000 --caustic-photons 800 "
        "--set gatherer.cache_bytes=2048 --work cosim --packets 20 -o {}",
        source("scenes/cornell_balls.xml"), scratch / "run"));
    INFO(o.out << o.err);
    REQUIRE(o.status == 0);
    return scratch / "run";
  }();
  return folder;
}

void copy_folder(const std::string& from, const std::string& to) {
  std::filesystem::copy(from, to, std::filesystem::copy_options::recursive);
}

std::string report(const std::string& folder, const std::string& page) {
  return fmt::format("report '{}' -o '{}'", folder, page);
}

void cut_short(const std::string& path) {
  const std::string text = read_file(path);
  std::ofstream(path) << text.substr(0, text.size() / 2);
}

// Two points, of which one could not be run.
void write_study(const std::string& folder) {
  std::filesystem::create_directories(folder);
  write_file(folder + "/points.json", "{}\n");
  write_file(
      folder + "/summary.json",
      R"({"study": "two", "seeds": [1], "scenes": [{"scene": "cornell", "file": "cornell.xml",
 "hash": "00000000000000aa", "failure": "", "baseline": 0, "reference_relmse": null}],
 "measures": [{"measure": "visible", "meaning": "error", "columns": [{"name": "relmse", "unit": "",
 "meaning": "mean"}]}], "fronts": [{"front": "cycles", "cost": "gather.cycles"}], "points": [
 {"point": 0, "scene": "cornell", "plan": "0123", "origin": "baseline", "state": "done", "lines": {},
 "command": "photonloom plan cornell.xml", "front": ["cycles"], "values": {"visible.relmse":
 {"mean": 0.01, "error": null, "ratio": 1, "ratio_error": null}}},
 {"point": 1, "scene": "cornell", "plan": "", "origin": "list", "state": "refused", "reason": "why",
 "lines": {"gather.k": "0"}, "command": "", "front": [], "values": {}}]})");
}

}  // namespace

TEST_CASE("the page of a run holds its summary, plan, packets and images") {
  const Scratch s;
  const Outcome o = run(report(small_run(), s / "report.html"));
  INFO(o.err);
  REQUIRE(o.status == 0);
  const std::string page = read_file(s / "report.html");
  CHECK(page.find("default-src 'none'") != std::string::npos);
  const Json data = Json::parse(block(page, "data"));
  REQUIRE(data["runs"].size() == 1);
  const Json& r = data["runs"][0];
  CHECK(r["name"] == "cornell_balls");
  CHECK(r["summary"] == Json::parse(read_file(small_run() + "/summary.json")));
  CHECK(payload(page, r["plan_text"]) == read_file(small_run() + "/plan.toml"));
  size_t reasons = 0;
  for (const Json& line : r["plan"]["lines"]) {
    INFO(line.dump());
    CHECK_FALSE(line["value"].get<std::string>().empty());
    CHECK(line["value"].get<std::string>().find('#') == std::string::npos);
    reasons += !line["reason"].get<std::string>().empty();
    if (line["section"] == "gather" && line["key"] == "k") CHECK(line["value"] == "8");
  }
  CHECK(reasons > 10);
  for (const Json& stream : r["streams"]) {
    INFO(stream["stream"]);
    CHECK(stream["count"] > 0);
    CHECK(stream["kept"] == std::min<uint64_t>(20, stream["count"].get<uint64_t>()));
    CHECK(Json::parse(payload(page, stream["payload"])).size() == stream["kept"]);
    for (const Json& f : stream["fields"]) CHECK(f["used"] <= f["bits"]);
  }
  CHECK(r["utilisation"].size() == 3);
  for (const Json& u : r["utilisation"])
    for (const Json& busy : u["busy"]) CHECK((busy >= 0.0 && busy <= 1.0));
  CHECK(r["resources"].size() == 3);
}

TEST_CASE(
    "a run with an irradiance cache has a page, with resources of the units that have predicted "
    "ones") {
  const Scratch s;
  const Outcome made = run(fmt::format(
      "cosim {} --size 4x4 --spp 1 --gather-rays 4 --k 4 --photons 300 --set cache.present=true "
      "--work cosim --backend irradiance_cache=rtl -o {}",
      source("scenes/cornell.xml"), s / "run"));
  INFO(made.err);
  REQUIRE(made.status == 0);
  const Outcome o = run(report(s / "run", s / "report.html"));
  INFO(o.err);
  REQUIRE(o.status == 0);
  const Json data = Json::parse(block(read_file(s / "report.html"), "data"));
  std::vector<std::string> units;
  for (const Json& r : data["runs"][0]["resources"]) units.push_back(r["unit"]);
  CHECK(units == std::vector<std::string>{"photon_gatherer", "cdf_sampler"});
  CHECK(data["runs"][0]["summary"]["units"].contains("irradiance_cache"));
}

TEST_CASE("images of a page are the files' to the stated precision, equal ones stored once") {
  const Scratch s;
  REQUIRE(run(report(small_run(), s / "report.html")).status == 0);
  const std::string page = read_file(s / "report.html");
  const Json images = Json::parse(block(page, "data"))["runs"][0]["images"];
  REQUIRE(images["list"].size() == 3);
  CHECK(images["list"][2]["same_as"] == "golden");
  CHECK_FALSE(images["list"][2].contains("layers"));
  CHECK(images["list"][0]["same_as"] == "");
  CHECK(images["base"] == "golden");
  const Image golden = read_exr(images["list"][1]["file"]);
  for (const size_t n : {0u, 1u}) {
    const Json& entry = images["list"][n];
    const Image file = read_exr(entry["file"]);
    size_t channels = 0;
    for (const Json& layer : entry["layers"]) {
      const std::string bytes = payload(page, layer["payload"]);
      std::vector<uint32_t> before;
      for (size_t c = 0; c < layer["channels"].size(); ++c, ++channels) {
        INFO(layer["channels"][c]);
        const Channel* truth = file.find(layer["channels"][c]);
        REQUIRE(truth);
        const int exponent = layer["exponents"][c];
        const auto read = channel(bytes, c, 8, 64, exponent, before, layer["chained"]);
        for (size_t p = 0; p < 64; ++p) {
          CHECK(layer["difference"] == (n == 0));
          // What an image differs by has a precision of its own.
          const float v =
              truth->pixels[p] - (n == 0 ? golden.find(layer["channels"][c])->pixels[p] : 0.0f);
          const float allowed =
              std::max(std::ldexp(std::fabs(v), -11), std::ldexp(1.0f, exponent - 25));
          CHECK(std::fabs(read[p] - v) <= allowed);
        }
      }
    }
    CHECK(channels == file.channels.size());
  }
}

TEST_CASE("equal folders give equal pages") {
  const Scratch s;
  REQUIRE(run(report(small_run(), s / "a.html")).status == 0);
  REQUIRE(run(report(small_run(), s / "b.html")).status == 0);
  CHECK(read_file(s / "a.html") == read_file(s / "b.html"));
}

TEST_CASE("a study's page lists the points that were not run") {
  const Scratch s;
  write_study(s / "study");
  const Outcome o = run(report(s / "study", s / "report.html"));
  INFO(o.err);
  REQUIRE(o.status == 0);
  const Json study = Json::parse(block(read_file(s / "report.html"), "data"))["studies"][0];
  CHECK(study["points"].size() == 2);
  CHECK(study["points"][1]["reason"] == "why");
  CHECK(study["plans_kept"] == 0);
  CHECK(study["scenes"][0]["images"].is_null());
}

TEST_CASE("a folder that is neither, a missing and a damaged file are errors that name it") {
  const Scratch s;
  const auto refused = [&](const std::string& folder, const std::string& file,
                           const std::string& expected) {
    const Outcome o = run(report(folder, s / "report.html"));
    INFO(o.err);
    CHECK(o.status == 1);
    CHECK(o.one_error_line());
    CHECK_THAT(o.err, ContainsSubstring(file) && ContainsSubstring(expected));
    CHECK_FALSE(std::filesystem::exists(s / "report.html"));
  };
  refused(s / "nowhere", s / "nowhere", "is no folder");
  std::filesystem::create_directories(s / "empty");
  refused(s / "empty", s / "empty", "neither a run");
  for (const char* name : {"summary.json", "golden.exr", "rtl.exr", "plan.toml", "timeline.json"}) {
    const std::string without = s / ("without-" + std::string(name)),
                      cut = s / ("cut-" + std::string(name));
    copy_folder(small_run(), without);
    std::filesystem::remove(without + "/" + name);
    refused(without, without + "/" + name, "");
    copy_folder(small_run(), cut);
    cut_short(cut + "/" + name);
    refused(cut, cut + "/" + name, "");
  }
  copy_folder(small_run(), s / "packets");
  cut_short(s / "packets/packets.json");
  refused(s / "packets", s / "packets/packets.json", "is damaged");
  copy_folder(small_run(), s / "plan");
  std::string plan = read_file(s / "plan/plan.toml");
  plan.replace(plan.find("\nk = 8"), 6, "\nk = 9");
  write_file(s / "plan/plan.toml", plan);
  refused(s / "plan", s / "plan/plan.toml", "has the hash");
  write_study(s / "study");
  write_file(s / "study/summary.json", "{\"study\": \"two\"}");
  refused(s / "study", s / "study/summary.json", "has no \"scenes\"");
}

TEST_CASE(
    "a study's summary.json that is no sweep's is refused with the member and what it must be") {
  const Scratch s;
  write_study(s / "study");
  const std::string file = s / "study/summary.json";
  const Json whole = Json::parse(read_file(file));
  const struct {
    const char *at, *value, *said;
  } wrong[] = {
      {"/study", "3", "study is 3, expected a text"},
      {"/scenes", "{}", "scenes is {}, expected an array"},
      {"/scenes/0", "3", ", scenes[0]: has no \"scene\""},
      {"/scenes/0/scene", "3", "scenes[0].scene is 3, expected a text"},
      {"/scenes/0/hash", "3", "scenes[0].hash is 3, expected a text"},
      {"/measures", "3", "measures is 3, expected an array"},
      {"/measures/0/columns/0/unit", "null",
       "measures[0].columns[0].unit is null, expected a text"},
      {"/fronts", "7", "fronts is 7, expected an array"},
      {"/points/1", "[]", ", points[1]: has no \"point\""},
      {"/points/1/point", "-1", "points[1].point is -1, expected an integer of at least 0"},
      {"/points/1/plan", "3", "points[1].plan is 3, expected a text"},
      {"/points/1/scene", "\"kitchen\"",
       "points[1].scene is \"kitchen\", expected one of the scenes"},
      {"/points/1/state", "\"bogus\"",
       "points[1].state is \"bogus\", expected done, refused, failed, missing"},
      {"/points/1/lines/gather.k", "0", "points[1].lines.gather.k is 0, expected a text"},
      {"/points/0/front", "[1]", "points[0].front[0] is 1, expected a text"},
      {"/points/1/values", "3", "points[1].values is 3, expected an object"},
      {"/points/0/values/visible.relmse", "3",
       ", points[0].values.visible.relmse: has no \"mean\""},
      {"/points/0/values/visible.relmse/mean", "\"0.01\"",
       "points[0].values.visible.relmse.mean is \"0.01\", expected a number or null"},
  };
  for (const auto& w : wrong) {
    INFO(w.at << " = " << w.value);
    Json changed = whole;
    changed[Json::json_pointer(w.at)] = Json::parse(w.value);
    write_file(file, changed.dump());
    const Outcome o = run(report(s / "study", s / "report.html"));
    INFO(o.err);
    CHECK(o.status == 1);
    CHECK(o.one_error_line());
    CHECK_THAT(o.err, ContainsSubstring(file) && ContainsSubstring(w.said));
    CHECK_FALSE(std::filesystem::exists(s / "report.html"));
  }
}

TEST_CASE("a further image is the first; one of no scene or another size is refused") {
  const Scratch s;
  const auto with = [&](const std::string& image) {
    return run(report(small_run(), s / "report.html") + " --image '" + image + "'");
  };
  const std::string reference = small_run() + "/reference.exr";
  CHECK(with("cornell_balls").status == 2);
  CHECK(with("cornell_balls/traced=").status == 2);
  const Outcome unknown = with("teapot/traced=" + reference);
  CHECK(unknown.status == 1);
  CHECK_THAT(unknown.err, ContainsSubstring("has a scene 'teapot'"));
  const Outcome large =
      with("cornell_balls/traced=" + source("scenes/references/cornell_balls.exr"));
  CHECK(large.status == 1);
  CHECK_THAT(large.err,
             ContainsSubstring("references/cornell_balls.exr: has 256x256 pixels, expected "));
  REQUIRE(with("cornell_balls/traced=" + reference).status == 0);
  const Json images = Json::parse(block(read_file(s / "report.html"), "data"))["runs"][0]["images"];
  CHECK(images["list"][0]["label"] == "traced");
  CHECK(images["list"][1]["same_as"] == "traced");
}
