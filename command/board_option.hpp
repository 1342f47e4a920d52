// SPDX-License-Identifier: Apache-2.0
// A backend "board:DEVICE" on a command line, and the options that go with it.
#pragma once
#include <memory>
#include <optional>
#include <string>

#include "command/command.hpp"
#include "host/photon_gatherer.hpp"

namespace photonloom {

// DEVICE of "board:DEVICE"; nothing for other backends. Throws UsageError for a DEVICE that is
// none.
std::optional<std::string> board_device(const std::string& backend);

class BoardFlags {
 public:
  void add_to(CLI::App& command);
  // The board is there and holds the plan's bitstream, or an error says what is wrong.
  void check(const Plan& plan, const std::string& device) const;
  // Says on stderr when the board goes away and comes back; keeps its journal in `work_dir`.
  std::unique_ptr<PhotonGatherer> photon_gatherer(const Plan& plan, const std::string& device,
                                                  const std::string& work_dir) const;

 private:
  double wait_ = 10;
  bool no_resume_ = false;
};

}  // namespace photonloom
