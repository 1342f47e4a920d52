// SPDX-License-Identifier: Apache-2.0
#include "golden/plan/plan_file.hpp"

#include <fmt/core.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <sstream>
#include <type_traits>
#include <vector>

#include "golden/numeric/output_file.hpp"
#include "golden/plan/quantiser.hpp"
#include "golden/plan/toml.hpp"
#include "golden/plan/units.hpp"

namespace photonloom {
namespace {

// Enumerations are spelt as in the file, in the order of their values.
constexpr std::array<const char*, 3> kKeyNames{"none", "hilbert", "hash"};
constexpr std::array<const char*, 2> kDrainNames{"sweep", "fullest"};
constexpr std::array<const char*, 5> kCombineNames{"sum", "product", "weighted", "photons",
                                                   "cosine"};
constexpr std::array<const char*, 2> kTablePhotonsNames{"all", "indirect"};
constexpr std::array<const char*, 3> kOrderNames{"pixel", "tile", "direction_bins"};
constexpr std::array<const char*, 2> kPhotonMemoryNames{"block_ram", "sdram"};
constexpr std::array<const char*, 2> kPhotonLinesNames{"plain", "compressed"};
constexpr std::array<const char*, 2> kCacheRadiusNames{"photons", "probe"};
constexpr std::array<const char*, 4> kCacheGradientsNames{"none", "rotation", "translation",
                                                          "both"};
constexpr const auto& names_of(ReorderKey) { return kKeyNames; }
constexpr const auto& names_of(ReorderDrain) { return kDrainNames; }
constexpr const auto& names_of(TableCombine) { return kCombineNames; }
constexpr const auto& names_of(TablePhotons) { return kTablePhotonsNames; }
constexpr const auto& names_of(FrameOrder) { return kOrderNames; }
constexpr const auto& names_of(PhotonMemory) { return kPhotonMemoryNames; }
constexpr const auto& names_of(PhotonLines) { return kPhotonLinesNames; }
constexpr const auto& names_of(CacheRadius) { return kCacheRadiusNames; }
constexpr const auto& names_of(CacheGradients) { return kCacheGradientsNames; }

template <class T>
constexpr bool kIsInteger = std::is_integral_v<T> && !std::is_same_v<T, bool>;
using Triple = std::array<double, 3>;

std::string quoted(const std::string& s) {
  std::string out = "\"";
  for (const char c : s) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    } else {
      out += c;
    }
  }
  return out + '"';
}

template <class T>
std::string value_text(const T& value) {
  if constexpr (std::is_same_v<T, std::string>)
    return quoted(value);
  else if constexpr (std::is_same_v<T, bool>)
    return value ? "true" : "false";
  else if constexpr (std::is_same_v<T, double>)
    return toml_number(value);
  else if constexpr (std::is_same_v<T, Triple>)
    return fmt::format("[{}, {}, {}]", toml_number(value[0]), toml_number(value[1]),
                       toml_number(value[2]));
  else if constexpr (std::is_enum_v<T>)
    return quoted(names_of(value)[static_cast<size_t>(value)]);
  else
    return fmt::format("{}", value);
}

// What a value of this line must be.
template <class T>
std::string expectation(const T& value, uint64_t smallest, uint64_t largest, bool signed_range,
                        int64_t signed_smallest) {
  if constexpr (std::is_same_v<T, std::string>) {
    return "a string";
  } else if constexpr (std::is_same_v<T, bool>) {
    return "true or false";
  } else if constexpr (std::is_same_v<T, double>) {
    return "a finite number that is not negative";
  } else if constexpr (std::is_same_v<T, Triple>) {
    return "an array of three finite numbers";
  } else if constexpr (std::is_enum_v<T>) {
    std::string list;
    for (const char* name : names_of(value)) list += (list.empty() ? "" : ", ") + quoted(name);
    return "one of " + list;
  } else {
    const std::string from =
        signed_range ? fmt::format("{}", signed_smallest) : fmt::format("{}", smallest);
    if (largest) return fmt::format("an integer from {} to {}", from, largest);
    if (std::is_unsigned_v<T>) return fmt::format("an integer from {} to 2^63 - 1", from);
    return fmt::format("an integer of at least {}", from);
  }
}

