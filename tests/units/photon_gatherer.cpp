// SPDX-License-Identifier: Apache-2.0
#include "golden/unit/photon_gatherer.hpp"

#include <algorithm>
#include <string>

#include "golden/numeric/reciprocal.hpp"
#include "tests/catch.hpp"
#include "tests/photon_sets.hpp"

using namespace photonloom;
using namespace photonloom::test;

namespace {

// A plan whose global map has no radius.
Plan make_plan(int position_bits, int k) {
  Plan plan;
  plan.position_bits = position_bits;
  plan.k = k;
  plan.global = {true, 1 << 20, 0, 0, plan.r2_limit()};
  plan.caustic = plan.global;
  return plan;
}

// Results of a unit for the queries; both maps are the same one.
struct Answers {
  std::vector<GatherResult> results;
  std::vector<GatherPhoton> photons;
};
Answers ask(PhotonGatherer& unit, const PhotonMap& map, const std::vector<GatherQuery>& queries) {
  Answers answers;
  unit.load(map, map);
  unit.process(queries, answers.results, answers.photons);
  return answers;
}

// Golden against brute force, everything but the counts.
void check_exact(const Plan& plan, PointSet set, size_t photons, size_t queries, uint64_t seed) {
  const PhotonMap map = build_photon_map(make_photons(plan, set, photons, seed), plan);
  std::vector<GatherQuery> in;
  for (uint64_t i = 0; i < queries; ++i) {
    in.push_back(make_query(plan, set, seed, i));
    in.back().want_photons = 1;
  }
  INFO(to_string(set) << ", " << photons << " photons, position bits " << plan.position_bits
                      << ", k " << plan.k << ", r2_max " << plan.global.r2_max << ", bucket "
                      << plan.bucket << ", seed " << seed);
  Answers golden = ask(*make_golden_photon_gatherer(plan), map, in);
  Answers brute = ask(*make_brute_photon_gatherer(plan), map, in);
  REQUIRE(golden.results.size() == in.size());
  for (GatherResult& result : golden.results) result.nodes = result.leaves = result.insertions = 0;
  for (size_t i = 0; i < in.size(); ++i) {
    INFO("query " << i);
    REQUIRE(golden.results[i] == brute.results[i]);
  }
  REQUIRE(golden.photons == brute.photons);
}

}  // namespace

TEST_CASE("the gather is exact for every k from 1 to 200 and every point set") {
  for (int k = 1; k <= 200; ++k)
    for (PointSet set : kPointSets)
      check_exact(make_plan(16, k), set, 400, 6, static_cast<uint64_t>(k));
}

TEST_CASE("the gather is exact for every number of photons, partial last lines included") {
  for (size_t n = 0; n <= 200; ++n)
    for (int bucket : {2, 4, 8, 16}) {
      Plan plan = make_plan(16, 1 + static_cast<int>(n % 20));
      plan.bucket = bucket;
      check_exact(plan, kPointSets[n % std::size(kPointSets)], n, 4, n);
    }
}

TEST_CASE("the gather is exact at every position width") {
  for (int bits = 4; bits <= 24; ++bits)
    for (PointSet set : kPointSets) {
      Plan plan = make_plan(bits, 13);
      check_exact(plan, set, 1000, 10, static_cast<uint64_t>(bits));
      plan.direction_bits = 2 + bits % 13;
      plan.normal_bits = 14 - bits % 13;
      check_exact(plan, set, 1000, 10, static_cast<uint64_t>(bits));
    }
}

TEST_CASE("the gather is exact with a radius: none, all, the boundary, zero") {
  for (PointSet set : kPointSets)
    for (uint64_t r2 : {uint64_t{0}, uint64_t{1}, uint64_t{4000000}, uint64_t{65535} * 65535,
                        uint64_t{3} * 65535 * 65535}) {
      Plan plan = make_plan(16, 20);
      plan.global.r2_max = r2;
      check_exact(plan, set, 500, 20, 5 + r2 % 7);
    }
}

