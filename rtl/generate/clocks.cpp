// SPDX-License-Identifier: Apache-2.0
#include "rtl/generate/clocks.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <regex>
#include <stdexcept>
#include <utility>

#include "golden/numeric/output_file.hpp"
#include "golden/plan/plan.hpp"

namespace photonloom {
namespace {

bool within(const IntRange& range, long x) { return x >= range.least && x <= range.most; }

// Sets dividers and VCO: exact, the VCO nearest to the best of those that a whole divider makes the
// SDRAM's clock of too; false where there are none.
bool choose_dividers(const PllLimits& pll, long in_khz, BoardClocks& clocks) {
  const long out_khz = clocks.core_khz;
  long best_distance = -1;
  if (!within(pll.output_khz, out_khz)) return false;
  for (int ref = pll.reference.least; ref <= pll.reference.most; ++ref) {
    if (in_khz < static_cast<long>(pll.detector_least_khz) * ref) break;
    for (int feedback = pll.feedback.least; feedback <= pll.feedback.most; ++feedback)
      for (int output = pll.output.least; output <= pll.output.most; ++output) {
        if (in_khz * feedback != out_khz * ref * (pll.fed_back_from_output ? 1 : output)) continue;
        const long vco = out_khz * output, distance = std::labs(vco - pll.vco_best_khz);
        if (!within(pll.vco_khz, vco) || (best_distance >= 0 && distance >= best_distance))
          continue;
        if (clocks.sdram_khz && vco % clocks.sdram_khz != 0) continue;
        best_distance = distance;
        clocks.reference = ref;
        clocks.feedback = feedback;
        clocks.output = output;
        clocks.vco_khz = static_cast<int>(vco);
      }
  }
  return best_distance >= 0;
}

// Clocks of an SDRAM that are looked for.
constexpr int kSdramStepKHz = 1250;

bool makes(const BoardDescription& board, int core_khz, int sdram_khz) {
  BoardClocks clocks{.core_khz = core_khz, .sdram_khz = sdram_khz};
  return choose_dividers(*board.pll, board.oscillator_khz, clocks);
}

// Core clocks in MHz that the PLL makes, for a message; "" where there are none.
std::string examples(const BoardDescription& board, int sdram_khz) {
  std::string text;
  for (const int khz : {25000, 50000, 60000, 62500, 75000, 100000}) {
    if (!makes(board, khz, sdram_khz)) continue;
    text += fmt::format("{}{:g}", text.empty() ? "--clock of for example " : ", ", khz / 1000.0);
  }
  return text;
}

// What else a board would need, for a message.
std::string other_limits(const BoardDescription& board) {
  return fmt::format("another clock or other limits in [pll] of {}", board.file);
}

// SDRAM clocks that the PLL makes beside the core's, for a message; "" where there are none.
std::string sdram_examples(const BoardDescription& board, int core_khz) {
  std::string text;
  int told = 0;
  for (int khz = std::min(board.sdram->clock_khz, kSdramMostKHz); khz >= kSdramLeastKHz && told < 3;
       khz -= kSdramStepKHz)
    if (makes(board, core_khz, khz))
      text += fmt::format("{}{}", told++ ? ", " : "a board.sdram_khz of for example ", khz);
  return text;
}

// Fastest rate that whole core clocks make, at least 8 of them a bit.
void choose_baud(const BoardDescription& board, BoardClocks& clocks) {
  const long hz = 1000L * clocks.core_khz;
  for (const int baud : board.baud) {
    const long whole = (hz + baud / 2) / baud;
    // 2 % off in the middle of the last bit is what a receiver bears; exact rates are the rule.
    if (whole < 8 || std::labs(hz - whole * baud) * 200 > hz) continue;
    clocks.baud = baud;
    clocks.clocks_per_bit = whole;
    return;
  }
  throw std::runtime_error(
      fmt::format("board {}: a core clock of {} kHz is too slow for its UART, expected a clock of "
                  "8 cycles a bit at one of the rates of serial.baud",
                  board.name, clocks.core_khz));
}

// The number behind `before` in a source of the RTL.
int number_in(const std::string& file, const std::string& before) {
  const std::string text = read_file(file);
  std::smatch m;
  if (!std::regex_search(text, m, std::regex(before + R"((\d+))")))
    throw std::runtime_error(fmt::format("{}: says no number behind {}", file, before));
  return std::stoi(m[1]);
}

// The controller waits the times that stand in it, whatever its clock.
void check_sdram(const BoardDescription& board, const std::string& rtl_dir) {
  const std::string controller = rtl_dir + "/board/sdram_controller.sv";
  static const std::pair<const char*, const char*> kTimes[] = {
      {"row_to_column_ns", "RowToColumn"},    {"precharge_ns", "Precharge"},
      {"row_active_ns", "RowActive"},         {"row_to_row_ns", "RowToRow"},
      {"write_recovery_ns", "WriteRecovery"}, {"refresh_ns", "RefreshTime"}};
  for (const auto& [key, name] : kTimes) {
    const int served = number_in(controller, fmt::format(R"({} = cycles\()", name));
    const int time = board.sdram->times_ns.at(key);
    if (time > served)
      throw std::runtime_error(fmt::format("{}: sdram.{} is {}, expected at most {}, what {} waits",
                                           board.file, key, time, served, controller));
  }
}

}  // namespace

int sdram_clock(const BoardDescription& board, int most_khz) {
  const int most = std::min(most_khz, board.sdram->clock_khz);
  if (makes(board, board.core_khz, most)) return most;
  for (int khz = most / kSdramStepKHz * kSdramStepKHz; khz >= kSdramLeastKHz; khz -= kSdramStepKHz)
    if (makes(board, board.core_khz, khz)) return khz;
  return most;
}

std::optional<PlanProblem> clock_problem(const Plan& plan, const BoardDescription& board) {
  if (plan.photon_memory != PhotonMemory::kSdram || !board.has_core() ||
      makes(board, board.core_khz, plan.sdram_khz))
    return std::nullopt;
  const std::string others = sdram_examples(board, board.core_khz);
  return PlanProblem{
      "board.sdram_khz",
      fmt::format("is {}, expected {}, which the PLL of {} makes beside {:g} MHz of its core",
                  plan.sdram_khz, others.empty() ? "one" : others, board.name,
                  board.core_khz / 1000.0)};
}

BoardClocks board_clocks(const BoardDescription& board, int core_khz, int sdram_khz,
                         const std::string& rtl_dir) {
  if (sdram_khz) check_sdram(board, rtl_dir);
  BoardClocks clocks{.core_khz = core_khz};
  if (!choose_dividers(*board.pll, board.oscillator_khz, clocks)) {
    const std::string core = examples(board, 0);
    throw std::runtime_error(fmt::format(
        "the PLL cannot make {:g} MHz of {:g} MHz exactly, expected {}", core_khz / 1000.0,
        board.oscillator_khz / 1000.0, core.empty() ? other_limits(board) : core));
  }
  clocks.sdram_khz = sdram_khz;
  if (sdram_khz && !choose_dividers(*board.pll, board.oscillator_khz, clocks)) {
    const std::string core = examples(board, sdram_khz), sdram = sdram_examples(board, core_khz);
    throw std::runtime_error(fmt::format(
        "the PLL cannot make {:g} MHz beside the {} kHz of the plan's board.sdram_khz, "
        "expected {}{}{}",
        core_khz / 1000.0, sdram_khz, core, core.empty() || sdram.empty() ? "" : ", or ",
        core.empty() && sdram.empty() ? other_limits(board) : sdram));
  }
  choose_baud(board, clocks);
  return clocks;
}

}  // namespace photonloom
