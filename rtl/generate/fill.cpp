// SPDX-License-Identifier: Apache-2.0
#include "rtl/generate/fill.hpp"
#include "rtl/generate/data_files.hpp"

#include <fmt/core.h>

#include <set>
#include <sstream>
#include <stdexcept>

#include "golden/numeric/output_file.hpp"
#include "rtl/generate/data_files.hpp"
#include "rtl/generate/sources.hpp"

namespace photonloom {
namespace {

bool is_capital(char c) { return c >= 'A' && c <= 'Z'; }
bool is_of_name(char c) { return is_capital(c) || (c >= '0' && c <= '9') || c == '_'; }

// A line being filled, and what is said of it.
struct Line {
  const std::string& file;
  int number;
  const Places &must, &may;
  std::set<std::string>& found;

  const std::string& value(const std::string& name) const {
    found.insert(name);
    for (const Places* places : {&must, &may})
      if (const auto at = places->find(name); at != places->end()) return at->second;
    std::string known;
    for (const Places* places : {&must, &may})
      for (const auto& [place, text] : *places)
        known += fmt::format("{}@{}@", known.empty() ? "" : ", ", place);
    throw std::runtime_error(
        fmt::format("{}, line {}: the place @{}@ is unknown, expected one of {}", file, number,
                    name, known.empty() ? "none" : known));
  }
};

std::string filled(const std::string& text, const Line& line) {
  std::string out;
  for (size_t i = 0; i < text.size();) {
    if (text[i] != '@' || i + 1 == text.size() || !is_capital(text[i + 1])) {
      out += text[i++];
      continue;
    }
    size_t end = i + 1;
    while (end < text.size() && is_of_name(text[end])) ++end;
    const std::string name = text.substr(i + 1, end - i - 1);
    if (end == text.size() || text[end] != '@')
      throw std::runtime_error(
          fmt::format("{}, line {}: the place @{} is not closed, expected @{}@", line.file,
                      line.number, name, name));
    const std::string& value = line.value(name);
    if (i == 0 && end + 1 == text.size())  // alone: whole lines
      return value.empty() || value.back() == '\n' ? value : value + "\n";
    out += value;
    i = end + 1;
  }
  return out + "\n";
}

}  // namespace

std::string fill_text(const std::string& text, const std::string& file, const Places& must,
                      const Places& may) {
  std::istringstream in(text);
  std::set<std::string> found;
  std::string out, line;
  for (int number = 1; std::getline(in, line); ++number)
    out += filled(line, {file, number, must, may, found});
  for (const auto& [name, value] : must)
    if (!found.count(name))
      throw std::runtime_error(
          fmt::format("{}: has no place @{}@, expected it at least once", file, name));
  return out;
}

std::string fill(const std::string& file, const Places& must, const Places& may) {
  return fill_text(read_file(file), file, must, may);
}

std::string fill_template(const std::string& name, const Places& must) {
  return fill(data_dir() + "/rtl/generate/templates/" + name + ".in", must);
}

}  // namespace photonloom
