// SPDX-License-Identifier: Apache-2.0
// The chip: a plan's units, wired.
#pragma once
#include <string>
#include <vector>

#include "golden/plan/plan.hpp"

namespace photonloom {

inline constexpr const char* kChip = "photonloom_chip";  // its module

// A port as a README tells it.
struct DescribedPort {
  bool output = false;
  std::string type, name, meaning;
};

// Ports of the chip. Those of its units under names of their own, and the plan's hash.
std::vector<DescribedPort> chip_ports(const Plan& plan, const std::string& rtl_dir);

// Ports of a module, with types as seen from outside. Throws std::runtime_error naming file and
// port where the RTL does not say what a port means.
std::vector<DescribedPort> described_ports(const std::string& rtl_dir, const std::string& module);

// Whether `unit` is among the names of a chip's units.
bool has_unit(const std::vector<std::string>& units, const std::string& unit);

// The generated top: query -> reorder_buffer -> photon_gatherer -> result and photon, and the
// other units with their own streams, as far as they are present. Its ports are the units' own.
std::string write_chip(const Plan& plan, const std::string& rtl_dir);

}  // namespace photonloom
