// SPDX-License-Identifier: Apache-2.0
// SHA-256 (FIPS 180-4), for sums of images that have to be the same everywhere.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace photonloom {

class Sha256 {
 public:
  Sha256();
  void add(std::string_view bytes);
  std::string hex();  // 64 digits; ends the sum

 private:
  void block(const unsigned char* bytes);

  uint32_t state_[8];
  unsigned char pending_[64];
  size_t filled_ = 0;
  uint64_t length_ = 0;  // bytes
};

}  // namespace photonloom
