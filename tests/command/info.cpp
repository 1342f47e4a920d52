// SPDX-License-Identifier: Apache-2.0
// photonloom info and mesh as a user runs them.
#include <fstream>
#include <nlohmann/json.hpp>

#include "golden/image/image.hpp"
#include "golden/numeric/output_file.hpp"
#include "golden/plan/plan_file.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"

using namespace photonloom::test;
using photonloom::read_file;

TEST_CASE("info: counts, bounds, powers, needs") {
  const Outcome text = run("info '" + source("scenes/cornell_balls.xml") + "'");
  CHECK(text.status == 0);
  CHECK_THAT(text.out, ContainsSubstring("caustic map yes") && ContainsSubstring("glass_ball"));
  const Outcome json = run("info --json '" + source("scenes/cornell_balls.xml") + "'");
  REQUIRE(json.status == 0);
  const auto j = nlohmann::json::parse(json.out);
  CHECK(j["triangles"] == 12);
  CHECK(j["primitives"] == 14);
  CHECK(j["bounds"]["lower"] == nlohmann::json({-1, -1, -1}));
  CHECK(j["needs"]["caustic_map"] == true);
  CHECK(j["needs"]["glossy_lobes"] == false);
  CHECK(j["needs"]["units"].size() == 4);
  // A lamp of 0.6 x 0.6 radiates pi L A.
  CHECK(j["power"][0].get<double>() == Approx(3.14159265358979 * 14 * 0.36));
  CHECK(j["hash"].get<std::string>().size() == 16);
  CHECK(j["film"]["filter"] == "box");
  CHECK(j["camera"] == "perspective");
  CHECK(j["instances"] == 0);
  CHECK_THAT(text.out, ContainsSubstring("film       256 x 256, box filter of radius 0.5") &&
                           ContainsSubstring("loaded     in "));
}

TEST_CASE("info and plan agree on maps and channels") {
  const Scratch scratch;
  // Grey walls, one lamp; a red BSDF that nothing uses.
  const std::string body =
      "<bsdf type=\"diffuse\" id=\"red\"><rgb name=\"reflectance\" value=\"0.7,0.1,0.1\"/></bsdf>"
      "<shape type=\"sphere\"><boolean name=\"flipNormals\" value=\"true\"/></shape>"
      "<shape type=\"sphere\"><float name=\"radius\" value=\"0.1\"/><emitter type=\"area\">"
      "<rgb name=\"radiance\" value=\"1,2,3\"/></emitter></shape>";
  for (const std::string depth : {"-1", "2"}) {
    std::ofstream(scratch / "s.xml")
        << "<scene version=\"0.6.0\"><integrator type=\"path\"><integer name=\"maxDepth\" value=\""
        << depth << "\"/></integrator><sensor type=\"perspective\"/>" << body << "</scene>";
    const Outcome info = run("info --json '" + scratch / "s.xml" + "'");
    INFO(info.err);
    REQUIRE(info.status == 0);
    const auto needs = nlohmann::json::parse(info.out)["needs"];
    const Outcome plan = run("plan --photons 500 '" + scratch / "s.xml" + "' -o -");
    INFO(plan.err);
    REQUIRE(plan.status == 0);
    const photonloom::Plan planned = photonloom::parse_plan(plan.out, "plan");
    CHECK(needs["global_map"] == planned.global.present);
    CHECK(needs["caustic_map"] == planned.caustic.present);
    CHECK(needs["units"].empty() == !planned.global.present);
    CHECK(needs["channels_at_most"] == 1);
    CHECK(planned.channels == 1);
  }
}

TEST_CASE("info: photons are of the hardware where a surface gathers them") {
  const Scratch s;
  const std::string glass = "<shape type=\"sphere\"><bsdf type=\"dielectric\"/></shape>",
                    floor = "<shape type=\"rectangle\"/>";
  for (const bool gathered : {false, true}) {
    std::ofstream(s / "s.xml") << "<scene version=\"0.6.0\"><sensor type=\"perspective\"/><emitter "
                                  "type=\"point\"/>" +
                                      glass + (gathered ? floor : "") + "</scene>";
    const auto info = nlohmann::json::parse(run("info --json '" + s / "s.xml" + "'").out);
    CHECK(info["needs"]["caustic_map"] == gathered);
    CHECK(info["bsdfs"][0]["hardware"][0] ==
          (gathered ? "caustic photons that it throws" : "nothing: the host follows its light"));
  }
}

TEST_CASE(
    "info: surroundings of several colours may take three channels, as the plan's photons do") {
  const Scratch scratch;
  std::ofstream(scratch / "s.xml")
      << "<scene version=\"0.6.0\"><sensor type=\"perspective\"/><shape type=\"sphere\"/>"
         "<emitter type=\"envmap\"><string name=\"filename\" "
         "value=\"sky.exr\"/></emitter></scene>";
  for (const bool coloured : {false, true}) {
    photonloom::Image sky;
    sky.width = 8;
    sky.height = 4;
    // A red half and a blue one; or one channel, brighter in one half.
    for (const char* name : {"R", "G", "B"}) {
      if (!coloured && *name != 'R') continue;
      auto& pixels = sky.add(coloured ? name : "Y").pixels;
      for (size_t i = 0; i < pixels.size(); ++i)
        pixels[i] = *name == (i % 8 < 4 ? 'R' : 'B') ? 2.0f : 1.0f;
    }
    write_exr(sky, scratch / "sky.exr");
    const Outcome info = run("info --json '" + scratch / "s.xml" + "'");
    INFO(info.err);
    REQUIRE(info.status == 0);
    const Outcome plan = run("plan --photons 500 '" + scratch / "s.xml" + "' -o -");
    INFO(plan.err);
    REQUIRE(plan.status == 0);
    const int channels = photonloom::parse_plan(plan.out, "plan").channels;
    CHECK(channels == (coloured ? 3 : 1));
    CHECK(nlohmann::json::parse(info.out)["needs"]["channels_at_most"] == channels);
  }
}

