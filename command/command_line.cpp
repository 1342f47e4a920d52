// SPDX-License-Identifier: Apache-2.0
#include "command/command_line.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <utility>

#include "verilator_tb/model/tools.hpp"

namespace photonloom {

std::string command_line(const std::vector<std::string>& without) {
  std::ifstream in("/proc/self/cmdline", std::ios::binary);
  const std::string all{std::istreambuf_iterator<char>(in), {}};
  std::string text;
  for (const char* name : {"PHOTONLOOM_RTL", "PHOTONLOOM_HLS", "PHOTONLOOM_BOARDS"})
    if (const char* folder = std::getenv(name); folder && *folder)
      text +=
          fmt::format("{}{}={}", text.empty() ? "" : " ", name, model_tools::shell_word(folder));
  bool value_follows = false;
  for (size_t at = 0; at < all.size();) {
    const std::string word = all.substr(at, all.find('\0', at) - at);
    at += word.size() + 1;
    const bool left_out = std::exchange(
        value_follows, std::find(without.begin(), without.end(), word) != without.end());
    const bool with_its_value =
        std::any_of(without.begin(), without.end(),
                    [&](const std::string& option) { return word.starts_with(option + "="); });
    if (left_out || value_follows || with_its_value) continue;
    text += (text.empty() ? "" : " ") + model_tools::shell_word(word);
  }
  return text;
}

}  // namespace photonloom
