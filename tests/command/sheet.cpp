// SPDX-License-Identifier: Apache-2.0
#include "golden/image/sheet.hpp"

#include <array>

#include "tests/catch.hpp"
#include "tests/command/run.hpp"
#include "tests/flat_image.hpp"

using namespace photonloom;
using photonloom::test::flat_image;
using photonloom::test::Outcome;
using photonloom::test::run;
using photonloom::test::Scratch;

namespace {

std::array<int, 3> at(const Picture& p, int x, int y) {
  const uint8_t* rgb = p.rgb.data() + (y * p.width + x) * 3;
  return {rgb[0], rgb[1], rgb[2]};
}

using Pixel = std::array<int, 3>;
const Pixel kWhite = {255, 255, 255}, kBlack = {0, 0, 0}, kPaper = {250, 250, 250};

}  // namespace

TEST_CASE("a sheet has its tiles row by row, each where its column and row are") {
  const Scratch s;
  // Tiles of 40 x 30 once shrunk; the last is smaller and stands at its place's top left.
  write_exr(flat_image(80, 60, 1.0f), s / "white.exr");
  write_exr(flat_image(80, 60, 0.0f), s / "black.exr");
  Image halves = flat_image(16, 20, 0.0f);
  for (size_t p = 0; p < 16 * 20; ++p)
    if (p % 2 == 0) halves.channels[1].pixels[p] = 1;  // G, in every other column
  write_exr(halves, s / "halves.exr");
  REQUIRE(halves.channels[1].name == "G");
  const std::string tiles = " w=" + s / "white.exr" + " b=" + s / "black.exr" +
                            " h=" + s / "halves.exr" + " -o " + s / "sheet.png";
  REQUIRE(run("sheet --columns 2 --shrink 2 --exposure 0" + tiles).status == 0);
  const Picture p = read_png(s / "sheet.png", 1);
  REQUIRE(p.width == 8 + 2 * 48);
  REQUIRE(p.height == 8 + 2 * 50);
  for (const auto& [x, y, colour] :
       {std::tuple(8, 8, kWhite), std::tuple(47, 37, kWhite), std::tuple(7, 8, kPaper),
        std::tuple(48, 8, kPaper), std::tuple(56, 8, kBlack), std::tuple(95, 37, kBlack),
        std::tuple(56, 58, kPaper)}) {
    CAPTURE(x, y);
    CHECK(at(p, x, y) == colour);
  }
  // Half of one in linear light is 188 in sRGB (IEC 61966-2-1).
  CHECK(at(p, 8, 58) == Pixel{0, 188, 0});
  CHECK(at(p, 15, 67) == Pixel{0, 188, 0});
  CHECK(at(p, 16, 58) == kPaper);

  // 2^-1 of one, and its text below.
  REQUIRE(run("sheet --columns 2 --shrink 2 --exposure -1" + tiles).status == 0);
  const Picture dim = read_png(s / "sheet.png", 1);
  CHECK(at(dim, 8, 8) == Pixel{188, 188, 188});
  int ink = 0;
  for (int y = 38; y < 58; ++y)
    for (int x = 8; x < 48; ++x) ink += at(dim, x, y) == Pixel{20, 20, 20};
  CHECK(ink > 5);
}

TEST_CASE("each row of a sheet is exposed by its first EXR") {
  const Scratch s;
  write_exr(flat_image(10, 10, 0.8f), s / "a.exr");
  write_exr(flat_image(10, 10, 0.4f), s / "b.exr");
  REQUIRE(run("sheet --columns 2 " + s / "a.exr" + " " + s / "b.exr" + " " + s / "b.exr" + " -o " +
              s / "sheet.png")
              .status == 0);
  const Picture p = read_png(s / "sheet.png", 1);
  const Pixel first = at(p, 8, 8), beside = at(p, 26, 8), below = at(p, 8, 38);
  CHECK(first == Pixel{231, 231, 231});   // 0.8
  CHECK(beside == Pixel{170, 170, 170});  // 0.4
  CHECK(below == first);
}

TEST_CASE("a sheet takes any label, and tells an image too small to be shrunk") {
  const Scratch s;
  write_exr(flat_image(3, 2, 1.0f), s / "a.exr");
  const auto sheet = [&](const std::string& label, const std::string& out) {
    return run("sheet '" + label + "=" + s / "a.exr" + "' -o " + s / out);
  };
  REQUIRE(sheet("\xc3\x97\n", "marks.png").status == 0);
  REQUIRE(sheet("???", "asked.png").status == 0);
  CHECK(read_file(s / "marks.png") == read_file(s / "asked.png"));
  // A file's whole name goes before a label.
  write_exr(flat_image(60, 2, 1.0f), s / "b=a.exr");
  REQUIRE(run("sheet '" + s / "b=a.exr" + "' -o " + s / "named.png").status == 0);
  REQUIRE(run("sheet 'b=" + s / "b=a.exr" + "' -o " + s / "b.png").status == 0);
  CHECK(read_file(s / "named.png") != read_file(s / "b.png"));
  const Outcome small = run("sheet --shrink 64 " + s / "a.exr" + " -o " + s / "small.png");
  CHECK(small.status == 1);
  CHECK(small.one_error_line());
  CHECK(small.err.find("a.exr: has 3x2 pixels, too few to be shrunk 64 times") !=
        std::string::npos);
}