TEST_CASE("info: parameters and bad input") {
  const std::string atrium = "info --json '" + source("scenes/atrium.xml") + "'";
  CHECK(nlohmann::json::parse(run(atrium + " -D triangles=300000").out)["triangles"] > 250000);
  // Before the scene and more than once, too.
  CHECK(run("info -D triangles=20000 '" + source("scenes/atrium.xml") + "'").status == 0);
  const Outcome twice =
      run("info -D triangles=20000 -D triangles=3 '" + source("scenes/atrium.xml") + "'");
  CHECK(twice.status == 2);
  CHECK(twice.err == "photonloom: parameter 'triangles' is given twice with -D\n");
  const Outcome unused = run(atrium + " -D size=3");
  CHECK(unused.status == 1);
  CHECK(unused.one_error_line());
  CHECK(run(atrium + " -D triangles").status == 2);
  CHECK(run("info").status == 2);
  const Outcome missing = run("info /nowhere.xml");
  CHECK(missing.status == 1);
  CHECK(missing.one_error_line());
  const Scratch scratch;
  std::ofstream(scratch / "image.xml") << "\x89PNG\r\n\x1a\n";
  const Outcome image = run("info '" + scratch / "image.xml" + "'");
  CHECK(image.status == 1);
  CHECK(image.one_error_line());
  CHECK_THAT(image.err, ContainsSubstring("image.xml:1: not an XML file"));
}

TEST_CASE("mesh: writes whole files only") {
  const Scratch scratch;
  CHECK(run("mesh atrium --triangles 5000 -o '" + scratch / "a.ply" + "'").status == 0);
  CHECK(scratch.entries() == 1);
  const Outcome picture = run("mesh planks -o '" + scratch / "b.exr" + "'");
  CHECK(picture.status == 2);
  CHECK(picture.err.find("expected a name that ends in .png") != std::string::npos);
  CHECK(run("mesh sky --triangles 500 -o '" + scratch / "b.exr" + "'").status == 2);
  const Outcome few = run("mesh atrium --triangles 100 -o '" + scratch / "b.ply" + "'");
  CHECK(few.status == 1);
  CHECK(few.one_error_line());
  CHECK(run("mesh ring -o '" + scratch / "none/b.ply" + "'").status == 1);
  CHECK(run("mesh sponza -o '" + scratch / "b.ply" + "'").status == 2);
  CHECK(scratch.entries() == 1);
}

TEST_CASE("output that is lost on a full disk is an error") {
  const Scratch scratch;
  for (const char* arguments : {"units", "units --json", "--help"}) {
    INFO(arguments);
    const std::string command = "'" + environment("PHOTONLOOM") + "' " + arguments +
                                " >/dev/full 2>'" + scratch / "err" + "'";
    CHECK(WEXITSTATUS(std::system(command.c_str())) == 1);
    CHECK(read_file(scratch / "err") ==
          "photonloom: standard output: cannot be written: No space left on device\n");
  }
}

TEST_CASE("what standard error cannot take is lost alone") {
  const Scratch scratch;
  const auto status = [&](const std::string& arguments, const std::string& streams) {
    const std::string command = "'" + environment("PHOTONLOOM") + "' " + arguments + " " + streams;
    return WEXITSTATUS(std::system(command.c_str()));
  };
  const std::string render = "render '" + source("scenes/cornell.xml") +
                             "' --photons 500 --size 16x16 --spp 1 --gather-rays 4 --k 8 -o '" +
                             scratch / "a.exr" + "'";
  REQUIRE_FALSE(run(render).err.empty());  // a warning, say
  for (const std::string streams : {"2>/dev/full", "2>&-"}) {
    INFO(streams);
    CHECK(status("info none.xml", streams) == 1);
    CHECK(status("nothing", streams) == 2);
    CHECK(status(render, streams + " >/dev/null") == 0);
    CHECK(std::filesystem::exists(scratch / "a.exr"));
  }
}

TEST_CASE("closed standard streams are no places for other files") {
  const Scratch scratch;
  const std::string program = "'" + environment("PHOTONLOOM") + "' ";
  for (int i = 0; i < 5; ++i) {
    const std::string info = program + "units <&- >&- 2>'" + scratch / "err" + "'";
    CHECK(WEXITSTATUS(std::system(info.c_str())) == 1);
    CHECK(read_file(scratch / "err") ==
          "photonloom: standard output: cannot be written: Bad file descriptor\n");
    const std::string silent = program + "photons '" + source("scenes/cornell.xml") +
                               "' --photons 100 -o '" + scratch / "p.ply" + "' <&- >&- 2>&-";
    CHECK(WEXITSTATUS(std::system(silent.c_str())) == 1);
  }
}
