// SPDX-License-Identifier: Apache-2.0
// Programs that a sweep runs beside itself.
#pragma once
#include <string>
#include <utility>

namespace photonloom {

// A shell command's exit status, 128 where it was killed, and what it printed on both streams,
// without newlines at its end.
std::pair<int, std::string> output_of(const std::string& command);

}  // namespace photonloom
