// SPDX-License-Identifier: Apache-2.0
#include "golden/image/pixel_sum.hpp"

#include <algorithm>
#include <bit>
#include <vector>

#include "golden/numeric/sha256.hpp"

namespace photonloom {
namespace {

void add_word(Sha256& sum, uint32_t word) {
  char bytes[4];
  for (int i = 0; i < 4; ++i) bytes[i] = static_cast<char>(word >> (8 * i));
  sum.add({bytes, 4});
}

}  // namespace

std::string pixel_sha256(const Image& image) {
  std::vector<const Channel*> channels;
  for (const Channel& c : image.channels) channels.push_back(&c);
  std::sort(channels.begin(), channels.end(),
            [](const Channel* a, const Channel* b) { return a->name < b->name; });
  Sha256 sum;
  add_word(sum, static_cast<uint32_t>(image.width));
  add_word(sum, static_cast<uint32_t>(image.height));
  for (const Channel* c : channels) {
    sum.add(c->name);
    sum.add(std::string_view("\0", 1));
    for (const float value : c->pixels) add_word(sum, std::bit_cast<uint32_t>(value));
  }
  return sum.hex();
}

}  // namespace photonloom
