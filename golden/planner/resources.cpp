// SPDX-License-Identifier: Apache-2.0
#include "golden/planner/resources.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "golden/packet/layout.hpp"
#include "golden/planner/resource_fit.hpp"

namespace photonloom {
namespace {

using Terms = std::vector<std::pair<std::string, double>>;

// Multipliers of a square or product of two `bits`-wide numbers, 18 x 18 each.
int multipliers(int bits) {
  const int limbs = (bits + 17) / 18;
  return limbs * limbs;
}

uint64_t power_of_two(int n) { return uint64_t{1} << clog2(static_cast<uint64_t>(n)); }

int load_bits(const Plan& p) { return p.photon_bits() - 3 * p.position_bits; }

// Blocks of photon_gatherer's memories, as its modules have them.
int gatherer_blocks(const Plan& p) {
  const auto cache_lines = static_cast<uint64_t>(std::max(1, p.cache_bytes / p.line_bytes()));
  const auto parts = static_cast<uint64_t>(p.bucket / p.lanes);  // a line is read in as many cycles
  const bool narrow = 8 * p.line_bytes() / static_cast<int>(parts) % p.beat_bits == 0;
  const uint64_t nodes = std::max<uint64_t>(2, p.lines(p.global) + p.lines(p.caustic));
  const uint64_t contexts = power_of_two(std::max(2, p.contexts));
  const uint64_t places = contexts * power_of_two(std::max(2, p.k));
  const uint64_t stack = contexts * power_of_two(p.line_bits() + 1) / 2;
  const int key = p.r2_bits() + p.index_bits();
  const int entry = 2 + p.line_bits() + 3 * (p.position_bits + 1) + p.r2_bits() +
                    clog2(static_cast<uint64_t>(p.epsilon_factor));
  const int body = p.count_bits() + p.r2_bits() + p.channels * p.flux_bits() +
                   2 * (p.line_bits() + 1) + p.index_bits() + 1;
  // Nodes are in slices as deep as they all are.
  const int address = clog2(nodes);
  const int slice = address >= 14   ? 1
                    : address == 13 ? 2
                    : address == 12 ? 4
                    : address == 11 ? 9
                    : address == 10 ? 18
                                    : 36;
  const int slices = (p.position_bits + 2 + slice - 1) / slice;
  return (narrow ? block_rams(p.lanes * p.photon_bits(), cache_lines * parts)
                 : block_rams(p.bucket * p.photon_bits(), cache_lines)) +
         p.cache_ways *
             block_rams(p.line_bits() + 2,
                        std::max<uint64_t>(1, cache_lines / static_cast<uint64_t>(p.cache_ways))) +
         slices * block_rams(slice, nodes) + block_rams(load_bits(p) + key, places) +
         block_rams(p.r2_bits(), places) + 2 * block_rams(entry, stack) +
         block_rams(p.lanes * load_bits(p), 32) + block_rams(2 * p.lanes * p.direction_bits, 32) +
         block_rams(body, contexts > 16 ? 2 * contexts : 4 * contexts);
}

Terms gatherer_terms(const Plan& p, const std::string& resource) {
  if (resource == "ebr") return {{"memories", gatherer_blocks(p)}, {"unit", 1}};
  // Squares of offsets in the lanes and in the nodes, two tests of a direction, powers' exponents.
  if (resource == "dsp")
    return {{"products", 3 * (p.lanes + 1) * multipliers(p.position_bits + 1) + 6 + p.channels}};
  const int list = p.k * (p.r2_bits() + p.index_bits());
  Terms terms = {{"list", list},
                 {"lanes", p.lanes * p.position_bits},
                 {"flux", p.channels * p.flux_bits()},
                 {"contexts", p.contexts},
                 {"unit", 1}};
  // LUT RAM is 16 words deep. Beyond 16 contexts the keys, and what else each context has there (27
  // bits for a bit of a coordinate and 360 more, from plans that differ in position_bits), take
  // another one and a choice.
  const int more = (p.contexts + 15) / 16 - 1;
  if (resource == "lut")
    terms.push_back({"beyond 16 contexts", more * (list + 27 * p.position_bits + 360)});
  return terms;
}

Terms reorder_terms(const Plan& p, const std::string& resource) {
  const int query = PacketLayout::of<GatherQuery>(p).bits();
  const auto packets = static_cast<uint64_t>(p.reorder_packets),
             bins = static_cast<uint64_t>(p.reorder_bins);
  const int count = clog2(packets + 1);
  const bool sweep = p.reorder_drain == ReorderDrain::kSweep;
  if (resource == "dsp") return {{"hash", p.reorder_key == ReorderKey::kHash ? 1 : 0}};
  if (resource == "ebr") {
    // As pool_ram divides them: the power of two, and what is beyond where that is much.
    const auto pool = [](int width, uint64_t depth) {
      const uint64_t main = std::bit_floor(depth), rest = depth - main;
      if (main < 512 || rest == 0) return block_rams(width, depth);
      return block_rams(width, main) + (rest > 64 ? block_rams(width, rest) : 0);
    };
    const uint64_t nodes = packets + 16;
    const int node = clog2(nodes);
    // Links and free list; tails, firsts, and heads, which have a bit more; how often a bin was
    // filled and emptied, each read at two places; and the sweep reads the number of a bin at
    // three.
    const uint64_t lists = 2 * pool(node, nodes) + 2 * block_rams(node, 4 * bins) +
                           block_rams(node + 1, 4 * bins) +
                           4 * block_rams(std::max(3, clog2(packets + 2)), bins);
    const uint64_t counts = sweep ? 3 * block_rams(count, bins) : 0;
    return {{"memories", pool(query, nodes) + lists + counts}};
  }
  // Numbers of packets and of bins go through every stage.
  const int bin = clog2(bins), levels = (std::max(2, bin) + 1) / 2;
  const double numbers = count + bin;
  if (resource == "ff") return {{"levels", sweep ? 0 : levels * count}, {"numbers", numbers}};
  // The sweep searches words of its bitmap. The tournament of reorder_fullest: at each level four
  // players a word in LUT RAM, six compared.
  double tree = 0;
  for (int l = 0; l < levels; ++l) {
    const int depth = 1 << (2 * levels - 2 * l - 2);
    tree += 4 * (count + 2 * l) * ((depth + 15) / 16) + 6 * count;
  }
  return {{"word", sweep ? 1 << ((bin + 1) / 2) : 0},
          {"tournament", sweep ? 0 : tree},
          {"numbers", numbers}};
}

Terms sampler_terms(const Plan& p, const std::string& resource) {
  const int index = p.cell_index_bits(), total = p.total_bits();
  const int power = p.mantissa_bits + clog2(static_cast<uint64_t>(p.channels)) +
                    static_cast<int>(ones(p.exponent_bits));
  const int power_total = power + clog2(static_cast<uint64_t>(p.k));
  const int cosine = p.cell_bits + p.normal_bits + 8;
  const int cosine_total = 3 * p.cell_bits + p.normal_bits + 8;
  const bool sum = p.combine == TableCombine::kSum;
  if (resource == "ebr") {
    int levels = 0;
    for (int l = 0; l < index; ++l) levels += block_rams(total, uint64_t{2} << l);
    return {{"tables", levels}, {"powers", block_rams(power_total, uint64_t{1} << index)}};
  }
  if (resource == "dsp") {
    // Limbs of 18 bits; one of a single bit takes no multiplier.
    const auto limbs = [](int bits) { return bits / 18 + (bits % 18 > 1 ? 1 : 0); };
    const int lanes = sum ? 1 << (p.cell_bits - 1) : 0;
    return {{"products",
             (sum ? limbs(power) * limbs(cosine_total) + limbs(power_total) * limbs(cosine) + lanes
                  : limbs(power) * limbs(cosine)) +
                 limbs(p.u_bits) * limbs(total) + 4}};
  }
  return {{"search", index * total},
          {"cosine lanes", sum ? (1 << (p.cell_bits - 1)) * (p.cell_bits + p.normal_bits + 1) : 0},
          {"powers", power_total},
          {"combination", (sum ? power + cosine_total : power + cosine)},
          {"draw", p.u_bits + total},
          {"place", 2 * p.v_bits},
          {"unit", 1}};
}

}  // namespace

int block_rams(int width, uint64_t depth) {
  struct Shape {
    int width;
    uint64_t depth;
  };
  int best = 0;
  for (const Shape& s : {Shape{1, 16384}, Shape{2, 8192}, Shape{4, 4096}, Shape{9, 2048},
                         Shape{18, 1024}, Shape{36, 512}}) {
    const int n =
        (width + s.width - 1) / s.width * static_cast<int>((depth + s.depth - 1) / s.depth);
    if (best == 0 || n < best) best = n;
  }
  return best;
}

Terms resource_terms(const Plan& plan, const std::string& unit, const std::string& resource) {
  if (resource != "lut" && resource != "ff" && resource != "dsp" && resource != "ebr")
    throw std::runtime_error("there is no resource " + resource + ", expected lut, ff, dsp or ebr");
  if (unit == "photon_gatherer") return gatherer_terms(plan, resource);
  if (unit == "reorder_buffer") return reorder_terms(plan, resource);
  if (unit == "cdf_sampler") return sampler_terms(plan, resource);
  throw std::runtime_error("there is no unit " + unit);
}

UnitResources estimate_resources(const Plan& plan, const std::string& unit) {
  const auto sum = [&](const std::string& resource) {
    double total = 0;
    for (const auto& [term, value] : resource_terms(plan, unit, resource))
      for (const ResourceCoefficient& c : kResourceCoefficients)
        if (unit == c.unit && resource == c.resource && term == c.term)
          total += c.coefficient * value;
    return total;
  };
  return {sum("lut"), sum("ff"), sum("dsp"), sum("ebr")};
}

double resource_error(const std::string& unit, const std::string& resource) {
  for (const ResourceError& e : kResourceErrors)
    if (unit == e.unit && resource == e.resource) return e.error;
  throw std::runtime_error("there is no error of " + resource + " of " + unit);
}

}  // namespace photonloom
