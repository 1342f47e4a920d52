// SPDX-License-Identifier: Apache-2.0
// The model of the leaf cache and the orders that it is asked about.
#include <algorithm>
#include <numeric>
#include <set>

#include "golden/numeric/hilbert.hpp"
#include "golden/numeric/random.hpp"
#include "golden/unit/photon_gatherer.hpp"
#include "study/cache_model.hpp"
#include "study/frame_gathers.hpp"
#include "study/photon_layouts.hpp"
#include "tests/catch.hpp"
#include "tests/photon_sets.hpp"

using namespace photonloom;

namespace {

LineVisits random_visits(size_t queries, uint32_t lines, uint64_t seed) {
  LineVisits visits;
  for (size_t q = 0; q < queries; ++q) {
    std::vector<uint32_t> list;
    const size_t n = hash_bits(seed, q, 0, 0) % 6;
    for (size_t i = 0; i < n; ++i)
      list.push_back(static_cast<uint32_t>(hash_bits(seed, q, 1, i) % lines));
    visits.add_query(list);
  }
  return visits;
}

constexpr LookupTimes kTimes{.read = 2, .beats = 8, .memory = 20, .between = 40, .misses = 8};

std::vector<uint32_t> in_order(const LineVisits& visits) {
  std::vector<uint32_t> order(visits.queries());
  std::iota(order.begin(), order.end(), 0u);
  return order;
}

}  // namespace

TEST_CASE("the cache of a hand-made stream") {
  // Two sets of two ways. Lines 0, 2, 4, 6 share set 0, line 1 is in set 1; the turn is common. Of
  // two ways the one used before is the one that goes.
  LineVisits visits;
  visits.add_query(std::vector<uint32_t>{0, 2});     // misses into ways 0, 1
  visits.add_query(std::vector<uint32_t>{0, 1, 4});  // hit; miss; miss: 2 goes
  visits.add_query(std::vector<uint32_t>{0, 4, 2});  // hit, hit, miss: 0 goes
  visits.add_query(std::vector<uint32_t>{});
  visits.add_query(std::vector<uint32_t>{4, 1, 0});  // hit, hit, miss
  const std::vector<uint32_t> order = in_order(visits);
  CHECK(lines_fetched({2, 2}, visits, order) == 6);
  CHECK(lines_fetched({2, 2}, visits, std::vector<uint32_t>{1, 0}) == 4);
  // Of three ways: all used but the last, so the turn decides among those that are not.
  LineVisits turns;
  turns.add_query(std::vector<uint32_t>{0, 1, 2});  // ways 0, 1, 2; then only 2 counts as used
  turns.add_query(std::vector<uint32_t>{1, 3});     // hit; the turn is at 0: 0 goes
  turns.add_query(std::vector<uint32_t>{1, 2});     // both still there
  turns.add_query(std::vector<uint32_t>{0});
  CHECK(lines_fetched({1, 3}, turns, in_order(turns)) == 5);
  // What is asked for again and again stays while others pass.
  LineVisits passing;
  for (uint32_t i = 1; i < 20; ++i) passing.add_query(std::vector<uint32_t>{0, i});
  CHECK(lines_fetched({1, 2}, passing, in_order(passing)) == 20);
}

TEST_CASE("a cache that holds everything fetches each line once, whatever order and turns") {
  const LineVisits visits = random_visits(500, 64, 1);
  std::set<uint32_t> lines;
  for (size_t q = 0; q < visits.queries(); ++q)
    lines.insert(visits.of(q).begin(), visits.of(q).end());
  std::vector<uint32_t> order = in_order(visits);
  for (const int contexts : {1, 3, 16}) {
    CHECK(lines_fetched({64, 1}, visits, order, contexts, kTimes) == lines.size());
    CHECK(lines_fetched({1, 64}, visits, order, contexts, kTimes) == lines.size());
    std::reverse(order.begin(), order.end());
  }
  // No line twice in a row in one set of one way, no hit.
  LineVisits apart;
  for (uint32_t i = 0; i < 100; ++i) apart.add_query(std::vector<uint32_t>{i % 7});
  CHECK(lines_fetched({1, 1}, apart, in_order(apart)) == 100);
}

TEST_CASE("queries in flight share lines, wait for them and take them from each other") {
  // Two queries in flight read the same lines at the same time: each is fetched once, although one
  // place would lose them to each other in turns.
  LineVisits same;
  for (int i = 0; i < 2; ++i) same.add_query(std::vector<uint32_t>{0, 1, 2});
  CHECK(lines_fetched({1, 1}, same, in_order(same), 2, kTimes) == 3);
  // One miss at a time may be on its way; a way that waits for its line cannot be taken.
  LookupTimes one = kTimes;
  one.misses = 1;
  CHECK(lines_fetched({1, 1}, same, in_order(same), 2, one) == 3);
  // The second query enters when the first has ended where one is in flight, and at once where two
  // are: then 0 and 1 are fetched by turns.
  LineVisits apart;
  apart.add_query(std::vector<uint32_t>{0, 0, 0, 0});
  apart.add_query(std::vector<uint32_t>{1, 1, 1, 1});
  CHECK(lines_fetched({1, 1}, apart, in_order(apart), 1, kTimes) == 2);
  CHECK(lines_fetched({1, 1}, apart, in_order(apart), 2, kTimes) == 8);
  CHECK(lines_fetched({1, 2}, apart, in_order(apart), 2, kTimes) == 2);
}