// One line's range. A largest of 0 means none.
struct Range {
  int64_t smallest, largest;
  template <class T>
  std::string expected(const T& value) const {
    return expectation(value, static_cast<uint64_t>(std::max<int64_t>(0, smallest)),
                       static_cast<uint64_t>(std::max<int64_t>(0, largest)), smallest < 0,
                       smallest);
  }
  template <class T>
  bool holds(const T& value) const {
    if constexpr (std::is_same_v<T, double>) {
      return std::isfinite(value) && value >= 0;
    } else if constexpr (std::is_same_v<T, Triple>) {
      return std::isfinite(value[0]) && std::isfinite(value[1]) && std::isfinite(value[2]);
    } else if constexpr (std::is_enum_v<T>) {
      return static_cast<size_t>(value) < names_of(value).size();
    } else if constexpr (kIsInteger<T>) {
      if constexpr (std::is_unsigned_v<T>)
        if (value > static_cast<uint64_t>(std::numeric_limits<int64_t>::max())) return false;
      const auto v = static_cast<int64_t>(value);
      return v >= smallest && (largest == 0 || v <= largest);
    } else {
      return true;
    }
  }
};

// What C++ code wrote into r2_max alone is kept by the radius in the file.
Plan with_radius(Plan plan) {
  for (MapPlan* m : {&plan.global, &plan.caustic})
    if (m->present && radius_to_r2_max(plan, m->radius) != m->r2_max)
      m->radius = radius_for_r2_max(plan, m->r2_max);
  return plan;
}

bool power_of_two(int64_t x) { return x > 0 && (x & (x - 1)) == 0; }

// Takes a TOML value into a line; false if type or range is wrong.
template <class T>
bool take(const toml::node& node, const Range& range, T& value) {
  if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, std::string>) {
    const auto v = node.value_exact<T>();
    if (!v) return false;
    value = *v;
    return true;
  } else if constexpr (std::is_same_v<T, double>) {
    const auto v = node.value<double>();
    if (!node.is_number() || !v) return false;
    value = *v;
  } else if constexpr (std::is_same_v<T, Triple>) {
    const toml::array* a = node.as_array();
    if (!a || a->size() != 3) return false;
    for (size_t i = 0; i < 3; ++i) {
      const auto v = a->get(i)->value<double>();
      if (!a->get(i)->is_number() || !v) return false;
      value[i] = *v;
    }
  } else if constexpr (std::is_enum_v<T>) {
    const auto v = node.value_exact<std::string>();
    if (!v) return false;
    const auto& names = names_of(value);
    for (size_t i = 0; i < names.size(); ++i)
      if (*v == names[i]) {
        value = static_cast<T>(i);
        return true;
      }
    return false;
  } else {
    const auto v = node.value_exact<int64_t>();
    if (!v || *v < range.smallest || (range.largest != 0 && *v > range.largest)) return false;
    value = static_cast<T>(*v);
  }
  return range.holds(value);
}

std::string section_meaning(const std::string& section) {
  static const std::map<std::string, std::string> meanings{
      {"scene", "the cube that positions are measured in"},
      {"photon", "formats of a stored photon"},
      {"global", "the map of all photons, asked by final gather rays"},
      {"caustic", "the map of photons that reached a diffuse surface through delta surfaces"},
      {"gather", "what a gather computes"},
      {"board", "a board's top; never which packets come"},
      {"frame", "the frame in packets"},
      {"pixel", "the shader and the exact integer a pixel is"}};
  for (const UnitInfo& u : all_units())
    if (section == u.section)
      return fmt::format("the {} unit{}", u.name,
                         section == unit_info<PhotonGatherer>.section
                             ? ": changes when packets come, never which"
                             : "");
  return meanings.at(section);
}

}  // namespace

void derive_plan(Plan& plan) {
  for (MapPlan* m : {&plan.global, &plan.caustic}) m->r2_max = radius_to_r2_max(plan, m->radius);
}

double radius_for_r2_max(const Plan& plan, uint64_t r2_max) {
  if (r2_max >= plan.r2_limit()) return 0;
  double radius = plan.position_unit() * std::sqrt(static_cast<double>(r2_max) + 0.5);
  for (int step = 0; step < 64 && radius_to_r2_max(plan, radius) > r2_max; ++step)
    radius = std::nextafter(radius, 0.0);
  for (int step = 0; step < 64 && radius_to_r2_max(plan, radius) < r2_max; ++step)
    radius = std::nextafter(radius, HUGE_VAL);
  return radius;
}

namespace {

// What a compressed line's record has no room for.
std::optional<PlanProblem> cramped_record(const Plan& plan) {
  const int corner = plan.position_bits - plan.corner_bits();  // bits that it leaves out
  if (plan.axis_offset_bits() < std::max(1, corner))
    return PlanProblem{
        "photon.photon_bytes",
        fmt::format("is {}, so a compressed slot has {} bits of header, {} of directions and "
                    "mantissas, and {} for offsets, of which {} along the line's axis; expected at "
                    "least {} along it, as many as the corner leaves out",
                    plan.photon_bytes, plan.slot_header_bits(),
                    2 * plan.direction_bits + plan.channels * plan.mantissa_bits,
                    plan.offset_bits(), plan.axis_offset_bits(), std::max(1, corner))};
  const int address = plan.line_address_bits() + 1;
  const int room = plan.offset_bits() - 2 + 2 * plan.direction_bits;
  if (room < address)
    return PlanProblem{
        "photon.photon_bytes",
        fmt::format("is {}, so a compressed slot has {} bits for a line's address, which has {}",
                    plan.photon_bytes, room, address)};
  return std::nullopt;
}

}  // namespace

