// SPDX-License-Identifier: Apache-2.0
// This program's own command line, for reports that say how to run it again.
#pragma once
#include <string>
#include <vector>

namespace photonloom {

// As a shell takes it, without the options of `without` and their values; before it the variables
// of the environment that choose sources.
std::string command_line(const std::vector<std::string>& without = {});

}  // namespace photonloom
