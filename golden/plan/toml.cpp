// SPDX-License-Identifier: Apache-2.0
#include "golden/plan/toml.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
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

constexpr size_t kMostParts = 64;  // of a dotted key

// The characters of bare keys and of numbers.
bool is_bare(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' ||
         c == '-' || c == '+' || c == '.';
}

// Whether a decimal number has digits other than 0 and is 0 in double precision.
bool is_lost(std::string_view word) {
  std::string number(word.substr(0, word.find_first_not_of("0123456789_+-.eE")));
  std::erase(number, '_');
  const size_t exponent = std::min(number.find_first_of("eE"), number.size());
  if (number.size() != word.size() - static_cast<size_t>(std::ranges::count(word, '_')))
    return false;
  const size_t digit = number.find_first_of("123456789");
  return digit < exponent && std::strtod(number.c_str(), nullptr) == 0;
}

struct Fault {
  size_t at = 0;
  const char* what = nullptr;
};

// What toml++ must not see, or takes for another value, outside of strings and comments.
Fault find_fault(std::string_view text) {
  size_t parts = 1;
  for (size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (!is_ascii(c)) return {i, "a character beyond ASCII stands outside of strings and comments"};
    if (c == '#') {
      i = std::min(text.find('\n', i), text.size());
    } else if (c == '"' || c == '\'') {
      i = end_of_string(text, i);
    } else if (is_bare(c)) {
      size_t end = i;
      while (end < text.size() && is_bare(text[end])) ++end;
      const std::string_view word = text.substr(i, end - i);
      if (is_lost(word)) return {i, "a number is smaller than the least above 0, 4.9e-324"};
      parts += static_cast<size_t>(std::ranges::count(word, '.'));
      if (parts > kMostParts) return {i, "a key has more than 64 parts"};
      i = end;
    } else {
      if (c != ' ' && c != '\t') parts = 1;
      ++i;
    }
  }
  return {};
}

}  // namespace

toml::table parse_toml(std::string_view text, const std::string& file) {
  if (text.starts_with(kMark)) text.remove_prefix(kMark.size());
  if (const Fault fault = find_fault(text); fault.what) {
    toml::source_position at;
    const std::string_view before = text.substr(0, fault.at);
    at.line = static_cast<toml::source_index>(1 + std::count(before.begin(), before.end(), '\n'));
    at.column = static_cast<toml::source_index>(fault.at - (before.rfind('\n') + 1) + 1);
    throw toml::parse_error(fault.what, at, std::make_shared<const std::string>(file));
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
