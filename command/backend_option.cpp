// SPDX-License-Identifier: Apache-2.0
#include "command/backend_option.hpp"

#include <fmt/core.h>

#include "command/tell.hpp"

namespace photonloom {

std::vector<BackendKind> backend_kinds() {
  const auto all = [](const UnitInfo&) { return true; };
  std::vector<BackendKind> kinds;
  for (const std::string& name : model_kind_names()) {
    const ModelKind kind = *model_kind(name);
    kinds.push_back({name, "", model_kind_meaning(kind), BackendSource::kModel, kind, true, all});
  }
  kinds.push_back({"board", ":DEVICE[@BAUD]", "a board with the plan's bitstream, at a serial port",
                   BackendSource::kBoard, std::nullopt, true,
                   [](const UnitInfo& unit) { return unit.board == BoardPlace::kLink; }});
  kinds.push_back(
      {"golden", "", "the golden unit itself", BackendSource::kGolden, std::nullopt, true, all});
  kinds.push_back(
      {"brute", "", "gathers by trying every photon", BackendSource::kBrute, std::nullopt, false,
       [](const UnitInfo& unit) { return std::string(unit.name) == unit_name<PhotonGatherer>; }});
  return kinds;
}

std::string backend_kinds_text(bool in_frames) {
  std::vector<std::string> names;
  for (const BackendKind& k : backend_kinds())
    if (k.in_frames || !in_frames)
      names.push_back(k.name + k.argument.substr(0, k.argument.find('[')));
  std::string text;
  for (size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + names[i];
  return text;
}

std::optional<Backend> parse_backend(const std::string& text) {
  for (const BackendKind& k : backend_kinds()) {
    if (k.argument.empty()) {
      if (text == k.name) return Backend{k, ""};
      continue;
    }
    if (!text.starts_with(k.name + ":")) continue;
    const std::string device = text.substr(k.name.size() + 1);
    as_usage("--backend: ", [&] { parse_device(device); });
    return Backend{k, device};
  }
  return std::nullopt;
}

std::string waveform_of(const Backend& backend) {
  return backend.kind.model ? waveform_extension(*backend.kind.model) : "";
}

void BoardFlags::add_to(CLI::App& command) {
  command_ = &command;
  command
      .add_option("--board-wait", wait_,
                  "Seconds for a board that is silent or went away to come back (default 10)")
      ->check(number_range(0.1, 86400))
      ->type_name("S");
  command.add_flag("--no-resume", no_resume_,
                   "Ask a board everything, also what an interrupted run has answers to");
}

void BoardFlags::refuse_alone() const {
  for (const char* option : {"--board-wait", "--no-resume"})
    if (command_->count(option) > 0)
      throw UsageError(fmt::format("{}: has no effect, no unit is a board", option));
}

void BoardFlags::check(const Plan& plan, const std::string& device) const {
  Board(open_serial(parse_device(device), wait_), wait_).check_plan(plan);
}

std::unique_ptr<PhotonGatherer> BoardFlags::make(std::type_identity<PhotonGatherer>,
                                                 const Plan& plan, const std::string& device,
                                                 const std::string& work_dir) const {
  BoardOptions options;
  options.open = [name = parse_device(device), wait = wait_] { return open_serial(name, wait); };
  options.device = parse_device(device).path;
  options.wait = wait_;
  options.work_dir = work_dir;
  options.resume = !no_resume_;
  options.tell = [](const std::string& text) { tell("photonloom: {}\n", text); };
  return std::make_unique<BoardPhotonGatherer>(plan, std::move(options));
}

}  // namespace photonloom
