// SPDX-License-Identifier: Apache-2.0
// The list of units.
#include "golden/plan/units.hpp"

#include <set>

#include "golden/unit/backend.hpp"
#include "tests/catch.hpp"

using namespace photonloom;

TEST_CASE("names, sections and places are one unit's each") {
  std::set<std::string> names, sections;
  std::set<int> places;
  for (const UnitInfo& u : all_units()) {
    names.insert(u.name);
    sections.insert(u.section);
    places.insert(u.chip_place);
  }
  CHECK(names.size() == all_units().size());
  CHECK(sections.size() == all_units().size());
  CHECK(places.size() == all_units().size());
}

TEST_CASE("a unit is found by its name") {
  for (const std::string& name : unit_names()) {
    CHECK(find_unit(name).name == name);
    int found = 0;
    with_unit(name, [&](auto unit) { found += name == unit_name<typename decltype(unit)::type>; });
    CHECK(found == 1);
  }
  CHECK_THROWS_WITH(find_unit("shader"), ContainsSubstring("there is no unit shader, expected ") &&
                                             ContainsSubstring(unit_names_text()));
  CHECK_THROWS_WITH(with_unit("", [](auto) {}), ContainsSubstring("there is no unit"));
}

TEST_CASE("a plan has the units that it lacks nothing for, in the order of the chip") {
  Plan plan;
  CHECK(units_present(plan).empty());
  plan.caustic.present = true;
  CHECK(units_present(plan) == std::vector<std::string>{"photon_gatherer"});
  plan.global.present = true;
  plan.gather_rays = 4;
  plan.reorder_key = ReorderKey::kHilbert;
  CHECK(units_present(plan) ==
        std::vector<std::string>{"reorder_buffer", "photon_gatherer", "cdf_sampler"});
  CHECK(find_unit("irradiance_cache").lacks(plan) == "irradiance cache (cache.present is false)");
  plan.cache_present = true;
  CHECK(units_present(plan) == std::vector<std::string>{"reorder_buffer", "photon_gatherer",
                                                        "cdf_sampler", "irradiance_cache"});
  plan.cache_present = false;
  plan.reorder_key = ReorderKey::kNone;
  CHECK(find_unit("reorder_buffer").lacks(plan) == "reordering (reorder.key is none)");
  CHECK(units_present(plan) == std::vector<std::string>{"photon_gatherer", "cdf_sampler"});
  plan.gather_rays = 0;
  for (const char* unit : {"reorder_buffer", "cdf_sampler", "irradiance_cache"})
    CHECK(find_unit(unit).lacks(plan) == "final gather rays");
  CHECK(units_present(plan) == std::vector<std::string>{"photon_gatherer"});
}

TEST_CASE("every unit has a golden unit with counters") {
  Plan plan;
  plan.global = {.present = true, .photons = 1};
  for_each_unit([&](auto unit) { CHECK(!make_golden(unit, plan)->counters().empty()); });
}
