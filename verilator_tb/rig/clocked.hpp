// SPDX-License-Identifier: Apache-2.0
// What a backend that has a clock tells of its packets.
#pragma once
#include <cstdint>
#include <span>

namespace photonloom {

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
};

}  // namespace photonloom
