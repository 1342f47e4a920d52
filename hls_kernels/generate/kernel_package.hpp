// SPDX-License-Identifier: Apache-2.0
// A kernel package: the units of a plan as HLS C++, with testbenches, recorded packets and scripts
// for the vendors' tools, to be taken to a machine without this program.
#pragma once
#include <map>
#include <string>

#include "golden/plan/plan.hpp"

namespace photonloom {

// Path in the package -> text, of every unit that the plan has. Deterministic in the plan and the
// sources in `hls_dir` (empty: default_hls_dir()).
std::map<std::string, std::string> write_kernel_package(const Plan& plan,
                                                        const std::string& hls_dir = "");

}  // namespace photonloom
