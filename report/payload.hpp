// SPDX-License-Identifier: Apache-2.0
// What a page carries beside its data: blocks that it unpacks when they are looked at.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace photonloom {

// What bytes are: text and the like, or differences of neighbours, which are small numbers that
// repeat little.
enum class Content { kText, kDifferences };

// zlib at its strongest for such content, then base64.
std::string packed_text(std::string_view bytes, Content content = Content::kText);

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
