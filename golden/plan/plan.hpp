// SPDX-License-Identifier: Apache-2.0
// The plan: the complete description of one hardware configuration. Everything that golden and
// hardware must agree on is a line of it or a function of its lines.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <string>

#include "golden/numeric/bits.hpp"

namespace photonloom {

enum class ReorderKey { kNone, kHilbert, kHash };  // kNone: pass-through
enum class ReorderDrain { kSweep, kFullest };
// What the sampler's weights are made of: photons and cosine in equal shares, multiplied, in shares
// by their number, or one of them alone.
enum class TableCombine { kSum, kProduct, kWeighted, kPhotons, kCosine };
enum class TablePhotons { kAll, kIndirect };
// Which final gather ray follows which: pixels row by row, tile by tile, or direction bin by
// direction bin within a tile.
enum class FrameOrder { kPixel, kTile, kDirectionBins };
enum class PhotonMemory { kBlockRam, kSdram };  // of a board
// Clock of an SDRAM's controller. Under 36 MHz data of a READ would be gone when they are taken,
// beyond 126 MHz they would not be there yet (docs/photon_memory.md, "At the pins").
inline constexpr int kSdramLeastKHz = 50000, kSdramMostKHz = 120000;
enum class PhotonLines { kPlain, kCompressed };
enum class CacheRadius { kPhotons, kProbe };  // what an irradiance record's radius comes from
// How a record's light may change over its reach.
enum class CacheGradients { kNone, kRotation, kTranslation, kBoth };

// One photon map as the hardware sees it.
struct MapPlan {
  bool present = false;
  uint64_t photons = 0;    // N; the map has ceil(N / bucket) lines
  int power_exponent = 0;  // one power unit is 2^power_exponent W
  double radius = 0;       // scene units; 0: none
  uint64_t r2_max = 0;     // squared position units, inclusive. Not a line of the file: it follows
                           // from the radius, so that position_bits can be edited alone

