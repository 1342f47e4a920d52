// SPDX-License-Identifier: Apache-2.0
// When packets were inside units, as Chrome trace JSON (opens in Perfetto): a process a unit, an
// asynchronous slice a packet; one cycle is shown as one microsecond.
#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace photonloom {

class Timeline {
 public:
  // Keeps the first `packets` packets of each unit.
  explicit Timeline(size_t packets) : packets_(packets) {}
  void add(const std::string& unit, const std::string& packet, uint64_t in, uint64_t out);
  std::string json() const;

 private:
  struct Slice {
    std::string packet;
    uint64_t in, out;
  };
  size_t packets_;
  std::map<std::string, std::vector<Slice>> units_;
};

}  // namespace photonloom
