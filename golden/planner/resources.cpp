// SPDX-License-Identifier: Apache-2.0
#include "golden/planner/resources.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <stdexcept>

#include "golden/packet/layout.hpp"
#include "golden/planner/resource_fit.hpp"
#include "golden/unit/self_test.hpp"

namespace photonloom {
namespace {

using Terms = std::vector<std::pair<std::string, double>>;
using MemoryBits = std::vector<std::pair<std::string, uint64_t>>;

using Gatherer = std::type_identity<PhotonGatherer>;
using Reorder = std::type_identity<ReorderBuffer>;
using Sampler = std::type_identity<CdfSampler>;

// A unit supplies terms once it was synthesized over plans, and the memory that it has; one that
// does not has neither a prediction nor rows.
template <class Unit>
Terms terms_of(std::type_identity<Unit>, const Plan&, const std::string&) {
  return {};
}
template <class Unit>
MemoryBits memory_bits_of(std::type_identity<Unit>, const Plan&) {
  return {};
}

// Multipliers of a square or product of two `bits`-wide numbers, 18 x 18 each.
int multipliers(int bits) {
  const int limbs = (bits + 17) / 18;
  return limbs * limbs;
}

uint64_t power_of_two(int n) { return uint64_t{1} << clog2(static_cast<uint64_t>(n)); }

int load_bits(const Plan& p) { return p.photon_bits() - 3 * p.position_bits; }

// A block RAM as so many words of `width` bits, which are written in lanes of nine bits where they
// are wider.
struct Shape {
  int width;
  uint64_t depth;
};
// With two ports that both read, 18 bits are the widest.
constexpr Shape kTwoReads[] = {{1, 16384}, {2, 8192}, {4, 4096}, {9, 2048}, {18, 1024}};
constexpr Shape kOneRead[] = {{1, 16384}, {2, 8192}, {4, 4096}, {9, 2048}, {18, 1024}, {36, 512}};

// Lanes of words that lie one behind another share blocks: 2,816 words of 73 bits are three times
// nine lanes, in 14 blocks of two lanes and not in three times five.
int fewest(std::span<const Shape> shapes, int width, uint64_t depth) {
  int best = 0;
  for (const Shape& s : shapes) {
    const int lane = std::min(s.width, 9), lanes_in_a_block = s.width / lane;
    const int lanes = (width + lane - 1) / lane * static_cast<int>((depth + s.depth - 1) / s.depth);
    const int n = (lanes + lanes_in_a_block - 1) / lanes_in_a_block;
    if (best == 0 || n < best) best = n;
  }
  return best;
}

// A unit's instances of block_ram: block RAM, or LUT RAM, a choice between its 16 words a cell and
// a register behind it, for those of board.lut_ram_words words at most.
class Memories {
 public:
  explicit Memories(const Plan& plan) : lut_words_(static_cast<uint64_t>(plan.lut_ram_words)) {}

  // What is added next is part of.
  void place(const char* name) { bits.emplace_back(name, 0); }
  // An instance of block_ram_two_reads.
  void add_two_reads(int width, uint64_t depth) {
    count(width, depth);
    blocks += fewest(kTwoReads, width, depth);
  }
  // Words or bits that the coefficients hold, and no term.
  void count(int width, uint64_t depth, int instances = 1) {
    if (bits.empty()) return;
    bits.back().second += static_cast<uint64_t>(width) * static_cast<uint64_t>(instances) * depth;
  }
  void add(int width, uint64_t depth, int instances = 1) {
    count(width, depth, instances);
    if (depth > lut_words_) {
      blocks += instances * block_rams(width, depth);
      return;
    }
    const int deep = static_cast<int>((depth + 15) / 16);
    cells += instances * ((width + 3) / 4) * deep;
    choices += instances * width * (deep - 1);
    registers += instances * width;
  }

  // The terms of a resource.
  Terms terms(const std::string& resource) const {
    if (resource == "ebr") return {{"memories", blocks}};
    if (resource == "ff") return {{"LUT RAM registers", registers}};
    // A choice was four fifths of a LUT in the gatherer and the sampler, fitted apart.
    if (resource == "lut") return {{"LUT RAM", 4 * cells + 0.8 * choices}};
    return {};
  }