std::optional<PlanProblem> extent_problem(const Plan& plan) {
  if (!(plan.extent > 0)) return PlanProblem{"scene.extent", "must be greater than 0"};
  if (plan.position_unit() < 1e-150 || plan.extent > 1e150)
    return PlanProblem{"scene.extent",
                       "must lie between 1e-140 and 1e150 so that squares stay finite"};
  return std::nullopt;
}

std::optional<PlanProblem> channel_problem(const Plan& plan) {
  if (plan.channels != 1 && plan.channels != 3)
    return PlanProblem{"photon.channels", fmt::format("is {}, expected 1 or 3", plan.channels)};
  for (const double color : plan.channel_color) {
    if (color < 0) return PlanProblem{"photon.channel_color", "must not be negative"};
    if (plan.channels > 1 && color != 1)
      return PlanProblem{"photon.channel_color",
                         fmt::format("must be [1.0, 1.0, 1.0] with {} channels", plan.channels)};
  }
  if (std::ranges::max(plan.channel_color) == 0)
    return PlanProblem{"photon.channel_color", "is black, expected one part above 0"};
  return std::nullopt;
}

std::optional<PlanProblem> find_problem(const Plan& plan) {
  std::optional<PlanProblem> problem;
  Plan::visit(plan, [&](const char* section, const char* key, const auto& value, auto smallest,
                        auto largest, const char*) {
    const Range range{static_cast<int64_t>(smallest), static_cast<int64_t>(largest)};
    if (!problem && !range.holds(value))
      problem = {fmt::format("{}.{}", section, key),
                 fmt::format("is {}, expected {}", value_text(value), range.expected(value))};
  });
  if (problem) return problem;

  const auto fail = [](const char* line, std::string what) -> std::optional<PlanProblem> {
    return PlanProblem{line, std::move(what)};
  };
  if (auto wrong = extent_problem(plan)) return wrong;
  if (!power_of_two(plan.bucket))
    return fail("photon.bucket", fmt::format("is {}, expected a power of two", plan.bucket));
  if (plan.compressed()) {
    if (auto cramped = cramped_record(plan)) return cramped;
  } else if (plan.photon_bits() > 8 * plan.photon_bytes) {
    return fail("photon.photon_bytes",
                fmt::format("is {}, but a photon has 3 * {} + 2 * {} + {} * {} + {} = {} bits and "
                            "needs at least {} bytes",
                            plan.photon_bytes, plan.position_bits, plan.direction_bits,
                            plan.channels, plan.mantissa_bits, plan.exponent_bits,
                            plan.photon_bits(), (plan.photon_bits() + 7) / 8));
  }
  if (plan.line_bytes() % 16 != 0)
    return fail("photon.photon_bytes",
                fmt::format("is {}, so a line of {} photons has {} bytes, expected a multiple of "
                            "the 16 bytes of a memory beat",
                            plan.photon_bytes, plan.bucket, plan.line_bytes()));
  if (auto wrong = channel_problem(plan)) return wrong;
  for (const bool is_caustic : {false, true}) {
    const MapPlan& m = plan.map(is_caustic);
    const char* section = is_caustic ? "caustic" : "global";
    if (!m.present && m.photons != 0)
      return PlanProblem{fmt::format("{}.photons", section),
                         fmt::format("is {} in a map that is not present, expected 0", m.photons)};
  }
  if (plan.r2_floor > plan.r2_limit())
    return fail("gather.r2_floor",
                fmt::format("is {}, but squared distances of {}-bit positions end at {}",
                            plan.r2_floor, plan.position_bits, plan.r2_limit()));
  for (const bool is_caustic : {false, true})
    if (plan.map(is_caustic).present && plan.map(is_caustic).photons == 0)
      return PlanProblem{is_caustic ? "caustic.photons" : "global.photons",
                         "is 0, expected at least 1 in a map that is present"};
  for (const bool is_caustic : {false, true})
    if (plan.map(is_caustic).r2_max > plan.r2_limit())
      return PlanProblem{
          is_caustic ? "caustic.radius" : "global.radius",
          fmt::format("gives r2_max {}, but squared distances of {}-bit positions "
                      "end at {}",
                      plan.map(is_caustic).r2_max, plan.position_bits, plan.r2_limit())};
  if (plan.epsilon_factor < (1u << plan.epsilon_shift))
    return fail("gather.epsilon_factor",
                fmt::format("is {}, expected at least 2^epsilon_shift = {}: less would visit "
                            "subtrees that cannot hold a result",
                            plan.epsilon_factor, 1u << plan.epsilon_shift));
  if (plan.reciprocal_bits != 0 && plan.reciprocal_bits < 8)
    return fail("gather.reciprocal_bits",
                fmt::format("is {}, expected 0 (none) or 8 to 24", plan.reciprocal_bits));
  if (!power_of_two(plan.lanes) || plan.lanes > plan.bucket)
    return fail("gatherer.lanes",
                fmt::format("is {}, expected a power of two up to the bucket of {}", plan.lanes,
                            plan.bucket));
  for (const auto& [line, width] :
       {std::pair{"gatherer.nodes_per_cycle", plan.nodes_per_cycle},
        std::pair{"gatherer.candidates_per_cycle", plan.candidates_per_cycle},
        std::pair{"gatherer.powers_per_cycle", plan.powers_per_cycle}}) {
    if (!power_of_two(width)) return fail(line, fmt::format("is {}, expected 1, 2 or 4", width));
    if (width > plan.contexts)
      return fail(line,
                  fmt::format("is {}, expected at most gatherer.contexts = {}: each of the {} "
                              "has contexts of its own",
                              width, plan.contexts, width));
  }
  if (plan.shared_nodes && plan.nodes_per_cycle != 1)
    return fail("board.shared_nodes",
                fmt::format("is true, expected false where gatherer.nodes_per_cycle is {}: a node "
                            "memory has two ports, and a gatherer would read on one of them",
                            plan.nodes_per_cycle));
  if (plan.powers_per_cycle > plan.candidates_per_cycle)
    return fail("gatherer.powers_per_cycle",
                fmt::format("is {}, expected at most candidates_per_cycle = {}: a sum reads what "
                            "one list or more have kept",
                            plan.powers_per_cycle, plan.candidates_per_cycle));
  if (plan.cache_bytes != 0) {
    const int way = plan.line_bytes() * plan.cache_ways;
    if (plan.cache_bytes % way != 0 || !power_of_two(plan.cache_bytes / way))
      return fail("gatherer.cache_bytes",
                  fmt::format("is {}, expected {} ways of {}-byte lines times a power of two: {}, "
                              "{}, {}, ...{}",
                              plan.cache_bytes, plan.cache_ways, plan.line_bytes(), way, 2 * way,
                              4 * way, plan.compressed() ? "" : ", or 0 for none"));
  }
  if (plan.beat_bits % 8 != 0 || (8 * plan.line_bytes()) % plan.beat_bits != 0)
    return fail("gatherer.beat_bits",
                fmt::format("is {}, expected whole bytes of which a line of {} bits is a multiple",
                            plan.beat_bits, 8 * plan.line_bytes()));
  if (plan.cache_bytes == 0) {
    if (plan.compressed())
      return fail("gatherer.cache_bytes",
                  "is 0, expected a leaf cache where photon.lines is compressed: it puts a line's "
                  "header together");
    const int lanes_bits = 8 * plan.photon_bytes * plan.lanes;
    if (lanes_bits % plan.beat_bits != 0)
      return fail("gatherer.beat_bits",
                  fmt::format("is {}, expected a divisor of the {} bits that {} lanes take a "
                              "cycle, as there is no leaf cache between",
                              plan.beat_bits, lanes_bits, plan.lanes));
  }
  if (plan.photon_memory == PhotonMemory::kSdram) {
    if (plan.beat_bits % (8 * plan.photon_bytes) != 0)
      return fail("gatherer.beat_bits",
                  fmt::format("is {}, expected whole photons of {} bytes before an SDRAM",
                              plan.beat_bits, plan.photon_bytes));
    // Four ways, as rtl/board/photon_sdram.sv has.
    if (plan.board_cache_bytes < 4 * plan.line_bytes())
      return fail("board.cache_bytes", fmt::format("is {}, expected at least 4 lines of {} bytes",
                                                   plan.board_cache_bytes, plan.line_bytes()));
    if (plan.sdram_bytes() > Plan::kSdramBytes)
      return fail("board.photon_memory",
                  fmt::format("is sdram, which holds {} bytes; the maps' lines take {}",
                              Plan::kSdramBytes, plan.sdram_bytes()));
  }
  if (!power_of_two(plan.replay_queries))
    return fail("board.replay_queries",
                fmt::format("is {}, expected a power of two", plan.replay_queries));
  if (!power_of_two(plan.reorder_bins))
    return fail("reorder.bins", fmt::format("is {}, expected a power of two", plan.reorder_bins));
  if (plan.reorder_cell_bits > plan.position_bits)
    return fail("reorder.cell_bits", fmt::format("is {}, but positions have {} bits",
                                                 plan.reorder_cell_bits, plan.position_bits));
  if (plan.reorder_key == ReorderKey::kHilbert &&
      clog2(static_cast<uint64_t>(plan.reorder_bins)) > 3 * plan.reorder_cell_bits)
    return fail(
        "reorder.bins",
        fmt::format("is {}, but a Hilbert key of {} bits a coordinate names only {} bins",
                    plan.reorder_bins, plan.reorder_cell_bits, 1u << (3 * plan.reorder_cell_bits)));
  if (plan.cell_bits > plan.direction_bits)
    return fail(
        "sampler.cell_bits",
        fmt::format("is {}, but a photon's cell is the top bits of its direction, which has "
                    "only {} a coordinate",
                    plan.cell_bits, plan.direction_bits));
  if (plan.levels > plan.cell_bits + 1)
    return fail("sampler.levels",
                fmt::format("is {}, but {} x {} cells have only {} block sizes", plan.levels,
                            1 << plan.cell_bits, 1 << plan.cell_bits, plan.cell_bits + 1));
  {
    const int room = plan.combine == TableCombine::kWeighted ? 56 : 64;
    if (plan.spread_power_bits() > room)
      return fail("sampler.levels",
                  fmt::format("is {}, and {} bits of a cell's power become {} bits, expected at "
                              "most {}",
                              plan.levels, plan.cell_power_bits(), plan.spread_power_bits(), room));
  }
  if (plan.direction_bin_bits > plan.sample_direction_bits())
    return fail("frame.direction_bin_bits",
                fmt::format("is {}, but a sampled direction has {} bits a coordinate",
                            plan.direction_bin_bits, plan.sample_direction_bits()));
  if (plan.u_bits < plan.total_bits() + 8)
    return fail("sampler.u_bits",
                fmt::format("is {}, expected at least 8 bits more than the table's total, which "
                            "has {}",
                            plan.u_bits, plan.total_bits()));
  if (plan.cache_present && plan.cache_angle_bits > 2 * plan.normal_bits + 2)
    return fail("cache.angle_bits",
                fmt::format("is {}, but squared distances of normals with {} bits a coordinate "
                            "end below 2^{}",
                            plan.cache_angle_bits, plan.normal_bits, 2 * plan.normal_bits + 2));
  if (plan.cache_present && plan.first_rays > 0)
    return fail("cache.present",
                fmt::format("is true, but with frame.first_rays = {} the rays of a frame follow "
                            "each sample's own noise; expected frame.first_rays = 0",
                            plan.first_rays));
  if (plan.cache_radius_min > plan.cache_radius_max)
    return fail("cache.radius_min", fmt::format("is {}, expected at most radius_max = {}",
                                                plan.cache_radius_min, plan.cache_radius_max));
  if (plan.first_rays > 0) {
    if (plan.first_rays % 2 != 0)
      return fail("frame.first_rays",
                  fmt::format("is {}, expected an even number: its halves tell the noise",
                              plan.first_rays));
    if (plan.mean_rays < plan.first_rays || plan.mean_rays > plan.gather_rays)
      return fail("frame.mean_rays",
                  fmt::format("is {}, expected from first_rays, {}, to gather_rays, {}",
                              plan.mean_rays, plan.first_rays, plan.gather_rays));
  }
  if (plan.first_shadow_rays > 0) {
    if (plan.first_shadow_rays % 2 != 0)
      return fail("frame.first_shadow_rays",
                  fmt::format("is {}, expected an even number: its halves tell the noise",
                              plan.first_shadow_rays));
    if (plan.mean_shadow_rays < plan.first_shadow_rays || plan.mean_shadow_rays > plan.shadow_rays)
      return fail("frame.mean_shadow_rays",
                  fmt::format("is {}, expected from first_shadow_rays, {}, to shadow_rays, {}",
                              plan.mean_shadow_rays, plan.first_shadow_rays, plan.shadow_rays));
  }
  if (plan.contribution_bits() > 127)
    return fail(
        "pixel.weight_bits",
        fmt::format("is {}, but flux {} bits + reciprocal {} + constant {} + weight {} = {} "
                    "bits and the shader's product has room for 127",
                    plan.weight_bits, plan.flux_bits(), plan.shader_bits() + 1,
                    plan.shader_bits() + 1, plan.weight_bits, plan.contribution_bits()));
  if (plan.pixel_contribution_bits() < 1)
    return fail("pixel.integer_bits",
                fmt::format("is {}, with {} fraction bits a pixel has no bits at all",
                            plan.integer_bits, plan.fraction_bits));
  if (plan.pixel_sum_bits() > 128)
    return fail("pixel.integer_bits",
                fmt::format("is {}, but integer {} + fraction {} + {} bits for {} samples of {} "
                            "final gather rays = {} bits and a pixel has room for 128",
                            plan.integer_bits, plan.integer_bits, plan.fraction_bits,
                            plan.pixel_sum_bits() - plan.pixel_contribution_bits(), plan.spp,
                            plan.gather_rays, plan.pixel_sum_bits()));
  if (plan.cache_present && plan.pixel_sum_bits() > 120)
    return fail("pixel.integer_bits",
                fmt::format("is {}, but a pixel of {} bits and 8 bits for the throughput that a "
                            "record's light is multiplied with exceed 128 bits",
                            plan.integer_bits, plan.pixel_sum_bits()));
  return std::nullopt;
}