  // The list of lines in plan.toml: (key, value, smallest, largest, meaning).
  template <class Self, class Visitor>
  static void visit(Self& m, Visitor&& v) {
    v("present", m.present, 0, 1, "whether the scene needs this map");
    v("photons", m.photons, 0, 1u << 30, "stored photons");
    v("power_exponent", m.power_exponent, -1000, 1000, "one power unit is 2^this W");
    v("radius", m.radius, 0, 0, "maximum gather radius in scene units, 0 for none");
  }
};

// A visitor of (section, key, ...) as a visitor of (key, ...).
template <class Visitor>
auto in_section(const char* section, Visitor& v) {
  return [section, &v](const char* key, auto& value, auto smallest, auto largest,
                       const char* meaning) { v(section, key, value, smallest, largest, meaning); };
}

struct Plan {
  // [scene]
  std::string scene;               // name, for people
  std::array<double, 3> origin{};  // lower corner of the scene's cube
  double extent = 1;               // its edge; one position unit is extent / 2^position_bits
  // [photon]
  int position_bits = 16;
  int direction_bits = 8;  // per octahedral coordinate
  int mantissa_bits = 9;
  int exponent_bits = 5;
  int channels = 3;
  std::array<double, 3> channel_color{1, 1, 1};  // with one channel: RGB = value * this
  int bucket = 8;                                // photons per line
  int photon_bytes = 16;                         // stride of a photon in a line
  PhotonLines photon_lines = PhotonLines::kPlain;
  int further_percent = 25;  // lines behind the leaves', for those that need more than one
  MapPlan global, caustic;
  // [gather]
  int k = 50;
  int normal_bits = 8;  // per octahedral coordinate of a query's normal
  uint64_t r2_floor = 1;
  uint32_t epsilon_factor = 1;  // E: a subtree is skipped iff distance^2 * E > bound * 2^s
  int epsilon_shift = 0;        // s
  uint32_t leaf_limit = 0;      // leaves visited per query at most; 0: no limit
  int reciprocal_bits = 18;     // W; 0: results carry no reciprocal
  // [gatherer]: changes when packets come, never which
  int contexts = 16;
  int lanes = 4;
  int nodes_per_cycle = 1;
  int candidates_per_cycle = 1;
  int powers_per_cycle = 1;
  int cache_bytes = 16384;
  int cache_ways = 2;
  int cache_misses = 8;
  int beat_bits = 128;  // of the line port
  // [reorder]
  ReorderKey reorder_key = ReorderKey::kHilbert;
  ReorderDrain reorder_drain = ReorderDrain::kSweep;
  int reorder_packets = 2048;  // P
  int reorder_bins = 512;      // a power of two
  int reorder_cell_bits = 3;   // bits of each coordinate that make the key
  // [sampler]
  int cell_bits = 4;          // a: the table has 2^a x 2^a cells
  int probability_bits = 16;  // width of a narrowed weight
  int u_bits = 32;
  int v_bits = 8;  // each of v1, v2
  TableCombine combine = TableCombine::kSum;
  int levels = 1;           // L: block sizes, from one cell up, over which a photon is spread
  int cosine_samples = 50;  // N_B: photons that the cosine counts as; weighted only
  // [cache]
  bool cache_present = false;
  int cache_records = 128;      // of a tile
  int cache_hits = 4;           // records in an answer at most
  int cache_passes = 2;         // 2: a tile's samples look up again when all its records are known
  double cache_accuracy = 0.1;  // a: a record reaches a times its split-sphere radius
  CacheRadius cache_radius = CacheRadius::kPhotons;
  int cache_probe_rays = 4;
  double cache_radius_min = 0, cache_radius_max = 0.25;  // split-sphere radius, of scene.extent
  int cache_angle_bits = 11;  // squared distance of normals at which a record has no weight: 2^this
  int cache_weight_bits = 8;  // fraction bits of a weight
  bool cache_glossy = false;  // surfaces reached through a glossy lobe too
  CacheGradients cache_gradients = CacheGradients::kNone;
  // [board]: what a board's top holds beside one gatherer; never which packets come
  int gatherers = 1;
  PhotonMemory photon_memory = PhotonMemory::kBlockRam;
  int board_cache_bytes = 65536;  // of photon lines, before an SDRAM
  int sdram_khz = 100000;         // clock of an SDRAM's controller
  int refreshes_ahead = 0;        // refreshes that an idle SDRAM may be ahead of those due
  int replay_queries = 1024;      // block RAM of the query replayer
  int lut_ram_words = 0;          // memories of so many words at most are made of LUTs
  bool shared_nodes = false;      // two gatherers, or one and the prefetcher, read one node memory
  bool parity = false;            // of memories of photons, nodes and cached lines
  bool self_test = false;         // a board asks itself stored queries after reset
  // [frame]
  int width = 256, height = 256;
  int spp = 16;
  int gather_rays = 16;
  int first_rays = 0;         // of the first pass of an adaptive frame; 0: all gather_rays at once
  int mean_rays = 16;         // of both passes, a sample in the mean; gather_rays at most
  int shadow_rays = 1;        // at a sample's first hit that is not a mirror's or glass
  int first_shadow_rays = 0;  // of the first of two passes; 0: all shadow_rays at once
  int mean_shadow_rays = 1;   // of both passes, a sample in the mean; shadow_rays at most
  TablePhotons table_photons = TablePhotons::kAll;
  int tile = 16;        // edge of a tile in pixels
  int batch_tiles = 0;  // tiles per batch; 0: the whole frame
  FrameOrder order = FrameOrder::kTile;
  int direction_bin_bits = 2;  // of each octahedral coordinate, of a direction bin
  // [pixel]
  int weight_bits = 18;    // mantissa of a query's weight
  int fraction_bits = 32;  // F: a pixel counts 2^-F W/(m^2 sr)
  int integer_bits = 32;   // I

