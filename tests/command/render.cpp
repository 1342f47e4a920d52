// SPDX-License-Identifier: Apache-2.0
// render and plan as a user runs them.
#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "golden/image/image.hpp"
#include "golden/plan/plan_file.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"

using namespace photonloom;
using photonloom::test::Outcome;
using photonloom::test::run;
using photonloom::test::Scratch;
using photonloom::test::source;

namespace {

const std::string kSmall = " --size 16x16 --spp 2 --gather-rays 4 --k 10";
const std::string kPhotons = " --photons 2000 --caustic-photons 1000";

std::string balls() { return " '" + source("scenes/cornell_balls.xml") + "' "; }
std::string box() { return " '" + source("scenes/cornell.xml") + "' "; }
std::string quoted(const std::string& path) { return " '" + path + "' "; }

// The run must succeed.
Outcome good(const std::string& arguments) {
  const Outcome o = run(arguments);
  INFO(arguments << "\n" << o.err);
  REQUIRE(o.status == 0);
  return o;
}

void fails(const std::string& arguments, int status, const std::vector<std::string>& parts) {
  const Outcome o = run(arguments);
  INFO(arguments << "\n" << o.out << o.err);
  CHECK(o.status == status);
  if (status == 1) CHECK(o.one_error_line());
  for (const std::string& part : parts) {
    INFO(part);
    CHECK(o.err.find(part) != std::string::npos);
  }
}

size_t line_count(const std::string& path) {
  const std::string text = read_file(path);
  return static_cast<size_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace

TEST_CASE("render writes all layers, the metadata and a PNG") {
  const Scratch scratch;
  const Outcome o = good("render" + balls() + kSmall + kPhotons + " --seed 010 -o" +
                         quoted(scratch / "a.exr") + "--json");
  const auto summary = nlohmann::json::parse(o.out);
  CHECK(summary["photons"] >= 2000);
  CHECK(summary["counts"]["table_gathers"] > 0);
  CHECK(summary["phases"].size() >= 5);
  const Image image = read_exr(scratch / "a.exr");
  CHECK(image.width == 16);
  for (const char* name : {"R", "G", "B", "direct.R", "caustic.G", "indirect.B", "emission.R",
                           "albedo.R", "N.X", "N.Y", "N.Z", "Z", "photonDensity.Y", "error.R"}) {
    INFO(name);
    CHECK(image.find(name) != nullptr);
  }
  CHECK(image.metadata.at("scene") == "cornell_balls");
  CHECK(image.metadata.at("seed") == "10");
  CHECK(image.metadata.at("k") == "10");
  CHECK(image.metadata.at("planHash") == summary["plan_hash"].get<std::string>());
  CHECK(std::stod(image.metadata.at("radius")) > 0);
  CHECK(read_file(scratch / "a.png").substr(1, 3) == "PNG");
  CHECK(scratch.entries() == 2);
}

TEST_CASE("render says what ended at the end of a range, and how often") {
  const Scratch scratch;
  const std::string command = "render" + balls() + kSmall + kPhotons;
  const Outcome none = good(command + " -o" + quoted(scratch / "a.exr"));
  CHECK_THAT(none.out, ContainsSubstring("at the ends of ranges: none\n"));
  // Every radius is below the floor, no reach of a record is a position unit.
  const std::string ends =
      command +
      " --set gather.r2_floor=17179869183 --set cache.present=true --set cache.accuracy=0 --set "
      "cache.gradients=both -o" +
      quoted(scratch / "b.exr");
  const auto counts = nlohmann::json::parse(good(ends + "--json").out)["counts"];
  CHECK(counts["clamped"] > 50);
  CHECK(counts["clamped_reaches"] > 50);
  CHECK(counts["outside_positions"] == 0);
  CHECK_THAT(good(ends).out,
             ContainsSubstring(fmt::format("at the ends of ranges: clamped {}, ",
                                           counts["clamped"].get<uint64_t>())) &&
                 ContainsSubstring(
                     fmt::format("clamped_reaches {}", counts["clamped_reaches"].get<uint64_t>())));
}

TEST_CASE("both arithmetics and the path tracer run; the path tracer says what it does not read") {
  const Scratch scratch;
  good("render" + balls() + kSmall + kPhotons + " --arithmetic reference -o" +
       quoted(scratch / "r.exr"));
  const Outcome o = good("render" + box() + " --integrator path --size 8x8 --spp 2 --k 9 -o" +
                         quoted(scratch / "p.exr"));
  CHECK(o.err.find("--k changes nothing") != std::string::npos);
  CHECK(read_exr(scratch / "p.exr").find("indirect.R") != nullptr);
}

TEST_CASE("loaded photon maps and a plan from a file give the same bytes") {
  const Scratch scratch;
  const std::string rendered = scratch / "rendered.exr", plan = scratch / "plan.toml";
  good("render" + balls() + kSmall + kPhotons + " -o" + quoted(rendered));
  good("photons" + balls() + "--photons 2000 -o" + quoted(scratch / "g.ply"));
  good("photons" + balls() + "--caustic --photons 1000 -o" + quoted(scratch / "c.ply"));
  good("render" + balls() + kSmall + " --load-photons" + quoted(scratch / "g.ply") +
       "--load-caustics" + quoted(scratch / "c.ply") + "-o" + quoted(scratch / "loaded.exr"));
  CHECK(read_file(scratch / "loaded.exr") == read_file(rendered));
  // A number beside a file must be the file's.
  good("render" + balls() + kSmall + kPhotons + " --load-photons" + quoted(scratch / "g.ply") +
       "--load-caustics" + quoted(scratch / "c.ply") + "-o" + quoted(scratch / "loaded.exr"));
  CHECK(read_file(scratch / "loaded.exr") == read_file(rendered));
  fails("render" + balls() + kSmall + " --caustic-photons 999 --load-caustics" +
            quoted(scratch / "c.ply") + "-o" + quoted(scratch / "x.exr"),
        1, {"c.ply: holds ", "expected 999, as --caustic-photons asks"});
  good("plan" + balls() + kSmall + kPhotons + " -o" + quoted(plan));
  good("render" + balls() + "--plan" + quoted(plan) + "-o" + quoted(scratch / "planned.exr"));
  CHECK(read_file(scratch / "planned.exr") == read_file(rendered));
  // An edited width still renders, to another image.
  good("render" + balls() + "--plan" + quoted(plan) + "--set photon.position_bits=11 -o" +
       quoted(scratch / "edited.exr"));
  CHECK(read_file(scratch / "edited.exr") != read_file(rendered));

  fails("render" + box() + "--load-photons" + quoted(scratch / "g.ply") + "-o" +
            quoted(scratch / "x.exr"),
        1, {"g.ply", "another scene"});
  fails("render" + balls() + "--load-photons" + quoted(scratch / "c.ply") + "-o" +
            quoted(scratch / "x.exr"),
        1, {"c.ply", "caustic"});
  fails("render" + box() + "--load-caustics" + quoted(scratch / "c.ply") + "-o" +
            quoted(scratch / "x.exr"),
        1, {"c.ply", "no surface is a mirror or glass"});
  fails("render" + box() + "--plan" + quoted(plan) + "-o" + quoted(scratch / "x.exr"), 1,
        {"plan.toml", "does not hold the scene"});
  // Nor do lines that are set by hand.
  for (const std::string line : {"scene.extent=0.01", "scene.origin=[900,0,0]"})
    fails("render" + balls() + "--photons 100 --set " + line + " -o" + quoted(scratch / "x.exr"), 1,
          {"plan: ", "does not hold the scene", "expected a plan made for it"});
  fails("render" + balls() + "--photons 100 --set photon.channels=1 -o" + quoted(scratch / "x.exr"),
        1, {"plan: photon.channels is 1", "other colours"});
  fails("render" + balls() + "--plan" + quoted(plan) + "--k 5 -o" + quoted(scratch / "x.exr"), 2,
        {"--k", "--plan"});
}

namespace {

// An open box of five grey walls from -1 to 1, with what is given; scaled as a whole.
std::string room(const std::string& more, const std::string& scale = "1") {
  const auto wall = [&](const std::string& turn, const std::string& move) {
    return "<shape type=\"rectangle\"><transform name=\"toWorld\">" + turn + "<translate " + move +
           "/><scale value=\"" + scale +
           "\"/></transform><bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"0.7\"/></bsdf>"
           "</shape>";
  };
  const std::string turn = "<rotate angle=\"";
  return "<scene version=\"0.6.0\"><sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/>"
         "<transform name=\"toWorld\"><lookat origin=\"0,0,3.6\" target=\"0,0,0\" up=\"0,1,0\"/>"
         "<scale value=\"1\"/></transform></sensor>" +
         wall(turn + "-90\" x=\"1\"/>", "y=\"-1\"") + wall(turn + "90\" x=\"1\"/>", "y=\"1\"") +
         wall("", "z=\"-1\"") + wall(turn + "90\" y=\"1\"/>", "x=\"-1\"") +
         wall(turn + "-90\" y=\"1\"/>", "x=\"1\"") + more + "</scene>";
}

std::string point_light(const std::string& y, const std::string& intensity) {
  return "<emitter type=\"point\"><point name=\"position\" x=\"0\" y=\"" + y +
         "\" z=\"0\"/><rgb name=\"intensity\" value=\"" + intensity + "\"/></emitter>";
}

}  // namespace

TEST_CASE("scenes at the edge of what can be: the right image, a warning, or one clear error") {
  const Scratch scratch;
  const std::string file = scratch / "s.xml", scene = "render" + quoted(file),
                    out = " -o" + quoted(scratch / "x.exr");
  const std::string sampled = " --size 16x16 --spp 16 --gather-rays 8 --photons 30000 --k 20";
  // A lamp that lies on the floor lights the walls, not the floor below it.
  write_file(file, room(point_light("-1", "1")));
  good(scene + sampled + out);
  good(scene + " --integrator path --size 16x16 --spp 128 -o" + quoted(scratch / "p.exr"));
  good("compare" + quoted(scratch / "x.exr") + quoted(scratch / "p.exr") + "--max-mean-ratio 0.03");
  // No pixel could hold the light.
  write_file(file, room(point_light("0", "1e-30")));
  fails(scene + sampled + out, 1, {"pixel.fraction_bits has no value", "expected brighter lamps"});
  // Positions that do not resolve the room.
  write_file(file, room(point_light("0", "1") +
                        "<shape type=\"rectangle\"><transform name=\"toWorld\"><scale "
                        "value=\"1e5\"/><rotate angle=\"-90\" x=\"1\"/><translate y=\"-1.01\"/>"
                        "</transform></shape>"));
  CHECK(good(scene + sampled + out).err.find("too little for positions of 20 bits") !=
        std::string::npos);
  // Photons that are one, or all in one place, say nothing of how fine positions must be.
  const std::string one =
      good("render" + balls() +
           "--photons 1 --caustic-photons 1 --size 8x8 --spp 1 --gather-rays 4" + out)
          .err;
  CHECK(one.find("too little for positions") == std::string::npos);
  // What it advises instead is enough to find k.
  const size_t advice = one.find("try --photons ");
  REQUIRE(advice != std::string::npos);
  CHECK(std::stoi(one.substr(advice + 14)) >= 50);
  // A plan that is given has its photons, and takes no --photons beside it.
  CHECK(one.find("a plan made anew") == std::string::npos);
  good("plan" + balls() + "--photons 1 --caustic-photons 1 --size 8x8 --spp 1 --gather-rays 4 -o" +
       quoted(scratch / "few.toml"));
  CHECK(good("render" + balls() + "--plan" + quoted(scratch / "few.toml") + out)
            .err.find("--photons in a plan made anew") != std::string::npos);
  for (const std::string scale : {"1e13", "1e-13"}) {
    write_file(file, room(point_light("0", "1"), scale));
    for (const std::string integrator : {"path", "photonmap"})
      fails(scene + " --size 16x16 --integrator " + integrator + out, 1,
            {file + ": the scene is ", "units across, expected 1e-12 to 1e+12"});
  }
}

TEST_CASE("a plan is complete, says why, and reads back") {
  const Scratch scratch;
  const Outcome o = good("plan" + box() + "--photons 4000 --k 8 -o -");
  const Plan plan = parse_plan(o.out, "stdout");
  CHECK(plan.k == 8);
  CHECK(plan.index_bits() == 12);
  CHECK(!plan.caustic.present);
  CHECK(o.out.find("no surface is a mirror or glass") != std::string::npos);
  // Every line of the file has a reason after its meaning.
  Plan::visit(plan, [&](const std::string& section, const std::string& key, const auto&, auto, auto,
                        const char* meaning) {
    if (section == "scene" && key == "name") return;
    const size_t at = o.out.find("\n" + key + " = ", o.out.find("[" + section + "]")) + 1;
    const std::string line = o.out.substr(at, o.out.find('\n', at) - at);
    INFO(section << ": " << line);
    CHECK(line.find(std::string(" # ") + meaning + ": ") != std::string::npos);
  });
  const std::string uncached =
      good("plan" + box() + "--photons 4000 --k 8 --set gatherer.cache_bytes=0 -o -").out;
  CHECK(uncached.find("cache_bytes is not 0") != std::string::npos);
  const Plan fine =
      parse_plan(good("plan" + box() + "--photons 4000 --format-error 0.0005 -o -").out, "fine");
  const Plan coarse =
      parse_plan(good("plan" + box() + "--photons 4000 --format-error 0.05 -o -").out, "coarse");
  // What no format reaches is not promised.
  const std::string finest = good("plan" + box() + "--photons 400 --format-error 1e-9 -o -").out;
  CHECK(finest.find("1e-09 of") == std::string::npos);
  CHECK(finest.find("too few for 1e-09") != std::string::npos);
  CHECK(fine.position_bits > coarse.position_bits);
  CHECK(fine.mantissa_bits > coarse.mantissa_bits);
  CHECK(fine.direction_bits > coarse.direction_bits);
}

TEST_CASE("every packet can be recorded") {
  const Scratch scratch;
  const Outcome o = good("render" + balls() + kSmall + kPhotons + " --json --record" +
                         quoted(scratch / "packets") + "-o" + quoted(scratch / "a.exr"));
  const auto counts = nlohmann::json::parse(o.out)["counts"];
  const std::string folder = scratch / "packets/";
  const size_t finals = counts["final_gathers"], tables = counts["table_gathers"],
               caustics = counts["caustic_queries"], directions = counts["directions"];
  CHECK(line_count(folder + "reorder_in.jsonl") == finals + 1);  // and the flush
  CHECK(line_count(folder + "reorder_out.jsonl") == finals + 1);
  CHECK(line_count(folder + "gather_query.jsonl") == finals + tables + caustics + 1);
  CHECK(line_count(folder + "gather_result.jsonl") == finals + tables + caustics + 1);
  CHECK(line_count(folder + "sample.jsonl") == directions);
  CHECK(line_count(folder + "sampler_input.jsonl") ==
        tables + directions + line_count(folder + "gather_photon.jsonl"));
  const Plan plan = read_plan(folder + "plan.toml");
  CHECK(plan.k == 10);
}

TEST_CASE("a folder of recorded packets has no place for the image") {
  const Scratch scratch;
  std::filesystem::create_directory_symlink(scratch.path, scratch / "here");
  for (const std::string& record : {scratch / "packets", scratch / "here/packets/"})
    fails("render" + balls() + kSmall + kPhotons + " --record" + quoted(record) + "-o" +
              quoted(scratch / "packets/a.exr"),
          2, {"--output: ", "packets/a.exr is in the folder of --record"});
  CHECK(scratch.entries() == 1);
}

TEST_CASE("a name that is no UTF-8 stands in JSON as far as it can") {
  const Scratch scratch;
  const std::string name = scratch / "x\xff.exr";
  const Outcome o = good("render" + balls() + kSmall + kPhotons + " --json -o" + quoted(name));
  CHECK(std::filesystem::exists(name));
  const auto said = nlohmann::json::parse(o.out);
  CHECK(said["output"].get<std::string>().ends_with("x\xef\xbf\xbd.exr"));
  CHECK(
      nlohmann::json::parse(good("compare --json" + quoted(name) + quoted(name)).out)["identical"]);
}

TEST_CASE("a plan whose lines do not hold another seed's photons is refused by every command") {
  const Scratch scratch;
  const std::string plan = quoted(scratch / "few.toml");
  good("plan" + balls() +
       "--size 8x8 --spp 1 --gather-rays 4 --k 8 --photons 45 "
       "--caustic-photons 200 -o" +
       plan);
  const Plan few = read_plan(scratch / "few.toml");
  const std::string of = balls() + "--plan" + plan + "--seed ";
  uint64_t seed = 2;
  const auto stored = [&] {
    return good("photons" + balls() + "--photons " + std::to_string(few.global.photons) +
                " --seed " + std::to_string(seed) + " --json -o" + quoted(scratch / "p.ply"));
  };
  while (nlohmann::json::parse(stored().out)["photons"].get<uint64_t>() <= few.room(few.global))
    ++seed;
  const std::vector<std::string> told{"few.toml: global.photons is ",
                                      "lines hold " + std::to_string(few.room(few.global))};
  fails("render" + of + std::to_string(seed) + " -o" + quoted(scratch / "a.exr"), 1, told);
  fails("generate" + of + std::to_string(seed) + " -o" + quoted(scratch / "g"), 1, told);
  fails("cosim" + of + std::to_string(seed) + " --backend photon_gatherer=hls -o" +
            quoted(scratch / "c"),
        1, told);
}

TEST_CASE("a plan may come from a pipe") {
  const Scratch scratch;
  const std::string plan = scratch / "plan.toml";
  good("plan" + box() + kSmall + kPhotons + " -o" + quoted(plan));
  good("render" + box() + "--plan" + quoted(plan) + "-o" + quoted(scratch / "a.exr"));
  const std::string piped = "render" + box() + "--plan /dev/fd/3 -o" + quoted(scratch / "b.exr");
  const std::string command = "cat '" + plan + "' | '" +
                              photonloom::test::environment("PHOTONLOOM") + "' " + piped +
                              " 3<&0 >/dev/null";
  CHECK(std::system(command.c_str()) == 0);
  CHECK(read_file(scratch / "a.exr") == read_file(scratch / "b.exr"));
  // For a board too, which asks what the plan has before it is prepared.
  const std::string board = "cat '" + plan + "' | '" + photonloom::test::environment("PHOTONLOOM") +
                            "' plan" + box() + "--plan /dev/fd/3 --board ulx3s-85f -o" +
                            quoted(scratch / "board.toml") + " 3<&0 >/dev/null";
  CHECK(std::system(board.c_str()) == 0);
}

TEST_CASE("a plan may go into a pipe, whose reader gets it whole before the pipe's first end") {
  const Scratch scratch;
  const std::string plan = "plan" + box() + kSmall + kPhotons + " -o", pipe = scratch / "pipe.toml";
  good(plan + quoted(scratch / "plan.toml"));
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  std::string got;
  int rest = -1;  // lets a program go on that opens the pipe a second time
  std::thread reader([&] {
    got = read_file(pipe);
    rest = open(pipe.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  });
  const Outcome o = run(plan + quoted(pipe));
  // Ends the wait of a reader whom nobody has written to.
  const int end = open(pipe.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  close(end);
  reader.join();
  close(rest);
  INFO(o.err);
  CHECK(o.status == 0);
  CHECK(got == read_file(scratch / "plan.toml"));
}

TEST_CASE("a plan that is edited in its place keeps the reasons of what stays") {
  const Scratch scratch;
  const std::string plan = scratch / "plan.toml";
  good("plan" + box() + kSmall + kPhotons + " -o" + quoted(plan));
  const std::string before = read_file(plan);
  good("plan" + quoted(plan) + "--set gather.k=9 -o" + quoted(plan));
  const std::string after = read_file(plan);
  CHECK(read_plan(plan).k == 9);
  const auto line_of = [](const std::string& text, const std::string& key) {
    const size_t at = text.find("\n" + key + " = ") + 1;
    return text.substr(at, text.find('\n', at) - at);
  };
  CHECK(line_of(after, "k").ends_with(": set by hand"));
  for (const char* key : {"width", "position_bits", "beat_bits"}) {
    INFO(key);
    CHECK(line_of(before, key).find(": ") != std::string::npos);
    CHECK(line_of(after, key) == line_of(before, key));
  }
}

TEST_CASE("- is no file's name where nothing goes to standard output") {
  const Scratch scratch;
  good("photons" + box() + "--photons 100 -o" + quoted(scratch / "p.ply"));
  fails("gather --photons" + quoted(scratch / "p.ply") + "--queries" + quoted(scratch / "p.ply") +
            "--k 4 -o -",
        1, {"-: is not standard output here, expected a file"});
}

TEST_CASE("what cannot be is one clear error, and nothing is left behind") {
  const Scratch scratch;
  const std::string out = " -o" + quoted(scratch / "x.exr");
  fails("render /nonexistent.xml" + out, 1, {"/nonexistent.xml"});
  fails("render" + box() + kSmall + " -o /nonexistent/x.exr", 1, {"/nonexistent/x.exr"});
  fails("render" + box() + "--size 0x5" + out, 2, {"--size"});
  fails("render" + box() + "--size 64" + out, 2, {"--size"});
  fails("render" + box() + "--k 0" + out, 2, {"--k"});
  fails("render" + box() + "--spp 0" + out, 2, {"--spp"});
  for (const std::string seed : {"-1", "18446744073709551616", "0x10", "1.5", ""})
    fails("render" + box() + kSmall + " --photons 100 --seed '" + seed + "'" + out, 2,
          {"--seed: '" + seed + "'"});
  for (const std::string radius :
       {"-1", "nan", "inf", "1e-999", "1e999", "0x10", " 5", "5 ", "1,5"})
    fails("render" + box() + kSmall + " --photons 100 --radius='" + radius + "'" + out, 2,
          {"--radius: '" + radius + "', expected"});
  for (const std::string error : {"0", "-0.1", "1", "nan", "inf", "1e-999", "0x0.1", " 0.1"})
    fails("plan" + box() + "--photons 100 --format-error='" + error + "' -o" +
              quoted(scratch / "p.toml"),
          2, {"--format-error: '" + error + "', expected"});
  fails("rendre" + box() + out, 2, {"'rendre' is no command; photonloom --help"});
  fails("study foo -o x", 2, {"'foo' is no command of study; photonloom study --help"});
  fails("--bogus", 2, {"--bogus: is no option of photonloom; photonloom --help"});
  fails("board foo", 2, {"'foo' is no command of board; photonloom board --help"});
  fails("render" + box() + "--arithmetic exact" + out, 2, {"--arithmetic"});
  fails("render" + box() + "-D x" + out, 2, {"-D"});
  fails("render" + box() + "-o" + quoted(scratch / "x.png"), 2, {".exr"});
  fails("render" + box() + "--k 1 --photons 100" + out, 1, {"--k: gather.k is 1"});
  fails("render" + box() + "--set gather.k=1 --photons 100" + out, 1,
        {"--set: 'gather.k=1': gather.k is 1"});
  fails("render" + box() + "--k 1 --radius 0 --photons 100" + out, 1, {"gather.k is 1"});
  fails("render" + box() + "--k 1 --radius 1 --photons 100" + out, 1, {"gather.k is 1"});
  fails("render" + box() + "--photons 100 --set photon.channels=1 --set " +
            quoted("photon.channel_color=[0,0,0]") + out,
        1, {"photon.channel_color is black"});
  // What a path traced image does not read.
  for (const std::string option :
       {"--plan p.toml", "--record r", "--set gather.k=5", "--load-photons none.ply",
        "--load-caustics none.ply", "--arithmetic golden", "--arithmetic reference"})
    fails("render" + box() + "--integrator path " + option + out, 2,
          {option.substr(0, option.find(' ')) + ": has no meaning with --integrator path"});
  fails("render" + box() + "--photons 100 --set gather.k=999" + out, 2,
        {"--set: 'gather.k=999': gather.k", "1 to 256"});
  fails("render" + box() + "--photons 100 --set gather.colour=1" + out, 2,
        {"--set: ", "no line gather.colour"});
  fails("render" + box() + "--set gather.k=-18446744073709551616" + out, 2,
        {"--set: ", "1 to 256"});
  fails("render" + box() + "--photons 100 --set gather.k=5 --set gather.k=6" + out, 2,
        {"--set gather.k=6: gather.k is set twice"});
  fails("render" + box() + "--photons 100 --set photon.photon_bytes=4" + out, 1,
        {"photon.photon_bytes", "needs at least"});
  fails("render" + box() + "--plan /nonexistent.toml" + out, 1, {"/nonexistent.toml"});
  fails("render" + quoted(source("scenes/cornell.xml")) + "--plan" +
            quoted(source("fpga/headline/block_ram_k16.toml")) + out,
        1, {"block_ram_k16.toml: global.photons is 16384, expected at least 16386: "});
  write_file(scratch / "bad.toml", "[scene]\nname = 3\n");
  fails("render" + box() + "--plan" + quoted(scratch / "bad.toml") + out, 1,
        {"bad.toml:2", "scene.name"});
  fails("render" + box() + "--integrator path --record" + quoted(scratch / "r") + out, 2,
        {"--record"});
  fails("render" + box() + kSmall + " --record ''" + out, 2, {"--record: '', expected a value"});
  fails("info ''", 2, {"SCENE: '', expected a value"});
  CHECK(scratch.entries() == 1);  // bad.toml
  // A PNG that cannot be written is found before the work.
  std::filesystem::create_directory(scratch / "x.png");
  fails("render" + box() + out, 1, {"x.png", "it is a folder"});
  CHECK(scratch.entries() == 2);
}

TEST_CASE("no command writes in the place of what it reads") {
  const Scratch s;
  const auto file = [&](const char* name) { return quoted(s / name); };
  // A scene of its own meshes and pictures.
  write_file(s / "scene.xml",
             "<scene version=\"0.6.0\"><sensor type=\"perspective\"/>\n"
             "<shape type=\"ply\"><string name=\"filename\" value=\"mesh.ply\"/></shape>\n"
             "<emitter type=\"envmap\"><string name=\"filename\" value=\"sky.exr\"/></emitter>\n"
             "</scene>\n");
  good("mesh ring --triangles 200 -o" + file("mesh.ply"));
  good("mesh sky -o" + file("sky.exr"));
  good("photons" + box() + "--photons 100 -o" + file("g.ply"));
  write_file(s / "q.ply",
             "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
             "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
             "end_header\n1 1 1 0 0 1\n");
  good("plan" + box() + "--photons 100 -o" + file("p.toml"));
  for (const char* name : {"a.exr", "b.exr"})
    good("render" + box() + kSmall + " --photons 100 -o" + file(name));
  for (const char* name : {"in.jsonl", "x.photons.jsonl", "x.addresses.jsonl"})
    write_file(s / name, "{}\n");
  const std::string gather =
      "gather --photons" + file("g.ply") + "--queries" + file("q.ply") + "-o";
  const std::string replay = "replay photon_gatherer --backend golden --plan" + file("p.toml");
  const std::string photons = " --photons" + file("x.photons.jsonl");
  const struct {
    std::string arguments;
    const char* output;  // that would be lost
  } wrong[] = {
      {"render" + file("scene.xml") + kSmall + " -o" + file("sky.exr"), "sky.exr"},
      {"render" + file("scene.xml") + "--size 16x16 --integrator path -o" + file("sky.exr"),
       "sky.exr"},
      {"photons" + file("scene.xml") + "--photons 100 -o" + file("mesh.ply"), "mesh.ply"},
      {gather + file("q.ply"), "q.ply"},
      {gather + file("g.ply"), "g.ply"},
      {replay + "--packets" + file("in.jsonl") + "-o" + file("in.jsonl"), "in.jsonl"},
      {replay + "--packets" + file("in.jsonl") + photons + "-o" + file("x.jsonl"),
       "x.photons.jsonl"},
      {replay + "--packets" + file("x.addresses.jsonl") + photons + "-o" + file("x.jsonl"),
       "x.photons.jsonl"},
      {replay + "--packets" + file("in.jsonl") + "-o" + file("p.toml"), "p.toml"},
      {"average" + file("b.exr") + file("a.exr") + "-o" + file("b.exr"), "b.exr"},
      {"sheet" + file("a.png") + "label=" + s / "b.png" + " -o" + file("b.png"), "b.png"},
  };
  for (const auto& w : wrong) {
    const std::string before = read_file(s / w.output);
    fails(w.arguments, 1, {s / w.output + ": is the input, which would be lost"});
    CHECK(read_file(s / w.output) == before);
  }
  // Nor does a format take the place of another.
  fails("plan" + box() + "--photons 100 -o" + file("a.exr"), 2,
        {"--output: '" + s / "a.exr" + "', expected a name that ends in .toml"});
  fails("plan" + box() + "--load-photons" + file("g.ply") + "-o" + file("g.ply"), 2, {"--output"});
  fails("photons" + box() + "--photons 100 -o" + file("x.txt"), 2,
        {"--output: '" + s / "x.txt" + "', expected a name that ends in .ply"});
  good("plan" + file("p.toml") + "--set gather.k=9 -o" + file("p.toml"));  // an edit in place
}

TEST_CASE("an output that cannot be written is told before the work") {
  const Scratch s;
  std::filesystem::create_directory(s / "folder");
  for (const std::string& command :
       {"plan" + box() + "--board ulx3s-85f -o", "plan" + box() + "--photons 9000000 -o",
        "plan" + box() + "--error 0.1 -o", "photons" + box() + "--photons 9000000 -o",
        "precision" + box() + "-o", "generate" + box() + "--photons 9000000 -o"}) {
    const auto began = std::chrono::steady_clock::now();
    fails(command + " /dev/null/x" + (command.starts_with("photons") ? ".ply" : ".toml"), 1,
          {"/dev/null/x"});
    CHECK(std::chrono::steady_clock::now() - began < std::chrono::seconds(2));
  }
  fails("precision" + box() + "-o" + quoted(s / "folder"), 1, {"folder", "it is a folder"});
}

TEST_CASE("an option and --set do not decide one line") {
  const Scratch s;
  const std::string end = " -o" + quoted(s / "p.toml"), image = " -o" + quoted(s / "x.exr");
  for (const auto& [option, line] : {std::pair{"--k 8", "gather.k=6"},
                                     {"--spp 2", "frame.spp=3"},
                                     {"--size 4x4", "frame.width=5"},
                                     {"--size 4x4", "frame.height=5"},
                                     {"--gather-rays 2", "frame.gather_rays=3"},
                                     {"--photons 100", "global.photons=90"},
                                     {"--caustic-photons 100", "caustic.photons=90"}}) {
    const std::string both = fmt::format("{} --set {}", option, line), name = option;
    const std::string said = fmt::format("--set {}: {} is decided by {}", line,
                                         std::string(line).substr(0, std::string(line).find('=')),
                                         name.substr(0, name.find(' ')));
    fails("plan" + box() + both + end, 2, {said});
    fails("render" + box() + both + image, 2, {said});
  }
  fails("cosim" + box() + "--k 8 --set gather.k=6", 2, {"gather.k is decided by --k"});
  fails("plan" + box() + "--set foo" + end, 2, {"--set: 'foo', expected section.key=value"});
  fails("plan" + box() + "--set foo=1" + end, 2, {"--set: 'foo=1', expected section.key=value"});
  // Two plans of one command line, and JSON beside a plan on standard output.
  fails("plan" + box() + "--photons 100 -o - --json", 2, {"--json: with -o - "});
  CHECK(s.entries() == 0);
}

// AddressSanitizer's shadow alone takes more than this limit.
#ifndef __SANITIZE_ADDRESS__
TEST_CASE("what does not fit in memory is told") {
  const Scratch s;
  for (const auto& [arguments, what] :
       {std::pair{"photons" + box() + "--photons 268435457 -o" + quoted(s / "x.ply"),
                  "not enough memory for 268435457 global photons"},
        {"render" + box() + "--photons 100 --size 16384x16384 -o" + quoted(s / "x.exr"),
         "not enough memory for a frame of 16384x16384 pixels"},
        {"render" + box() + "--photons 100 --size 16x16 --spp 1048576 -o" + quoted(s / "x.exr"),
         "not enough memory for a frame of 16x16 pixels, 1048576 samples of each (frame.spp), "},
        {"render" + box() + "--integrator path --size 16384x16384 -o" + quoted(s / "x.exr"),
         "not enough memory for a frame of 16384x16384 pixels"},
        {"render /dev/zero -o" + quoted(s / "x.exr"),
         "/dev/zero: is larger than the memory that there is"}}) {
    const std::string command = "ulimit -v 1200000; '" +
                                photonloom::test::environment("PHOTONLOOM") + "' " + arguments +
                                " --threads 2 2>" + quoted(s / "err");
    INFO(command);
    CHECK(WEXITSTATUS(std::system(command.c_str())) == 1);
    CHECK_THAT(read_file(s / "err"), ContainsSubstring(what));
  }
}
#endif

TEST_CASE("render says why a region is short of photons, and the options that mend it do") {
  const Scratch scratch;
  const std::string frame = "render" + balls() + kSmall + " --photons 8000 --caustic-photons 2000";
  const Outcome bad = good(frame + " --radius 0.005 -o" + quoted(scratch / "a.exr") + "--json");
  CHECK(bad.err.find("warning: ") != std::string::npos);
  CHECK(bad.err.find("no photon within the radius of 0.005") != std::string::npos);
  const auto diagnosis = nlohmann::json::parse(bad.out)["diagnosis"];
  CHECK(diagnosis["global"]["no_photon"] > diagnosis["global"]["gathers"].get<uint64_t>() / 2);
  REQUIRE(diagnosis["regions"].size() >= 1);
  CHECK(diagnosis["regions"][0]["cause"] == "no photon within the radius");
  const Image image = read_exr(scratch / "a.exr");
  for (const char* layer : {"noPhoton.Y", "fewPhotons.Y", "starvedLight.Y"})
    CHECK(image.find(layer) != nullptr);
  const Outcome mended = good(frame + " --radius 0.005 " +
                              diagnosis["regions"][0]["advice"]["options"].get<std::string>() +
                              " -o" + quoted(scratch / "b.exr") + "--json");
  INFO(mended.err);
  CHECK(nlohmann::json::parse(mended.out)["diagnosis"]["regions"].empty());
}
