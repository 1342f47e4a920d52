// SPDX-License-Identifier: Apache-2.0
#include "hls_kernels/generate/header.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <stdexcept>

#include "golden/numeric/output_file.hpp"
#include "golden/packet/layout.hpp"
#include "rtl/generate/data_files.hpp"
#include "rtl/generate/package.hpp"

namespace photonloom {

namespace {

std::string member_type(const FieldPlace& f) {
  return fmt::format("typename T::template uint<{}>", f.bits);
}

// Statements for every element of a field: `at` is its expression in the packet, `bit` its place in
// the word.
template <class F>
std::string for_each_element(const PacketLayout& layout, F&& statement) {
  std::string text;
  for (const FieldPlace& f : layout.fields())
    if (f.present())
      for (int i = 0; i < f.elements; ++i)
        text += statement(f, f.array ? fmt::format("{}[{}]", f.name, i) : f.name,
                          f.offset + i * f.bits);
  return text;
}

template <class P>
std::string packet_text(const Plan& plan) {
  const PacketLayout layout = PacketLayout::of<P>(plan);
  const std::string name = upper_camel(P::kName);
  const auto word = fmt::format("typename T::template bits<{}>", layout.bits());
  std::string text = fmt::format(
      "\n// {} bits; as a word the first field is in the most significant bits, element 0 of an "
      "array "
      "lowest.\ntemplate <class T>\nstruct {} {{\n  static constexpr int kBits = {};\n",
      layout.bits(), name, layout.bits());
  for (const FieldPlace& f : layout.fields()) {
    if (!f.present()) continue;
    text += fmt::format("  {} {}{};  // {}{}\n", member_type(f), f.name,
                        f.array ? fmt::format("[{}]", f.elements) : std::string(), f.meaning,
                        f.unit.empty() ? "" : " [" + f.unit + "]");
  }
  text += "  // Every field 0.\n  void zero() {\n";
  text += for_each_element(layout, [](const FieldPlace&, const std::string& at, int) {
    return fmt::format("    {} = 0;\n", at);
  });
  text += fmt::format("  }}\n}};\ntemplate <class T>\nvoid pack(const {}<T>& p, {}& word) {{\n",
                      name, word);
  text += for_each_element(layout, [](const FieldPlace&, const std::string& at, int bit) {
    return fmt::format("  T::set_slice(word, {}, p.{});\n", bit, at);
  });
  text +=
      fmt::format("}}\ntemplate <class T>\nvoid unpack(const {}& word, {}<T>& p) {{\n", word, name);
  text += for_each_element(layout, [](const FieldPlace& f, const std::string& at, int bit) {
    return fmt::format("  p.{} = T::template slice<{}>(word, {});\n", at, f.bits, bit);
  });
  return text + "}\n";
}

}  // namespace

std::string write_hls_header(const Plan& plan, uint64_t plan_hash) {
  std::string text = fmt::format(
      "// SPDX-License-Identifier: Apache-2.0\n"
      "// Generated from plan {0:016x}: its constants and packets. Edit the plan, not this file.\n"
      "#pragma once\n\n"
      "namespace photonloom_hls {{\n\n"
      "constexpr unsigned long long kPlanHash = 0x{0:016x}ull;  // of the plan's text\n",
      plan_hash);
  for (const PackageConstant& c : package_constants(plan))
    text += fmt::format("constexpr {} k{} = {}{};  // {}\n",
                        c.type == "int unsigned" ? "int" : "unsigned long long", c.name, c.number,
                        c.type == "int unsigned" ? "" : "ull", c.meaning);
  for_each_packet([&](auto tag) { text += packet_text<typename decltype(tag)::type>(plan); });
  return text + "\n}  // namespace photonloom_hls\n";
}

std::string default_hls_dir() {
  const char* chosen = std::getenv("PHOTONLOOM_HLS");
  return chosen && *chosen ? chosen : data_dir() + "/hls_kernels";
}

std::vector<std::string> hls_files(const std::string& hls_dir, std::vector<std::string> files) {
  constexpr std::string_view kInclude = "#include \"hls_kernels/";
  for (size_t i = 0; i < files.size(); ++i) {
    std::istringstream in(read_file(hls_dir + "/" + files[i]));
    for (std::string line; std::getline(in, line);) {
      if (!line.starts_with(kInclude)) continue;
      const std::string file = line.substr(kInclude.size(), line.rfind('"') - kInclude.size());
      if (std::find(files.begin(), files.end(), file) == files.end()) files.push_back(file);
    }
  }
  return files;
}

}  // namespace photonloom
