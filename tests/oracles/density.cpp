// SPDX-License-Identifier: Apache-2.0
// The density estimate on a plane with evenly scattered photons is Phi / A, with c = (k - 1) / k
// for a full gather and 1 else, whether the radius holds k photons, half of them or half as many
// again.
#include <cmath>
#include <set>

#include "golden/numeric/elementary.hpp"
#include "golden/unit/reference_gather.hpp"
#include "tests/catch.hpp"
#include "tests/oracles/statistics.hpp"

using namespace photonloom;
using namespace photonloom::oracle;

TEST_CASE(
    "density estimate on a uniform plane: Phi / A at full, half and one and a half filled radius, "
    "within 2 %") {
  constexpr int kPhotons = 4000, kSets = 160, kQueries = 12;
  const Rgb power(0.5, 1, 2);
  for (const int k : {5, 50})
    for (const double filled : {1.0, 0.5, 1.5}) {
      const double r2 = filled * k / (kPi * kPhotons);  // on the unit square
      std::set<double> sets;                            // each by where its first photon lies
      for (const uint64_t seed : kSeeds) {
        Tally flat;
        for (uint64_t set = 0; set < kSets; ++set) {
          std::vector<Photon> photons;
          for (uint64_t i = 0; i < kPhotons; ++i) {
            const Random r(batch_seed(seed, set), Phase::kPath, i);
            photons.push_back({Vec3(r.unit(0, 0), r.unit(0, 1), 0), Vec3(0, 0, 1), power, i, 0});
          }
          REQUIRE(sets.insert(photons[0].position.x).second);  // no set is counted twice
          const ReferenceGather map(photons);
          // Queries away from the border, on a grid that covers the rest.
          double sum = 0;
          std::vector<ReferenceNeighbour> found;
          for (int i = 0; i < kQueries * kQueries; ++i) {
            const Vec3 x(0.15 + 0.7 * (i % kQueries + 0.5) / kQueries,
                         0.15 + 0.7 * (i / kQueries + 0.5) / kQueries, 0);
            map.find(x, Vec3(0, 0, 1), k, r2, found);
            const Rgb e = map.irradiance(found, k, r2, 0, Kernel::kFlat);
            sum += (e.x / 0.5 + e.y + e.z / 2) / 3;
          }
          flat.add(sum / (kQueries * kQueries));
        }
        INFO("k " << k << ", radius filled " << filled);
        check_estimate("flat kernel", seed, flat.estimate(), kPhotons, 0.02);
      }
    }
}
