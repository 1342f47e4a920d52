// SPDX-License-Identifier: Apache-2.0
// What a backend that has a clock tells of its packets.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace photonloom {

// How full a queue of the RTL was.
struct QueueFill {
  std::string name;  // instances in the design, from the top on, with dots between
  size_t depth = 0, most = 0;
  uint64_t full = 0, cycles = 0;  // cycles in which it was full, of so many since reset
};

// What a backend that has a clock knows of its packets. Cycles count from reset; those of the last
// process() only.
class Clocked {
 public:
  virtual ~Clocked() = default;
  virtual uint64_t cycles() const = 0;
  // In which cycle each packet of the last process() went in; empty unless RunOptions::timeline.
  virtual std::span<const uint64_t> in_cycles() const = 0;
  // In which cycle each packet came out; stream 0 is the unit's first output, 1 its second.
  virtual std::span<const uint64_t> out_cycles(int stream) const = 0;
  // Lets the unit run on without input: a packet that still comes is one too many, a RigError.
  virtual void finish() = 0;
  // Its queues, where RunOptions::watch_queues asks for them and the backend has them.
  virtual std::vector<QueueFill> queue_fills() const { return {}; }
};

}  // namespace photonloom
