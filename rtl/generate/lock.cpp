// SPDX-License-Identifier: Apache-2.0
#include "rtl/generate/lock.hpp"

#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "golden/numeric/sha256.hpp"
#include "golden/plan/plan_file.hpp"
#include "rtl/generate/board_file.hpp"

namespace photonloom {

std::string write_lock(const Plan& plan, const std::string& board, const std::string& boards_dir,
                       const std::map<std::string, std::string>& files) {
  // What simulates and synthesizes any package; what a board asks for counts where both name one.
  std::map<std::string, std::string> tools = {{"verilator", "5.006"}, {"yosys", "0.23"}};
  if (!board.empty())
    for (const auto& [tool, version] : read_board(board, boards_dir).tools) tools[tool] = version;
  nlohmann::ordered_json lock{{"photonloom", PHOTONLOOM_VERSION}, {"plan", plan_hash_text(plan)}};
  for (const auto& [tool, version] : tools) lock["tools"][tool] = ">= " + version;
  for (const auto& [name, text] : files) {
    if (!name.starts_with("rtl/") && !name.starts_with("board/")) continue;
    Sha256 sum;
    sum.add(text);
    lock["sources"][name] = sum.hex();
  }
  return lock.dump(2) + "\n";
}

}  // namespace photonloom
