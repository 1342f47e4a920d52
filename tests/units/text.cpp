// SPDX-License-Identifier: Apache-2.0
#include "golden/numeric/text.hpp"

#include <fmt/core.h>

#include "tests/catch.hpp"

using namespace photonloom;

TEST_CASE("a number has one sign at most, before its first digit") {
  for (const char* text : {"5", "+5", "05"}) {
    CAPTURE(text);
    CHECK(parse_integer(text) == 5);
    CHECK(parse_double(text) == 5.0);
  }
  CHECK(parse_integer("-5") == -5);
  CHECK(parse_double("-5") == -5.0);
  for (const char* text : {"+-5", "-+5", "++5", "--5", "+", "-", "", " 5", "5 ", "5+", "0x5"}) {
    CAPTURE(text);
    CHECK_FALSE(parse_integer(text));
    CHECK_FALSE(parse_double(text));
  }
}

TEST_CASE("bytes that move the cursor are shown by number, all others as they are") {
  for (int byte = 0; byte < 256; ++byte) {
    CAPTURE(byte);
    const std::string text(1, static_cast<char>(byte));
    const bool moves = byte < 0x20 || byte == 0x7f;  // ASCII's control characters
    CHECK(shown("a" + text + "b") == "a" + (moves ? fmt::format("\\x{:02x}", byte) : text) + "b");
  }
  CHECK(shown(std::string(100, 'a')) == std::string(40, 'a'));
}

TEST_CASE("a reader of CSV gets each field back") {
  const std::vector<std::string> fields{"plain",     "",           "a,b",       "\"",
                                        "a \"b\" c", "two\nlines", "\"\",\"\"", " x "};
  std::string line;
  for (const std::string& field : fields) line += csv_field(field) + ",";
  // As RFC 4180 reads: a field in quotes ends at a quote that no second one follows.
  std::vector<std::string> read;
  for (size_t at = 0; at < line.size(); ++at) {
    std::string field;
    if (line[at] == '"') {
      for (++at; line.at(at) != '"' || line.at(at + 1) == '"'; ++at) {
        if (line[at] == '"') ++at;
        field += line[at];
      }
      ++at;
    } else {
      for (; line.at(at) != ','; ++at) field += line[at];
    }
    REQUIRE(line.at(at) == ',');
    read.push_back(field);
  }
  CHECK(read == fields);
  CHECK(csv_field("plain") == "plain");
  CHECK(csv_field("a\rb") == "\"a\rb\"");
}

TEST_CASE("seconds are said in units that a person counts in") {
  CHECK(spoken(0.42) == "0.4 s");
  for (int s = 10; s < 3 * 3600; ++s) {
    std::string wanted;
    if (s >= 3600)
      wanted = fmt::format("{} h {} min", s / 3600, s / 60 - s / 3600 * 60);
    else if (s >= 60)
      wanted = fmt::format("{} min {} s", s / 60, s - s / 60 * 60);
    else
      wanted = fmt::format("{} s", s);
    REQUIRE(spoken(s + 0.4) == wanted);
    REQUIRE(spoken(s - 0.4) == (s == 10 ? "9.6 s" : wanted));
  }
  // Examples of its declaration.
  CHECK(spoken(3 * 60 + 20) == "3 min 20 s");
  CHECK(spoken(2 * 3600 + 5 * 60) == "2 h 5 min");
}
