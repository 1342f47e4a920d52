// SPDX-License-Identifier: Apache-2.0
// The reorder buffer at its ends.
#include <algorithm>
#include <deque>
#include <set>

#include "golden/numeric/random.hpp"
#include "tests/extremes/suite/suite.hpp"

namespace photonloom::extremes {
namespace {

using Packets = std::vector<GatherQuery>;

Plan plan_of(ReorderKey key, ReorderDrain drain, int packets, int bins, int cell_bits,
             int position_bits = 16) {
  Plan plan;
  plan.reorder_key = key;
  plan.reorder_drain = drain;
  plan.reorder_packets = packets;
  plan.reorder_bins = bins;
  plan.reorder_cell_bits = cell_bits;
  plan.position_bits = position_bits;
  plan.photon_bytes = position_bits > 16 ? 32 : 16;
  return plan;
}

Plan usual_reorder() { return plan_of(ReorderKey::kHilbert, ReorderDrain::kSweep, 512, 512, 3); }
Plan fullest() { return plan_of(ReorderKey::kHilbert, ReorderDrain::kFullest, 64, 8, 1); }
Plan hashed() { return plan_of(ReorderKey::kHash, ReorderDrain::kSweep, 37, 128, 4); }
Plan one_place() { return plan_of(ReorderKey::kHilbert, ReorderDrain::kFullest, 1, 1, 1); }
Plan least_reorder() { return plan_of(ReorderKey::kHash, ReorderDrain::kSweep, 3, 2, 1, 4); }
Plan greatest_reorder() {
  return plan_of(ReorderKey::kHilbert, ReorderDrain::kSweep, 65536, 4096, 7, 24);
}
Plan pass_through() { return plan_of(ReorderKey::kNone, ReorderDrain::kSweep, 1, 1, 1); }

GatherQuery packet(const Plan& plan, uint64_t i, const UVec3& position) {
  GatherQuery q{};
  q.pixel = static_cast<uint32_t>(i & ones(plan.pixel_bits()));
  q.sample = static_cast<uint32_t>(i >> plan.pixel_bits() & ones(plan.sample_bits()));
  q.position = position;
  return q;
}

GatherQuery flush(const Plan& plan, uint64_t i) {
  GatherQuery q = packet(plan, i, {0, 0, 0});
  q.flush = 1;
  return q;
}

UVec3 anywhere(const Plan& plan, uint64_t i) {
  UVec3 p;
  for (size_t c = 0; c < 3; ++c)
    p[c] = static_cast<uint32_t>(hash_bits(5, i, 0, c) >> (64 - plan.position_bits));
  return p;
}

Packets many(const Plan& plan, uint64_t n) {
  Packets in;
  for (uint64_t i = 0; i < n; ++i) in.push_back(packet(plan, i, anywhere(plan, i)));
  in.push_back(flush(plan, n));
  return in;
}

// The Hilbert curve by its recursion: a cell of eight is entered by a Gray code; each part is the
// whole curve turned, which this finds by walking. Only for one level: x then y, z as bits of a
// Gray code.
uint32_t gray_order(const UVec3& octant) {
  const uint32_t g = octant[0] << 2 | octant[1] << 1 | octant[2];
  uint32_t n = g;
  n ^= n >> 1;
  n ^= n >> 2;
  return n;
}

// The page's order, by lists: no pool, no bitmaps. bin(q) says where a packet waits.
template <class Bin>
Packets by_the_page(const Plan& plan, const Packets& in, Bin&& bin) {
  std::vector<std::deque<GatherQuery>> bins(static_cast<size_t>(plan.reorder_bins));
  Packets out;
  size_t held = 0, current = 0, fixed = 0;
  const auto leave = [&] {
    if (plan.reorder_drain == ReorderDrain::kSweep) {
      while (bins[current].empty()) current = (current + 1) % bins.size();
    } else if (fixed == 0) {
      for (size_t b = current = 0; b < bins.size(); ++b)
        if (bins[b].size() > bins[current].size()) current = b;
      fixed = bins[current].size();
    }
    if (fixed > 0) --fixed;
    out.push_back(bins[current].front());
    bins[current].pop_front();
    --held;
  };
  for (const GatherQuery& q : in) {
    if (q.flush) {
      while (held > 0) leave();
      out.push_back(q);
      current = fixed = 0;
      continue;
    }
    bins[bin(q)].push_back(q);
    if (++held == static_cast<size_t>(plan.reorder_packets)) leave();
  }
  return out;
}

// c * 2654435769 mod 2^32, the top bits: the page's hash.
size_t hash_bin(const Plan& plan, const GatherQuery& q) {
  const int shift = plan.position_bits - plan.reorder_cell_bits;
  uint64_t c = 0;
  for (int i = 2; i >= 0; --i)
    c = c << plan.reorder_cell_bits | q.position[static_cast<size_t>(i)] >> shift;
  return static_cast<size_t>(c * 2654435769u % (uint64_t{1} << 32) /
                             ((uint64_t{1} << 32) / static_cast<uint64_t>(plan.reorder_bins)));
}

void check_order(Run& run, const Packets& due, const Packets& out) { run.same("order", due, out); }

}  // namespace

Group reorder_cases() {
  std::vector<Case> cases{
      {"no packet", Known::kDefinition, "nothing goes in, nothing comes out",
       [](Run& run) {
         run.exact("packets", 0, run.process<ReorderBuffer>(usual_reorder(), {}).size());
       }},
      {"flushes only", Known::kDefinition, "on an empty buffer each passes alone, in order",
       [](Run& run) {
         Packets in;
         for (uint64_t i = 0; i < 20; ++i) in.push_back(flush(usual_reorder(), i));
         check_order(run, in, run.process<ReorderBuffer>(usual_reorder(), in));
       }},
      {"P - 1 packets, no flush", Known::kDefinition, "nothing leaves before P are held",
       [](Run& run) {
         Packets in = many(usual_reorder(), 511);
         in.pop_back();
         run.exact("packets", 0, run.process<ReorderBuffer>(usual_reorder(), in).size());
       }},
      {"P packets, no flush", Known::kDefinition, "the P-th lets exactly one leave",
       [](Run& run) {
         Packets in = many(usual_reorder(), 512);
         in.pop_back();
         run.exact("packets", 1, run.process<ReorderBuffer>(usual_reorder(), in).size());
       }},
      {"all packets in one place", Known::kClosedForm, "one bin is a queue: out as in",
       [](Run& run) {
         const Plan plan = usual_reorder();
         Packets in;
         for (uint64_t i = 0; i < 3000; ++i) in.push_back(packet(plan, i, {65535, 65535, 65535}));
         in.push_back(flush(plan, 0));
         check_order(run, in, run.process<ReorderBuffer>(plan, in));
       }},
      {"one packet in each of 512 bins, backwards", Known::kClosedForm,
       "a sweep from bin 0 gives them along the Hilbert curve: each cell next to the one before",
       [](Run& run) {
         const Plan plan = usual_reorder();
         Packets in;
         for (uint32_t c = 512; c-- > 1;)  // 511, so that nothing leaves before the flush
           in.push_back(packet(plan, c, {(c & 7) << 13, (c >> 3 & 7) << 13, (c >> 6) << 13}));
         in.push_back(flush(plan, 0));
         const Packets out = run.process<ReorderBuffer>(plan, in);
         run.exact("packets", in.size(), out.size());
         uint64_t jumps = 0;
         for (size_t i = 1; i + 1 < out.size(); ++i) {
           int distance = 0;
           for (size_t a = 0; a < 3; ++a)
             distance +=
                 std::abs(int(out[i].position[a] >> 13) - int(out[i - 1].position[a] >> 13));
           jumps += distance != 1;
         }
         run.exact("jumps", 0, jumps);
       }},
      {"the eight octants", Known::kClosedForm,
       "with cells of one bit the Hilbert order is that of the Gray code of (x, y, z)",
       [](Run& run) {
         const Plan plan = fullest();
         Packets in;
         for (uint32_t i = 0; i < 8; ++i)
           in.push_back(
               packet(plan, i, {i & 1 ? 65535u : 0, i & 2 ? 65535u : 0, i & 4 ? 65535u : 0}));
         Packets due = in;
         std::sort(due.begin(), due.end(), [](const GatherQuery& a, const GatherQuery& b) {
           const auto octant = [](const GatherQuery& q) {
             return UVec3{q.position[0] >> 15, q.position[1] >> 15, q.position[2] >> 15};
           };
           return gray_order(octant(a)) < gray_order(octant(b));
         });
         in.push_back(flush(plan, 9));
         due.push_back(in.back());
         check_order(run, due, run.process<ReorderBuffer>(plan, in));
       }},
      {"fullest: all bins equally full", Known::kDefinition,
       "a tie is the lowest bin's: with 5 packets in each of 8 bins they leave bin by bin",
       [](Run& run) {
         const Plan plan = fullest();
         Packets in;
         for (uint32_t round = 0; round < 5; ++round)
           for (uint32_t i = 0; i < 8; ++i)
             in.push_back(packet(plan, round * 8 + i,
                                 {i & 1 ? 40000u : 1, i & 2 ? 40000u : 1, i & 4 ? 40000u : 1}));
         in.push_back(flush(plan, 0));
         check_order(
             run,
             by_the_page(plan, in,
                         [](const GatherQuery& q) {
                           return size_t{gray_order(
                               {q.position[0] >> 15, q.position[1] >> 15, q.position[2] >> 15})};
                         }),
             run.process<ReorderBuffer>(plan, in));
       }},
      {"fullest: a bin that is fed while it leaves", Known::kDefinition,
       "as many as it held when it was chosen leave, what joins waits for another choice",
       [](Run& run) {
         const Plan plan = fullest();
         Packets in;
         for (uint64_t i = 0; i < 2000; ++i)
           in.push_back(packet(plan, i, i % 5 ? UVec3{3, 3, 3} : anywhere(plan, i)));
         in.push_back(flush(plan, 0));
         check_order(
             run,
             by_the_page(plan, in,
                         [](const GatherQuery& q) {
                           return size_t{gray_order(
                               {q.position[0] >> 15, q.position[1] >> 15, q.position[2] >> 15})};
                         }),
             run.process<ReorderBuffer>(plan, in));
       }},
      {"sweep: a bin that is fed while it leaves", Known::kDefinition,
       "the sweep stays as long as the bin holds a packet: with the hash of the page",
       [](Run& run) {
         const Plan plan = hashed();
         Packets in;
         for (uint64_t i = 0; i < 2000; ++i)
           in.push_back(packet(plan, i, i % 3 ? UVec3{9, 9, 60000} : anywhere(plan, i)));
         in.push_back(flush(plan, 0));
         check_order(run,
                     by_the_page(plan, in, [&](const GatherQuery& q) { return hash_bin(plan, q); }),
                     run.process<ReorderBuffer>(plan, in));
       }},
      {"hash: positions of all zeros and all ones", Known::kDefinition,
       "cell 0 is in bin 0; the cell of all ones is where the page's product puts it",
       [](Run& run) {
         const Plan plan = hashed();
         Packets in;
         for (uint64_t i = 0; i < 200; ++i) {
           const uint32_t x = i % 2 ? 65535 : 0;
           in.push_back(packet(plan, i, {x, x, x}));
         }
         in.push_back(flush(plan, 0));
         check_order(run,
                     by_the_page(plan, in, [&](const GatherQuery& q) { return hash_bin(plan, q); }),
                     run.process<ReorderBuffer>(plan, in));
       }},
      {"packets = 1", Known::kClosedForm, "a pool of one lets each pass: out as in",
       [](Run& run) {
         const Packets in = many(one_place(), 500);
         check_order(run, in, run.process<ReorderBuffer>(one_place(), in));
       }},
      {"key = none", Known::kClosedForm, "every packet leaves as it came, nothing is held back",
       [](Run& run) {
         Packets in = many(pass_through(), 500);
         in.pop_back();
         check_order(run, in, run.process<ReorderBuffer>(pass_through(), in));
       }},
      {"position_bits = 4, cell_bits = 1, 2 bins", Known::kDefinition,
       "the least key there is; the order is that of lists by the page",
       [](Run& run) {
         const Plan plan = least_reorder();
         const Packets in = many(plan, 300);
         check_order(run,
                     by_the_page(plan, in, [&](const GatherQuery& q) { return hash_bin(plan, q); }),
                     run.process<ReorderBuffer>(plan, in));
       }},
      {"65,536 packets, 4,096 bins, cell_bits = 7, position_bits = 24", Known::kClosedForm,
       "140,000 packets: out come those that went in, each once, the flush last",
       [](Run& run) {
         const Plan plan = greatest_reorder();
         const Packets in = many(plan, 140000);
         const Packets out = run.process<ReorderBuffer>(plan, in);
         const auto numbers = [](const Packets& list) {
           std::vector<uint64_t> n;
           for (const GatherQuery& q : list) n.push_back(uint64_t{q.sample} << 32 | q.pixel);
           std::sort(n.begin(), n.end());
           return n;
         };
         run.same("packets", numbers(in), numbers(out));
         run.exact("flush at the end", 1, out.back().flush);
       }},
      {"1,000,000 packets", Known::kDefinition, "the order of lists by the page to the last packet",
       [](Run& run) {
         const Plan plan = hashed();
         const Packets in = many(plan, 1000000);
         check_order(run,
                     by_the_page(plan, in, [&](const GatherQuery& q) { return hash_bin(plan, q); }),
                     run.process<ReorderBuffer>(plan, in));
       },
       true},
      {"a flush after each packet", Known::kClosedForm, "nothing can be reordered: out as in",
       [](Run& run) {
         const Plan plan = usual_reorder();
         Packets in;
         for (uint64_t i = 0; i < 300; ++i) {
           in.push_back(packet(plan, i, anywhere(plan, i)));
           in.push_back(flush(plan, i));
         }
         check_order(run, in, run.process<ReorderBuffer>(plan, in));
       }},
      {"every field all ones", Known::kDefinition, "packets leave with every bit that they brought",
       [](Run& run) {
         const Plan plan = usual_reorder();
         GatherQuery q{};
         const PacketLayout layout = PacketLayout::of<GatherQuery>(plan);
         for (const FieldPlace& f : layout.fields())
           for (int i = 0; i < f.elements; ++i) layout.set(&q, f, i, ones(f.bits));
         q.flush = 0;
         Packets in(600, q);
         in.push_back(flush(plan, 0));
         check_order(run, in, run.process<ReorderBuffer>(plan, in));
       }},
      {"bins = 3", Known::kRefusal, "a number of bins that is no power of two has no key",
       [](Run& run) {
         Plan plan = usual_reorder();
         plan.reorder_bins = 3;
         run.refused("reorder.bins is 3, expected a power of two",
                     [&] { run.process<ReorderBuffer>(plan, {}); });
       }},
      {"packets = 65,537", Known::kRefusal, "more than the pool's greatest size is refused",
       [](Run& run) {
         Plan plan = usual_reorder();
         plan.reorder_packets = 65537;
         run.refused("reorder.packets is 65537", [&] { run.process<ReorderBuffer>(plan, {}); });
       }},
  };
  return {"reorder_buffer",
          "Plans: Hilbert sweep (512 packets, 512 bins), fullest bin (64, 8), hash sweep (37, "
          "128), one "
          "place, pass-through, the least and the greatest of every line.",
          std::move(cases)};
}

}  // namespace photonloom::extremes
