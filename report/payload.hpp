// SPDX-License-Identifier: Apache-2.0
// What a page carries beside its data: blocks that it unpacks when they are looked at.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace photonloom {

// zlib at its strongest, then base64.
std::string packed_text(std::string_view bytes);

class Payloads {
 public:
  // The block's number.
  size_t add(std::string_view bytes) {
    blocks_.push_back(packed_text(bytes));
    return blocks_.size() - 1;
  }
  const std::vector<std::string>& blocks() const { return blocks_; }

 private:
  std::vector<std::string> blocks_;
};

}  // namespace photonloom
