// SPDX-License-Identifier: Apache-2.0
// A unit's HLS kernel as a loadable library, compiled natively for one plan (docs/hls.md).
#pragma once
#include <string>

#include "golden/plan/plan.hpp"

namespace photonloom {

// Path of the library in `work_dir`, compiled if it is not there (seconds; needs a C++ compiler,
// $CXX or c++). Several processes may ask for the same one. A failure is a ModelBuildError.
std::string build_kernel(const Plan& plan, const std::string& unit, const std::string& work_dir);

}  // namespace photonloom
