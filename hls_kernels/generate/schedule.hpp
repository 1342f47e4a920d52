// SPDX-License-Identifier: Apache-2.0
// The schedule of the HLS kernels as a model: what keeps the turns of each loop apart, and how many
// cycles packets take by that. Initiation intervals are derived here, not measured; they were not
// run on a vendor's tool.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "golden/plan/units.hpp"
#include "golden/unit/backend.hpp"

namespace photonloom {

// A turn needs what the turn `distance` before it computed, which takes `latency` cycles.
struct LoopDependency {
  std::string name;  // the member of the kernel, or the value
  int latency = 1;   // cycles
  int distance = 1;  // turns
  std::string why;
};

// The pipelined loop of a process.
struct KernelLoop {
  std::string process;
  std::vector<LoopDependency> dependencies;
  // Cycles between the starts of two turns: the largest ceil(latency / distance).
  int interval() const;
};

// In the order in which the kernel has its processes.
std::vector<KernelLoop> kernel_loops(std::type_identity<PhotonGatherer>, const Plan& plan);
std::vector<KernelLoop> kernel_loops(std::type_identity<ReorderBuffer>, const Plan& plan);
std::vector<KernelLoop> kernel_loops(std::type_identity<CdfSampler>, const Plan& plan);
std::vector<KernelLoop> kernel_loops(std::type_identity<IrradianceCache>, const Plan& plan);

// Queries that the gatherer's kernel keeps in flight: the plan's contexts, at least 4, rounded up
// to a power of two.
int kernel_contexts(const Plan& plan);

// Turns that a loop takes for one reason.
struct TurnTerm {
  std::string what;
  double turns = 0;
};

// Turns of each loop for these packets, in the order of kernel_loops, and cycles before the first
// and after the last packet in which loops do not overlap. `out` is what golden gives; `lines` are
// those of a leaf in the mean, more than one where lines are compressed.
struct TripCounts {
  std::vector<double> turns;
  double fill = 0;
  std::vector<TurnTerm> terms{};  // of the first loop's turns, which are their sum
};
struct LinesALeaf {
  double global = 1, caustic = 1;
};
TripCounts trip_counts(const Plan& plan, std::span<const GatherQuery> in,
                       std::span<const GatherResult> out, const LinesALeaf& lines);
TripCounts trip_counts(const Plan& plan, std::span<const GatherQuery> in);
TripCounts trip_counts(const Plan& plan, std::span<const SamplerInput> in);
TripCounts trip_counts(const Plan& plan, std::span<const CacheLookup> in);

// Loops run beside each other: the slowest one counts.
double modelled_cycles(const std::vector<KernelLoop>& loops, const TripCounts& trips);

}  // namespace photonloom
