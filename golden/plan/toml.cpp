// SPDX-License-Identifier: Apache-2.0
#include "golden/plan/toml.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <sstream>

namespace photonloom {
namespace {

constexpr std::string_view kMark = "\xEF\xBB\xBF";  // what some editors write in front

bool is_ascii(char c) { return static_cast<unsigned char>(c) < 0x80; }

// Where the string that starts at `at` ends: behind its last quote, or where its line or the text
// ends if it has none.
size_t end_of_string(std::string_view text, size_t at) {
  const char quote = text[at];
  const std::string three(3, quote);
  const bool is_long = text.substr(at, 3) == three;
  for (size_t i = at + (is_long ? 3 : 1); i < text.size(); ++i) {
    if (text[i] == '\\' && quote == '"') {
      ++i;
    } else if (is_long) {
      if (text.substr(i, 3) == three) return i + 3;
    } else if (text[i] == quote) {
      return i + 1;
    } else if (text[i] == '\n') {
      return i;
    }
  }
  return text.size();
}

// The first character beyond ASCII outside of strings and comments, or the text's end.
size_t find_stray(std::string_view text) {
  size_t i = 0;
  while (i < text.size() && is_ascii(text[i])) {
    if (text[i] == '#')
      i = std::min(text.find('\n', i), text.size());
    else if (text[i] == '"' || text[i] == '\'')
      i = end_of_string(text, i);
    else
      ++i;
  }
  return i;
}

}  // namespace

toml::table parse_toml(std::string_view text, const std::string& file) {
  if (text.starts_with(kMark)) text.remove_prefix(kMark.size());
  if (const size_t stray = find_stray(text); stray < text.size()) {
    toml::source_position at;
    const std::string_view before = text.substr(0, stray);
    at.line = static_cast<toml::source_index>(1 + std::count(before.begin(), before.end(), '\n'));
    at.column = static_cast<toml::source_index>(stray - (before.rfind('\n') + 1) + 1);
    throw toml::parse_error("a character beyond ASCII stands outside of strings and comments", at,
                            std::make_shared<const std::string>(file));
  }
  // What is no TOML is found while it is ASCII alone: behind an error strings need not be strings.
  if (!std::all_of(text.begin(), text.end(), is_ascii)) {
    std::string plain(text);
    std::replace_if(plain.begin(), plain.end(), std::not_fn(is_ascii), 'x');
    static_cast<void>(toml::parse(plain, file));
  }
  return toml::parse(text, file);
}

std::string toml_number(double x) {
  const std::string text = fmt::format("{}", x);
  return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

std::string toml_text(const toml::node& node) {
  if (node.is_table()) return "a table";
  std::ostringstream shown;
  if (const toml::array* array = node.as_array()) {
    for (const toml::node& n : *array) shown << (&n == array->get(0) ? "" : ", ") << toml_text(n);
    return "[" + shown.str() + "]";
  }
  if (const auto* f = node.as_floating_point()) return toml_number(f->get());
  node.visit([&](const auto& n) { shown << n; });
  return shown.str();
}

}  // namespace photonloom
