// SPDX-License-Identifier: Apache-2.0
// The golden reorder buffer against the sentences of docs/reorder_buffer.md, written as slowly and
// plainly as possible.
#include "golden/unit/reorder_buffer.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <deque>
#include <set>

#include "golden/numeric/random.hpp"
#include "golden/unit/backend.hpp"
#include "tests/catch.hpp"

using namespace photonloom;

namespace {

GatherQuery query_at(const UVec3& position, uint32_t number) {
  return {.pixel = number,
          .sample = 0,
          .tag = 0,
          .map = 0,
          .flush = 0,
          .want_photons = 0,
          .position = position,
          .normal = {1, 2}};
}

GatherQuery flush_packet(uint32_t number) {
  GatherQuery q = query_at({0, 0, 0}, number);
  q.flush = 1;
  return q;
}

Plan small_plan(ReorderKey key, ReorderDrain drain, int packets, int bins) {
  Plan plan;
  plan.position_bits = 8;
  plan.reorder_key = key;
  plan.reorder_drain = drain;
  plan.reorder_packets = packets;
  plan.reorder_bins = bins;
  plan.reorder_cell_bits = 3;
  return plan;
}

// The Hilbert curve by its definition: it passes the octants of a cube in the order of a Gray code,
// x the top bit of an octant and z the lowest, and each octant by the curve itself, turned so that
// it enters beside where it left the octant before. `from` says which coordinate of the octant each
// coordinate of the curve before its turn is; those of `back` run backwards.
struct Octant {
  std::array<uint32_t, 3> at;
  std::array<size_t, 3> from;
  std::array<bool, 3> back;
};
constexpr std::array<Octant, 8> kOctants{{{{0, 0, 0}, {2, 0, 1}, {false, false, false}},
                                          {{0, 0, 1}, {1, 0, 2}, {false, false, false}},
                                          {{0, 1, 1}, {0, 1, 2}, {false, false, false}},
                                          {{0, 1, 0}, {2, 1, 0}, {true, false, true}},
                                          {{1, 1, 0}, {2, 1, 0}, {false, false, false}},
                                          {{1, 1, 1}, {0, 1, 2}, {false, false, false}},
                                          {{1, 0, 1}, {1, 0, 2}, {true, true, false}},
                                          {{1, 0, 0}, {2, 0, 1}, {true, false, true}}}};

uint64_t index_on_curve(const std::array<uint32_t, 3>& cell, int bits) {
  if (bits == 0) return 0;
  const uint32_t half = uint32_t{1} << (bits - 1);
  for (uint64_t o = 0; o < kOctants.size(); ++o) {
    const Octant& octant = kOctants[o];
    bool here = true;
    for (size_t c = 0; c < 3; ++c) here = here && cell[c] / half == octant.at[c];
    if (!here) continue;
    std::array<uint32_t, 3> inside;
    for (size_t c = 0; c < 3; ++c) {
      const uint32_t x = cell[octant.from[c]] % half;
      inside[c] = octant.back[octant.from[c]] ? half - 1 - x : x;
    }
    return o * half * half * half + index_on_curve(inside, bits - 1);
  }
  FAIL("no octant");
  return 0;
}

// What docs/reorder_buffer.md says of a bin.
size_t bin_on_page(const Plan& plan, const UVec3& position) {
  const uint64_t edge = uint64_t{1} << plan.reorder_cell_bits;
  std::array<uint32_t, 3> cell;
  for (size_t c = 0; c < 3; ++c)
    cell[c] = position[c] >> (plan.position_bits - plan.reorder_cell_bits);
  const auto bins = static_cast<uint64_t>(plan.reorder_bins);
  if (plan.reorder_key == ReorderKey::kHilbert)
    return index_on_curve(cell, plan.reorder_cell_bits) / (edge * edge * edge / bins);
  const uint64_t product = ((cell[2] * edge + cell[1]) * edge + cell[0]) * 2654435769;
  return (product % 0x100000000) / (0x100000000 / bins);
}

// One deque a bin, every rule by brute force.
std::vector<GatherQuery> plain_model(const Plan& plan, const std::vector<GatherQuery>& in) {
  std::vector<GatherQuery> out;
  std::vector<std::deque<GatherQuery>> bins(static_cast<size_t>(plan.reorder_bins));
  size_t held = 0, current = 0, fixed = 0;
  const auto release = [&] {
    if (plan.reorder_drain == ReorderDrain::kSweep) {
      while (bins[current].empty()) current = (current + 1) % bins.size();
    } else if (fixed == 0) {
      current = 0;
      for (size_t b = 1; b < bins.size(); ++b)
        if (bins[b].size() > bins[current].size()) current = b;
      fixed = bins[current].size();
    }
    if (fixed) --fixed;
    out.push_back(bins[current].front());
    bins[current].pop_front();
    --held;
  };
  for (const GatherQuery& q : in) {
    if (q.flush) {
      while (held) release();
      out.push_back(q);
      current = fixed = 0;
    } else {
      bins[bin_on_page(plan, q.position)].push_back(q);
      if (++held == static_cast<size_t>(plan.reorder_packets)) release();
    }
  }
  return out;
}

std::vector<GatherQuery> golden(const Plan& plan, const std::vector<GatherQuery>& in,
                                size_t chunk) {
  const auto unit = make_golden_reorder_buffer(plan);
  std::vector<GatherQuery> out;
  for (size_t i = 0; i < in.size(); i += chunk)
    unit->process(std::span(in).subspan(i, std::min(chunk, in.size() - i)), out);
  return out;
}

}  // namespace