std::optional<PlanProblem> hardware_problem(const Plan& plan) {
  if (plan.node_words() <= kNodeAddresses) return std::nullopt;
  const bool is_caustic = plan.caustic.present && plan.caustic.photons > plan.global.photons;
  return PlanProblem{
      is_caustic ? "caustic.photons" : "global.photons",
      fmt::format("is {}, so the maps have {} lines of {} photons, expected at most {} in "
                  "hardware: fewer photons or a larger photon.bucket",
                  plan.map(is_caustic).photons, plan.node_words(), plan.bucket, kNodeAddresses)};
}

std::optional<PlanProblem> board_problem(const Plan& plan) {
  if (auto problem = hardware_problem(plan)) return problem;
  const uint64_t words = (plan.memory_lines(plan.global) + plan.memory_lines(plan.caustic)) *
                         static_cast<uint64_t>(plan.line_bytes()) / 4;
  if (words >= kLinkWords)
    return PlanProblem{
        "board.photon_memory",
        fmt::format("is {}, and the maps' lines take {} words of 32 bits, expected fewer than the "
                    "{} that a board's link has addresses for",
                    value_text(plan.photon_memory), words, kLinkWords)};
  if (plan.photon_memory != PhotonMemory::kBlockRam || plan.beat_bits % 32 == 0)
    return std::nullopt;
  return PlanProblem{"gatherer.beat_bits",
                     fmt::format("is {}, expected a multiple of 32 where a board has its photons "
                                 "in block RAM, which is written by words of 32 bits",
                                 plan.beat_bits)};
}

