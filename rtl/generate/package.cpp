// SPDX-License-Identifier: Apache-2.0
#include "rtl/generate/package.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>

#include "golden/packet/layout.hpp"
#include "golden/plan/plan_file.hpp"
#include "golden/unit/self_test.hpp"

namespace photonloom {

std::string upper_camel(const std::string& snake) {
  std::string camel;
  bool up = true;
  for (const char c : snake) {
    if (c == '_') {
      up = true;
      continue;
    }
    camel += up ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
    up = false;
  }
  return camel;
}

std::vector<PackageConstant> package_constants(const Plan& plan) {
  std::vector<PackageConstant> list;
  const auto number = [&](const std::string& name, uint64_t value, const std::string& meaning) {
    list.push_back({upper_camel(name), "int unsigned", fmt::format("{}", value), meaning, value});
  };
#define LINE(member, meaning) number(#member, static_cast<uint64_t>(plan.member), meaning)
#define WIDTH(function, meaning) number(#function, static_cast<uint64_t>(plan.function()), meaning)
  LINE(position_bits, "bits of each coordinate");
  LINE(direction_bits, "bits of each octahedral coordinate of a photon's direction");
  LINE(mantissa_bits, "bits of each channel's mantissa");
  LINE(exponent_bits, "bits of the shared exponent");
  LINE(channels, "colour channels of a power");
  LINE(bucket, "photons in a line");
  LINE(photon_bytes, "stride of a photon in a line");
  number("lines_compressed", plan.compressed() ? 1 : 0, "0 plain, 1 compressed lines");
  number("global_present", plan.global.present, "1: there is a global map");
  number("global_photons", plan.global.photons, "its photons at most");
  number("caustic_present", plan.caustic.present, "1: there is a caustic map");
  number("caustic_photons", plan.caustic.photons, "its photons at most");
  WIDTH(max_photons, "photons of the larger map");
  WIDTH(max_lines, "lines of the larger map");
  LINE(k, "photons in an estimate");
  LINE(normal_bits, "bits of each octahedral coordinate of a query's normal");
  list.push_back({"R2Floor", fmt::format("logic [{}:0]", plan.r2_bits() - 1),
                  fmt::format("{}'d{}", plan.r2_bits(), plan.r2_floor),
                  "smallest r^2 an estimate divides by", plan.r2_floor});
  LINE(epsilon_factor, "E: skip iff distance^2 * E > bound * 2^s");
  LINE(epsilon_shift, "s of the same");
  LINE(leaf_limit, "leaves visited per query at most, 0 for no limit");
  LINE(reciprocal_bits, "W of reciprocal(r^2), 0 for none");
  LINE(contexts, "queries in flight");
  LINE(lanes, "distances per cycle");
  LINE(nodes_per_cycle, "inner nodes per cycle: trees, of far gatherers levels");
  LINE(candidates_per_cycle, "candidates per cycle: lists");
  LINE(powers_per_cycle, "powers per cycle: sums");
  LINE(cache_bytes, "leaf cache");
  LINE(cache_ways, "its associativity");
  LINE(cache_misses, "misses outstanding");
  LINE(reorder_key, "0 none (pass-through), 1 hilbert, 2 hash");
  LINE(reorder_drain, "0 sweep, 1 fullest");
  LINE(reorder_packets, "pool size P");
  LINE(reorder_bins, "bins");
  LINE(reorder_cell_bits, "bits of each coordinate in the key");
  LINE(cell_bits, "a: the table has 2^a x 2^a cells");
  LINE(probability_bits, "width of a cell's weight");
  LINE(u_bits, "bits of the number that picks the cell");
  LINE(v_bits, "bits of each number that places the direction in it");
  number("combine", static_cast<uint64_t>(plan.combine),
         "0 sum, 1 product, 2 weighted, 3 photons, 4 cosine");
  LINE(levels, "block sizes over which a photon is spread");
  LINE(cosine_samples, "photons that the cosine counts as");
  number("line_beat_bits", static_cast<uint64_t>(plan.beat_bits), "one beat of the line port");
  LINE(cache_records, "irradiance records of a tile at most");
  LINE(cache_hits, "records in an answer at most");
  LINE(cache_angle_bits, "a record whose normal is off by sqrt(2^this) cells has no weight");
  LINE(cache_weight_bits, "fraction bits of a record's weight");
  LINE(gatherers, "gatherers of a board");
  LINE(photon_memory, "of a board: 0 block RAM, 1 SDRAM");
  LINE(board_cache_bytes, "lines that a board's gatherers share before an SDRAM");
  number("sdram_kHz", static_cast<uint64_t>(plan.sdram_khz),
         "clock of an SDRAM's controller, from which its waits follow");
  LINE(refreshes_ahead, "refreshes that an idle SDRAM may be ahead of those due");
  LINE(replay_queries, "queries that a board's replayer holds");
  LINE(lut_ram_words, "memories of so many words at most are made of LUTs");
  number("shared_nodes", plan.shared_nodes,
         "1: a board's gatherers and its prefetcher share a node memory in twos");
  number("parity", plan.parity, "1: words of photons, nodes and cached lines have a parity bit");
  number("far_gatherers", plan.far_gatherers(), "1: gatherers lie far from a board's dispatcher");
  number("queued_beats", static_cast<uint64_t>(plan.queued_beats()),
         "beats of candidates that may wait for each list of a gatherer, at least");
  number("prefetch_queries", static_cast<uint64_t>(plan.prefetch_queries()),
         "queries that a board's prefetcher looks at ahead, 0 for none");
  number("reciprocals", static_cast<uint64_t>(plan.reciprocals()),
         "that a gatherer makes at a time, 0 for none");
  number("line_tag_bits", static_cast<uint64_t>(plan.line_tag_bits()), "tag of a line request");
  WIDTH(r2_bits, "squared distance");
  WIDTH(line_bits, "line number");
  WIDTH(node_words, "words of a node memory");
  WIDTH(slot_bits, "slot in a line");
  WIDTH(index_bits, "photon index");
  WIDTH(count_bits, "count of photons up to k");
  WIDTH(list_code_bits, "code of a key in a list of candidates, 0: keys are compared whole");
  WIDTH(power_bits, "one decoded channel of a power");
  WIDTH(flux_bits, "one channel of a sum of k powers");
  WIDTH(reciprocal_exponent_bits, "exponent of the reciprocal");
  WIDTH(pixel_bits, "pixel number");
  WIDTH(sample_bits, "sample of a pixel");
  WIDTH(tag_bits, "final gather ray of a sample");
  WIDTH(cell_index_bits, "cell of the table");
  WIDTH(total_bits, "sum of the table's weights");
  WIDTH(sample_direction_bits, "octahedral coordinate of a sampled direction");
  WIDTH(photon_bits, "a photon without padding");
  number("global_memory_lines", plan.memory_lines(plan.global), "lines of the global map");
  number("caustic_memory_lines", plan.memory_lines(plan.caustic), "lines of the caustic map");
  WIDTH(line_address_bits, "line of memory");
  WIDTH(record_bits, "a slot of a line without its part of the header");
  WIDTH(slot_header_bits, "a slot's part of the header");
  WIDTH(corner_bits, "a coordinate of a compressed line's corner");
  const auto offset = [&](const char* name, int bits, const char* meaning) {
    number(name, plan.compressed() ? static_cast<uint64_t>(bits) : 0, meaning);
  };
  offset("axis_offset_bits", plan.axis_offset_bits(), "least offset along a line's axis");
  offset("other_offset_bits", plan.other_offset_bits(), "least offset along its other two");
  WIDTH(cache_record_bits, "record of a tile");
  WIDTH(cache_hit_bits, "count of records in an answer");
  WIDTH(cache_falloff_bits, "W of the reciprocal of a record's squared reach");
  WIDTH(cache_falloff_exponent_bits, "its exponent");
#undef LINE
#undef WIDTH
  for_each_packet([&](auto tag) {
    using P = typename decltype(tag)::type;
    number(std::string(P::kName) + "_packet_bits",
           static_cast<uint64_t>(PacketLayout::of<P>(plan).bits()),
           fmt::format("width of {}_t", P::kName));
  });
  return list;
}

namespace {

// A board's self-test, or nothing of it.
std::string self_test_constants(const Plan& plan) {
  const SelfTest test = plan.self_test ? make_self_test(plan) : SelfTest{{0}, 0, 0};
  std::string digits;
  for (size_t i = test.words.size(); i > 0; --i)
    digits += fmt::format("{}{:08x}", i == test.words.size() ? "" : "_", test.words[i - 1]);
  return fmt::format(
      "\n  // A board's power-up self-test (docs/board.md): WRITEs, the first word lowest, and "
      "what their\n"
      "  // replay must give.\n"
      "  localparam int unsigned SelfTest = {};  // 1: there is one\n"
      "  localparam int unsigned SelfTestWords = {};\n"
      "  localparam int unsigned SelfTestResults = {};\n"
      "  localparam logic [63:0] SelfTestSignature = 64'h{:016x};\n"
      "  localparam logic [{}:0] SelfTestScript = {}'h{};\n",
      plan.self_test ? 1 : 0, test.words.size(), test.results, test.signature,
      32 * test.words.size() - 1, 32 * test.words.size(), digits);
}

}  // namespace

std::string write_package(const Plan& plan, uint64_t plan_hash) {
  throw_problem(hardware_problem(plan), "plan", {});
  std::string text = fmt::format(
      "// SPDX-License-Identifier: Apache-2.0\n"
      "// Generated from plan {0:016x}: its constants and packets. Edit the plan, not this file.\n"
      "package photonloom_pkg;\n\n"
      "  // A unit reads the constants that concern it; `map` is a word of the packets.\n"
      "  /* verilator lint_off UNUSEDPARAM */\n"
      "  /* verilator lint_off SYMRSVDWORD */\n\n"
      "  localparam logic [63:0] PlanHash = 64'h{0:016x};  // of the plan's text\n",
      plan_hash);
  for (const PackageConstant& c : package_constants(plan))
    text += fmt::format("  localparam {} {} = {};  // {}\n", c.type, c.name, c.value, c.meaning);
  for_each_packet([&](auto tag) {
    using P = typename decltype(tag)::type;
    const PacketLayout layout = PacketLayout::of<P>(plan);
    text += fmt::format(
        "\n  // {} bits; array fields are flat, element 0 lowest.\n"
        "  typedef struct packed {{\n",
        layout.bits());
    for (const FieldPlace& f : layout.fields()) {
      if (!f.present()) continue;
      const std::string size =
          f.elements > 1 ? fmt::format("{} x {} bits; ", f.elements, f.bits) : std::string();
      text += fmt::format("    logic [{}:0] {};  // {}{}{}\n", f.elements * f.bits - 1, f.name,
                          size, f.meaning, f.unit.empty() ? "" : " [" + f.unit + "]");
    }
    text += fmt::format("  }} {}_t;\n", layout.name());
  });
  text += self_test_constants(plan);
  text += "\n  /* verilator lint_on SYMRSVDWORD */\n  /* verilator lint_on UNUSEDPARAM */\n";
  return text + "endpackage\n";
}

}  // namespace photonloom
