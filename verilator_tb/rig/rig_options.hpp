// SPDX-License-Identifier: Apache-2.0
// RunOptions on a command line, the same flags for benches, cosim and replay.
#pragma once
#include <CLI/CLI.hpp>
#include <set>
#include <string>

#include "verilator_tb/rig/number_options.hpp"
#include "verilator_tb/rig/rig.hpp"

namespace photonloom {

class RigFlags {
 public:
  RigFlags() = default;
  explicit RigFlags(uint64_t watchdog) : watchdog_(watchdog) {}  // the default of --watchdog
  // `seed_flag` names the flag that seeds the rig.
  void add_to(CLI::App& command, const std::string& seed_flag);
  // The options for one unit; throws UsageError for a bad value.
  RunOptions options(const std::string& unit) const;
  // Where a run's results go that has no folder of its own: --work, or default_results_dir().
  std::string results_dir() const;

  // A waveform is of one unit: an error where --wave does not say of which of several.
  void check_waveform(const std::set<std::string>& units) const;
  // --wave and what goes with it: a report's command has its own.
  static std::vector<std::string> waveform_options() {
    return {"--wave", "--wave-unit", "--wave-cycles"};
  }
  const std::string& waveform() const { return wave_; }  // a file, or empty
  const std::string& wave_unit() const { return wave_unit_; }
  const std::string& netlist() const { return netlist_; }  // a file, or empty
  // After a run: an error where the waveform is of `unit`, but of no cycle that came.
  void check_cycles_came(const std::string& unit, uint64_t cycles) const;
  // A netlist is of one unit too: an error where --netlist is given and not just one unit runs as
  // netlist.
  void check_netlist(size_t units) const;
  // Throws UsageError where an option is given that no model of these kinds reads. Whether --work
  // is read where there is none is the command's.
  void refuse_unread(const std::set<ModelKind>& kinds) const;
  void refuse_work() const;

 private:
  CLI::App* command_ = nullptr;
  std::string seed_flag_;
  uint64_t seed_ = 1, initial_seed_ = 1;
  std::string stall_ = "none", stall_in_, stall_out_, stall_memory_;
  std::string latency_ = "20";
  int banks_ = 8, bank_cycles_ = 0;
  uint64_t watchdog_ = RunOptions{}.watchdog;
  std::string rtl_, work_, yosys_ = "yosys", netlist_;
  std::string wave_, wave_unit_, wave_cycles_;
};

}  // namespace photonloom
