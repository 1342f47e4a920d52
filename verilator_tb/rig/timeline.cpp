// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/rig/timeline.hpp"

#include <fmt/core.h>

namespace photonloom {

void Timeline::add(const std::string& unit, const std::string& packet, uint64_t in, uint64_t out) {
  std::vector<Slice>& slices = units_[unit];
  if (slices.size() < packets_) slices.push_back({packet, in, out});
}

std::string Timeline::json() const {
  std::string text = "{\"displayTimeUnit\": \"ns\", \"traceEvents\": [\n";
  int process = 0;
  for (const auto& [unit, slices] : units_) {
    ++process;
    text += fmt::format(
        "{{\"ph\": \"M\", \"name\": \"process_name\", \"pid\": {}, \"args\": {{\"name\": "
        "\"{}\"}}}},\n",
        process, unit);
    size_t id = 0;
    for (const Slice& s : slices) {
      for (const auto& [phase, cycle] : {std::pair{'b', s.in}, std::pair{'e', s.out}})
        text += fmt::format(
            "{{\"ph\": \"{}\", \"cat\": \"{}\", \"name\": \"{}\", \"id\": {}, \"pid\": {}, "
            "\"tid\": "
            "0, \"ts\": {}}},\n",
            phase, unit, s.packet, id, process, cycle);
      ++id;
    }
  }
  if (text[text.size() - 2] == ',') text.erase(text.size() - 2, 1);
  return text + "]}\n";
}

}  // namespace photonloom
