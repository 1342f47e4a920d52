// SPDX-License-Identifier: Apache-2.0
// The list of units: what the program, the generator, the rig, the prediction of sizes, messages
// and pages know of a unit beyond its own code. docs/units.md is made of it. The code that each
// unit supplies is found by its type: golden/unit/backend.hpp, verilator_tb/unit.
#pragma once
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "golden/plan/plan.hpp"

namespace photonloom {

// Where a unit stands when the plan is on a board.
enum class BoardPlace {
  kHost,    // its work stays with the host
  kInside,  // in the board's top, between other units
  kLink,    // behind the host link: a frame can have the board as its backend
};

// What the plan has not and the unit needs; empty: the plan's hardware has the unit.
using UnitLacks = std::string (*)(const Plan& plan);
std::string lacks_photon_map(const Plan& plan);
std::string lacks_final_gathers(const Plan& plan);
std::string lacks_reordering(const Plan& plan);
std::string lacks_caching(const Plan& plan);

// clang-format off
// One line a unit, in the order in which commands tell of them: interface (golden/unit/backend.hpp);
// name, that of its files and its module; section of plan.toml; place in the chip's streams; place
// on a board; prefix of its ports on the chip; when a plan has it.
#define PHOTONLOOM_UNITS(UNIT)                                                                      \
  UNIT(PhotonGatherer, photon_gatherer, "gatherer", 2, BoardPlace::kLink, "", lacks_photon_map)       \
  UNIT(ReorderBuffer, reorder_buffer, "reorder", 1, BoardPlace::kInside, "", lacks_reordering)        \
  UNIT(CdfSampler, cdf_sampler, "sampler", 3, BoardPlace::kHost, "sampler_", lacks_final_gathers)   \
  UNIT(IrradianceCache, irradiance_cache, "cache", 4, BoardPlace::kHost, "cache_", lacks_caching)
// clang-format on

struct UnitInfo {
  const char* name;
  const char* section;
  int chip_place;
  BoardPlace board;
  const char* chip_prefix;
  UnitLacks lacks;
};

template <class Unit>
struct UnitTraits;

#define PHOTONLOOM_UNIT_TRAITS(Interface, name, ...)        \
  class Interface;                                          \
  template <>                                               \
  struct UnitTraits<Interface> {                            \
    static constexpr UnitInfo kInfo = {#name, __VA_ARGS__}; \
  };
PHOTONLOOM_UNITS(PHOTONLOOM_UNIT_TRAITS)
#undef PHOTONLOOM_UNIT_TRAITS

template <class Unit>
inline constexpr const UnitInfo& unit_info = UnitTraits<Unit>::kInfo;
template <class Unit>
inline constexpr const char* unit_name = UnitTraits<Unit>::kInfo.name;

// Calls f(std::type_identity<Interface>{}) for every unit, in the list's order.
template <class F>
void for_each_unit(F&& f) {
#define PHOTONLOOM_UNIT_VISIT(Interface, ...) f(std::type_identity<Interface>{});
  PHOTONLOOM_UNITS(PHOTONLOOM_UNIT_VISIT)
#undef PHOTONLOOM_UNIT_VISIT
}

// In the list's order.
std::vector<UnitInfo> all_units();
std::vector<std::string> unit_names();
// "a, b or c".
std::string unit_names_text();
// Throws std::runtime_error, with the names that there are, for another one.
UnitInfo find_unit(const std::string& name);

// Calls f(std::type_identity<Interface>{}) for the unit of this name; throws as find_unit.
template <class F>
void with_unit(const std::string& name, F&& f) {
  find_unit(name);
  for_each_unit([&](auto unit) {
    if (name == unit_name<typename decltype(unit)::type>) f(unit);
  });
}

// Names of the units that the plan's hardware has, in the order in which they stand on the chip.
std::vector<std::string> units_present(const Plan& plan);
// Names of those inside a board's top, in the same order: also a reorder buffer that no final
// gathers of the plan's frame go through.
std::vector<std::string> units_on_board(const Plan& plan);

}  // namespace photonloom
