// SPDX-License-Identifier: Apache-2.0
// Golden and another backend of a unit side by side, as one unit.
#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include "golden/unit/backend.hpp"
#include "verilator_tb/rig/compare.hpp"

namespace photonloom {

// The backends below run golden and the given unit on the same packets, compare, and pass on what
// the given unit produced. Counters are the given unit's, and what the comparison counts beside
// them. A unit that is also Clocked has its cycles in reports and in the timeline.
template <class Unit>
class Comparing : public InFront<Unit> {
 public:
  using InFront<Unit>::InFront;
  virtual uint64_t packets_in() const = 0;
  virtual uint64_t compared() const = 0;
  virtual uint64_t differences() const = 0;
  virtual std::string first_report() const = 0;
};

// Of each unit, defined in verilator_tb/unit/NAME.cpp.
#define PHOTONLOOM_COMPARE_UNITS(Interface, ...)       \
  std::unique_ptr<Comparing<Interface>> compare_units( \
      const Plan& plan, const CompareContext& context, Interface& golden, Interface& other);
PHOTONLOOM_UNITS(PHOTONLOOM_COMPARE_UNITS)
#undef PHOTONLOOM_COMPARE_UNITS

}  // namespace photonloom
