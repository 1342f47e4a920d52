// SPDX-License-Identifier: Apache-2.0
#include "study/board_room.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "golden/planner/resources.hpp"
#include "rtl/generate/board.hpp"
#include "rtl/generate/clocks.hpp"

namespace photonloom {
namespace {

std::string board_list() {
  std::string names;
  for (const std::string& name : board_names()) try {
      if (read_board(name).resources.count(kBlockRam)) names += (names.empty() ? "" : ", ") + name;
    } catch (const std::runtime_error&) {  // of no use, but not the one that was asked for
    }
  return names;
}

// Of one of them, without block RAM.
BoardNeeds predicted_needs(const Plan& plan, const std::string& unit) {
  const UnitResources r = estimate_resources(plan, unit);
  return {r.lut, r.ff, r.dsp, 0};
}

// The same, larger by the largest error of the prediction.
BoardNeeds unit_needs(const Plan& plan, const std::string& unit) {
  BoardNeeds needs = predicted_needs(plan, unit);
  needs.lut *= 1 + resource_error(unit, "lut");
  needs.ff *= 1 + resource_error(unit, "ff");
  return needs;
}

}  // namespace

BoardDescription predicted_board(const std::string& name) {
  const std::vector<std::string> all = board_names();
  if (all.empty()) return read_board(name);  // throws: the folder has no board
  if (std::find(all.begin(), all.end(), name) == all.end())
    throw std::runtime_error(
        fmt::format("--board: there is no board {}, expected one of {}", name, board_list()));
  BoardDescription board = read_board(name);
  for (const char* resource : {"LUT4", "FF", "MULT18X18D", kBlockRam})
    if (!board.resources.count(resource))
      throw std::runtime_error(
          fmt::format("--board: {} states no {} in [part.resources], which the prediction counts; "
                      "expected one of {}",
                      name, resource, board_list()));
  return board;
}

std::optional<int> block_rams_of(const BoardDescription& board) {
  for (const char* name : {kBlockRam, kHalfBlockRam})
    if (const auto has = board.resources.find(name); has != board.resources.end())
      return has->second;
  return std::nullopt;
}

BoardNeeds operator+(const BoardNeeds& a, const BoardNeeds& b) {
  return {a.lut + b.lut, a.ff + b.ff, a.dsp + b.dsp, a.blocks + b.blocks};
}

BoardNeeds operator*(int n, const BoardNeeds& a) {
  return {n * a.lut, n * a.ff, n * a.dsp, n * a.blocks};
}

BoardNeeds gatherer_needs(const Plan& plan) {
  BoardNeeds needs = unit_needs(plan, unit_name<PhotonGatherer>);
  needs.blocks = estimate_resources(plan, unit_name<PhotonGatherer>).ebr;
  return needs;
}

BoardNeeds other_needs(const Plan& plan) {
  BoardNeeds needs;
  for (const std::string& unit : units_on_board(plan))
    if (unit != unit_name<PhotonGatherer> && is_predicted(unit))
      needs = needs + unit_needs(plan, unit);
  needs.blocks = board_memories(plan).total() -
                 plan.gatherers * estimate_resources(plan, unit_name<PhotonGatherer>).ebr;
  return needs;
}

std::vector<BoardShortage> board_shortages(const Plan& plan, const BoardDescription& board) {
  std::vector<BoardShortage> all;
  const auto compare = [&](const char* resource, double needed, std::optional<int> has) {
    if (has && std::lround(needed) > *has) all.push_back({resource, std::lround(needed), *has});
  };
  const auto states = [&](const char* name) -> std::optional<int> {
    const auto found = board.resources.find(name);
    if (found == board.resources.end()) return std::nullopt;
    return found->second;
  };
  if (states(kBlockRam)) {
    BoardNeeds needs;
    for (const std::string& unit : units_on_board(plan))
      if (is_predicted(unit))
        needs = needs + (unit == unit_name<PhotonGatherer> ? plan.gatherers : 1) *
                            predicted_needs(plan, unit);
    compare("LUT-equivalents", needs.lut, states("LUT4"));
    compare("flip-flops", needs.ff, states("FF"));
    compare("multipliers", needs.dsp, states("MULT18X18D"));
  }
  compare("block RAMs", board_memories(plan).total(), block_rams_of(board));
  return all;
}

std::string misfit(const BoardNeeds& needs, const BoardDescription& board,
                   const BoardShare& share) {
  const struct {
    const char *name, *unit;
    double needed, share;
  } all[] = {{"LUT4", "LUT-equivalents", needs.lut, share.logic},
             {"FF", "FF", needs.ff, share.logic},
             {"MULT18X18D", "MULT18X18D", needs.dsp, 1},
             {kBlockRam, kBlockRam, needs.blocks, share.blocks}};
  // What lacks most.
  double worst = 1;
  std::string why;
  for (const auto& need : all) {
    const double has = std::floor(need.share * board.resources.at(need.name));
    const double needed = std::ceil(need.needed);
    if (needed <= worst * has) continue;
    worst = needed / has;
    why = fmt::format("needs {:.0f} {}, and {} has {:.0f} for it", needed, need.unit, board.name,
                      has);
  }
  return why;
}

std::string misfit(const Plan& plan, const BoardDescription& board, const BoardShare& share) {
  auto problem = board_problem(plan, board);
  if (!problem) problem = clock_problem(plan, board);
  if (problem) return fmt::format("has {}, which {}", problem->line, problem->what);
  return misfit(other_needs(plan) + plan.gatherers * gatherer_needs(plan), board, share);
}

}  // namespace photonloom
