// SPDX-License-Identifier: Apache-2.0
// The search with vector instructions against the one that is written step by step: equal packets,
// counts included, at every level that this machine has.
#include "golden/unit/gather_search.hpp"

#include <cstdlib>

#include "golden/unit/photon_gatherer.hpp"
#include "tests/catch.hpp"
#include "tests/photon_sets.hpp"

using namespace photonloom;
using namespace photonloom::test;

namespace {

struct SearchCase {
  PointSet set;
  size_t photons;
  uint64_t seed;
  size_t queries;
};

void check_levels(const Plan& plan, const SearchCase& what) {
  const PhotonMap map =
      build_photon_map(make_photons(plan, what.set, what.photons, what.seed), plan);
  std::vector<GatherQuery> in;
  std::vector<GatherResult> expected;
  std::vector<GatherPhoton> expected_photons;
  std::vector<Neighbour> found;
  for (uint64_t i = 0; i < what.queries; ++i) {
    in.push_back(make_query(plan, what.set, what.seed, i));
    in.back().want_photons = i % 3 == 0;
    const SearchCounts counts = search_gather(plan, map, in.back(), found);
    expected.push_back(make_gather_result(plan, map, in.back(), found, counts));
    if (in.back().want_photons) append_gather_photons(map, found, expected_photons);
  }
  for (const search::Level* level : search::available_levels()) {
    INFO(level->name << ": " << to_string(what.set) << ", " << what.photons
                     << " photons, position bits " << plan.position_bits << ", bucket "
                     << plan.bucket << ", k " << plan.k << ", r2_max " << plan.global.r2_max
                     << ", E " << plan.epsilon_factor << ", s " << plan.epsilon_shift
                     << ", leaf_limit " << plan.leaf_limit << ", seed " << what.seed);
    auto unit = make_golden_photon_gatherer(plan, *level);
    unit->load(map, map);
    std::vector<GatherResult> results;
    std::vector<GatherPhoton> photons;
    unit->process(in, results, photons);
    for (size_t i = 0; i < in.size(); ++i) {
      INFO("query " << i);
      REQUIRE(results[i] == expected[i]);
    }
    REQUIRE(photons == expected_photons);
  }
}

Plan search_plan(int position_bits, int k) {
  Plan plan;
  plan.position_bits = position_bits;
  plan.k = k;
  plan.global = {true, 1 << 20, 0, 0, plan.r2_limit()};
  plan.caustic = plan.global;
  return plan;
}

uint64_t draw(uint64_t seed, uint64_t dimension, uint64_t below) {
  return hash_bits(seed, 0, 9, dimension) % below;
}

}  // namespace

TEST_CASE("every level gives the packets of the search step by step, for every k") {
  for (int k = 1; k <= 256; ++k)
    check_levels(search_plan(16, k), {kPointSets[static_cast<size_t>(k) % std::size(kPointSets)],
                                      900, static_cast<uint64_t>(k), 12});
}

TEST_CASE("every level gives the packets of the search step by step, on random plans") {
  for (uint64_t seed = 1; seed <= 400; ++seed) {
    Plan plan = search_plan(4 + static_cast<int>(draw(seed, 0, 21)),
                            1 + static_cast<int>(draw(seed, 1, 80)));
    plan.bucket = 2 << draw(seed, 2, 4);
    plan.direction_bits = 2 + static_cast<int>(draw(seed, 3, 13));
    plan.normal_bits = 2 + static_cast<int>(draw(seed, 4, 13));
    plan.mantissa_bits = 2 + static_cast<int>(draw(seed, 5, 15));
    plan.exponent_bits = 1 + static_cast<int>(draw(seed, 6, 5));
    plan.channels = draw(seed, 7, 2) ? 3 : 1;
    plan.global.r2_max >>= draw(seed, 8, 2) * draw(seed, 9, static_cast<uint64_t>(plan.r2_bits()));
    if (draw(seed, 10, 3) == 0) {
      plan.epsilon_shift = static_cast<int>(draw(seed, 11, 16));
      plan.epsilon_factor = static_cast<uint32_t>(1 + draw(seed, 12, 65535));
    }
    plan.leaf_limit = static_cast<uint32_t>(draw(seed, 13, 3) == 0 ? 1 + draw(seed, 14, 20) : 0);
    check_levels(plan, {kPointSets[draw(seed, 15, std::size(kPointSets))],
                        static_cast<size_t>(draw(seed, 16, 3000)), seed, 10});
  }
}

TEST_CASE("a map whose keys are too wide is searched step by step") {
  Plan plan = search_plan(24, 5);
  const PhotonMap map = build_photon_map(make_photons(plan, PointSet::kRandom, 40000, 1), plan);
  REQUIRE_FALSE(search::Map::fits(map, plan.global));
  plan.global.r2_max = ones(46);
  REQUIRE(search::Map::fits(map, plan.global));
  plan.global.r2_max = plan.r2_limit();
  check_levels(plan, {PointSet::kRandom, 40000, 1, 20});
}

TEST_CASE("PHOTONLOOM_SIMD names the level, and anything else is refused") {
  const char* const before = std::getenv("PHOTONLOOM_SIMD");
  const std::string kept = before ? before : "";
  for (const search::Level* level : search::available_levels()) {
    setenv("PHOTONLOOM_SIMD", level->name, 1);
    REQUIRE(&search::chosen_level() == level);
  }
  setenv("PHOTONLOOM_SIMD", "sse9", 1);
  REQUIRE_THROWS_WITH(search::chosen_level(),
                      "PHOTONLOOM_SIMD=sse9: expected scalar, avx2 or avx512");
  setenv("PHOTONLOOM_SIMD", "", 1);
  REQUIRE(&search::chosen_level() == search::available_levels().back());
  if (before) {
    setenv("PHOTONLOOM_SIMD", kept.c_str(), 1);
  } else {
    unsetenv("PHOTONLOOM_SIMD");
  }
}
