// SPDX-License-Identifier: Apache-2.0
// Numbers as people write them, read to the last character.
#pragma once
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <type_traits>

namespace photonloom {

// Nothing unless all of `text` is one decimal number that T holds: no blanks, no plus sign, no
// hexadecimal; a floating one is finite, and 0 only where it is written as 0.
template <class T>
std::optional<T> strict_number(std::string_view text) {
  T value{};
  const char* const end = text.data() + text.size();
  const auto [rest, problem] = std::from_chars(text.data(), end, value);
  if (problem != std::errc() || rest != end) return std::nullopt;
  if constexpr (std::is_floating_point_v<T>) {
    const std::string_view digits = text.substr(0, text.find_first_of("eE"));
    const bool written_as_zero = digits.find_first_of("123456789") == std::string_view::npos;
    if (!std::isfinite(value) || (value == 0 && !written_as_zero)) return std::nullopt;
  }
  return value;
}

}  // namespace photonloom
