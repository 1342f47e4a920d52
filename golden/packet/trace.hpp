// SPDX-License-Identifier: Apache-2.0
// Packets as text: one JSON object a line, its members the packet's fields, decoded. Array fields
// are JSON arrays. A field wider than 53 bits is written as a decimal string, since JSON readers
// keep no more than a double; the reader takes either for any field. Absent fields do not appear.
#pragma once
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "golden/numeric/output_file.hpp"
#include "golden/packet/layout.hpp"

namespace photonloom {

std::string packet_to_json(const PacketLayout& layout, const void* packet);

// Parses one line into the C++ struct. `where` ("queries.jsonl, line 7") starts every message. A
// missing, unknown or repeated field, a value that is no unsigned integer or is over its width, or
// an array of another length is an error that names the field.
void packet_from_json(const PacketLayout& layout, std::string_view line, const std::string& where,
                      void* packet);

// Writes packets of one type; the file appears with commit().
template <class P>
class TraceWriter {
 public:
  TraceWriter(const std::string& path, const Plan& plan)
      : layout_(PacketLayout::of<P>(plan)), out_(path) {}
  void write(const P& packet) { out_.write(packet_to_json(layout_, &packet) + "\n"); }
  void commit() { out_.commit(); }

 private:
  PacketLayout layout_;
  OutputFile out_;
};

// Calls f(line, "path, line N") for every line that is not blank. An unreadable file is an error.
template <class F>
void for_each_line(const std::string& path, F&& f) {
  std::ifstream in(path);
  if (!in) throw std::runtime_error(path + ": cannot be opened for reading");
  std::string line;
  for (uint64_t number = 1; std::getline(in, line); ++number)
    if (line.find_first_not_of(" \t\r") != std::string::npos)
      f(line, path + ", line " + std::to_string(number));
  if (in.bad()) throw std::runtime_error(path + ": reading failed");
}

template <class P>
std::vector<P> read_trace(const std::string& path, const Plan& plan) {
  const PacketLayout layout = PacketLayout::of<P>(plan);
  std::vector<P> packets;
  for_each_line(path, [&](const std::string& line, const std::string& where) {
    P packet{};
    packet_from_json(layout, line, where, &packet);
    packets.push_back(packet);
  });
  return packets;
}

}  // namespace photonloom
