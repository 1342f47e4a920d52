// SPDX-License-Identifier: Apache-2.0
// Photon lines with positions relative to the line's box, exact. docs/reordering.md has the format.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "golden/unit/photon_map.hpp"

namespace photonloom {

// Bits of each coordinate's offset from the box's lower corner, and of the exponent's offset from
// the line's smallest.
struct LineLayout {
  std::array<uint8_t, 3> position{};
  uint8_t exponent = 0;
  auto operator<=>(const LineLayout&) const = default;
};

// The handful of layouts that lines choose from, and the size of a line.
struct LineFormat {
  int line_bytes = 80;
  std::vector<LineLayout> layouts;  // at most kLineLayouts
};
inline constexpr int kLayoutBits = 4;
inline constexpr size_t kLineLayouts = (1 << kLayoutBits) - 1;  // the last code says: overflow

// The corner is a multiple of 2^kCornerStep position units.
inline constexpr int kCornerStep = 6;

// Bits that a photon's offsets may take together in a line of so many bytes; negative: none.
int offset_bits(const Plan& plan, int line_bytes);

// The layouts with which most lines of the map fit: the one that fits most, then the one that fits
// most of the rest, and so on; of equals the first in ascending order.
LineFormat choose_line_format(const Plan& plan, const PhotonMap& map, int line_bytes);

// The first layout in which these photons fit; nothing: they overflow.
std::optional<size_t> fitting_layout(const LineFormat& format, std::span<const PackedPhoton> line);

// The line's bytes, one line or two. A line that overflows is its photons as they are in a plain
// line, without padding.
std::vector<uint8_t> encode_line(const Plan& plan, const LineFormat& format,
                                 std::span<const PackedPhoton> line);
std::vector<PackedPhoton> decode_line(const Plan& plan, const LineFormat& format,
                                      std::span<const uint8_t> bytes);

}  // namespace photonloom