  int blocks = 0, cells = 0, choices = 0, registers = 0;
  MemoryBits bits;  // of all instances, words times bits, by place

 private:
  uint64_t lut_words_;
};

// Of a word of photons, nodes or cached lines.
int parity_bits(const Plan& p) { return p.parity ? 1 : 0; }

// Data of a cache of `lines` photon lines, which are read in `parts` parts and written in beats;
// so many bits of each slot are kept.
void add_cached_lines(Memories& m, const Plan& p, int slot_bits, uint64_t lines, uint64_t parts,
                      int beat_bits) {
  const int parity = parity_bits(p);
  const bool narrow = 8 * p.line_bytes() / static_cast<int>(parts) % beat_bits == 0;
  if (narrow && parts > 1)
    m.add(p.bucket / static_cast<int>(parts) * slot_bits + parity, lines * parts);
  else
    m.add(p.bucket * slot_bits + parity, lines);
}

// Bits of a slice that is one block of so many words: none is chosen between blocks behind it.
int slice_bits(uint64_t words) {
  const int address = clog2(words);
  return address >= 14   ? 1
         : address == 13 ? 2
         : address == 12 ? 4
         : address == 11 ? 9
         : address == 10 ? 18
                         : 36;
}
void add_slices(Memories& m, int width, uint64_t words) {
  for (int left = width; left > 0; left -= slice_bits(words))
    m.add(std::min(left, slice_bits(words)), words);
}

// A memory of single nodes, read by one tree or on both ports of its blocks, which have 18 bits
// there at most.
void add_nodes(Memories& m, int bits, uint64_t words, int trees) {
  if (trees == 1) return add_slices(m, bits, words);
  const int widest = std::min(slice_bits(words), 18);
  for (int left = bits; left > 0; left -= widest) m.add_two_reads(std::min(left, widest), words);
}

int node_bits(const Plan& p) { return p.position_bits + 2 + parity_bits(p); }

// own_nodes: it has a node memory, as a gatherer that shares none.
Memories gatherer_memories(const Plan& p, bool own_nodes = true) {
  Memories m(p);
  const auto sets = static_cast<uint64_t>(p.cache_bytes / (p.line_bytes() * p.cache_ways));
  const uint64_t lines = sets * power_of_two(p.cache_ways);
  const auto parts = static_cast<uint64_t>(p.bucket / p.lanes);  // a line is read in as many cycles
  if (p.cache_bytes != 0) {
    m.place("leaf cache, lines");
    add_cached_lines(m, p, p.record_bits(), lines, parts, p.beat_bits);
    if (p.compressed()) m.add(p.bucket * p.slot_header_bits() + parity_bits(p), lines);
    m.place("leaf cache, tags");
    m.add(p.line_address_bits() + 2 + parity_bits(p), sets, p.cache_ways);
  }

  // Nodes are in slices as deep as they all are. Of two levels there are three in a word, and words
  // for half of the numbers that a map's nodes have.
  const auto words = [&](const MapPlan& m) {
    const uint64_t lines = p.lines(m);
    return p.node_levels() == 1 ? lines : lines > 1 ? uint64_t{1} << (clog2(lines) - 1) : 0;
  };
  const uint64_t nodes = std::max<uint64_t>(2, words(p.global) + words(p.caustic));
  m.place("inner nodes");
  if (own_nodes)
    for (int word = 0; word < (p.node_levels() > 1 ? 3 : 1); word++)
      add_nodes(m, node_bits(p), nodes, p.trees());

  // Trees and lists have their contexts each.
  const auto contexts_of = [&](int parts) {
    return power_of_two(std::max(2, (p.contexts + parts - 1) / parts));
  };
  const uint64_t contexts = contexts_of(1);
  const uint64_t places = contexts_of(p.candidates_per_cycle) * power_of_two(std::max(2, p.k));
  const int lists = p.candidates_per_cycle;
  m.place("candidate lists");
  m.add(load_bits(p) + p.r2_bits() + p.index_bits(), places, lists);
  m.add(p.r2_bits() + (p.list_code_bits() == 0 ? 0 : p.index_bits()), places, lists);
  m.place("stacks of subtrees");
  m.add(2 + p.line_bits() + 3 * (p.position_bits + 1) + p.r2_bits() +
            clog2(static_cast<uint64_t>(p.epsilon_factor)),
        contexts_of(p.trees()) * power_of_two(p.line_bits() + 1) / 2, 2 * p.trees());
  const bool many_behind =
      p.list_code_bits() == 0 && (p.contexts + lists - 1) / lists > 16 && parts <= 2;
  const uint64_t rows = uint64_t{1}
                        << clog2(std::max<uint64_t>(16, 2 * parts) + (many_behind ? 48 : 16));
  m.place("beats of candidates");
  m.add(p.lanes * load_bits(p), rows, lists);
  m.add(2 * p.lanes * p.direction_bits, rows, lists);
  // Of several trees and lists, squared distances too (photon_gatherer_beat_queue).
  if (p.trees() > 1 && lists > 1) m.add(p.lanes * p.r2_bits(), rows, lists);

  // Of a result: what is known of it at the start, at the end, and its reciprocal.
  // LUTs hold them where they hold 4 a context.
  const uint64_t held = p.lut_ram_words >= 512   ? 512
                        : p.lut_ram_words >= 128 ? 128
                        : p.lut_ram_words >= 64  ? 64
                                                 : 0;
  const uint64_t wanted = held >= 4 * contexts ? held : 512;
  const uint64_t most = p.parity ? std::min<uint64_t>(128, wanted) : wanted;
  const uint64_t slots = std::min(8 * contexts, std::max(most, 2 * contexts));
  const int body = p.count_bits() + p.r2_bits() + p.channels * p.flux_bits() +
                   2 * (p.line_bits() + 1) + p.index_bits() + 3;
  m.place("results");
  m.add(p.pixel_bits() + p.sample_bits() + p.tag_bits() + 1, slots);
  // Of several trees and lists with one sum, whether it is a flush; of others that is LUT RAM.
  if (p.trees() > 1 && lists > 1 && p.powers_per_cycle == 1 &&
      slots > static_cast<uint64_t>(p.lut_ram_words))
    m.add(1, slots);
  // Far ones keep a word of few in halves (photon_gatherer_results).
  if (p.far_gatherers() && p.powers_per_cycle == 1 && p.reciprocal_bits != 0 && slots <= 256 &&
      slots > static_cast<uint64_t>(p.lut_ram_words))
    m.add((body + 1) / 2, 2 * slots);
  else
    m.add(body + (p.reciprocal_bits == 0 ? 1 : 0), slots);
  if (p.reciprocal_bits != 0) {
    m.add(1 + p.reciprocal_bits + p.reciprocal_exponent_bits(), slots);
    // The lap of the slots that it is of: a bit that the coefficients were fitted without.
    m.count(1, slots);
  }
  return m;
}

Terms terms_of(Gatherer, const Plan& p, const std::string& resource) {
  const Terms of_memories = gatherer_memories(p).terms(resource);
  if (resource == "ebr") return of_memories;
  // Squares of offsets in the lanes and in the nodes, two tests of a direction (a lane gives one
  // at a time), powers' exponents.
  if (resource == "dsp")
    return {{"products", 3 * (p.lanes + p.nodes_per_cycle) * multipliers(p.position_bits + 1) +
                             3 * std::min(p.lanes, 2) * p.candidates_per_cycle +
                             p.channels * p.powers_per_cycle}};
  const int lists = p.candidates_per_cycle;
  const bool coded = p.list_code_bits() != 0;
  const int list = p.k * lists *
                   (coded && resource == "lut" ? p.list_code_bits() : p.r2_bits() + p.index_bits());
  Terms terms = {{"list", list},
                 // Of a place, beside its code: whether that is a candidate's too, and the way to
                 // its whole key.
                 {"codes", coded ? p.k * lists : 0},
                 {"lanes", p.lanes * p.position_bits},
                 {"flux", p.channels * p.flux_bits()},
                 {"contexts", p.contexts},
                 {"unit", 1},
                 {"leaf cache", p.cache_bytes != 0 ? 1 : 0},
                 // Of more a cycle, beside the lists' keys: what each further part has. A second
                 // level counts as a further tree, of which it is a part.
                 {"further trees", (p.nodes_per_cycle - 1) * p.position_bits},
                 {"further lists", lists - 1},
                 {"further sums", (p.powers_per_cycle - 1) * p.channels * p.flux_bits()},
                 // Of a beat, however many lanes there are.
                 {"decoder", p.compressed() ? 1 : 0}};
  // LUT RAM is 16 words deep. Beyond 16 contexts the keys, and what else each context has there (27
  // bits for a bit of a coordinate and 360 more, from plans that differ in position_bits), take
  // another one and a choice; a list has its part of the contexts.
  const auto more = [](int contexts) { return (contexts + 15) / 16 - 1; };
  if (resource == "lut")
    terms.push_back({"beyond 16 contexts", more((p.contexts + lists - 1) / lists) * list +
                                               more(p.contexts) * (27 * p.position_bits + 360)});
  terms.insert(terms.end(), of_memories.begin(), of_memories.end());
  return terms;
}

Memories reorder_memories(const Plan& p) {
  Memories m(p);
  const auto packets = static_cast<uint64_t>(p.reorder_packets),
             bins = static_cast<uint64_t>(p.reorder_bins);
  // As pool_ram divides them: the power of two, from 8,192 on in slices, and what is beyond where
  // that is much.
  const auto pool = [&](int width, uint64_t depth) {
    const uint64_t main = std::bit_floor(depth), rest = depth - main;
    if (main < 512 || rest == 0) return m.add(width, depth);
    if (main < 8192)
      m.add(width, main);
    else
      add_slices(m, width, main);
    if (rest > 64)
      m.add(width, rest);
    else
      m.count(width, rest);
  };
  const uint64_t nodes = packets + 16;
  const int node = clog2(nodes);
  m.place("pool");
  pool(PacketLayout::of<GatherQuery>(p).bits(), nodes);
  // Links and free list; tails, firsts, and heads, which have a bit more; how often a bin was
  // filled and emptied, each read at two places; and the sweep reads the number of a bin at three.
  m.place("links and free list");
  pool(node, nodes);
  pool(node, nodes);
  m.place("bins");
  m.add(node, 4 * bins, 2);
  m.add(node + 1, 4 * bins);
  m.add(std::max(3, clog2(packets + 2)), bins, 4);
  if (p.reorder_drain == ReorderDrain::kSweep) m.add(clog2(packets + 1), bins, 3);
  return m;
}

Terms terms_of(Reorder, const Plan& p, const std::string& resource) {
  if (resource == "dsp") return {{"hash", p.reorder_key == ReorderKey::kHash ? 1 : 0}};
  Terms terms = reorder_memories(p).terms(resource);
  if (resource == "ebr") return terms;
  const bool sweep = p.reorder_drain == ReorderDrain::kSweep;
  const int count = clog2(static_cast<uint64_t>(p.reorder_packets) + 1);
  // Numbers of packets and of bins go through every stage.
  const int bin = clog2(static_cast<uint64_t>(p.reorder_bins)), levels = (std::max(2, bin) + 1) / 2;
  const double numbers = count + bin;
  if (resource == "ff") {
    terms.push_back({"levels", sweep ? 0 : levels * count});
    terms.push_back({"numbers", numbers});
    return terms;
  }
  // The sweep searches words of its bitmap. The tournament of reorder_fullest: at each level four
  // players a word in LUT RAM, six compared.
  double tree = 0;
  for (int l = 0; l < levels; ++l) {
    const int depth = 1 << (2 * levels - 2 * l - 2);
    tree += 4 * (count + 2 * l) * ((depth + 15) / 16) + 6 * count;
  }
  terms.push_back({"word", sweep ? 1 << ((bin + 1) / 2) : 0});
  terms.push_back({"tournament", sweep ? 0 : tree});
  terms.push_back({"numbers", numbers});
  return terms;
}

Memories sampler_memories(const Plan& p) {
  Memories m(p);
  const int index = p.cell_index_bits();
  m.place("two tables");
  for (int l = 0; l < index; ++l) m.add(p.total_bits(), uint64_t{2} << l);
  // A memory of blocks for each level; the level of all cells is a sum that is there anyway.
  m.place("powers of cells");
  if (p.combine != TableCombine::kCosine)
    for (int l = 0; l < std::min(p.levels, p.cell_bits); ++l)
      m.add(p.cell_power_bits(), uint64_t{1} << (index - 2 * l));
  return m;
}

Terms terms_of(Sampler, const Plan& p, const std::string& resource) {
  const int index = p.cell_index_bits(), total = p.total_bits();
  // The highest bits of a power with levels are a sum's, and few.
  const int spread = p.spread_power_bits() - clog2(static_cast<uint64_t>(p.k));
  const int spread_total = p.spread_power_bits();
  const int cosine = p.cell_bits + p.normal_bits + 8;
  const int cosine_total = 3 * p.cell_bits + p.normal_bits + 8;
  const bool weighted = p.combine == TableCombine::kWeighted;
  const bool sum = p.combine == TableCombine::kSum || weighted;
  const bool product = p.combine == TableCombine::kProduct;
  Terms terms = sampler_memories(p).terms(resource);
  if (resource == "ebr") return terms;
  if (resource == "dsp") {
    // Limbs of 18 bits; one of a single bit takes no multiplier.
    const auto limbs = [](int bits) { return bits / 18 + (bits % 18 > 1 ? 1 : 0); };
    const int lanes = product ? 0 : 1 << (p.cell_bits - 1);
    const int shares = weighted ? limbs(cosine_total) + limbs(spread_total) : 0;
    const int count = weighted ? p.count_bits() : 0, samples = weighted ? 8 : 0;
    return {{"products", (sum ? limbs(spread) * limbs(cosine_total + count) +
                                    limbs(spread_total + samples) * limbs(cosine)
                          : product ? limbs(spread) * limbs(cosine)
                                    : 0) +
                             lanes + shares + limbs(p.u_bits) * limbs(total) + 4}};
  }
  const Terms rest = {
      {"search", index * total},
      {"cosine lanes", !product ? (1 << (p.cell_bits - 1)) * (p.cell_bits + p.normal_bits + 1) : 0},
      {"powers", spread_total},
      {"combination", sum       ? spread + cosine_total
                      : product ? spread + cosine
                                : spread},
      {"draw", p.u_bits + total},
      {"place", 2 * p.v_bits},
      {"unit", 1}};
  terms.insert(terms.end(), rest.begin(), rest.end());
  return terms;
}

MemoryBits memory_bits_of(Gatherer, const Plan& p) {
  if (!p.global.present && !p.caustic.present) return {};
  return gatherer_memories(p).bits;
}

MemoryBits memory_bits_of(Reorder, const Plan& p) {
  if (!p.global.present || p.reorder_key == ReorderKey::kNone) return {};
  return reorder_memories(p).bits;
}

MemoryBits memory_bits_of(Sampler, const Plan& p) {
  if (!p.global.present) return {};
  return sampler_memories(p).bits;
}

MemoryBits memory_bits_of(std::type_identity<IrradianceCache>, const Plan& p) {
  if (!p.cache_present) return {};
  Memories m(p);
  m.place("records");
  m.add(3 * (p.position_bits + p.normal_bits) + p.cache_falloff_bits() + 1 +
            p.cache_falloff_exponent_bits(),
        static_cast<uint64_t>(p.cache_records));
  return m.bits;
}

// Bits of a slot that a board keeps.
int kept_bits(const Plan& p) { return p.record_bits() + p.slot_header_bits(); }

// As photon_ram and photon_sdram keep them.
int photon_memory_blocks(const Plan& p) {
  const int beats = p.line_beats();
  if (p.photon_memory == PhotonMemory::kBlockRam) {
    const int stride = 8 * p.photon_bytes;
    const int width = p.beat_bits % stride == 0 ? p.beat_bits / stride * kept_bits(p) : p.beat_bits;
    const uint64_t depth = p.photon_ram_beats();
    constexpr uint64_t kBankWords = 1024;
    if (const int row = p.photon_ram_row(); row > 1)
      return row * fewest(kTwoReads, width + parity_bits(p), depth / static_cast<uint64_t>(row));
    if (p.photon_ram_is_divided())
      return static_cast<int>((depth + kBankWords - 1) / kBankWords) *
             fewest(kTwoReads, width + parity_bits(p), kBankWords);
    return fewest(kTwoReads, width + parity_bits(p), depth);
  }
  constexpr int kWays = 4;
  const uint64_t sets =
      std::bit_floor(static_cast<uint64_t>(p.board_cache_bytes / (p.line_bytes() * kWays)));
  Memories m(p);
  add_cached_lines(m, p, kept_bits(p), sets * kWays, static_cast<uint64_t>(beats), 64);
  m.add(p.line_address_bits() + 2 + parity_bits(p), sets, kWays);
  // The prefetcher's queries and its nodes.
  if (p.prefetch_queries() != 0) {
    m.add(PacketLayout::of<GatherQuery>(p).bits(), static_cast<uint64_t>(p.prefetch_queries()));
    if (!p.shared_nodes) add_nodes(m, p.position_bits + 2, p.node_words(), 1);
  }
  return m.blocks;
}

}  // namespace

int block_rams(int width, uint64_t depth) { return fewest(kOneRead, width, depth); }

BoardMemories board_memories(const Plan& p) {
  BoardMemories b;
  b.photons = photon_memory_blocks(p);
  Memories replayer(p), link(p);
  const int words = (PacketLayout::of<GatherQuery>(p).bits() + 31) / 32;
  replayer.add(32, static_cast<uint64_t>(p.replay_queries), words);
  // link_receiver's bytes and frame, the words to and from the gatherers.
  link.add(8, 2048);
  link.add(8, 512);
  link.add(32, 512);
  link.add(32, 1024);
  b.replayer = replayer.blocks;
  b.link = link.blocks;
  // The self-test's script is block RAM whatever board.lut_ram_words says (rtl/board/self_test.sv).
  if (p.self_test) b.link += block_rams(32, make_self_test(p).words.size());
  b.units = p.gatherers * gatherer_memories(p).blocks;
  if (p.shared_nodes) {
    Memories nodes(p);
    for (int readers = p.gatherers + (p.prefetch_queries() != 0 ? 1 : 0); readers > 0; readers -= 2)
      add_nodes(nodes, node_bits(p), p.node_words(), std::min(readers, 2));
    b.shared_nodes = nodes.blocks + p.gatherers * (gatherer_memories(p, false).blocks -
                                                   gatherer_memories(p).blocks);
    b.units += b.shared_nodes;
  }
  if (p.reorder_key != ReorderKey::kNone) b.units += reorder_memories(p).blocks;
  return b;
}

Terms resource_terms(const Plan& plan, const std::string& unit, const std::string& resource) {
  if (resource != "lut" && resource != "ff" && resource != "dsp" && resource != "ebr")
    throw std::runtime_error("there is no resource " + resource + ", expected lut, ff, dsp or ebr");
  Terms terms;
  with_unit(unit, [&](auto type) { terms = terms_of(type, plan, resource); });
  return terms;
}

MemoryBits unit_memory_bits(const Plan& plan, const std::string& unit) {
  MemoryBits bits;
  with_unit(unit, [&](auto type) { bits = memory_bits_of(type, plan); });
  return bits;
}

bool is_predicted(const std::string& unit) {
  return std::any_of(std::begin(kResourceCoefficients), std::end(kResourceCoefficients),
                     [&](const ResourceCoefficient& c) { return unit == c.unit; });
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