  // Widths that follow.
  int r2_bits() const { return 2 * position_bits + 2; }
  uint64_t r2_limit() const { return ones(r2_bits()); }
  const MapPlan& map(bool is_caustic) const { return is_caustic ? caustic : global; }
  uint64_t lines(const MapPlan& m) const {
    return (m.photons + static_cast<uint64_t>(bucket) - 1) / static_cast<uint64_t>(bucket);
  }
  // Photons that they hold.
  uint64_t room(const MapPlan& m) const { return lines(m) * static_cast<uint64_t>(bucket); }
  uint64_t max_photons() const { return std::max(global.photons, caustic.photons); }
  uint64_t max_lines() const { return std::max(lines(global), lines(caustic)); }
  int line_bits() const { return std::max(1, clog2(max_lines())); }
  int slot_bits() const { return clog2(static_cast<uint64_t>(bucket)); }
  int index_bits() const { return line_bits() + slot_bits(); }
  int count_bits() const { return clog2(static_cast<uint64_t>(k) + 1); }
  // Of many places, of all lists of a gatherer, codes of keys are compared, and whole keys are in
  // block RAM. 0: keys are compared whole, since of few places codes save little for a block RAM.
  // Of far gatherers of more than 8 places there are so many that it is LUTs that are short.
  // Four lists have shorter ones: 2 % more cycles at k = 50, for a LUT RAM less of each place.
  int list_code_bits() const {
    if (k * candidates_per_cycle <= 24 && !(far_gatherers() && k > 8)) return 0;
    return candidates_per_cycle == 4 ? 16 : 20;
  }
  int power_bits() const {
    return mantissa_bits + static_cast<int>(ones(exponent_bits));
  }  // one channel, decoded
  int flux_bits() const { return power_bits() + clog2(static_cast<uint64_t>(k)); }
  int reciprocal_exponent_bits() const {
    return reciprocal_bits ? clog2(static_cast<uint64_t>(r2_bits()) + 1) : 0;
  }
  int pixel_bits() const {
    return std::max(1, clog2(static_cast<uint64_t>(width) * static_cast<uint64_t>(height)));
  }
  int sample_bits() const { return std::max(1, clog2(static_cast<uint64_t>(spp))); }
  int tag_bits() const { return std::max(1, clog2(static_cast<uint64_t>(gather_rays) + 1)); }
  int cell_index_bits() const { return 2 * cell_bits; }
  int total_bits() const { return probability_bits + cell_index_bits(); }
  int sample_direction_bits() const { return cell_bits + v_bits; }
  // A cell's power, and that of all cells; and with its levels (docs/cdf_sampler.md, Q).
  int cell_power_bits() const {
    return power_bits() + clog2(static_cast<uint64_t>(channels)) + clog2(static_cast<uint64_t>(k));
  }
  int spread_power_bits() const {
    return cell_power_bits() + 2 * (levels - 1) + clog2(static_cast<uint64_t>(levels));
  }
  // What a photon counts in all cells together, its levels included: L 4^(L - 1).
  uint64_t photon_spread() const { return static_cast<uint64_t>(levels) << (2 * (levels - 1)); }
  int photon_bits() const {
    return 3 * position_bits + 2 * direction_bits + channels * mantissa_bits + exponent_bits;
  }
  double position_unit() const {
    return extent / static_cast<double>(uint64_t{1} << position_bits);
  }
  int line_bytes() const { return bucket * photon_bytes; }
  // Compressed lines (docs/photon_memory.md): a slot has its record, then its part of the header.
  static constexpr int kCornerBits = 10;
  bool compressed() const { return photon_lines == PhotonLines::kCompressed; }
  int corner_bits() const { return std::min(position_bits, kCornerBits); }
  int line_header_bits() const { return 5 + exponent_bits + 3 * corner_bits(); }
  int slot_header_bits() const {
    return compressed() ? (line_header_bits() + bucket - 1) / bucket : 0;
  }
  int record_bits() const {
    return compressed() ? 8 * photon_bytes - slot_header_bits() : photon_bits();
  }
  // Bits of a record for what is relative to its line.
  int offset_bits() const { return record_bits() - 2 * direction_bits - channels * mantissa_bits; }
  // Bits of an offset that every layout has: along the line's own axis, along the other two.
  int other_offset_bits() const { return (offset_bits() - 1) / 3; }
  int axis_offset_bits() const { return offset_bits() - 6 - 2 * other_offset_bits(); }
  // Lines of a map in memory: its leaves' and those further ones that there is room for.
  uint64_t memory_lines(const MapPlan& m) const {
    const uint64_t percent = compressed() ? static_cast<uint64_t>(further_percent) : 0;
    return lines(m) + (lines(m) * percent + 99) / 100;
  }
  // Beats of photon lines in a board's block RAM, and how many of them one address reads: 2,049 to
  // 4,096 beats have those of a line side by side where they are four or fewer
  // (rtl/board/photon_ram.sv).
  int line_beats() const { return 8 * line_bytes() / beat_bits; }
  uint64_t photon_ram_beats() const {
    return std::max<uint64_t>(1, memory_lines(global) + memory_lines(caustic)) *
           static_cast<uint64_t>(line_beats());
  }
  bool photon_ram_is_divided() const {
    return photon_ram_beats() > 2048 && photon_ram_beats() <= 4096;
  }
  int photon_ram_row() const {
    return photon_ram_is_divided() && line_beats() <= 4 ? line_beats() : 1;
  }
  // Bytes of an SDRAM that the maps' lines take, each from a multiple of a power of two on, and
  // those that there are (256 Mbit).
  static constexpr uint64_t kSdramBytes = uint64_t{32} << 20;
  uint64_t sdram_bytes() const {
    return (memory_lines(global) + memory_lines(caustic))
           << clog2(static_cast<uint64_t>(line_bytes()));
  }
  // Five and more gatherers whose lists have more than 8 places, and several before an SDRAM,
  // beside whose cache there mostly is a reorder buffer, fill so much of a board's part that they
  // lie far from its dispatcher: what they give has a register more on its way, and which of them
  // gets the next query, and whether there is room for it, is known a cycle ahead.
  bool far_gatherers() const {
    return (gatherers > 4 && k > 8) || (gatherers > 1 && photon_memory == PhotonMemory::kSdram);
  }
  // Queries that a board's prefetcher (rtl/board/line_prefetcher.sv) looks at ahead, 0 for none: so
  // many that the lines of a region of the map are on their way while the one before is searched,
  // and no more than the cache before the SDRAM keeps lines for, four of it each.
  int prefetch_queries() const {
    if (gatherers == 1 || photon_memory != PhotonMemory::kSdram) return 0;
    const int lines = board_cache_bytes / line_bytes();
    return lines >= 512 ? 128 : lines >= 256 ? 64 : 0;
  }
  // Beats of candidates that may wait for each list, unless two lines are more
  // (rtl/photon_gatherer/photon_gatherer_beat_queue.sv). Room is held in all lists for each line on
  // its way, so of several lists with lines of four beats one waits while another has work: five
  // lines instead of four. Their rows are still 32, for a list of codes takes none that is too far
  // ahead.
  int queued_beats() const {
    return candidates_per_cycle > 1 && list_code_bits() != 0 && bucket == 4 * lanes ? 20 : 16;
  }
  // Reciprocals that a gatherer makes at a time (rtl/photon_gatherer/photon_gatherer_results.sv), 0
  // where results have none; else as many as sums, or more. One takes some (W + 2) / 2 + 10
  // cycles, and of few photons a sum is done earlier, in k + 1. So of several trees and lists there
  // are as many as keep up with a sum, at most as many as lists, in which queries take longest; and
  // without a leaf cache, where queries of three photons or fewer, or of four leaves or fewer, are
  // done as soon as one, two a sum.
  int reciprocals() const {
    if (reciprocal_bits == 0) return 0;
    const int of_sum = ((reciprocal_bits + 2) / 2 + 10 + k) / (k + 1);
    const int of_lists = std::min(of_sum, candidates_per_cycle);
    if (trees() > 1 && of_lists > powers_per_cycle) return of_lists;
    const bool few = k < 4 || (leaf_limit != 0 && leaf_limit <= 4);
    return cache_bytes == 0 && few && of_sum > 1 ? 2 * powers_per_cycle : powers_per_cycle;
  }
  // Words of a node memory: the maps' inner nodes by number, the caustic map's after the others.
  uint64_t node_words() const {
    return std::max<uint64_t>(
        2, (global.present ? lines(global) : 0) + (caustic.present ? lines(caustic) : 0));
  }
  // Two nodes a cycle are those of two trees or, of far gatherers, two levels of one.
  int trees() const { return far_gatherers() ? 1 : nodes_per_cycle; }
  int node_levels() const { return nodes_per_cycle / trees(); }
  int line_address_bits() const {
    return std::max(1, clog2(std::max(memory_lines(global), memory_lines(caustic))));
  }
  // Of a line request: a miss of the leaf cache, or where there is none the context that asks.
  int line_tag_bits() const {
    return std::max(1, clog2(static_cast<uint64_t>(cache_bytes ? cache_misses : contexts)));
  }
  int cache_record_bits() const { return std::max(1, clog2(static_cast<uint64_t>(cache_records))); }
  int cache_hit_bits() const { return clog2(static_cast<uint64_t>(cache_hits) + 1); }
  // W of the reciprocal of a record's squared reach.
  int cache_falloff_bits() const { return cache_weight_bits + 4; }
  int cache_falloff_exponent_bits() const { return clog2(static_cast<uint64_t>(r2_bits())); }
  // W of the shader: that of the results, 18 where they carry no reciprocal.
  int shader_bits() const { return reciprocal_bits ? reciprocal_bits : 18; }
  // Bits of flux * R * c * weight before it is rounded to the pixel.
  int contribution_bits() const { return flux_bits() + 2 * (shader_bits() + 1) + weight_bits; }
  int pixel_contribution_bits() const { return integer_bits + fraction_bits; }
  // A pixel adds the direct light, the emission, the glossy light, the caustic estimate and the
  // final gather rays of each sample.
  int pixel_sum_bits() const {
    return pixel_contribution_bits() + clog2(static_cast<uint64_t>(spp)) +
           clog2(static_cast<uint64_t>(gather_rays) + 4);
  }
  // Largest exponent of a weight at which no contribution can reach 2^(I+F).
  int weight_exponent_max() const {
    return pixel_contribution_bits() - flux_bits() - weight_bits + msb(r2_floor) - 1;
  }

