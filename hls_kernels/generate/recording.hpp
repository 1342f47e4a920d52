// SPDX-License-Identifier: Apache-2.0
// Packets for a kernel's testbench: what goes in, drawn for the plan, and what golden gives for it.
// Equal plans have equal recordings.
#pragma once
#include <string>
#include <vector>

#include "golden/plan/units.hpp"
#include "golden/unit/backend.hpp"

namespace photonloom {

// Some thousand packets at most.
std::vector<GatherQuery> drawn_packets(std::type_identity<ReorderBuffer>, const Plan& plan);
std::vector<SamplerInput> drawn_packets(std::type_identity<CdfSampler>, const Plan& plan);
// Queries near the photons of drawn_maps.
std::vector<GatherQuery> drawn_packets(std::type_identity<PhotonGatherer>, const Plan& plan);
// Tiles of lookups that lie close together.
std::vector<CacheLookup> drawn_packets(std::type_identity<IrradianceCache>, const Plan& plan);
// The global and the caustic map, of 512 photons at most.
std::vector<PhotonMap> drawn_maps(const Plan& plan);

// data/NAME.hpp of a kernel package: C arrays of packed packets, `in` and each output by its name;
// of the gatherer also its maps.
std::string write_recording(std::type_identity<PhotonGatherer>, const Plan& plan);
std::string write_recording(std::type_identity<ReorderBuffer>, const Plan& plan);
std::string write_recording(std::type_identity<CdfSampler>, const Plan& plan);
std::string write_recording(std::type_identity<IrradianceCache>, const Plan& plan);

}  // namespace photonloom
