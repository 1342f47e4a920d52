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
  size_t add(std::string_view bytes) { return add_packed(packed_text(bytes)); }
  size_t add_packed(std::string text) {
    blocks_.push_back(std::move(text));
    return blocks_.size() - 1;
  }
  const std::vector<std::string>& blocks() const { return blocks_; }

 private:
  std::vector<std::string> blocks_;
};

}  // namespace photonloom
