// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "golden/image/metrics.hpp"
#include "golden/image/sheet.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"
#include "tests/flat_image.hpp"

using namespace photonloom;
using photonloom::test::Outcome;
using photonloom::test::run;
using photonloom::test::Scratch;

namespace {

Image flat(int width, int height, float value) {
  return photonloom::test::flat_image(width, height, value,
                                      {"R", "G", "B", "direct.R", "direct.G", "direct.B"});
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

TEST_CASE("compare judges the channel whose mean is the worst, whichever it is") {
  const Scratch s;
  write_exr(flat(8, 6, 1), s / "b.exr");
  for (const char* name : {"R", "G", "B"})
    for (const float value : {1.5f, 0.5f}) {
      INFO(name << " " << value);
      Image one = flat(8, 6, 1);
      for (Channel& c : one.channels)
        if (c.name == name) c.pixels.assign(c.pixels.size(), value);
      write_exr(one, s / "a.exr");
      const std::string command =
          "compare " + s / "a.exr" + " " + s / "b.exr" + " --max-mean-ratio-rgb ";
      CHECK(run(command + "0.51").status == 0);
      const Outcome failed = run(command + "0.49");
      CHECK(failed.status == 1);
      CHECK_THAT(failed.err,
                 ContainsSubstring("largest |mean_ratio_rgb - 1| is 0.5, at most 0.49"));
    }
}

TEST_CASE("an error map is black where images are equal and brighter where they differ more") {
  const Scratch s;
  // Green against ever more blue, in steps from the left: none at first, further than FLIP's
  // filters reach, all of it at last.
  constexpr int kWidth = 128, kHeight = 16;
  Image b = flat(kWidth, kHeight, 0);
  Image a = b;
  for (size_t c = 0; c < 3; ++c)
    for (size_t i = 0; i < static_cast<size_t>(kWidth * kHeight); ++i) {
      const float blue = static_cast<float>(i % kWidth / 32) / 3;
      b.channels[c].pixels[i] = b.channels[c].name == "G" ? 1.0f : 0.0f;
      a.channels[c].pixels[i] = a.channels[c].name == "G"   ? 1 - blue
                                : a.channels[c].name == "B" ? blue
                                                            : 0.0f;
    }
  write_exr(a, s / "a.exr");
  write_exr(b, s / "b.exr");
  REQUIRE(
      run("compare " + s / "a.exr" + " " + s / "b.exr" + " --error-map " + s / "map.png").status ==
      0);
  const Picture map = read_png(s / "map.png", 1);
  REQUIRE(map.width == kWidth);
  REQUIRE(map.height == kHeight);
  const std::vector<double> flip = hdr_flip(planes_of(a, "", "a"), planes_of(b, "", "b"));
  // The stops of --error-map's help, with straight lines between them.
  const double stops[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}};
  for (size_t i = 0; i < flip.size(); ++i)
    for (size_t c = 0; c < 3; ++c) {
      const size_t below = std::min<size_t>(2, static_cast<size_t>(flip[i] * 3));
      const double part = flip[i] * 3 - static_cast<double>(below);
      const double wanted = stops[below][c] * (1 - part) + stops[below + 1][c] * part;
      REQUIRE(std::fabs(map.rgb[3 * i + c] - 255 * wanted) <= 0.5 + 1e-9);
    }
  const auto light = [&](size_t pixel) {
    return map.rgb[3 * pixel] + map.rgb[3 * pixel + 1] + map.rgb[3 * pixel + 2];
  };
  CHECK(light(0) == 0);
  const auto worst = std::max_element(flip.begin(), flip.end()) - flip.begin();
  CHECK(flip[static_cast<size_t>(worst)] > 2.0 / 3);
  CHECK(light(static_cast<size_t>(worst)) > 2 * 255);
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
