// SPDX-License-Identifier: Apache-2.0
#include "rtl/generate/sources.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>

#include "golden/numeric/output_file.hpp"
#include "golden/plan/units.hpp"
#include "rtl/generate/data_files.hpp"

namespace photonloom {

namespace fs = std::filesystem;

namespace {

std::string chosen_or(const char* variable, const std::string& folder) {
  const char* chosen = std::getenv(variable);
  return chosen && *chosen ? chosen : data_dir() + "/" + folder;
}

}  // namespace

std::string default_rtl_dir() { return chosen_or("PHOTONLOOM_RTL", "rtl"); }

std::string default_boards_dir() { return chosen_or("PHOTONLOOM_BOARDS", "fpga/boards"); }

namespace {

// Module name -> path relative to rtl_dir.
std::map<std::string, std::string> index_modules(const std::string& rtl_dir) {
  if (!fs::is_directory(rtl_dir))
    throw std::runtime_error(rtl_dir + ": is no folder, expected the RTL sources");
  std::map<std::string, std::string> modules;
  for (const auto& folder : fs::directory_iterator(rtl_dir)) {
    if (folder.path().extension() == ".sv" && folder.path().stem() != "photonloom_pkg")
      modules[folder.path().stem().string()] = folder.path().filename().string();
    if (!folder.is_directory()) continue;
    for (const auto& file : fs::directory_iterator(folder.path()))
      if (file.path().extension() == ".sv")
        modules[file.path().stem().string()] =
            folder.path().filename().string() + "/" + file.path().filename().string();
  }
  return modules;
}

std::string find_module(const std::map<std::string, std::string>& modules,
                        const std::string& rtl_dir, const std::string& module) {
  const auto at = modules.find(module);
  if (at == modules.end())
    throw std::runtime_error(fmt::format("{}: has no module {}", rtl_dir, module));
  return at->second;
}

// The text without comments; line breaks stay.
std::string without_comments(const std::string& text) {
  std::string out;
  for (size_t i = 0; i < text.size();) {
    if (text.compare(i, 2, "//") == 0) {
      while (i < text.size() && text[i] != '\n') ++i;
    } else if (text.compare(i, 2, "/*") == 0) {
      const size_t end = text.find("*/", i + 2);
      for (; i < text.size() && i < end + 2; ++i)
        if (text[i] == '\n') out += '\n';
    } else {
      out += text[i++];
    }
  }
  return out;
}

void visit(const std::map<std::string, std::string>& modules, const std::string& rtl_dir,
           const std::string& module, std::set<std::string>& seen,
           std::vector<std::string>& files) {
  if (!seen.insert(module).second) return;
  const std::string file = find_module(modules, rtl_dir, module);
  const std::string text = without_comments(read_file(rtl_dir + "/" + file));
  std::string word;
  for (const char c : text + " ") {
    if (std::isalnum(static_cast<unsigned char>(c)) || c == '_') {
      word += c;
      continue;
    }
    if (word != module && modules.count(word)) visit(modules, rtl_dir, word, seen, files);
    word.clear();
  }
  files.push_back(file);
}

}  // namespace

std::vector<std::string> module_files(const std::string& rtl_dir, const std::string& module,
                                      const std::set<std::string>& without) {
  const auto modules = index_modules(rtl_dir);
  std::set<std::string> seen = without;
  std::vector<std::string> files;
  visit(modules, rtl_dir, module, seen, files);
  return files;
}

std::vector<std::string> modules_named(const std::string& text, const std::string& dir) {
  const std::string code = without_comments(text);
  std::set<std::string> found;
  for (const auto& [module, file] : index_modules(dir))
    if (std::regex_search(code, std::regex("\\b" + module + "\\b"))) found.insert(module);
  return {found.begin(), found.end()};
}

std::vector<ModulePort> module_ports(const std::string& rtl_dir, const std::string& module) {
  const std::string file = find_module(index_modules(rtl_dir), rtl_dir, module);
  std::istringstream in(read_file(rtl_dir + "/" + file));
  static const std::regex port(
      R"(^\s*(input|output)\s+(?:wire\s+)?(.*?)\s*\b(\w+)\s*,?\s*(?://\s*(.*))?$)");
  static const std::regex start("^\\s*module\\s+" + std::string(R"((\w+)\b.*)"));
  static const std::regex comment(R"(^\s*(//.*)?$)");
  std::vector<ModulePort> ports;
  bool inside = false, listing = false;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    std::smatch m;
    if (!inside) {
      inside = std::regex_match(line, m, start) && m[1] == module;
      if (!inside) continue;
    }
    if (std::regex_match(line, m, port)) {
      listing = true;
      ports.push_back({m[1] == "output", m[2], m[3], m[4]});
      continue;
    }
    if (!listing) continue;
    if (line.find(");") != std::string::npos) return ports;
    if (!std::regex_match(line, comment))
      throw std::runtime_error(
          fmt::format("{}/{}, line {}: expected one port a line", rtl_dir, file, number));
  }
  throw std::runtime_error(fmt::format("{}/{}: no port list found", rtl_dir, file));
}

bool is_shared(const ModulePort& port) { return port.name.starts_with("shared_"); }

std::string open_pin(const ModulePort& port) {
  if (!port.output) return "." + port.name + "('0)";
  return "/* verilator lint_off PINCONNECTEMPTY */ ." + port.name +
         "() /* verilator lint_on PINCONNECTEMPTY */";
}

std::string package_type(const std::string& type, const std::string& unit) {
  const auto is_word = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
  };
  const bool named = type.find("photonloom_pkg::") != std::string::npos;
  std::string out;
  for (size_t i = 0; i < type.size();) {
    std::string word;
    while (i < type.size() && is_word(type[i])) word += type[i++];
    if (named || word.empty() || !std::isupper(static_cast<unsigned char>(word[0])))
      out += word;
    else if (unit == unit_name<PhotonGatherer> && word == "TagBits")
      out += "photonloom_pkg::LineTagBits";
    else
      out += "photonloom_pkg::" + word;
    if (!word.empty()) continue;
    if (!(type[i] == ' ' && !out.empty() && (out.back() == ' ' || out.back() == '[')))
      out += type[i];
    ++i;
  }
  return out;
}

}  // namespace photonloom
