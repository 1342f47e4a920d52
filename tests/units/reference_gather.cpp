// SPDX-License-Identifier: Apache-2.0
#include "golden/unit/reference_gather.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "golden/numeric/elementary.hpp"
#include "tests/catch.hpp"
#include "tests/photon_sets.hpp"

using namespace photonloom;
using namespace photonloom::test;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Vec3 make_position(PointSet set, uint64_t seed, uint64_t i) {
  const UVec3 p = make_point(set, 20, seed, i);
  return Vec3(p[0], p[1], p[2]) * 1e-3 - Vec3(7, 300, 0);
}

Vec3 make_direction(uint64_t seed, uint64_t i) {
  const Random random(seed, Phase::kPath, i);
  return oct_unfold(2 * random.unit(1, 0) - 1, 2 * random.unit(1, 1) - 1);
}

std::vector<Photon> make_reference_photons(PointSet set, size_t n, uint64_t seed) {
  std::vector<Photon> photons(n);
  for (size_t i = 0; i < n; ++i)
    photons[i] = {make_position(set, seed, i), make_direction(seed, i),
                  Rgb(1.0 + static_cast<double>(i), 2, 3), i, 0};
  return photons;
}

std::vector<ReferenceNeighbour> brute(const std::vector<Photon>& photons, const Vec3& position,
                                      const Vec3& normal, int k, double r2_max) {
  std::vector<ReferenceNeighbour> found;
  for (uint32_t i = 0; i < photons.size(); ++i) {
    const Vec3 d = photons[i].position - position;
    const double d2 = d.x * d.x + d.y * d.y + d.z * d.z;
    const Vec3& w = photons[i].direction;
    if (d2 <= r2_max && w.x * normal.x + w.y * normal.y + w.z * normal.z > 0)
      found.push_back({d2, i});
  }
  std::sort(found.begin(), found.end());
  if (found.size() > static_cast<size_t>(k)) found.resize(static_cast<size_t>(k));
  return found;
}

}  // namespace

TEST_CASE("both reference trees find exactly the nearest photons") {
  std::vector<ReferenceNeighbour> found;
  for (PointSet set : kPointSets)
    for (size_t n : {0, 1, 2, 7, 8, 9, 100, 1000})
      for (ReferenceTree tree : {ReferenceTree::kNodes, ReferenceTree::kBuckets}) {
        const ReferenceGather gather(make_reference_photons(set, n, n), tree);
        for (int k : {1, 2, 8, 50, 200})
          for (double radius : {0.0, 30.0, 400.0, kInfinity})
            for (uint64_t q = 0; q < 4; ++q) {
              const Vec3 position = make_position(q % 2 ? PointSet::kRandom : set, 77, q);
              const Vec3 normal = make_direction(78, q);
              INFO(to_string(set) << ", " << n << " photons, k " << k << ", radius " << radius
                                  << ", query " << q);
              gather.find(position, normal, k, radius * radius, found);
              REQUIRE(found == brute(gather.photons(), position, normal, k, radius * radius));
            }
      }
}

TEST_CASE("the two kernels by hand") {
  std::vector<Photon> photons;
  for (double x : {1.0, 2.0, 3.0})
    photons.push_back({Vec3(x, 0, 0), Vec3(0, 0, 1), Rgb(1, 10, 100), 0, 0});
  const ReferenceGather gather(photons);
  std::vector<ReferenceNeighbour> found;
  gather.find(Vec3(0), Vec3(0, 0, 1), 2, 100, found);
  REQUIRE(ReferenceGather::radius2(found, 2, 100) == 4);
  // Two of two: c = 1/2, r^2 = 4.
  Rgb e = gather.irradiance(found, 2, 100, 0, Kernel::kFlat);
  REQUIRE(e.y == Approx(10 * 2 * 0.5 / (4 * kPi)));
  e = gather.irradiance(found, 2, 100, 0, Kernel::kEpanechnikov);
  REQUIRE(e.z == Approx(100 * 2 * (0.75 + 0.0) / (4 * kPi)));
  // Three of four: c = 1, r^2 = r2_max.
  gather.find(Vec3(0), Vec3(0, 0, 1), 4, 100, found);
  REQUIRE(found.size() == 3);
  e = gather.irradiance(found, 4, 100, 0, Kernel::kFlat);
  REQUIRE(e.x == Approx(3 / (100 * kPi)));
  // The floor.
  e = gather.irradiance(found, 4, 100, 200, Kernel::kFlat);
  REQUIRE(e.x == Approx(3 / (200 * kPi)));
  // No radius and too few photons: no density.
  gather.find(Vec3(0), Vec3(0, 0, 1), 4, kInfinity, found);
  REQUIRE(gather.irradiance(found, 4, kInfinity, 0, Kernel::kFlat) == Rgb(0));
}
