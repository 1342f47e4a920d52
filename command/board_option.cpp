// SPDX-License-Identifier: Apache-2.0
#include "command/board_option.hpp"

#include <fmt/core.h>

namespace photonloom {

std::optional<std::string> board_device(const std::string& backend) {
  const std::string prefix = "board:";
  if (backend.rfind(prefix, 0) != 0) return std::nullopt;
  const std::string device = backend.substr(prefix.size());
  try {
    parse_device(device);
  } catch (const std::runtime_error& error) {
    throw UsageError(fmt::format("--backend: {}", error.what()));
  }
  return device;
}

void BoardFlags::add_to(CLI::App& command) {
  command
      .add_option("--board-wait", wait_,
                  "Seconds for a board that is silent or went away to come back (default 10)")
      ->check(number_range(0.1, 86400))
      ->type_name("S");
  command.add_flag("--no-resume", no_resume_,
                   "Ask a board everything, also what an interrupted run has answers to");
}

void BoardFlags::check(const Plan& plan, const std::string& device) const {
  Board(open_serial(parse_device(device), wait_), wait_).check_plan(plan);
}

std::unique_ptr<PhotonGatherer> BoardFlags::photon_gatherer(const Plan& plan,
                                                            const std::string& device,
                                                            const std::string& work_dir) const {
  BoardOptions options;
  options.open = [name = parse_device(device), wait = wait_] { return open_serial(name, wait); };
  options.device = parse_device(device).path;
  options.wait = wait_;
  options.work_dir = work_dir;
  options.resume = !no_resume_;
  options.tell = [](const std::string& text) { fmt::print(stderr, "photonloom: {}\n", text); };
  return std::make_unique<BoardPhotonGatherer>(plan, std::move(options));
}

}  // namespace photonloom
