// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "golden/plan/plan_file.hpp"
#include "verilator_tb/bench/bench.hpp"

namespace photonloom {

namespace {

// Changes what decides the bytes of a line; caches keep their lines, and a beat that was a whole
// line or half of one stays that.
template <class Change>
void change_line(Plan& p, Change change) {
  const int before = p.line_bytes(), cached = p.cache_bytes / before,
            board_cached = p.board_cache_bytes / before;
  const bool whole_line = p.beat_bits == 8 * before, half_line = p.beat_bits == 4 * before;
  change();
  while (p.bucket * p.photon_bytes % 16 != 0) ++p.photon_bytes;
  p.cache_bytes = p.line_bytes() * cached;
  p.board_cache_bytes = p.line_bytes() * board_cached;
  if (whole_line) p.beat_bits = 8 * p.line_bytes();
  if (half_line) p.beat_bits = 4 * p.line_bytes();
}

// The fewest bytes in which a photon's slot has room for what its formats need.
void fewest_bytes(Plan& p) {
  const auto fits = [&] {
    const auto problem = find_problem(p);
    return !problem || problem->line != "photon.photon_bytes";
  };
  p.photon_bytes = 4;
  while (p.photon_bytes < 32 && !fits()) ++p.photon_bytes;
}

// Compressed lines from the shortest that its formats can have, so that many leaves take several.
void compress(Plan& p, RoleRandom& random) {
  change_line(p, [&] {
    p.photon_lines = PhotonLines::kCompressed;
    p.further_percent = 1500;
    const int longer = static_cast<int>(random.below(3));
    fewest_bytes(p);
    for (int i = 0; i < longer && p.photon_bytes < 32; ++i) ++p.photon_bytes;
  });
}

Plan draw(RoleRandom& random) {
  const auto between = [&](int low, int high) {
    return low + static_cast<int>(random.below(static_cast<uint64_t>(high - low) + 1));
  };
  Plan p;
  p.position_bits = between(4, 24);
  p.direction_bits = between(2, 12);
  p.mantissa_bits = between(4, 12);
  p.exponent_bits = between(2, 5);
  p.channels = random.below(3) ? 3 : 1;
  p.bucket = random.below(2) ? 8 : 16;
  p.photon_bytes = std::max(4, (p.photon_bits() + 7) / 8);
  // Lines fill whole beats of 16 bytes.
  while (p.bucket * p.photon_bytes % 16 != 0) ++p.photon_bytes;
  p.normal_bits = between(2, 12);
  p.k = between(1, 64);
  p.global.present = true;
  p.global.photons = static_cast<uint64_t>(between(200, 3000));
  p.caustic.present = random.below(2) != 0;
  if (p.caustic.present) p.caustic.photons = static_cast<uint64_t>(between(1, 1000));
  for (MapPlan* m : {&p.global, &p.caustic})
    if (m->present)
      m->r2_max = random.below(2) ? p.r2_limit() : random.bits() & ones(between(1, p.r2_bits()));
  p.r2_floor = 1 + (random.bits() & ones(between(0, p.position_bits)));
  p.epsilon_factor = 1;
  if (random.below(3) == 0) {
    p.epsilon_shift = between(0, 6);
    p.epsilon_factor = static_cast<uint32_t>(between(1 << p.epsilon_shift, 3 << p.epsilon_shift));
  }
  p.leaf_limit = random.below(3) == 0 ? static_cast<uint32_t>(between(1, 12)) : 0;
  p.reciprocal_bits = random.below(4) == 0 ? 0 : between(8, 24);
  p.lanes = 1 << between(0, 3);
  const int line_bytes = p.bucket * p.photon_bytes;
  p.cache_ways = 1 << between(0, 2);
  const int sets = 1 << between(0, 5);
  p.cache_bytes = line_bytes * p.cache_ways * sets;
  p.cache_misses = between(1, 16);
  p.reorder_key = static_cast<ReorderKey>(between(0, 2));
  p.reorder_drain = static_cast<ReorderDrain>(between(0, 1));
  p.reorder_packets = between(1, 600);
  p.reorder_bins = 1 << between(0, 9);
  p.reorder_cell_bits = std::min(between(3, 5), p.position_bits);
  p.cell_bits = between(1, std::min(4, p.direction_bits));
  p.probability_bits = between(8, 20);
  p.u_bits = std::min(48, p.total_bits() + between(8, 12));
  p.v_bits = between(1, 10);
  p.combine = static_cast<TableCombine>(between(0, 4));
  p.levels = random.below(2) ? between(1, p.cell_bits + 1) : 1;
  p.cosine_samples = between(1, 255);
  p.width = between(1, 300);
  p.height = between(1, 300);
  p.spp = between(1, 64);
  p.gather_rays = between(1, 64);
  // Half the plans with a line in one beat, or in halves.
  if (random.below(2)) p.beat_bits = 8 * line_bytes >> between(0, 1);
  p.gatherers = between(1, 4);
  p.photon_memory = static_cast<PhotonMemory>(between(0, 1));
  p.board_cache_bytes = line_bytes << between(2, 8);
  p.cache_present = true;
  p.cache_records = between(1, 200);
  p.cache_hits = between(1, 8);
  p.cache_angle_bits = between(0, 2 * p.normal_bits + 2);
  p.cache_weight_bits = between(4, 12);
  p.contexts = between(1, random.below(3) ? 32 : 64);
  p.nodes_per_cycle = between(1, 2);
  p.candidates_per_cycle = 1 << between(0, 2);
  p.powers_per_cycle = 1 << between(0, clog2(static_cast<uint64_t>(p.candidates_per_cycle)));
  if (random.below(2)) compress(p, random);
  p.parity = random.below(2) != 0;
  return p;
}

// Applies a change to one plan in `one_in` that has nothing against it.
template <class Change>
void maybe(Plan& plan, RoleRandom& random, uint64_t one_in, Change change) {
  if (random.below(one_in) != 0) return;
  Plan other = plan;
  change(other);
  if (!find_problem(other)) plan = other;
}

// What few plans have: a leaf in one beat of lanes, ways that are no power of two, memories of
// LUTs, no leaf cache, more than four gatherers.
Plan rarer(const Plan& drawn, RoleRandom& random) {
  Plan plan = drawn;
  const auto change = [&](auto&& line) { maybe(plan, random, 4, line); };
  change([](Plan& p) { p.lanes = p.bucket; });
  change([&](Plan& p) {
    const int bytes_of_a_way = p.cache_bytes / p.cache_ways;
    p.cache_ways = random.below(2) ? 3 : 5;
    p.cache_bytes = bytes_of_a_way * p.cache_ways;
  });
  change([&](Plan& p) { p.lut_ram_words = 32 << random.below(5); });
  change([&](Plan& p) {
    p.sdram_khz =
        kSdramLeastKHz + static_cast<int>(random.below(kSdramMostKHz - kSdramLeastKHz + 1));
  });
  change([](Plan& p) {
    p.cache_bytes = 0;
    p.beat_bits = std::min(p.beat_bits, 8 * p.photon_bytes * p.lanes);
  });
  change([&](Plan& p) { p.gatherers = 5 + static_cast<int>(random.below(4)); });
  change([](Plan& p) { p.shared_nodes = true; });
  change([&](Plan& p) { p.refreshes_ahead = 1 + static_cast<int>(random.below(255)); });
  return plan;
}

// Ends of ranges that draw() and rarer() leave out: long lists, lines of few photons, formats of
// fewest or most bits, most queries in flight, a caustic map alone. Each in half of the plans,
// where nothing is against it.
Plan at_ends(const Plan& drawn, RoleRandom& random) {
  Plan plan = drawn;
  const auto change = [&](auto&& line) { maybe(plan, random, 2, line); };
  change([&](Plan& p) { p.k = random.below(2) ? 256 : 65 + static_cast<int>(random.below(191)); });
  change([&](Plan& p) {
    change_line(p, [&] {
      p.bucket = random.below(2) ? 2 : 4;
      p.lanes = std::min(p.lanes, p.bucket);
      if (p.compressed()) fewest_bytes(p);
    });
  });
  change([](Plan& p) { p.contexts = 64; });
  change([&](Plan& p) {
    change_line(p, [&] {
      p.mantissa_bits = random.below(2) ? 2 : 16;
      p.exponent_bits = random.below(2) ? 1 : 5;
      p.direction_bits = random.below(2) ? 2 : 14;
      p.normal_bits = random.below(2) ? 2 : 14;
      p.cell_bits = std::min(p.cell_bits, p.direction_bits);
      p.levels = std::min(p.levels, p.cell_bits + 1);
      p.cache_angle_bits = std::min(p.cache_angle_bits, 2 * p.normal_bits + 2);
      p.u_bits = std::max(p.u_bits, std::min(48, p.total_bits() + 8));
      fewest_bytes(p);
    });
  });
  change([](Plan& p) {
    if (p.caustic.present) p.global = {};
  });
  return plan;
}

// Half of the boards: lines side by side in rows of block RAM, for which other maps are too small.
// Their last gatherer uses both ports where it is one of an odd number with two nodes a cycle.
Plan with_rows(const Plan& drawn, RoleRandom& random) {
  Plan plan = drawn;
  maybe(plan, random, 2, [&](Plan& p) {
    p.photon_memory = PhotonMemory::kBlockRam;
    change_line(p, [&] {
      p.bucket = random.below(2) ? 2 : 4;
      p.lanes = std::min(p.lanes, p.bucket);
      p.photon_lines = PhotonLines::kPlain;
      fewest_bytes(p);
    });
    if (random.below(2)) p.cache_bytes = 0;
    const int beats = p.bucket == 2 || random.below(2) ? 2 : 4;
    p.beat_bits = 8 * p.line_bytes() / beats;
    MapPlan& map = p.global.present ? p.global : p.caustic;
    const auto lines = 2100 / static_cast<uint64_t>(beats) + random.below(400);
    map.photons = lines * static_cast<uint64_t>(p.bucket);
    if (random.below(2)) p.gatherers = 3 + 2 * static_cast<int>(random.below(3));
    if (p.cache_bytes == 0) p.lanes = std::max(p.lanes, p.bucket / beats);  // at least a beat
  });
  return plan;
}

}  // namespace

Plan random_plan(uint64_t seed, RandomPlans which, bool on_board) {
  const bool ends = which == RandomPlans::kEnds;
  RoleRandom random(seed, ends ? "plan at ends of ranges" : "plan"),
      rare(seed, ends ? "ends of ranges" : "rare lines of a plan"), rows(seed, "rows of a board");
  for (;;) {
    const Plan drawn = draw(random);
    if (find_problem(drawn)) continue;
    Plan plan = ends ? at_ends(rarer(drawn, rare), rare) : rarer(drawn, rare);
    if (on_board) plan = with_rows(plan, rows);
    if (!on_board || !board_problem(plan)) return plan;
  }
}

}  // namespace photonloom
