// SPDX-License-Identifier: Apache-2.0
// photonloom plan SCENE --error E: options, search, and what is said of it.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "command/command.hpp"
#include "golden/pipeline/prepare.hpp"

namespace photonloom {

class PlanForError {
 public:
  void add_to(CLI::App& command);
  // Whether one of its options asks for a search.
  bool wanted() const;
  // Of --board; empty: not given.
  const std::string& board() const { return board_; }
  // Throws UsageError for one of its options that stands without the one it belongs to.
  void refuse_alone() const;

  // Searches, writes the plan to `output` ("": nowhere, "-": standard output) and tells why that
  // one. `describe` tells what the written plan takes. Throws CheckFailed where nothing meets the
  // error.
  void run(const FrameRequest& request, const std::string& output, bool json, int workers,
           const std::function<void(const Plan&)>& describe) const;

 private:
  CLI::App* command_ = nullptr;
  std::string error_;  // a number, or one with an x behind it
  std::optional<uint64_t> check_;
  std::string metric_ = "relmse", board_, minimise_ = "cycles", work_ = "build/plan";
  std::string explain_, measured_size_;
  bool advise_ = false;
  int seeds_ = 6, points_ = 24, reference_spp_ = 2048;
};

}  // namespace photonloom