TEST_CASE("a photon exactly at r2_max is a candidate, one unit further is not") {
  Plan plan = make_plan(16, 4);
  plan.global.r2_max = 25;
  std::vector<PackedPhoton> photons(2);
  photons[0].position = {103, 104, 100};
  photons[1].position = {103, 104, 101};
  for (PackedPhoton& p : photons) p.power.mantissa = {256, 0, 0};
  const PhotonMap map = build_photon_map(photons, plan);
  GatherQuery query{};
  query.position = {100, 100, 100};
  const Answers answers = ask(*make_golden_photon_gatherer(plan), map, {query});
  REQUIRE(answers.results[0].count == 1);
  REQUIRE(answers.results[0].r2 == 25);
  REQUIRE(answers.results[0].full == 0);
  REQUIRE(answers.results[0].flux == Channels64{256, 0, 0});
}

TEST_CASE("a photon from behind and one along the surface are rejected inside the search") {
  Plan plan = make_plan(16, 1);
  // Two bits: centres have odd coordinates, so opposite and orthogonal pairs exist.
  plan.direction_bits = plan.normal_bits = 2;
  int front = 0, back = 0, along = 0;
  for (uint32_t code = 0; code < 16; ++code)
    for (uint32_t normal = 0; normal < 16; ++normal) {
      std::vector<PackedPhoton> photons(2);
      photons[0].position = {100, 100, 100};  // nearest, the one in question
      photons[0].direction = {code & 3, code >> 2};
      photons[1].position = {200, 100, 100};
      photons[1].direction = {normal & 3, normal >> 2};
      for (PackedPhoton& p : photons) p.power.mantissa = {256, 1, 2};
      const PhotonMap map = build_photon_map(photons, plan);
      GatherQuery query{};
      query.position = {100, 100, 101};
      query.normal = {normal & 3, normal >> 2};
      const Answers answers = ask(*make_golden_photon_gatherer(plan), map, {query});
      const int64_t product = oct_dot(oct_decode(photons[0].direction, 2),
                                      oct_decode({query.normal[0], query.normal[1]}, 2));
      (product > 0 ? front : product < 0 ? back : along) += 1;
      REQUIRE(answers.results[0].count == 1);
      REQUIRE(answers.results[0].r2 == (product > 0 ? 1u : 10001u));
    }
  REQUIRE(front > 0);
  REQUIRE(back > 0);
  REQUIRE(along > 0);
}

TEST_CASE("an empty map answers n = 0, flux 0, r2_max") {
  Plan plan = make_plan(16, 8);
  plan.global.r2_max = 777;
  const PhotonMap empty = build_photon_map({}, plan);
  GatherQuery query{};
  query.pixel = 5;
  query.want_photons = 1;
  const Answers answers = ask(*make_golden_photon_gatherer(plan), empty, {query});
  GatherResult expected{};
  expected.pixel = 5;
  expected.r2 = 777;
  const Reciprocal inverse = reciprocal(777, plan.reciprocal_bits);
  expected.reciprocal = inverse.mantissa;
  expected.reciprocal_exponent = inverse.exponent;
  REQUIRE(answers.results[0] == expected);
  REQUIRE(answers.photons.empty());
}

TEST_CASE("a flush is answered by a flush, in its place, and r2 below the floor is clamped") {
  Plan plan = make_plan(16, 2);
  plan.r2_floor = 4;
  const PhotonMap map = build_photon_map(make_photons(plan, PointSet::kCoincident, 50, 1), plan);
  GatherQuery query = make_query(plan, PointSet::kCoincident, 1, 0);
  GatherQuery flush{};
  flush.pixel = 3;
  flush.sample = 2;
  flush.tag = 1;
  flush.flush = 1;
  auto unit = make_golden_photon_gatherer(plan);
  const Answers answers = ask(*unit, map, {query, flush, query});
  GatherResult expected{};
  expected.pixel = 3;
  expected.sample = 2;
  expected.tag = 1;
  expected.flush = 1;
  REQUIRE(answers.results[1] == expected);
  REQUIRE(answers.results[0] == answers.results[2]);
  REQUIRE(answers.results[0].r2 == 0);
  REQUIRE(answers.results[0].full == 1);
  REQUIRE(answers.results[0].clamped == 1);
  const Reciprocal inverse = reciprocal(4, plan.reciprocal_bits);
  REQUIRE(answers.results[0].reciprocal == inverse.mantissa);
  REQUIRE(unit->counters().at("flushes") == 1);
  REQUIRE(unit->counters().at("queries") == 2);
}