void check_plan(const Plan& plan) { check_plan(plan, "plan", {}); }

void check_plan(const Plan& plan, const std::string& file,
                const std::vector<std::string>& assignments) {
  throw_problem(find_problem(plan), file, assignments);
}

void throw_problem(const std::optional<PlanProblem>& problem, const std::string& file,
                   const std::vector<std::string>& assignments) {
  if (!problem) return;
  std::string where = file;
  for (size_t i = 0; i < assignments.size(); ++i)
    where += (i == 0 ? " with --set " : ", ") + assignments[i];
  for (const std::string& one : assignments)
    if (one.substr(0, one.find('=')) == problem->line) where = fmt::format("--set: '{}'", one);
  throw PlanError(fmt::format("{}: {} {}", where, problem->line, problem->what));
}

namespace {

// Each line's value as the file spells it.
std::map<std::string, std::string> line_values(const Plan& plan) {
  std::map<std::string, std::string> values;
  Plan::visit(plan, [&](const std::string& section, const std::string& key, const auto& value, auto,
                        auto, const char*) { values[section + "." + key] = value_text(value); });
  return values;
}

}  // namespace

bool may_be_left_out(const std::string& line) {
  static const std::set<std::string> kLines{"cache.present",
                                            "cache.records",
                                            "cache.hits",
                                            "cache.passes",
                                            "cache.accuracy",
                                            "cache.radius",
                                            "cache.probe_rays",
                                            "cache.radius_min",
                                            "cache.radius_max",
                                            "cache.angle_bits",
                                            "cache.weight_bits",
                                            "cache.glossy",
                                            "cache.gradients",
                                            "board.sdram_khz",
                                            "board.refreshes_ahead",
                                            "board.shared_nodes",
                                            "board.parity",
                                            "board.self_test",
                                            "photon.lines",
                                            "photon.further_percent",
                                            "gatherer.nodes_per_cycle",
                                            "gatherer.candidates_per_cycle",
                                            "gatherer.powers_per_cycle",
                                            "sampler.levels",
                                            "sampler.cosine_samples",
                                            "frame.first_rays",
                                            "frame.mean_rays",
                                            "frame.shadow_rays",
                                            "frame.first_shadow_rays",
                                            "frame.mean_shadow_rays",
                                            "frame.table_photons",
                                            "frame.order",
                                            "frame.direction_bin_bits"};
  return kLines.count(line) != 0;
}

