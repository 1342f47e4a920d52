// SPDX-License-Identifier: Apache-2.0
// Each subcommand is one file of this folder: a function that adds it to the command line, and one
// line that registers it:
//   static const Command render_command(20, add_render);
// The callback throws std::runtime_error for what the user can mend (printed as one line, exit
// status 1), UsageError for a wrong command line (exit status 2).
#pragma once
#include <CLI/CLI.hpp>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "verilator_tb/rig/number_options.hpp"

namespace photonloom {

// What was asked does not hold (a threshold exceeded, packets that differ): exit status 1, after
// the command has printed its report; `what` is the last line on stderr.
struct CheckFailed : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Commands are listed in --help in ascending `place`, which no two share.
struct Command {
  using Add = void (*)(CLI::App& app);
  Command(int place, Add add);
};
std::vector<std::pair<int, Command::Add>>& registered_commands();

// --threads N for a subcommand. Keep the object as long as the callback may run; call apply() at
// its beginning.
class ThreadsOption {
 public:
  void add_to(CLI::App& command);
  void apply() const;   // for the rest of the program
  int threads() const;  // as given, or all of the machine's

 private:
  int given_ = 0;
};

// Calls f(), whose std::runtime_error is that of a wrong command line: `before`, then its text.
template <class F>
void as_usage(const std::string& before, const F& f) {
  try {
    f();
  } catch (const std::runtime_error& error) {
    throw UsageError(before + error.what());
  }
}

// Throws UsageError unless `path`, given by `option`, ends in `suffix`: the format that is written.
void require_suffix(const std::string& option, const std::string& path, const std::string& suffix);

}  // namespace photonloom
