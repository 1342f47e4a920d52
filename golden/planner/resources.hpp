// SPDX-License-Identifier: Apache-2.0
// What a plan's units take of an LFE5U FPGA, predicted from the plan's lines without synthesis:
// sums of structural terms (bits of a list, of lanes, of memories in blocks) with coefficients
// fitted to synthesized plans. docs/fpga-plans.md has the measurements and the errors.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "golden/plan/units.hpp"

namespace photonloom {

// Of one unit. LUT-equivalents are LUT4 + 2 CCU2C + 4 DPR16X4.
struct UnitResources {
  double lut = 0, ff = 0, dsp = 0, ebr = 0;
};

// What board_memories counts, as a part's resources call it: 18 Kibit block RAM of an LFE5U.
inline constexpr const char* kBlockRam = "DP16KD";
// As many memories of that size and shape a 7-series part has, of which board_memories's count is
// true too (docs/fpga.md).
inline constexpr const char* kHalfBlockRam = "RAMB18E1";

// 18 Kibit block RAMs of a memory with one write and one read port, in the shape that takes fewest.
int block_rams(int width, uint64_t depth);

// Block RAMs of board_core, a board's whole top: its gatherers and reorder buffer (`units`), the
// photon memory or the cache before it, the replayer and the link. Of every top in docs/headline.md
// as many as were synthesized.
struct BoardMemories {
  int photons = 0, replayer = 0, link = 0, units = 0;
  // Of these units': node memories that they share instead of those that gatherers alone have.
  int shared_nodes = 0;
  int total() const { return photons + replayer + link + units; }
};
BoardMemories board_memories(const Plan& plan);

// The terms from which a resource ("lut", "ff", "dsp", "ebr") of `unit` is predicted, by name.
// Throws std::runtime_error for an unknown unit or resource.
std::vector<std::pair<std::string, double>> resource_terms(const Plan& plan,
                                                           const std::string& unit,
                                                           const std::string& resource);

// The memories of a unit, in bits, by what they hold: words times bits of all its instances of
// rtl/common/block_ram.sv, be they block RAM or LUT RAM, and of rtl/reorder_buffer/pool_ram.sv;
// what the RTL keeps in registers and in arrays of LUTs is not among them.
std::vector<std::pair<std::string, uint64_t>> unit_memory_bits(const Plan& plan,
                                                               const std::string& unit);

// Whether the unit was synthesized over plans; of others there is no prediction.
bool is_predicted(const std::string& unit);

// The prediction. Meaningful only where the plan has the unit.
UnitResources estimate_resources(const Plan& plan, const std::string& unit);

// Largest relative error of the prediction over the measured plans, each predicted from those that
// it does not see as the same or nearly so.
double resource_error(const std::string& unit, const std::string& resource);

}  // namespace photonloom
