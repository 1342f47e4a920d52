// SPDX-License-Identifier: Apache-2.0
#include "golden/plan/units.hpp"

#include <algorithm>

namespace photonloom {

std::string lacks_photon_map(const Plan& plan) {
  return plan.global.present || plan.caustic.present ? "" : "photon map";
}

std::string lacks_final_gathers(const Plan& plan) {
  return plan.global.present && plan.gather_rays > 0 ? "" : "final gather rays";
}

// Only final gather rays are incoherent enough to be worth reordering.
std::string lacks_reordering(const Plan& plan) {
  if (const std::string rays = lacks_final_gathers(plan); !rays.empty()) return rays;
  return plan.reorder_key == ReorderKey::kNone ? "reordering (reorder.key is none)" : "";
}

std::string lacks_caching(const Plan& plan) {
  if (const std::string rays = lacks_final_gathers(plan); !rays.empty()) return rays;
  return plan.cache_present ? "" : "irradiance cache (cache.present is false)";
}

std::vector<UnitInfo> all_units() {
  std::vector<UnitInfo> units;
  for_each_unit([&](auto unit) { units.push_back(unit_info<typename decltype(unit)::type>); });
  return units;
}

std::vector<std::string> unit_names() {
  std::vector<std::string> names;
  for (const UnitInfo& u : all_units()) names.push_back(u.name);
  return names;
}

std::string unit_names_text() {
  const std::vector<std::string> names = unit_names();
  std::string text;
  for (size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + names[i];
  return text;
}

UnitInfo find_unit(const std::string& name) {
  for (const UnitInfo& u : all_units())
    if (name == u.name) return u;
  throw std::runtime_error("there is no unit " + name + ", expected " + unit_names_text());
}

namespace {

template <class Has>
std::vector<std::string> names_where(Has has) {
  std::vector<UnitInfo> units = all_units();
  std::sort(units.begin(), units.end(),
            [](const UnitInfo& a, const UnitInfo& b) { return a.chip_place < b.chip_place; });
  std::vector<std::string> names;
  for (const UnitInfo& u : units)
    if (has(u)) names.push_back(u.name);
  return names;
}

}  // namespace

std::vector<std::string> units_present(const Plan& plan) {
  return names_where([&](const UnitInfo& u) { return u.lacks(plan).empty(); });
}

std::vector<std::string> units_on_board(const Plan& plan) {
  return names_where([&](const UnitInfo& u) {
    if (u.board == BoardPlace::kHost) return false;
    return u.board == BoardPlace::kInside ? plan.reorder_key != ReorderKey::kNone
                                          : u.lacks(plan).empty();
  });
}

}  // namespace photonloom