uint64_t plan_hash(const Plan& plan) {
  static const std::map<std::string, std::string> kDefault = line_values(Plan{});
  uint64_t hash = 0xcbf29ce484222325ull;
  const Plan written = with_radius(plan);
  Plan::visit(written, [&](const std::string& section, const std::string& key, const auto& value,
                           auto, auto, const char*) {
    const std::string line = section + "." + key, text = value_text(value);
    if (line == "scene.name" || (may_be_left_out(line) && text == kDefault.at(line))) return;
    for (const char c : line + "=" + text + "\n") {
      hash ^= static_cast<unsigned char>(c);
      hash *= 0x100000001b3ull;
    }
  });
  return hash;
}

std::string plan_hash_text(const Plan& plan) { return fmt::format("{:016x}", plan_hash(plan)); }

std::string plan_text(const Plan& plan, const PlanReasons& reasons) {
  std::string text = fmt::format(
      "# Photonloom plan: one hardware configuration, completely. Lines may be edited; "
      "docs/plan.md "
      "has those that may be left out.\n");
  std::string current;
  const Plan written = with_radius(plan);
  Plan::visit(written, [&](const std::string& section, const std::string& key, const auto& value,
                           auto, auto, const char* meaning) {
    if (section != current) {
      text += fmt::format("\n# {}\n[{}]\n", section_meaning(section), section);
      current = section;
    }
    const auto reason = reasons.find(section + "." + key);
    const std::string line = fmt::format("{} = {}", key, value_text(value));
    text += fmt::format("{:<30} # {}{}\n", line, meaning,
                        reason == reasons.end() ? "" : ": " + reason->second);
  });
  return text;
}