TEST_CASE("a hit that waits for the reader may lose its line") {
  // Where the reader takes 100 cycles a line, hits wait for it, and misses overtake them.
  LookupTimes slow = kTimes;
  slow.read = 100;
  slow.between = 1;
  const LineVisits visits = random_visits(400, 40, 3);
  const uint64_t quick = lines_fetched({8, 2}, visits, in_order(visits), 16, kTimes);
  CHECK(lines_fetched({8, 2}, visits, in_order(visits), 16, slow) > quick);
}

TEST_CASE(
    "orders of the model are permutations; a window of one is none, of all the Hilbert order") {
  Plan plan;
  plan.reorder_packets = 100;
  FrameGathers gathers;
  for (uint64_t i = 0; i < 1000; ++i) {
    GatherQuery q{};
    for (size_t c = 0; c < 3; ++c)
      q.position[c] = static_cast<uint32_t>(hash_bits(2, i, c, 0) >> 48);
    gathers.queries.push_back(q);
  }
  std::vector<uint32_t> made(1000);
  std::iota(made.begin(), made.end(), 0u);
  std::reverse(made.begin(), made.end());
  const auto sorted = [](std::vector<uint32_t> v) {
    std::sort(v.begin(), v.end());
    return v;
  };
  const std::vector<uint32_t> buffered = buffered_order(plan, gathers.queries, made);
  CHECK(buffered != made);
  CHECK(sorted(buffered) == sorted(made));
  CHECK(sorted_windows(plan, gathers, made, 1) == made);
  const std::vector<uint32_t> whole = sorted_windows(plan, gathers, made, made.size());
  CHECK(sorted(whole) == sorted(made));
  const auto index = [&](uint32_t q) {
    return hilbert_index(gathers.queries[q].position, plan.position_bits);
  };
  CHECK(std::is_sorted(whole.begin(), whole.end(),
                       [&](uint32_t a, uint32_t b) { return index(a) < index(b); }));
  const std::vector<uint32_t> windows = sorted_windows(plan, gathers, made, 300);
  for (size_t begin = 0; begin < 1000; begin += 300) {
    const auto at = [](const auto& v, size_t i) {
      return v.begin() + static_cast<std::ptrdiff_t>(std::min<size_t>(i, 1000));
    };
    CHECK(sorted({at(windows, begin), at(windows, begin + 300)}) ==
          sorted({at(made, begin), at(made, begin + 300)}));
  }
}

namespace {

Plan layout_plan(int k, uint64_t r2_max) {
  Plan plan;
  plan.k = k;
  plan.global.present = true;
  plan.global.photons = 3000;
  plan.global.r2_max = r2_max;
  return plan;
}

std::vector<PackedPhoton> random_photons(test::PointSet set, const Plan& plan, size_t n) {
  std::vector<PackedPhoton> photons(n);
  for (uint64_t i = 0; i < n; ++i) {
    const auto bits = [&](uint64_t d, int width) {
      return static_cast<uint32_t>(hash_bits(9, i, 7, d) >> (64 - width));
    };
    photons[i].position = test::make_point(set, plan.position_bits, 9, i);
    photons[i].direction = {bits(0, plan.direction_bits), bits(1, plan.direction_bits)};
    photons[i].power = {{bits(2, 9) | 256, bits(3, 9), bits(4, 9)}, bits(5, 2) + 8};
  }
  return photons;
}

}  // namespace

TEST_CASE("every layout finds the photons that the tree of lines finds") {
  for (const test::PointSet set : test::kPointSets)
    for (const int k : {1, 8, 50}) {
      const Plan plan = layout_plan(k, uint64_t{6000} * 6000);
      const PhotonMap map = build_photon_map(random_photons(set, plan, 3000), plan);
      const std::unique_ptr<PhotonLayout> layouts[] = {
          make_plain_lines(plan, map, 12), make_compressed_lines(plan, map, 80),
          make_textbook_tree(plan, map), make_hash_grid(plan, map)};
      for (uint64_t i = 0; i < 40; ++i) {
        GatherQuery query{};
        query.position = test::make_point(set, plan.position_bits, 10, i);
        query.normal = {static_cast<uint32_t>(hash_bits(11, i, 0, 0) >> 56),
                        static_cast<uint32_t>(hash_bits(11, i, 0, 1) >> 56)};
        const std::vector<Neighbour> expected = brute_force_gather(plan, map, query);
        for (const auto& layout : layouts) {
          std::vector<Neighbour> found;
          std::vector<uint32_t> lines;
          layout->gather(query, found, lines);
          INFO(test::to_string(set)
               << ", k " << k << ", query " << i << ", layout " << (&layout - layouts));
          CHECK(found == expected);
          for (const uint32_t line : lines)
            CHECK((uint64_t{line} + 1) * static_cast<uint64_t>(layout->line_bytes()) <=
                  layout->map_bytes());
        }
      }
    }
}
