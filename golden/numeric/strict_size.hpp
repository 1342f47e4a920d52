// SPDX-License-Identifier: Apache-2.0
// The size of an image as people write it: "640x480".
#pragma once
#include <optional>
#include <string_view>
#include <utility>

#include "golden/numeric/strict_number.hpp"

namespace photonloom {

// Width and height; nothing unless all of `text` is WIDTHxHEIGHT, both of 1 to `most`.
inline std::optional<std::pair<int, int>> strict_size(std::string_view text, int most) {
  const size_t x = text.find_first_of("xX");
  if (x == std::string_view::npos) return std::nullopt;
  const auto width = strict_number<int>(text.substr(0, x)),
             height = strict_number<int>(text.substr(x + 1));
  const auto fits = [&](const std::optional<int>& edge) {
    return edge && *edge >= 1 && *edge <= most;
  };
  if (!fits(width) || !fits(height)) return std::nullopt;
  return std::make_pair(*width, *height);
}

}  // namespace photonloom
