// SPDX-License-Identifier: Apache-2.0
// The lines of a photon map in memory, plain or compressed, and their reading.
// docs/photon_memory.md has the formats to the bit.
#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "golden/plan/plan.hpp"
#include "golden/unit/photon_map.hpp"

namespace photonloom {

// Leaf n of the map in line n; with compressed lines, the further lines of leaves that need them
// behind. A line has plan.line_bytes(). Throws where the plan has no room for the further lines.
std::vector<uint8_t> photon_lines(const Plan& plan, const PhotonMap& map, bool is_caustic);

// A leaf as it is read from such lines.
struct StoredLeaf {
  std::vector<PackedPhoton> slots;  // unused ones have invalid_power
  std::vector<uint32_t> lines;      // that were read, in their order
};
StoredLeaf read_leaf(const Plan& plan, std::span<const uint8_t> lines, uint32_t leaf);

// The further lines of those leaves that have some, in the order in which they are read. None with
// plain lines.
using FurtherLines = std::map<uint32_t, std::vector<uint32_t>>;
FurtherLines further_lines(const Plan& plan, const PhotonMap& map, bool is_caustic);
// The lines that are read of these leaves.
std::vector<uint32_t> lines_of(const FurtherLines& further, std::span<const uint32_t> leaves);

// Bits of each offset in the layout with this split and axis.
struct OffsetBits {
  int own, first, second, exponent;
};
inline constexpr uint32_t kSplits = 4, kAxes = 4;
OffsetBits offset_bits_of(const Plan& plan, uint32_t split, uint32_t axis);

}  // namespace photonloom
