// SPDX-License-Identifier: Apache-2.0
// Units as RTL, or what was made of it (RunOptions::kind), behind golden/unit/backend.hpp, and what
// a run of them tells beyond packets.
#pragma once
#include <memory>
#include <string>

#include "golden/unit/backend.hpp"
#include "verilator_tb/rig/clocked.hpp"
#include "verilator_tb/rig/rig.hpp"

namespace photonloom {

class ClockedPhotonGatherer : public PhotonGatherer, public Clocked {};
class ClockedReorderBuffer : public ReorderBuffer, public Clocked {};
class ClockedCdfSampler : public CdfSampler, public Clocked {};

std::unique_ptr<ClockedPhotonGatherer> make_rtl_photon_gatherer(const Plan& plan,
                                                                const RunOptions& options);
// All gatherers of the plan's board on its photon memory, with the behavioural SDRAM where that is
// one. With `reordered` queries pass the reorder buffer: results come in its order, and process()
// gives those that are due, which are as many as golden's buffer has let go. With `back_door` lines
// are put into the SDRAM's cells, not written through its controller.
std::unique_ptr<ClockedPhotonGatherer> make_rtl_gather_engine(const Plan& plan,
                                                              const RunOptions& options,
                                                              bool reordered,
                                                              bool back_door = false);
std::unique_ptr<ClockedReorderBuffer> make_rtl_reorder_buffer(const Plan& plan,
                                                              const RunOptions& options);
std::unique_ptr<ClockedCdfSampler> make_rtl_cdf_sampler(const Plan& plan,
                                                        const RunOptions& options);

}  // namespace photonloom
