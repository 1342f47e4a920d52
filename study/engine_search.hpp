// SPDX-License-Identifier: Apache-2.0
// The gather engine of a board (docs/gather_cluster.md): how many gatherers, how wide, and what its
// memories are made of, for the most gathers a second that the board has room for. What it changes
// decides when packets come, never which. docs/planner.md, "The fastest that a board holds".
#pragma once
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "golden/packet/packet.hpp"
#include "golden/pipeline/prepare.hpp"
#include "golden/plan/plan_file.hpp"
#include "golden/unit/photon_map.hpp"
#include "rtl/generate/board_file.hpp"
#include "study/board_room.hpp"

namespace photonloom {

// Up to 131,072 gathers that the frame asks for with one sample a pixel, or with all where that one
// asks for none, in the order in which it asks: as runs of neighbours from different places of the
// stream (WatchedGatherer), before any reorder buffer.
std::vector<GatherQuery> engine_queries(const PreparedFrame& frame, Progress* progress);

// Cycles of the core a gather of all gatherers together, predicted.
struct EngineCycles {
  double cycles = 0;
  double gatherers = 0;     // that the gatherers need by themselves
  double memory = 0;        // that the photon memory needs by itself
  double memory_lines = 0;  // lines a gather that come from an SDRAM; 0 with block RAM
};

// Of a plan's engine for these queries, in the order in which the frame makes them and as the
// plan's reorder buffer lets them go on. The SDRAM's controller runs at the plan's clock, the core
// at core_khz.
EngineCycles engine_cycles(const Plan& plan, const PhotonMap& global, const PhotonMap& caustic,
                           std::span<const GatherQuery> queries, int core_khz);

struct Engine {
  Plan plan;
  EngineCycles cycles;
};

struct EngineSearch {
  Engine best;
  PlanReasons reasons;  // of every line that the search decides
  std::optional<EngineCycles>
      given;           // of the plan as it was; none where the board lacks its memory
  std::string misfit;  // why that does not fit; empty: it does
  size_t fitting = 0;  // engines that fit, of which it is the fastest
};

// Largest share of a part that is planned for: that of the fullest tops of docs/headline.md, 49,841
// LUT-equivalents and 201 of 208 block RAMs. One of 207 was not
// (docs/planner.md). Flip-flops are held to the share of LUTs, though gatherers without leaf caches
// have more of these than predicted LUTs: it leaves out block_ram_k16 of fpga/headline.
inline constexpr BoardShare kEngineShare = {.logic = 0.55, .blocks = 0.97};
// Most bits of a beat of all gatherers together: those of the widest tops of fpga/headline that
// have three or more, of 384 bits each; without leaf caches, before block RAM, five.
// Two of 1,024 bits were routed too, but are slower than four of 256; the tools' end was not waited
// for with 3,072 and 4,096 (docs/headline.md).
inline constexpr int kEngineWires = 1152, kUncachedWires = 1920;

// Why a plan's engine is not one for this board: it has no top with the plan's memory, it does not
// fit in kEngineShare, is wider than those, or stores its photons in banks of block RAM, or with
// leaf caches in rows (rtl/board/photon_ram.sv), with which no engine has been routed; empty: it
// is.
std::string engine_misfit(const Plan& plan, const BoardDescription& board);

// Lines of a plan that the search decides on this board, whatever they were. Bytes a photon it
// leaves alone where lines are compressed ones.
std::vector<const char*> engine_lines(const BoardDescription& board, PhotonLines photons);

// Every combination of the searched lines that fits is predicted, but before an SDRAM those without
// leaf caches, and there with a node memory for each two gatherers what does not fit otherwise; the
// fastest is the plan, the smallest of those that are as fast within 1 %. Throws
// std::runtime_error where none fits, with what the smallest lacks, and where there are no queries.
EngineSearch fastest_engine(const Plan& plan, const PhotonMap& global, const PhotonMap& caustic,
                            std::span<const GatherQuery> queries, const BoardDescription& board);

}  // namespace photonloom
