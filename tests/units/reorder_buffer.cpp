// SPDX-License-Identifier: Apache-2.0
// The golden reorder buffer against the sentences of docs/reorder_buffer.md, written as slowly and
// plainly as possible.
#include "golden/unit/reorder_buffer.hpp"

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
      bins[reorder_bin(plan, q.position)].push_back(q);
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

TEST_CASE("reorder_bin: Hilbert bins are prefixes, every bin of a full set of cells is used") {
  Plan plan = small_plan(ReorderKey::kHilbert, ReorderDrain::kSweep, 16, 512);
  for (const auto key : {ReorderKey::kHilbert, ReorderKey::kHash})
    for (const int bins : {1, 2, 64, 512}) {
      plan.reorder_key = key;
      plan.reorder_bins = bins;
      std::set<uint32_t> seen;
      for (uint32_t i = 0; i < 512; ++i)
        seen.insert(reorder_bin(plan, {(i & 7) << 5 | 31, (i >> 3 & 7) << 5, (i >> 6) << 5}));
      CAPTURE(bins);
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
