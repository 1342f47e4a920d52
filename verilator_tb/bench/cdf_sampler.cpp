// SPDX-License-Identifier: Apache-2.0
// Bench of the CDF sampler: --list shows its plans and cases.
#include <algorithm>
#include <bit>

#include "verilator_tb/bench/bench.hpp"

using namespace photonloom;

namespace {

std::vector<BenchPlan> plans() {
  Plan usual;
  Plan product;
  product.combine = TableCombine::kProduct;
  product.cell_bits = 3;
  product.channels = 1;
  product.mantissa_bits = 6;
  product.exponent_bits = 4;
  product.direction_bits = 6;
  product.normal_bits = 5;
  product.probability_bits = 10;
  product.u_bits = 24;
  product.v_bits = 5;
  product.k = 16;
  Plan coarse;
  coarse.cell_bits = 1;
  coarse.direction_bits = 2;
  coarse.normal_bits = 4;
  coarse.mantissa_bits = 16;
  coarse.photon_bytes = 32;
  coarse.probability_bits = 4;
  coarse.u_bits = 16;
  coarse.v_bits = 12;
  coarse.k = 3;
  Plan fine;
  fine.cell_bits = 5;
  fine.direction_bits = 10;
  fine.normal_bits = 12;
  fine.probability_bits = 24;
  fine.u_bits = 48;
  fine.k = 100;
  Plan spread;
  spread.levels = 4;
  Plan weighted = coarse;
  weighted.combine = TableCombine::kWeighted;
  weighted.cell_bits = 2;
  weighted.probability_bits = 12;
  weighted.u_bits = 24;
  weighted.mantissa_bits = 9;
  weighted.levels = 3;
  weighted.cosine_samples = 7;
  weighted.k = 20;
  Plan photons;
  photons.combine = TableCombine::kPhotons;
  photons.levels = 5;
  Plan cosine;
  cosine.combine = TableCombine::kCosine;
  return {{"usual", usual},   {"product", product},   {"coarse", coarse},   {"fine", fine},
          {"spread", spread}, {"weighted", weighted}, {"photons", photons}, {"cosine", cosine}};
}

uint32_t random_field(BenchRandom& random, int bits) {
  return static_cast<uint32_t>(random.bits() & ones(bits));
}

// Every packet has all its fields random, those of other kinds included: they must not matter.
SamplerInput packet(const Plan& plan, BenchRandom& random, uint32_t kind) {
  SamplerInput p{};
  p.kind = kind;
  p.pixel = random_field(random, plan.pixel_bits());
  p.sample = random_field(random, plan.sample_bits());
  p.tag = random_field(random, plan.tag_bits());
  for (uint32_t& n : p.normal) n = random_field(random, plan.normal_bits);
  for (int c = 0; c < plan.channels; ++c)
    p.mantissa[static_cast<size_t>(c)] = random_field(random, plan.mantissa_bits);
  p.exponent = random_field(random, plan.exponent_bits);
  for (uint32_t& d : p.direction) d = random_field(random, plan.direction_bits);
  p.u = random.bits() & ones(plan.u_bits);
  for (uint32_t& v : p.v) v = random_field(random, plan.v_bits);
  return p;
}

using In = std::vector<SamplerInput>;

SamplerInput header(const Plan& plan, BenchRandom& random) { return packet(plan, random, 0); }
SamplerInput photon(const Plan& plan, BenchRandom& random) { return packet(plan, random, 1); }

// Requests at both ends of u and in between.
void add_requests(In& in, const Plan& plan, BenchRandom& random, uint64_t count) {
  for (uint64_t i = 0; i < count; ++i) {
    in.push_back(packet(plan, random, 2));
    if (i == 0) in.back().u = 0;
    if (i == 1) in.back().u = ones(plan.u_bits);
  }
}

// Fewer tables where they are large.
uint64_t tables(const Plan& plan) { return plan.cell_bits > 4 ? 4 : 10; }

// Cycles that the tables of a stream take when nothing holds it back and each header has its
// photons and a request right behind it (docs/cdf_sampler.md, "table").
uint64_t table_cycles(const Plan& plan, const In& in) {
  const uint64_t side = uint64_t{1} << plan.cell_bits;
  const uint64_t steps = plan.combine == TableCombine::kProduct ? 0 : (side / 2 + 2) / 2;
  const auto levels = static_cast<uint64_t>(plan.levels);
  const uint64_t delay = plan.combine == TableCombine::kWeighted
                             ? 3
                             : static_cast<uint64_t>(std::bit_width(levels - 1));
  uint64_t cycles = 0;
  for (size_t at = 0; at < in.size();) {
    const size_t header = at++;
    while (at < in.size() && in[at].kind == 1) ++at;
    const uint64_t photons = at - header - 1;
    const uint64_t waits = photons == 0 && steps > 0 ? steps - 1 : steps;
    cycles += std::max(photons, waits) + side * side + 12 + delay;
    while (at < in.size() && in[at].kind != 0) ++at;
  }
  return cycles;
}

std::vector<StreamCase<SamplerInput>> cases() {
  return {
      {"uniform",
       [](const Plan& plan, BenchRandom& random) {
         In in;
         for (uint64_t t = 0; t < tables(plan); ++t) {
           in.push_back(header(plan, random));
           for (int i = 0; i < plan.k; ++i) in.push_back(photon(plan, random));
           add_requests(in, plan, random, 60);
         }
         return in;
       }},
      // Powers of like size, so that many cells count.
      {"even_powers",
       [](const Plan& plan, BenchRandom& random) {
         In in;
         for (uint64_t t = 0; t < tables(plan); ++t) {
           in.push_back(header(plan, random));
           const uint32_t exponent = random_field(random, plan.exponent_bits);
           for (uint64_t i = 0; i < random.below(static_cast<uint64_t>(plan.k) + 1); ++i) {
             in.push_back(photon(plan, random));
             in.back().exponent = exponent;
           }
           add_requests(in, plan, random, 60);
         }
         return in;
       }},
      {"empty_map",
       [](const Plan& plan, BenchRandom& random) {
         In in;
         for (uint64_t t = 0; t < tables(plan); ++t) {
           in.push_back(header(plan, random));
           add_requests(in, plan, random, 40);
         }
         return in;
       }},
      {"photons_without_power",
       [](const Plan& plan, BenchRandom& random) {
         In in;
         for (uint64_t t = 0; t < tables(plan); ++t) {
           in.push_back(header(plan, random));
           for (int i = 0; i < plan.k / 2; ++i) {
             in.push_back(photon(plan, random));
             in.back().mantissa = {0, 0, 0};
           }
           add_requests(in, plan, random, 40);
         }
         return in;
       }},
      // All photons in one cell, of the smallest or largest power; runs of one cell test the sums
      // under way.
      {"one_cell",
       [](const Plan& plan, BenchRandom& random) {
         In in;
         for (uint64_t t = 0; t < tables(plan); ++t) {
           in.push_back(header(plan, random));
           const SamplerInput first = photon(plan, random);
           for (int i = 0; i < plan.k; ++i) {
             in.push_back(photon(plan, random));
             in.back().direction = first.direction;
             const auto large = static_cast<uint32_t>(t & 1);
             for (int c = 0; c < plan.channels; ++c)
               in.back().mantissa[static_cast<size_t>(c)] =
                   large ? static_cast<uint32_t>(ones(plan.mantissa_bits)) : 1;
             in.back().exponent = large ? static_cast<uint32_t>(ones(plan.exponent_bits)) : 0;
           }
           add_requests(in, plan, random, 40);
         }
         return in;
       }},
      // As much power as there can be, in all directions or in one; by turns with as many zeros
      // below it as there can be.
      {"largest_powers",
       [](const Plan& plan, BenchRandom& random) {
         In in;
         for (uint64_t t = 0; t < tables(plan); ++t) {
           in.push_back(header(plan, random));
           const SamplerInput first = photon(plan, random);
           const uint64_t mantissa =
               t & 1 ? ones(plan.mantissa_bits) : uint64_t{1} << (plan.mantissa_bits - 1);
           for (int i = 0; i < plan.k; ++i) {
             in.push_back(photon(plan, random));
             if (t & 2) in.back().direction = first.direction;
             for (int c = 0; c < plan.channels; ++c)
               in.back().mantissa[static_cast<size_t>(c)] =
                   t & 1 || c == 0 ? static_cast<uint32_t>(mantissa) : 0;
             in.back().exponent = static_cast<uint32_t>(ones(plan.exponent_bits));
           }
           add_requests(in, plan, random, 40);
         }
         return in;
       }},
      {"two_cells_by_turns",
       [](const Plan& plan, BenchRandom& random) {
         In in;
         for (uint64_t t = 0; t < tables(plan); ++t) {
           in.push_back(header(plan, random));
           const SamplerInput one = photon(plan, random), two = photon(plan, random);
           for (int i = 0; i < plan.k; ++i) {
             in.push_back(photon(plan, random));
             in.back().direction = random.chance(0.5) ? one.direction : two.direction;
           }
           add_requests(in, plan, random, 40);
         }
         return in;
       }},
      // Normals along the axes and in the corners of the unfolded square.
      {"normals",
       [](const Plan& plan, BenchRandom& random) {
         In in;
         const auto last = static_cast<uint32_t>(ones(plan.normal_bits));
         const uint32_t half = (last + 1) / 2;
         for (const uint32_t u : {0u, half - 1, half, last})
           for (const uint32_t v : {0u, half, last}) {
             in.push_back(header(plan, random));
             in.back().normal = {u, v};
             for (uint64_t i = 0; i < random.below(4); ++i) in.push_back(photon(plan, random));
             add_requests(in, plan, random, 30);
           }
         return in;
       }},
      // More photons than k, more requests than places, tables without requests, photons after
      // requests, packets before the first header.
      {"odd_streams",
       [](const Plan& plan, BenchRandom& random) {
         In in;
         in.push_back(photon(plan, random));
         add_requests(in, plan, random, 3);
         for (uint64_t t = 0; t < tables(plan); ++t) {
           in.push_back(header(plan, random));
           for (int i = 0; i < plan.k + static_cast<int>(random.below(3)); ++i)
             in.push_back(photon(plan, random));
           if (random.chance(0.4)) continue;
           add_requests(in, plan, random, 1 + random.below(3));
           if (random.chance(0.5)) in.push_back(photon(plan, random));
           add_requests(in, plan, random, random.below(200));
         }
         in.push_back(header(plan, random));
         in.push_back(header(plan, random));
         add_requests(in, plan, random, 2);
         return in;
       }},
      // Power in the first cell that is read, from photons too few to hide the cosine's total.
      {"first_cell",
       [](const Plan& plan, BenchRandom& random) {
         In in;
         for (uint64_t t = 0; t < 2 * tables(plan); ++t) {
           in.push_back(header(plan, random));
           for (uint64_t i = 0; i < 1 + t % 3; ++i) {
             in.push_back(photon(plan, random));
             in.back().direction = {0, 0};
             in.back().exponent = static_cast<uint32_t>(ones(plan.exponent_bits));
           }
           add_requests(in, plan, random, 4);
         }
         return in;
       }},
      {"short_tables",
       [](const Plan& plan, BenchRandom& random) {
         In in;
         for (uint64_t t = 0; t < 2 * tables(plan); ++t) {
           in.push_back(header(plan, random));
           const uint64_t photons = random.below(std::min<uint64_t>(plan.k, 12) + 1);
           for (uint64_t i = 0; i < photons; ++i) in.push_back(photon(plan, random));
           add_requests(in, plan, random, 1 + random.below(3));
         }
         return in;
       }},
      // Photons fewer and more than the steps of the cosine's total.
      {"cycles",
       [](const Plan& plan, BenchRandom& random) {
         In in;
         for (uint64_t t = 0; t < 2 * tables(plan); ++t) {
           in.push_back(header(plan, random));
           for (uint64_t i = 0; i < std::min<uint64_t>(plan.k, t); ++i)
             in.push_back(photon(plan, random));
           add_requests(in, plan, random, 1);
         }
         return in;
       },
       [](const Plan& plan, const In& in) -> Counters {
         return {{"cycles building", table_cycles(plan, in)}};
       }},
  };
}

}  // namespace

int main(int argc, char** argv) {
  return stream_bench_main<CdfSampler>(argc, argv, plans(), cases());
}
