// SPDX-License-Identifier: Apache-2.0
// photonloom_hls.hpp, the header of a plan for HLS kernels: its constants and packets, from the
// lists of which rtl/generate/package.hpp makes the SystemVerilog package.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "golden/plan/plan.hpp"

namespace photonloom {

// Deterministic in the plan. `plan_hash` becomes kPlanHash.
std::string write_hls_header(const Plan& plan, uint64_t plan_hash);

// The folder hls_kernels/ of the sources: PHOTONLOOM_HLS of the environment, or that of the build.
std::string default_hls_dir();

// What a native shared object of `unit` is compiled from, hls_kernels/native/UNIT.cpp first and
// then all that it includes from hls_kernels/; paths relative to `hls_dir`. An unknown unit is an
// error.
std::vector<std::string> hls_files(const std::string& hls_dir, const std::string& unit);

}  // namespace photonloom