  // The list of lines in plan.toml, in order: (section, key, value, smallest, largest, meaning).
  template <class Self, class Visitor>
  static void visit(Self& p, Visitor&& v) {
    v("scene", "name", p.scene, 0, 0, "for people; not part of the hash");
    v("scene", "origin", p.origin, 0, 0, "lower corner of the scene's cube, scene units");
    v("scene", "extent", p.extent, 0, 0, "edge of the scene's cube, scene units");
    v("photon", "position_bits", p.position_bits, 4, 24, "bits of each coordinate");
    v("photon", "direction_bits", p.direction_bits, 2, 14, "bits of each octahedral coordinate");
    v("photon", "mantissa_bits", p.mantissa_bits, 2, 16, "bits of each channel's mantissa");
    v("photon", "exponent_bits", p.exponent_bits, 1, 5, "bits of the shared exponent");
    v("photon", "channels", p.channels, 1, 3, "1 where all light has one colour");
    v("photon", "channel_color", p.channel_color, 0, 0, "with one channel, RGB = value * this");
    v("photon", "bucket", p.bucket, 2, 16, "photons per line, a power of two");
    v("photon", "photon_bytes", p.photon_bytes, 4, 32, "stride of a photon in a line");
    v("photon", "lines", p.photon_lines, 0, 0,
      "plain, or compressed: positions relative to the line's box");
    v("photon", "further_percent", p.further_percent, 0, 1500,
      "room for further lines of leaves whose photons do not fit in one, of the leaves");
    MapPlan::visit(p.global, in_section("global", v));
    MapPlan::visit(p.caustic, in_section("caustic", v));
    v("gather", "k", p.k, 1, 256, "photons in an estimate");
    v("gather", "normal_bits", p.normal_bits, 2, 14,
      "bits of each octahedral coordinate of a query's normal");
    v("gather", "r2_floor", p.r2_floor, 1, 0, "smallest r^2 an estimate divides by");
    v("gather", "epsilon_factor", p.epsilon_factor, 1, 65535, "E; exact when E = 2^epsilon_shift");
    v("gather", "epsilon_shift", p.epsilon_shift, 0, 15,
      "s: skip iff distance^2 * E > bound * 2^s");
    v("gather", "leaf_limit", p.leaf_limit, 0, 65535,
      "leaves visited per query at most, 0 for no limit");
    v("gather", "reciprocal_bits", p.reciprocal_bits, 0, 24,
      "W of reciprocal(r^2), 0 for none, else at least 8");
    v("gatherer", "contexts", p.contexts, 1, 64, "queries in flight");
    v("gatherer", "lanes", p.lanes, 1, 16, "distances per cycle");
    v("gatherer", "nodes_per_cycle", p.nodes_per_cycle, 1, 2, "inner nodes per cycle");
    v("gatherer", "candidates_per_cycle", p.candidates_per_cycle, 1, 4,
      "candidates per cycle that enter lists: 1, 2 or 4");
    v("gatherer", "powers_per_cycle", p.powers_per_cycle, 1, 4,
      "powers summed per cycle: 1, 2 or 4, at most candidates_per_cycle");
    v("gatherer", "cache_bytes", p.cache_bytes, 0, 1 << 20, "leaf cache");
    v("gatherer", "cache_ways", p.cache_ways, 1, 8, "its associativity");
    v("gatherer", "cache_misses", p.cache_misses, 1, 32, "misses outstanding");
    v("gatherer", "beat_bits", p.beat_bits, 32, 4096, "bits of a beat of the line port");
    v("reorder", "key", p.reorder_key, 0, 0, "none (pass-through), hilbert or hash");
    v("reorder", "drain", p.reorder_drain, 0, 0, "sweep or fullest");
    v("reorder", "packets", p.reorder_packets, 1, 1 << 16, "pool size");
    v("reorder", "bins", p.reorder_bins, 1, 4096, "a power of two");
    v("reorder", "cell_bits", p.reorder_cell_bits, 1, 7, "bits of each coordinate in the key");
    v("sampler", "cell_bits", p.cell_bits, 1, 6, "the table has 2^this x 2^this cells");
    v("sampler", "probability_bits", p.probability_bits, 4, 24, "width of a cell's weight");
    v("sampler", "u_bits", p.u_bits, 16, 48, "bits of the number that picks the cell");
    v("sampler", "v_bits", p.v_bits, 1, 12, "bits of each number that places the direction in it");
    v("sampler", "combine", p.combine, 0, 0,
      "sum, product, weighted, cosine or photons: docs/sampling.md");
    v("sampler", "levels", p.levels, 1, 7,
      "block sizes, from one cell up, over which a photon is spread");
    v("sampler", "cosine_samples", p.cosine_samples, 1, 255,
      "photons that the cosine counts as, where combine is weighted");
    v("cache", "present", p.cache_present, 0, 1, "whether samples share irradiance");
    v("cache", "records", p.cache_records, 1, 4096, "records of a tile at most");
    v("cache", "hits", p.cache_hits, 1, 8, "records in an answer at most: the heaviest");
    v("cache", "passes", p.cache_passes, 1, 2,
      "2: samples look up again when all records of their tile are known");
    v("cache", "accuracy", p.cache_accuracy, 0, 0,
      "a record reaches this times its split-sphere radius");
    v("cache", "radius", p.cache_radius, 0, 0,
      "what the split-sphere radius comes from: photons or probe");
    v("cache", "probe_rays", p.cache_probe_rays, 1, 256, "rays of a probe");
    v("cache", "radius_min", p.cache_radius_min, 0, 0,
      "smallest split-sphere radius, of the scene's extent");
    v("cache", "radius_max", p.cache_radius_max, 0, 0,
      "largest split-sphere radius, of the scene's extent");
    v("cache", "angle_bits", p.cache_angle_bits, 0, 31,
      "a record whose normal is off by sqrt(2^this) cells has no weight");
    v("cache", "weight_bits", p.cache_weight_bits, 4, 12, "fraction bits of a record's weight");
    v("cache", "glossy", p.cache_glossy, 0, 1,
      "surfaces that were reached through a glossy lobe too");
    v("cache", "gradients", p.cache_gradients, 0, 0,
      "how a record's light changes over its reach: none, rotation, translation or both");
    v("board", "gatherers", p.gatherers, 1, 16, "gatherers behind a board's dispatcher");
    v("board", "photon_memory", p.photon_memory, 0, 0,
      "where a board keeps the photon lines: block_ram or sdram");
    v("board", "cache_bytes", p.board_cache_bytes, 64, 1 << 20,
      "lines that all gatherers share before an SDRAM");
    v("board", "sdram_khz", p.sdram_khz, kSdramLeastKHz, kSdramMostKHz,
      "clock of the SDRAM and its controller");
    v("board", "refreshes_ahead", p.refreshes_ahead, 0, 255,
      "refreshes that an idle SDRAM may be ahead of those due");
    v("board", "replay_queries", p.replay_queries, 2, 65536,
      "queries that a board's replayer holds, a power of two");
    v("board", "lut_ram_words", p.lut_ram_words, 0, 1024,
      "memories of so many words at most are made of LUTs, not of block RAM");
    v("board", "shared_nodes", p.shared_nodes, 0, 1,
      "whether a node memory serves two gatherers, or one and the prefetcher");
    v("board", "parity", p.parity, 0, 1,
      "a bit for each word of photons, nodes and cached lines; results tell of wrong ones");
    v("board", "self_test", p.self_test, 0, 1,
      "whether a board asks itself stored queries after reset");
    v("frame", "width", p.width, 1, 16384, "pixels");
    v("frame", "height", p.height, 1, 16384, "pixels");
    v("frame", "spp", p.spp, 1, 1 << 20, "samples per pixel");
    v("frame", "gather_rays", p.gather_rays, 0, 65535, "final gather rays per sample");
    v("frame", "first_rays", p.first_rays, 0, 65535,
      "rays of the first of two passes, 0 for gather_rays in one");
    v("frame", "mean_rays", p.mean_rays, 1, 65535,
      "with two passes, rays per sample in the mean; gather_rays is the most");
    v("frame", "shadow_rays", p.shadow_rays, 1, 4096, "shadow rays per sample");
    v("frame", "first_shadow_rays", p.first_shadow_rays, 0, 4096,
      "shadow rays of the first of two passes, 0 for shadow_rays in one");
    v("frame", "mean_shadow_rays", p.mean_shadow_rays, 1, 4096,
      "with two passes, shadow rays per sample in the mean; shadow_rays is the most");
    v("frame", "table_photons", p.table_photons, 0, 0,
      "photons that make a sampler's table: all, or those that another surface sent (indirect)");
    v("frame", "tile", p.tile, 1, 1024, "edge of a tile in pixels");
    v("frame", "batch_tiles", p.batch_tiles, 0, 1 << 28, "tiles per batch, 0 for the whole frame");
    v("frame", "order", p.order, 0, 0, "of final gather rays: pixel, tile or direction_bins");
    v("frame", "direction_bin_bits", p.direction_bin_bits, 1, 6,
      "bits of each octahedral coordinate that name a direction bin");
    v("pixel", "weight_bits", p.weight_bits, 8, 24, "mantissa of a query's weight");
    v("pixel", "fraction_bits", p.fraction_bits, -64, 96, "F: a pixel counts 2^-F W/(m^2 sr)");
    v("pixel", "integer_bits", p.integer_bits, 1, 96, "I: integer bits of a pixel");
  }
};

}  // namespace photonloom