TEST_CASE("each query asks the map that it names, with that map's radius") {
  Plan plan = make_plan(16, 5);
  plan.caustic.r2_max = 1000000;
  const PhotonMap global = build_photon_map(make_photons(plan, PointSet::kRandom, 300, 1), plan);
  const PhotonMap caustic = build_photon_map(make_photons(plan, PointSet::kRandom, 200, 2), plan);
  std::vector<GatherQuery> in;
  for (uint64_t i = 0; i < 40; ++i) {
    in.push_back(make_query(plan, PointSet::kRandom, 9, i));
    in.back().map = i % 3 == 0;
  }
  auto unit = make_golden_photon_gatherer(plan);
  unit->load(global, caustic);
  std::vector<GatherResult> results;
  std::vector<GatherPhoton> photons;
  unit->process(in, results, photons);
  for (size_t i = 0; i < in.size(); ++i) {
    const PhotonMap& map = in[i].map ? caustic : global;
    const auto found = brute_force_gather(plan, map, in[i]);
    GatherResult expected = make_gather_result(plan, map, in[i], found, {});
    expected.nodes = results[i].nodes;
    expected.leaves = results[i].leaves;
    expected.insertions = results[i].insertions;
    REQUIRE(results[i] == expected);
  }
}

TEST_CASE("how the calls cut the stream does not change what comes out") {
  const Plan plan = make_plan(16, 12);
  const PhotonMap map = build_photon_map(make_photons(plan, PointSet::kSurfaces, 5000, 4), plan);
  std::vector<GatherQuery> in;
  for (uint64_t i = 0; i < 6000; ++i) {
    in.push_back(make_query(plan, PointSet::kSurfaces, 4, i));
    in.back().want_photons = i % 5 == 0;
  }
  const Answers whole = ask(*make_golden_photon_gatherer(plan), map, in);
  auto unit = make_golden_photon_gatherer(plan);
  unit->load(map, map);
  Answers cut;
  for (size_t i = 0; i < in.size(); i += 701)
    unit->process(std::span(in).subspan(i, std::min<size_t>(701, in.size() - i)), cut.results,
                  cut.photons);
  REQUIRE(cut.results == whole.results);
  REQUIRE(cut.photons == whole.photons);
}

TEST_CASE("counts of a search small enough to follow by hand") {
  // Two lines of two photons on a line; node 1 splits x at 30.
  Plan plan = make_plan(8, 1);
  plan.bucket = 2;
  std::vector<PackedPhoton> photons(4);
  for (uint32_t i = 0; i < 4; ++i) {
    photons[i].position = {10 * (i + 1), 0, 0};
    photons[i].power.mantissa = {256, 0, 0};
  }
  const PhotonMap map = build_photon_map(photons, plan);
  REQUIRE(map.nodes[1].split == 30);
  GatherQuery query{};
  std::vector<Neighbour> found;
  const auto counts = [&](uint32_t x) {
    query.position = {x, 0, 0};
    const SearchCounts c = search_gather(plan, map, query, found);
    return std::vector<uint32_t>{c.nodes, c.leaves, c.insertions, found[0].index};
  };
  // Left of the split: both photons of line 0 enter one after the other (10, then 20 is nearer).
  REQUIRE(counts(21) == std::vector<uint32_t>{1, 1, 2, 1});
  // At the split the query goes right first; 30 is at distance 0, so 40 does not enter and the far
  // side, at distance 0, is not skipped: it may hold an equal photon with a smaller index.
  REQUIRE(counts(30) == std::vector<uint32_t>{1, 2, 1, 2});
  // Distance 5 to 20 and to the split is 25 against 25: equal, so visited; 30 loses by index.
  REQUIRE(counts(25) == std::vector<uint32_t>{1, 2, 2, 1});
  plan.leaf_limit = 1;
  REQUIRE(counts(25) == std::vector<uint32_t>{1, 1, 2, 1});
  plan.leaf_limit = 0;
  // A quarter more than the exact distance is skipped: 25 * 5 > 25 * 4.
  plan.epsilon_factor = 5;
  plan.epsilon_shift = 2;
  REQUIRE(counts(25) == std::vector<uint32_t>{1, 1, 2, 1});
}
