// SPDX-License-Identifier: Apache-2.0
// The reorder buffer's key and its golden unit; the order is defined in docs/reorder_buffer.md.
#pragma once
#include <cstdint>
#include <memory>

#include "golden/numeric/vec.hpp"
#include "golden/plan/plan.hpp"
#include "golden/unit/backend.hpp"

namespace photonloom {

// The bin of a position in the plan's position units. The cell is the top reorder_cell_bits of
// each coordinate. Hilbert: the top log2(bins) bits of the cell's Hilbert index. Hash: those of
// the low 32 bits of (z, y, x as one number, z on top) * 2654435769 (Knuth's multiplicative
// hashing, floor(2^32 / golden ratio)).
uint32_t reorder_bin(const Plan& plan, const UVec3& position);

// The unit with a pool of any size: for studies of more packets than the plan's range, which is the
// hardware's. Else as make_golden_reorder_buffer.
std::unique_ptr<ReorderBuffer> make_golden_reorder_pool(const Plan& plan);

}  // namespace photonloom
