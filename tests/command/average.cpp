// SPDX-License-Identifier: Apache-2.0
#include "tests/catch.hpp"
#include "tests/command/run.hpp"
#include "tests/flat_image.hpp"

using namespace photonloom;
using photonloom::test::Outcome;
using photonloom::test::run;
using photonloom::test::Scratch;

namespace {

Image uniform(int width, int height, float value) {
  Image image = photonloom::test::flat_image(width, height, value, {"R", "G", "B", "Z"});
  image.metadata["scene"] = "flat";
  return image;
}

}  // namespace

TEST_CASE("average is the mean of every channel, or of those asked for") {
  const Scratch s;
  write_exr(uniform(3, 2, 1.0f), s / "a.exr");
  write_exr(uniform(3, 2, 4.0f), s / "b.exr");
  const std::string files = s / "a.exr" + " " + s / "b.exr";
  REQUIRE(run("average " + files + " -o " + s / "m.exr --channels R,G,B").status == 0);
  const Image m = read_exr(s / "m.exr");
  CHECK(m.find("Z") == nullptr);
  CHECK(m.metadata.at("scene") == "flat");
  for (const char* name : {"R", "G", "B"})
    for (const float v : m.find(name)->pixels) CHECK(v == 2.5f);
  REQUIRE(run("average --channels R,G,B " + files + " -o " + s / "m2.exr").status == 0);
  CHECK(read_file(s / "m2.exr") == read_file(s / "m.exr"));
  REQUIRE(run("average " + files + " -o " + s / "all.exr").status == 0);
  CHECK(read_exr(s / "all.exr").channels.size() == 4);
}

TEST_CASE("average refuses sizes and channels that do not fit, in one line") {
  const Scratch s;
  write_exr(uniform(3, 2, 1.0f), s / "a.exr");
  write_exr(uniform(4, 2, 1.0f), s / "b.exr");
  write_exr(uniform(3, 4, 1.0f), s / "c.exr");
  for (const auto& [other, size] : {std::pair{"b.exr", "4x2"}, {"c.exr", "3x4"}}) {
    const Outcome sizes = run("average " + s / "a.exr" + " " + s / other + " -o " + s / "m.exr");
    CHECK(sizes.status == 1);
    CHECK(sizes.one_error_line());
    CHECK_THAT(sizes.err,
               ContainsSubstring(std::string(other) + ": " + size + " pixels, expected 3x2"));
  }
  const Outcome channel = run("average " + s / "a.exr -o " + s / "m.exr --channels R,X");
  CHECK(channel.status == 1);
  CHECK(channel.one_error_line());
  CHECK(channel.err.find("no channel X") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(s / "m.exr"));
  CHECK(run("average -o " + s / "m.exr").status == 2);
  const Outcome nowhere = run("average " + s / "a.exr -o " + s / "none/m.exr");
  CHECK(nowhere.status == 1);
  CHECK(nowhere.one_error_line());
}
