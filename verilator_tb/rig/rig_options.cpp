// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/rig/rig_options.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

#include "rtl/generate/data_files.hpp"

namespace photonloom {

void RigFlags::add_to(CLI::App& command, const std::string& seed_flag) {
  command_ = &command;
  seed_flag_ = seed_flag;
  const auto add = [&](const std::string& flag, auto& value, const std::string& help) {
    return command.add_option(flag, value, help);
  };
  add_seed_option(command, seed_,
                  "Seed of stalls, latencies and initial register values; changes when packets "
                  "move, never which. Default 1.",
                  seed_flag);
  add_seed_option(command, initial_seed_,
                  "Mixed into the initial register values alone. Default 1.", "--initial-seed");
  add("--stall", stall_,
      "When streams hold back: none, bernoulli:P, bursts or adversary. Default "
      "none.");
  add("--stall-in", stall_in_, "The same for input streams only.");
  add("--stall-out", stall_out_, "The same for output streams only.");
  add("--stall-memory", stall_memory_, "The same for the line memory only.");
  add("--latency", latency_,
      "Cycles from a line request to its first beat: N, random (mean 20, out of "
      "order) or random:MEAN. Default 20.");
  add("--banks", banks_, "Banks of the line memory. Default 8.")->check(CLI::Range(1, 1024));
  add("--bank-cycles", bank_cycles_,
      "A bank takes one request in so many cycles; 0: no limit. Default 0.")
      ->check(CLI::Range(0, 100000));
  add("--watchdog", watchdog_,
      fmt::format("Cycles without a handshake after which a unit counts as stuck. Default {}.",
                  watchdog_))
      ->check(CLI::Range(uint64_t{1}, uint64_t{1} << 48));
  add("--rtl", rtl_, "Folder of the RTL sources, if not those of this build.");
  add("--work", work_,
      "Folder of the built models. Default build/cosim; of an installed program "
      "~/.cache/photonloom.");
  add("--yosys", yosys_, "The Yosys that makes netlists and CXXRTL models. Default yosys.");
  add("--netlist", netlist_,
      "With backend netlist: this Verilog netlist of the unit, made for the same plan, instead of "
      "a synthesis.");
  add("--wave", wave_, "Write a waveform to this file: FST, of CXXRTL models VCD.");
  add("--wave-unit", wave_unit_, "The unit to write it of.");
  add("--wave-cycles", wave_cycles_, "The cycles to write, FROM:TO.");
}

RunOptions RigFlags::options(const std::string& unit) const {
  RunOptions o;
  o.seed = seed_;
  o.initial_seed = initial_seed_;
  const auto policy = [&](const char* option, const std::string& text) {
    try {
      return StallPolicy::parse(text);
    } catch (const std::runtime_error& error) {
      throw UsageError(fmt::format("{}: {}", option, error.what()));
    }
  };
  const StallPolicy all = policy("--stall", stall_);
  o.stall_in = stall_in_.empty() ? all : policy("--stall-in", stall_in_);
  o.stall_out = stall_out_.empty() ? all : policy("--stall-out", stall_out_);
  o.stall_memory = stall_memory_.empty() ? all : policy("--stall-memory", stall_memory_);
  std::string latency = latency_;
  if (latency == "random") latency = "random:20";
  if (latency.starts_with("random:")) {
    o.random_latency = true;
    latency = latency.substr(7);
  }
  const auto cycles = strict_number<int>(latency);
  if (!cycles || *cycles < 1 || *cycles > 1000000)
    throw UsageError(
        fmt::format("--latency {}: expected 1 to 1000000 cycles, random or random:MEAN", latency_));
  o.latency = *cycles;
  o.banks = banks_;
  o.bank_cycles = bank_cycles_;
  o.watchdog = watchdog_;
  o.rtl_dir = rtl_;
  o.work_dir = work_.empty() ? default_work_dir() : work_;
  std::error_code unseen;  // what may not be looked at is told where it is used
  if (std::filesystem::exists(o.work_dir, unseen) &&
      !std::filesystem::is_directory(o.work_dir, unseen))
    throw std::runtime_error(
        fmt::format("--work {}: is a file, expected a folder of models", o.work_dir));
  o.yosys = yosys_;
  o.netlist = netlist_;
  if (wave_.empty() || (!wave_unit_.empty() && wave_unit_ != unit)) return o;
  o.waveform = wave_;
  if (!wave_cycles_.empty()) {
    const size_t colon = std::min(wave_cycles_.find(':'), wave_cycles_.size() - 1);
    const auto from = strict_number<uint64_t>(wave_cycles_.substr(0, colon)),
               to = strict_number<uint64_t>(wave_cycles_.substr(colon + 1));
    if (!from || !to || *from > *to)
      throw UsageError(
          fmt::format("--wave-cycles {}: expected FROM:TO, FROM not after TO", wave_cycles_));
    o.waveform_from = *from;
    o.waveform_to = *to;
  }
  return o;
}

std::string RigFlags::results_dir() const { return work_.empty() ? default_results_dir() : work_; }

void RigFlags::check_netlist(size_t units) const {
  if (!netlist_.empty() && units != 1)
    throw UsageError(fmt::format("--netlist {}: is of one unit, but {} run with backend netlist",
                                 netlist_, units));
}

void RigFlags::refuse_unread(const std::set<ModelKind>& kinds) const {
  std::vector<std::string> unread;
  if (kinds.empty())
    unread = {seed_flag_, "--initial-seed", "--stall", "--stall-in", "--stall-out"};
  // A kernel has no cycles of its own, no line port and no RTL.
  if (kinds.empty() || kinds == std::set{ModelKind::kHls})
    unread.insert(unread.end(), {"--stall-memory", "--latency", "--banks", "--bank-cycles",
                                 "--watchdog", "--rtl"});
  if (!kinds.count(ModelKind::kNetlist) && !kinds.count(ModelKind::kCxxrtl))
    unread.push_back("--yosys");
  for (const std::string& option : unread)
    if (command_->count(option) > 0)
      throw UsageError(
          fmt::format("{}: has no effect, no unit runs by a backend that reads it", option));
}

void RigFlags::refuse_work() const {
  if (!work_.empty()) throw UsageError("--work: has no effect, no unit runs as a model or a board");
}

void RigFlags::check_waveform(const std::set<std::string>& units) const {
  if (wave_.empty() && (!wave_unit_.empty() || !wave_cycles_.empty()))
    throw UsageError("--wave-unit and --wave-cycles need --wave FILE");
  if (wave_.empty()) return;
  if (units.empty()) throw UsageError("--wave: no unit runs by a backend that writes a waveform");
  if (wave_unit_.empty() && units.size() > 1)
    throw UsageError("--wave: several units run as hardware; name one with --wave-unit");
  if (!wave_unit_.empty() && !units.count(wave_unit_))
    throw UsageError(fmt::format("--wave-unit {}: no such unit runs as hardware", wave_unit_));
}

void RigFlags::check_cycles_came(const std::string& unit, uint64_t cycles) const {
  const RunOptions o = options(unit);
  if (!o.waveform.empty() && o.waveform_from >= cycles)
    throw std::runtime_error(fmt::format(
        "--wave-cycles {}: {} ran for {} cycles, the first of them 0; {} is not written",
        wave_cycles_, unit, cycles, wave_));
}

}  // namespace photonloom
