// SPDX-License-Identifier: Apache-2.0
// Units as HLS kernels, compiled natively per plan, behind golden/unit/backend.hpp. Their cycles
// are those that the kernels' loops count (docs/hls.md).
#pragma once
#include <memory>

#include "verilator_tb/unit/backends.hpp"

namespace photonloom {

// RunOptions::seed and initial_seed choose the order in which a kernel's processes run, which must
// not matter, and what the stall policies of its streams do to its clock. The line memory has no
// latency but the kernel's own. A kernel that waits forever is a RigError, one
// that cannot be compiled a ModelBuildError.
std::unique_ptr<ClockedPhotonGatherer> make_hls_photon_gatherer(const Plan& plan,
                                                                const RunOptions& options);
std::unique_ptr<ClockedReorderBuffer> make_hls_reorder_buffer(const Plan& plan,
                                                              const RunOptions& options);
std::unique_ptr<ClockedCdfSampler> make_hls_cdf_sampler(const Plan& plan,
                                                        const RunOptions& options);

}  // namespace photonloom
