// SPDX-License-Identifier: Apache-2.0
// Text files with named places: what is filled, and what is refused.
#include "rtl/generate/fill.hpp"

#include "tests/catch.hpp"

using namespace photonloom;

TEST_CASE("places are filled, and values are taken as they are") {
  CHECK(fill_text("a @X@ b @Y2_@@X@\n", "t", {{"X", "1"}, {"Y2_", "@X@"}}) == "a 1 b @X@1\n");
  CHECK(fill_text("no newline @X@", "t", {{"X", "1"}}) == "no newline 1\n");
  CHECK(fill_text("@X@\n", "t", {}, {{"X", "1"}, {"Y", "2"}}) == "1\n");
  CHECK(fill_text("tty@@X@\n", "t", {{"X", "9"}}) == "tty@9\n");
}

TEST_CASE("an @ before anything but a capital is text") {
  const std::string text = "\t@mkdir -p $@ a@b @ @@ @1@ @\n";
  CHECK(fill_text(text, "t", {}) == text);
}

TEST_CASE("a place alone on its line stands for whole lines") {
  CHECK(fill_text("a\n@X@\nb\n", "t", {{"X", ""}}) == "a\nb\n");
  CHECK(fill_text("a\n@X@\nb\n", "t", {{"X", "1\n2"}}) == "a\n1\n2\nb\n");
  CHECK(fill_text("a\n@X@\nb\n", "t", {{"X", "1\n2\n"}}) == "a\n1\n2\nb\n");
  CHECK(fill_text("a\n @X@\nb\n", "t", {{"X", ""}}) == "a\n \nb\n");
}

TEST_CASE("a place that is unknown, not closed or missing is named with its file") {
  CHECK_THROWS_WITH(fill_text("a\nb @TPO@\n", "Makefile", {{"TOP", "t"}}, {{"PINS", "p"}}),
                    "Makefile, line 2: the place @TPO@ is unknown, expected one of @TOP@, @PINS@");
  CHECK_THROWS_WITH(fill_text("@X@\n", "t", {}),
                    "t, line 1: the place @X@ is unknown, expected one of none");
  for (const char* text : {"b @TOP.ys\n", "b @TOP", "@TOP\n", "@TOP @TOP@\n"})
    CHECK_THROWS_WITH(fill_text(text, "t", {{"TOP", "t"}}),
                      "t, line 1: the place @TOP is not closed, expected @TOP@");
  CHECK_THROWS_WITH(fill_text("a\n", "t", {{"TOP", "t"}}),
                    "t: has no place @TOP@, expected it at least once");
  CHECK_NOTHROW(fill_text("a\n", "t", {}, {{"TOP", "t"}}));
}
