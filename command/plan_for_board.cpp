// SPDX-License-Identifier: Apache-2.0
#include "command/plan_for_board.hpp"

#include <fmt/core.h>

#include <vector>

#include "command/console.hpp"
#include "command/frame_options.hpp"
#include "golden/planner/planner.hpp"
#include "study/board_room.hpp"

namespace photonloom {

BoardPlan plan_for_board(const FrameRequest& request, const std::string& board_name) {
  const BoardDescription board = predicted_board(board_name);
  ConsoleProgress progress;
  PreparedFrame frame = prepare_frame(request, Arithmetic::kGolden, &progress);
  print_warnings(frame.warnings);
  const std::vector<GatherQuery> queries = engine_queries(frame, &progress);

  BoardPlan found;
  found.engine = fastest_engine(frame.plan, frame.global, frame.caustic, queries, board);
  found.core_khz = board.core_khz;
  found.reasons = frame.reasons;
  for (const auto& [line, why] : found.engine.reasons) found.reasons[line] = why;
  // The search may take padding away, and so make a line shorter, and has its own reorder buffer; a
  // line that was asked for keeps its reason.
  const auto say_anew = [&](const char* line, std::string (*reason_in)(const Plan&)) {
    const auto reason = found.reasons.find(line);
    if (reason != found.reasons.end() && reason->second == reason_in(frame.plan))
      reason->second = reason_in(found.engine.best.plan);
  };
  say_anew("photon.bucket", bucket_reason);
  say_anew("frame.order", order_reason);
  return found;
}

std::string engine_text(const BoardPlan& found, const std::string& board) {
  const EngineSearch& e = found.engine;
  const auto rate = [&](double cycles) { return found.core_khz / cycles / 1000; };
  std::string text = fmt::format(
      "engine for {}: {:.2f} cycles a gather, {:.2f} million gathers/s at {:g} MHz, predicted; the "
      "fastest of {} that fit\n"
      "  the gatherers need {:.2f} cycles, the photon memory {:.2f}\n"
      "  the plan without --board: ",
      board, e.best.cycles.cycles, rate(e.best.cycles.cycles), found.core_khz / 1000.0, e.fitting,
      e.best.cycles.gatherers, e.best.cycles.memory);
  if (e.given) text += fmt::format("{:.2f} cycles", e.given->cycles);
  if (!e.misfit.empty()) text += (e.given ? ", which " : "") + e.misfit;
  return text + "\n";
}

}  // namespace photonloom
