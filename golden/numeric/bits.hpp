// SPDX-License-Identifier: Apache-2.0
// Integers wider than the language's and small helpers on widths.
#pragma once
#include <bit>
#include <cstdint>
#include <string>

namespace photonloom {

__extension__ typedef __int128 Int128;
__extension__ typedef unsigned __int128 UInt128;

// Bits that address n things; 0 for n <= 1. As $clog2 in SystemVerilog.
constexpr int clog2(uint64_t n) { return n <= 1 ? 0 : std::bit_width(n - 1); }

constexpr uint64_t ones(int bits) { return bits >= 64 ? ~0ull : (1ull << bits) - 1; }

// Position of the highest set bit; x must not be 0.
constexpr int msb(uint64_t x) { return std::bit_width(x) - 1; }

std::string to_decimal(Int128 x);

}  // namespace photonloom
