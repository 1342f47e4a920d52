// SPDX-License-Identifier: Apache-2.0
#include "golden/packet/signature.hpp"

namespace photonloom {

namespace {
constexpr uint64_t kPolynomial = 0xC96C5795D7870F42;  // CRC-64 of ECMA-182, reflected
}

ResultSignature::ResultSignature(const Plan& plan)
    : layout_(PacketLayout::of<GatherResult>(plan)), words_(layout_.words() + 1, 0) {}

void ResultSignature::add(const GatherResult& result) {
  layout_.pack(&result, words_.data());
  for (size_t i = 0; i < layout_.words(); i += 2) {
    const uint64_t part = words_[i] | uint64_t{words_[i + 1]} << 32;
    state_ = (state_ >> 1) ^ (state_ & 1 ? kPolynomial : 0) ^ part;
  }
}

}  // namespace photonloom
