// SPDX-License-Identifier: Apache-2.0
// The packets that are drawn for a plan (hls_kernels/generate/recording.hpp) through a backend with
// a clock, beside the kernel's schedule model.
#pragma once
#include "hls_kernels/generate/schedule.hpp"
#include "verilator_tb/unit/backends.hpp"

namespace photonloom {

struct DrawnRun {
  uint64_t packets = 0;  // that went in
  uint64_t cycles = 0;   // of the backend for them
  TripCounts trips{};    // of the kernel's loops
  Counters counters{};
  double in_flight = 0;  // packets that are in and not out, on average; where each has an answer
};

// Packets that differ from golden's are an error.
DrawnRun run_drawn(std::type_identity<PhotonGatherer>, const Plan& plan, const RunOptions& options);
DrawnRun run_drawn(std::type_identity<ReorderBuffer>, const Plan& plan, const RunOptions& options);
DrawnRun run_drawn(std::type_identity<CdfSampler>, const Plan& plan, const RunOptions& options);
DrawnRun run_drawn(std::type_identity<IrradianceCache>, const Plan& plan,
                   const RunOptions& options);

}  // namespace photonloom
