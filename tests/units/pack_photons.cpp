// SPDX-License-Identifier: Apache-2.0
#include "golden/unit/pack_photons.hpp"

#include <cmath>

#include "golden/plan/quantiser.hpp"
#include "tests/catch.hpp"

using namespace photonloom;

namespace {

Photon photon(const Rgb& power) { return {Vec3(0.25, 0.5, 0.75), Vec3(0, 0, 1), power, 0, 0}; }

}  // namespace

TEST_CASE("a photon is packed by the named conversions") {
  Plan plan;
  MapPlan map;
  map.power_exponent = -10;
  PackCounts counts;
  const PackedPhoton packed = pack(photon({3, 2, 1}), plan, map, &counts);
  REQUIRE(packed.position == UVec3{1 << 14, 1 << 15, 3 << 14});
  REQUIRE(packed.direction == oct_encode(Vec3(0, 0, 1), 8));
  // 3072, 2048, 1024 units; the top mantissa is below 512, so the exponent is 3.
  REQUIRE(packed.power == PowerCode{{384, 256, 128}, 3});
  REQUIRE(counts.zeroed == 0);
  REQUIRE(counts.saturated == 0);
}

TEST_CASE("one channel carries the value of the plan's colour") {
  Plan plan;
  plan.channels = 1;
  plan.channel_color = {0.5, 1, 0.25};
  MapPlan map;
  const PackedPhoton packed = pack(photon({50, 100, 25}), plan, map, nullptr);
  REQUIRE(packed.power == PowerCode{{100, 0, 0}, 0});
}

TEST_CASE("photons outside of the cube are counted and become its nearest unit") {
  const Plan plan;  // the unit cube
  std::vector<Photon> photons(4, photon({1, 1, 1}));
  photons[0].position = Vec3(0);
  photons[1].position = Vec3(0.5, 0.5, 1);  // the upper faces are not part of the cube
  photons[2].position = Vec3(-1e-9, 2, 0.5);
  photons[3].position = Vec3(0.5, 0.5, 1 - 1e-9);
  PackCounts counts;
  const auto packed = pack_photons(photons, plan, MapPlan{}, &counts);
  REQUIRE(counts.outside == 2);
  REQUIRE(packed[1].position == UVec3{32768, 32768, 65535});
  REQUIRE(packed[2].position == UVec3{0, 65535, 32768});
}

TEST_CASE("photons that become zero or do not fit are counted; black ones are neither") {
  Plan plan;
  plan.exponent_bits = 1;  // largest code 511 * 2
  MapPlan map;
  std::vector<Photon> photons{photon({0.4, 0.2, 0.1}), photon({0.5, 0, 0}), photon({2000, 1, 1}),
                              photon({1022, 1, 1}), photon({0, 0, 0})};
  PackCounts counts;
  const auto packed = pack_photons(photons, plan, map, &counts);
  REQUIRE(counts.zeroed == 1);
  REQUIRE(counts.saturated == 1);
  REQUIRE(power_value(packed[1].power, 0) == 1);
  REQUIRE(power_value(packed[2].power, 0) == power_max(9, 1));
}

TEST_CASE("the power exponent is the smallest at which the largest photon fits") {
  for (int m : {2, 5, 9, 16})
    for (int e : {1, 3, 5})
      for (double largest : {1e-30, 3.7e-6, 0.5, 1.0, 511.0, 511.5, 512.0, 1e9}) {
        Plan plan;
        plan.mantissa_bits = m;
        plan.exponent_bits = e;
        const std::vector<Photon> photons{photon({largest, 0, largest / 3}), photon({0, 1e-40, 0})};
        INFO("mantissa bits " << m << ", exponent bits " << e << ", largest " << largest);
        MapPlan map;
        map.power_exponent = choose_power_exponent(photons, plan);
        PackCounts counts;
        pack_photons(photons, plan, map, &counts);
        REQUIRE(counts.saturated == 0);
        --map.power_exponent;
        pack_photons(photons, plan, map, &counts);
        REQUIRE(counts.saturated == 1);
      }
  REQUIRE(choose_power_exponent(std::vector<Photon>{photon({0, 0, 0})}, Plan{}) == 0);
}
