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

// These files and all that they include from hls_kernels/; paths relative to `hls_dir`. A file that
// is not there is an error.
std::vector<std::string> hls_files(const std::string& hls_dir, std::vector<std::string> files);

}  // namespace photonloom
