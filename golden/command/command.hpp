// SPDX-License-Identifier: Apache-2.0
// Each subcommand is one file of this folder with one function that adds it to the command line. A
// subcommand's callback throws std::runtime_error for what the user can mend (printed as one line,
// exit status 1), UsageError for a wrong command line (exit status 2).
#pragma once
#include <CLI/CLI.hpp>
#include <stdexcept>

namespace photonloom {

struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace photonloom