PlanReasons kept_reasons(const std::string& text, const Plan& from, const Plan& to) {
  std::vector<std::string> lines;
  std::istringstream rest(text);
  for (std::string line; std::getline(rest, line);) lines.push_back(line);
  const toml::table table = parse_toml(text);
  // What stands behind a value as its comment, without '#' and blanks. Columns count characters.
  const auto comment_of = [&](const std::string& section, const std::string& key) -> std::string {
    const toml::node* node = table[section][key].node();
    if (!node) return "";
    const toml::source_position end = node->source().end;
    const std::string& line = lines.at(end.line - 1);
    size_t behind = 0;
    for (size_t column = 1; behind < line.size(); ++behind)
      if ((static_cast<unsigned char>(line[behind]) & 0xc0) != 0x80 && column++ == end.column)
        break;
    const size_t mark = line.find_first_not_of(" \t", behind);
    if (mark == std::string::npos || line[mark] != '#') return "";
    const size_t begin = line.find_first_not_of("# \t", mark);
    return begin == std::string::npos
               ? ""
               : line.substr(begin, line.find_last_not_of(" \t\r") + 1 - begin);
  };
  std::map<std::string, std::string> values = line_values(from);
  PlanReasons kept;
  Plan::visit(to, [&](const std::string& in, const std::string& key, const auto& value, auto, auto,
                      const std::string& meaning) {
    const std::string name = in + "." + key;
    std::string comment = comment_of(in, key);
    if (values[name] != value_text(value) || comment.empty() || comment == meaning) return;
    if (comment.starts_with(meaning + ": ")) comment.erase(0, meaning.size() + 2);
    kept[name] = comment;
  });
  return kept;
}