TEST_CASE(
    "the curve of this test is a Hilbert curve: every cell once, each beside the one before") {
  for (const int bits : {1, 2, 3, 4}) {
    const uint32_t edge = uint32_t{1} << bits;
    std::vector<std::array<uint32_t, 3>> on_curve(edge * edge * edge, {edge, edge, edge});
    for (uint32_t x = 0; x < edge; ++x)
      for (uint32_t y = 0; y < edge; ++y)
        for (uint32_t z = 0; z < edge; ++z)
          on_curve.at(index_on_curve({x, y, z}, bits)) = {x, y, z};
    CAPTURE(bits);
    REQUIRE(on_curve[0] == std::array<uint32_t, 3>{0, 0, 0});
    for (size_t i = 1; i < on_curve.size(); ++i) {
      int distance = 0;
      for (size_t c = 0; c < 3; ++c)
        distance +=
            std::abs(static_cast<int>(on_curve[i][c]) - static_cast<int>(on_curve[i - 1][c]));
      REQUIRE(distance == 1);
    }
  }
}

TEST_CASE("reorder_bin: Hilbert bins are prefixes of the index, hash bins of the hash, all used") {
  Plan plan = small_plan(ReorderKey::kHilbert, ReorderDrain::kSweep, 16, 512);
  for (const int cell_bits : {3, 4})
    for (const auto key : {ReorderKey::kHilbert, ReorderKey::kHash})
      for (const int bins : {1, 2, 64, 512}) {
        plan.reorder_cell_bits = cell_bits;
        plan.reorder_key = key;
        plan.reorder_bins = bins;
        const uint32_t edge = uint32_t{1} << cell_bits, size = 256 / edge;
        std::set<uint32_t> seen;
        CAPTURE(cell_bits, bins);
        for (uint32_t i = 0; i < edge * edge * edge; ++i) {
          // Anywhere in the cell.
          const UVec3 position{i % edge * size + i % size, i / edge % edge * size,
                               i / (edge * edge) * size + size - 1};
          const uint32_t bin = reorder_bin(plan, position);
          REQUIRE(bin == bin_on_page(plan, position));
          seen.insert(bin);
        }
        REQUIRE(*seen.rbegin() < static_cast<uint32_t>(bins));
        // A hash may leave bins empty, but not many.
        REQUIRE(seen.size() * (key == ReorderKey::kHash ? 2 : 1) >= static_cast<size_t>(bins));
      }
}

TEST_CASE("golden reorder buffer does what the sentences say, however the stream is cut") {
  const uint64_t seed = 11;
  int run = 0;
  for (const auto key : {ReorderKey::kHilbert, ReorderKey::kHash})
    for (const auto drain : {ReorderDrain::kSweep, ReorderDrain::kFullest})
      for (const int packets : {1, 2, 7, 64, 300})
        for (const int bins : {1, 2, 64, 512})
          for (const int spread : {1, 3, 8}) {
            const Plan plan = small_plan(key, drain, packets, bins);
            const Random random(seed, Phase::kPath, static_cast<uint64_t>(run++));
            std::vector<GatherQuery> in;
            for (uint32_t i = 0; i < 1500; ++i) {
              UVec3 p;
              for (size_t c = 0; c < 3; ++c)
                p[c] = static_cast<uint32_t>(random.bits(i, c) % (32u * spread));
              in.push_back(random.unit(i, 3) < 0.004 ? flush_packet(i) : query_at(p, i));
            }
            if (run % 2) in.push_back(flush_packet(1500));
            CAPTURE(seed, run, packets, bins, spread);
            const auto expected = plain_model(plan, in);
            REQUIRE(golden(plan, in, in.size()) == expected);
            REQUIRE(golden(plan, in, 17) == expected);
          }
}

TEST_CASE("golden reorder buffer: full, flush on empty, pass-through") {
  const Plan plan = small_plan(ReorderKey::kHilbert, ReorderDrain::kSweep, 8, 64);
  std::vector<GatherQuery> in;
  for (uint32_t i = 0; i < 8; ++i) in.push_back(query_at({255 - i, 0, 0}, i));
  REQUIRE(golden(plan, std::vector(in.begin(), in.begin() + 7), 7).empty());
  REQUIRE(golden(plan, in, 8).size() == 1);
  REQUIRE(golden(plan, {flush_packet(5), flush_packet(6)}, 1) ==
          std::vector{flush_packet(5), flush_packet(6)});
  Plan pass = plan;
  pass.reorder_key = ReorderKey::kNone;
  in.push_back(flush_packet(9));
  REQUIRE(golden(pass, in, 3) == in);
}
