// SPDX-License-Identifier: Apache-2.0
// Golden and another backend of a unit side by side, as one unit.
#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include "golden/unit/backend.hpp"
#include "verilator_tb/rig/compare.hpp"
#include "verilator_tb/unit/backends.hpp"

namespace photonloom {

// The backends below run golden and the given unit on the same packets, compare, and pass on what
// the given unit produced. Counters are the given unit's; the reorder buffer's have "displacement"
// beside them, the sum over "packets matched" of the distance between places in and out. A unit
// that is also Clocked has its cycles in reports and in the timeline.
template <class Unit>
class Comparing : public Unit {
 public:
  virtual uint64_t packets_in() const = 0;
  virtual uint64_t compared() const = 0;
  virtual uint64_t differences() const = 0;
  virtual std::string first_report() const = 0;
};

std::unique_ptr<Comparing<PhotonGatherer>> compare_units(const Plan& plan,
                                                         const CompareContext& context,
                                                         PhotonGatherer& golden,
                                                         PhotonGatherer& other);
std::unique_ptr<Comparing<ReorderBuffer>> compare_units(const Plan& plan,
                                                        const CompareContext& context,
                                                        ReorderBuffer& golden,
                                                        ClockedReorderBuffer& other);
std::unique_ptr<Comparing<CdfSampler>> compare_units(const Plan& plan,
                                                     const CompareContext& context,
                                                     CdfSampler& golden, ClockedCdfSampler& other);

}  // namespace photonloom