Plan parse_plan(const std::string& text, const std::string& file) {
  if (text.find_first_not_of(" \t\r\n") == std::string::npos)
    throw PlanError(fmt::format("{}: is empty, expected a plan", file));
  toml::table table;
  try {
    table = parse_toml(text, file);
  } catch (const toml::parse_error& error) {
    throw PlanError(fmt::format("{}:{}: not TOML: {}", file, error.source().begin.line,
                                std::string(error.description())));
  }
  // Every node that the plan knows, so that the rest can be named.
  std::map<std::string, std::set<std::string>> known;
  std::map<std::string, unsigned> lines;
  Plan plan;
  Plan::visit(plan, [&](const std::string& section, const std::string& key, auto&, auto, auto,
                        const char*) { known[section].insert(key); });
  for (const auto& [section, node] : table) {
    const std::string name(section.str());
    const unsigned line = section.source().begin.line;
    if (!known.count(name)) {
      std::string list;
      for (const auto& [s, keys] : known) list += (list.empty() ? "" : ", ") + s;
      throw PlanError(fmt::format("{}:{}: unknown {} '{}', expected one of the sections {}", file,
                                  line, node.is_table() ? "section" : "key", name, list));
    }
    if (!node.is_table())
      throw PlanError(
          fmt::format("{}:{}: '{}' must be a section, written [{}]", file, line, name, name));
    for (const auto& [key, value] : *node.as_table()) {
      const std::string k(key.str());
      if (!known[name].count(k)) {
        std::string list;
        for (const std::string& s : known[name]) list += (list.empty() ? "" : ", ") + s;
        throw PlanError(fmt::format("{}:{}: unknown key {}.{}, expected one of {}", file,
                                    key.source().begin.line, name, k, list));
      }
      lines[name + "." + k] = key.source().begin.line;
    }
  }
  Plan::visit(plan, [&](const char* section, const char* key, auto& value, auto smallest,
                        auto largest, const char* meaning) {
    const Range range{static_cast<int64_t>(smallest), static_cast<int64_t>(largest)};
    const bool optional = may_be_left_out(std::string(section) + "." + key);
    const toml::table* keys = table[section].as_table();
    if (optional && (!keys || !keys->get(key))) return;
    if (!keys) throw PlanError(fmt::format("{}: section [{}] is missing", file, section));
    const toml::node* node = keys->get(key);
    if (!node)
      throw PlanError(fmt::format("{}:{}: {}.{} is missing ({}), expected {}", file,
                                  keys->source().begin.line, section, key, meaning,
                                  range.expected(value)));
    if (!take(*node, range, value))
      throw PlanError(fmt::format("{}:{}: {}.{} is {}, expected {}", file,
                                  node->source().begin.line, section, key, toml_text(*node),
                                  range.expected(value)));
  });
  derive_plan(plan);
  if (const auto problem = find_problem(plan)) {
    const auto line = lines.find(problem->line);
    throw PlanError(
        line == lines.end()
            ? fmt::format("{}: {} {}; the file leaves it out", file, problem->line, problem->what)
            : fmt::format("{}:{}: {} {}", file, line->second, problem->line, problem->what));
  }
  return plan;
}

Plan read_plan(const std::string& path) { return parse_plan(read_file(path), path); }

void write_plan(const Plan& plan, const std::string& path, const PlanReasons& reasons) {
  check_plan(plan);
  write_file(path, plan_text(plan, reasons));
}

void set_plan_line(Plan& plan, const std::string& assignment) {
  const size_t equals = assignment.find('=');
  const size_t dot = assignment.find('.');
  if (equals == std::string::npos || dot == std::string::npos || dot > equals)
    throw PlanError(fmt::format("'{}': expected section.key=value", assignment));
  const std::string line = assignment.substr(0, equals), text = assignment.substr(equals + 1);
  bool found = false;
  Plan::visit(plan, [&](const std::string& section, const std::string& key, auto& value,
                        auto smallest, auto largest, const char*) {
    if (section + "." + key != line) return;
    found = true;
    using T = std::remove_cvref_t<decltype(value)>;
    const Range range{static_cast<int64_t>(smallest), static_cast<int64_t>(largest)};
    constexpr bool is_text = std::is_enum_v<T> || std::is_same_v<T, std::string>;
    bool taken = false;
    try {
      const bool bare = is_text && (text.empty() || text.front() != '"');
      const toml::table one = parse_toml("x = " + (bare ? quoted(text) : text));
      taken = one.size() == 1 && take(*one.get("x"), range, value);
    } catch (const toml::parse_error&) {
    }
    if (!taken)
      throw PlanError(fmt::format("'{}': {} is '{}', expected {}", assignment, line, text,
                                  range.expected(value)));
  });
  if (!found) {
    const std::string section = line.substr(0, dot);
    std::string keys, sections, last;
    Plan::visit(plan,
                [&](const std::string& s, const std::string& key, auto&, auto, auto, const char*) {
                  if (s == section) keys += (keys.empty() ? "" : ", ") + key;
                  if (s != last) sections += (sections.empty() ? "" : ", ") + s;
                  last = s;
                });
    throw PlanError(fmt::format("'{}': the plan has no line {}, expected one of the {} {}",
                                assignment, line, keys.empty() ? "sections" : "keys of " + section,
                                keys.empty() ? sections : keys));
  }
  derive_plan(plan);
}

std::vector<std::string> plan_line_words(const std::string& line) {
  std::vector<std::string> words;
  Plan plan;
  Plan::visit(plan, [&](const std::string& section, const std::string& key, auto& value, auto, auto,
                        const char*) {
    using T = std::remove_cvref_t<decltype(value)>;
    if (section + "." + key != line) return;
    if constexpr (std::is_enum_v<T>)
      words.assign(names_of(value).begin(), names_of(value).end());
    else if constexpr (std::is_same_v<T, bool>)
      words = {"false", "true"};
  });
  return words;
}

}  // namespace photonloom
