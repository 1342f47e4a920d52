// SPDX-License-Identifier: Apache-2.0
// The number by which a board's query replayer tells what its results were (docs/host-link.md).
#pragma once
#include <cstdint>
#include <vector>

#include "golden/packet/layout.hpp"

namespace photonloom {

// A 64-bit multiple-input signature register over the packed results, in order.
class ResultSignature {
 public:
  explicit ResultSignature(const Plan& plan);
  void add(const GatherResult& result);
  uint64_t value() const { return state_; }

 private:
  PacketLayout layout_;
  std::vector<uint32_t> words_;
  uint64_t state_ = 0;
};

}  // namespace photonloom
