// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "golden/image/image.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"

using namespace photonloom;
using photonloom::test::Outcome;
using photonloom::test::run;
using photonloom::test::Scratch;

namespace {

Image flat(int width, int height, float value) {
  Image image;
  image.width = width;
  image.height = height;
  for (const char* name : {"R", "G", "B", "direct.R", "direct.G", "direct.B"})
    for (float& v : image.add(name).pixels) v = value;
  return image;
}

}  // namespace

TEST_CASE("compare prints every metric and keeps its exit status to what was asked") {
  const Scratch s;
  write_exr(flat(8, 6, 1.5f), s / "a.exr");
  write_exr(flat(8, 6, 1.0f), s / "b.exr");
  const std::string files = s / "a.exr" + " " + s / "b.exr";
  const Outcome o = run("compare --json " + files);
  CHECK(o.status == 0);
  CHECK(o.err.empty());
  const auto j = nlohmann::json::parse(o.out);
  CHECK(j["rmse"].get<double>() == Approx(0.5));
  CHECK(j["relmse"].get<double>() == Approx(0.25 / 1.01));
  CHECK(j["mape"].get<double>() == Approx(0.5 / 1.01));
  CHECK(j["mean_ratio"].get<double>() == Approx(1.5));
  CHECK(j["mean_ratio_rgb"].size() == 3);
  CHECK(j["psnr"].get<double>() == Approx(20 * std::log10(2.0)));
  CHECK(j["flip"].get<double>() > 0);
  CHECK(j["identical"] == false);

  for (const char* option :
       {"--max-rmse 0.51", "--max-relmse 0.26", "--max-mape 0.51", "--max-mean-ratio 0.51",
        "--max-mean-ratio-rgb 0.51", "--min-psnr 6", "--max-flip 0.9"}) {
    INFO(option);
    CHECK(run("compare " + files + " " + option).status == 0);
  }
  for (const char* option :
       {"--max-rmse 0.49", "--max-relmse 0.24", "--max-mape 0.49", "--max-mean-ratio 0.49",
        "--max-mean-ratio-rgb 0.49", "--min-psnr 6.1", "--max-flip 0.001", "--identical"}) {
    INFO(option);
    const Outcome failed = run("compare " + files + " " + option);
    CHECK(failed.status == 1);
    CHECK(failed.one_error_line());
    CHECK_FALSE(failed.out.empty());
  }
  const Outcome same =
      run("compare --identical --json --layer direct " + s / "a.exr" + " " + s / "a.exr");
  CHECK(same.status == 0);
  CHECK(nlohmann::json::parse(same.out)["psnr"].is_null());
}

TEST_CASE("compare refuses what cannot be compared, in one line") {
  const Scratch s;
  write_exr(flat(8, 6, 1), s / "a.exr");
  write_exr(flat(6, 8, 1), s / "b.exr");
  write_png(flat(8, 6, 1), s / "c.exr");
  Image bad = flat(8, 6, 1);
  bad.channels[2].pixels[9] = std::numeric_limits<float>::quiet_NaN();
  write_exr(bad, s / "d.exr");
  for (const char* other : {"b.exr", "c.exr", "d.exr", "none.exr"}) {
    INFO(other);
    const Outcome o =
        run("compare " + s / "a.exr" + " " + s / other + " --error-map " + s / "map.png");
    CHECK(o.status == 1);
    CHECK(o.one_error_line());
    CHECK(o.err.find(other) != std::string::npos);
    CHECK(o.out.empty());
  }
  CHECK(s.entries() == 4);
  CHECK(
      run("compare " + s / "a.exr" + " " + s / "a.exr" + " --error-map " + s / "map.png").status ==
      0);
  CHECK(s.entries() == 5);
  CHECK(run("compare " + s / "a.exr" + " " + s / "a.exr" + " --error-map /dev/full").status == 2);
  std::filesystem::create_symlink("/dev/full", s / "full.png");
  CHECK(
      run("compare " + s / "a.exr" + " " + s / "a.exr" + " --error-map " + s / "full.png").status ==
      1);
  const Outcome jpeg =
      run("compare " + s / "a.exr" + " " + s / "a.exr" + " --error-map " + s / "map.jpg");
  CHECK(jpeg.status == 2);
  CHECK(jpeg.err ==
        "photonloom: --error-map: '" + s / "map.jpg" + "', expected a name that ends in .png\n");
  CHECK(s.entries() == 6);
  CHECK(run("compare " + s / "a.exr" + " " + s / "a.exr" + " --layer caustic").status == 1);
}

TEST_CASE("a wrong command line is exit status 2") {
  for (const char* arguments :
       {"", "nothing", "compare", "compare a b c", "compare a b --max-relmse x", "--unknown",
        "compare a b --max-relmse nan", "average a -o b.exr --channels R,R", "average a -o b.png",
        "sheet a -o b.exr", "sheet a -o b.png --exposure nan", "sheet a= -o b.png"}) {
    INFO(arguments);
    CHECK(run(arguments).status == 2);
  }
  for (const char* arguments : {"--help", "--version", "compare --help"})
    CHECK(run(arguments).status == 0);
}
