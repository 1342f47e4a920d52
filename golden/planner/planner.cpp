// SPDX-License-Identifier: Apache-2.0
#include "golden/planner/planner.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "golden/numeric/elementary.hpp"
#include "golden/plan/quantiser.hpp"
#include "golden/unit/pack_photons.hpp"

namespace photonloom {
namespace {

// Camera paths pass mirrors and glass with at most this throughput (eta^2, roulette).
constexpr double kThroughput = 256;
// Maps up to this size are cached whole: the cache then costs less than a pool that reorders.
constexpr uint64_t kCachedMapBytes = 65536;
// Samples of a batch, some 350 bytes each on the host.
constexpr uint64_t kBatchSamples = uint64_t{1} << 20;

// Exponent of the power of two just above x > 0.
int exponent_above(double x) {
  int e;
  std::frexp(x, &e);
  return e;
}

// Smallest whole number of at least log2(x), x > 0.
int ceil_log2(double x) {
  int e;
  return std::frexp(x, &e) == 0.5 ? e - 1 : e;
}

// The colour that all photons share, its largest channel 1; nothing where they differ.
std::optional<Rgb> common_color(const PhotonPass& global, const PhotonPass& caustic) {
  std::optional<Rgb> color;
  for (const PhotonPass* pass : {&global, &caustic})
    for (const Photon& p : pass->photons) {
      const double power = max_component(p.power);
      if (!(power > 0)) continue;
      const Rgb c(p.power.x / power, p.power.y / power, p.power.z / power);
      if (!color) color = c;
      // Products of reflectances in different orders differ by roundings.
      if (max_component(glm::abs(c - *color)) > 0x1p-40) return std::nullopt;
    }
  return color;
}

// Bits of a position that are wanted beyond the default: where nearly all photons lie in a small
// part of the cube (a room on a wide ground), its units must still be small beside the distances
// between them. 16 bits have room for a part of an eighth; each halving of it takes one more.
int extra_position_bits(const PhotonPass& pass, double extent) {
  if (pass.photons.empty()) return 0;
  double spread = 0;
  std::vector<double> x(pass.photons.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (size_t i = 0; i < x.size(); ++i) x[i] = pass.photons[i].position[axis];
    const auto cut = static_cast<std::ptrdiff_t>(x.size() / 100);
    const auto low = x.begin() + cut, high = x.end() - 1 - cut;
    std::nth_element(x.begin(), low, x.end());
    if (low < high) std::nth_element(low + 1, high, x.end());
    spread = std::max(spread, *high - *low);
  }
  // One photon, or all in one place: there is no distance that units could be too large for.
  if (!(spread > 0)) return 0;
  int bits = 0;
  while (bits < 64 && std::ldexp(spread, bits + 4) <= extent) ++bits;
  return bits;
}

// Formats for a relative error that they may add to an estimate.
void choose_formats(Plan& plan, double error, double smallest_radius, PlanReasons& why) {
  const int bits = ceil_log2(1 / error);
  // As many as wanted, within the format's limits; the reason, or that they do not suffice.
  const auto choose = [error](int& line, int wanted, int fewest, int most, std::string reason) {
    line = std::clamp(wanted, fewest, most);
    return wanted > most ? fmt::format("the widest there is, too few for {:g}", error) : reason;
  };
  why["photon.position_bits"] =
      choose(plan.position_bits, ceil_log2(plan.extent / (error * smallest_radius)), 8, 24,
             fmt::format("a position unit is at most {:g} of the smallest radius, {:.4g}", error,
                         smallest_radius));
  why["photon.mantissa_bits"] = choose(plan.mantissa_bits, bits, 2, 16,
                                       fmt::format("rounds a power by at most {:g} of it", error));
  // Photons within a cell of the horizon may change sides; they carry the square of its angle.
  why["photon.direction_bits"] =
      choose(plan.direction_bits, bits / 2 + 4, 5, 14,
             fmt::format("photons within a cell of the horizon, which may change sides, carry less "
                         "than {:g}",
                         error));
  plan.normal_bits = plan.direction_bits;
  why["gather.normal_bits"] = "as photon directions";
  plan.cell_bits = std::min(plan.cell_bits, plan.direction_bits);
  why["gather.reciprocal_bits"] = why["pixel.weight_bits"] =
      choose(plan.reciprocal_bits, bits + 9, 8, 24,
             fmt::format("nine bits finer than the error of {:g}", error));
  plan.weight_bits = plan.reciprocal_bits;
}

// The maps, their counts and radii.
void choose_maps(Plan& plan, const World& world, const PlanRequest& request,
                 const PhotonPass& global, const PhotonPass& caustic, PlanReasons& why) {
  const MapsNeeded needed = maps_needed(world, request.gather_rays);
  for (const bool is_caustic : {false, true}) {
    const PhotonPass& pass = is_caustic ? caustic : global;
    const bool wanted = is_caustic ? needed.caustic : needed.global;
    MapPlan& m = is_caustic ? plan.caustic : plan.global;
    const std::string section = is_caustic ? "caustic." : "global.";
    m = MapPlan{};
    m.present = wanted && !pass.photons.empty();
    why[section + "present"] = m.present || !wanted
                                   ? (is_caustic ? needed.caustic_reason : needed.global_reason)
                                   : "no photon reached a diffuse surface";
    if (!m.present) {
      for (const char* key : {"photons", "power_exponent", "radius"})
        why[section + key] = "there is no such map";
      continue;
    }
    m.photons = pass.photons.size();
    why[section + "photons"] =
        fmt::format("stored of {} paths; the path that fills the map is stored whole", pass.paths);
    if (request.radius) {
      m.radius = *request.radius;
      why[section + "radius"] = "as asked for";
    } else {
      const double share = is_caustic ? kCausticShare : kGlobalShare;
      m.radius = default_radius(share, plan.k, world.diffuse_area(), m.photons);
      why[section + "radius"] =
          fmt::format("sqrt({} k A / (pi N)), A = {:.4g} being the surface that can hold photons",
                      share, world.diffuse_area());
    }
    m.power_exponent = choose_power_exponent(pass.photons, plan);
    why[section + "power_exponent"] = "the finest at which the largest photon fits";
  }
}

// Power that can reach the surfaces, largest channel, W: of a point or spot outside of the sphere
// around the scene no more than its intensity times the sphere's solid angle, which is at most
// pi tan^2 of the cone's half angle.
double power_at_surfaces(const World& world) {
  Rgb sum(0);
  for (const Emitter& e : world.emitters()) {
    Rgb power = e.power;
    if (e.light >= 0) {
      const Light& l = world.scene().lights[static_cast<size_t>(e.light)];
      const double r2 = world.radius() * world.radius();
      const Vec3 d = l.position - world.centre();
      const double beyond2 = glm::dot(d, d) - r2;
      const bool has_place = l.kind == LightKind::kPoint || l.kind == LightKind::kSpot;
      if (has_place && beyond2 > 0) power = glm::min(power, l.intensity * (kPi * r2 / beyond2));
    }
    sum += power;
  }
  return max_component(sum);
}

// W/(m^2 sr), of surfaces that this power falls on.
double mean_radiance(const World& world, double power) {
  const double area = world.diffuse_area() > 0 ? world.diffuse_area() : world.surface_area();
  return std::max(power / (kPi * std::max(area, 1e-290)), 1e-290);
}

// Bits of a pixel's fraction that 2^-24 of the light of all lamps takes.
int least_fraction_bits(const World& world) {
  return 24 - exponent_above(mean_radiance(world, max_component(world.emitted_power())));
}

// Formats of the pixel: F from the mean radiance of a room of this surface and power, I from a
// bound on every contribution.
void choose_pixel(Plan& plan, const World& world, const PlanRequest& request, PlanReasons& why) {
  const double mean = mean_radiance(world, power_at_surfaces(world));
  const double inverse_area = 1 / (kPi * plan.position_unit() * plan.position_unit());
  // 1/pdf of a final gather direction is at most W/w of its cell <= 2^(probability + 2a), times the
  // cell's solid angle <= 4 / 2^2a * sqrt(27).
  const double gather_weight =
      kThroughput / kPi * std::ldexp(4 * 5.1961525, plan.probability_bits) / kPi;
  plan.integer_bits = 1;
  const std::string* loaded = nullptr;  // the file whose photons take too many of them
  for (const bool is_caustic : {false, true}) {
    const MapPlan& m = plan.map(is_caustic);
    if (!m.present) continue;
    // So that weight_exponent_max() admits the largest weight.
    const int weight =
        exponent_above((is_caustic ? kThroughput / kPi : gather_weight) * inverse_area);
    plan.integer_bits = std::max(
        plan.integer_bits, weight + m.power_exponent + plan.flux_bits() - msb(plan.r2_floor) + 2);
    const std::string& file = is_caustic ? request.caustic_file : request.photon_file;
    if (plan.integer_bits > 96 && !loaded && !file.empty()) loaded = &file;
  }
  double brightest = 0;
  for (const Shape& s : world.scene().shapes)
    if (s.radiance) {
      const double texture =
          s.radiance_texture < 0
              ? 1
              : texture_max(world.scene().textures[static_cast<size_t>(s.radiance_texture)]);
      brightest = std::max(brightest, max_component(*s.radiance) * texture);
    }
  if (world.environment()) brightest = std::max(brightest, world.environment()->brightest());
  for (const Light& l : world.scene().lights) {
    if (l.kind == LightKind::kEnvironment) continue;
    const Vec3 outside =
        glm::max(glm::max(world.lower() - l.position, l.position - world.upper()), Vec3(0));
    const double nearest = l.kind == LightKind::kDirectional
                               ? 1
                               : std::max(plan.extent * 0x1p-12, glm::length(outside));
    brightest = std::max(brightest, max_component(l.intensity) / (nearest * nearest));
  }
  if (brightest > 0)
    plan.integer_bits = std::max(plan.integer_bits, exponent_above(kThroughput * brightest) + 1);
  plan.fraction_bits = 0;
  const int sum = plan.pixel_sum_bits() - plan.integer_bits;
  // A frame is refused only if it is coarse beside all light that is emitted: photons carry that.
  const double most = mean_radiance(world, max_component(world.emitted_power()));
  const int fine =
      request.format_error ? std::clamp(ceil_log2(1 / *request.format_error) + 31, 32, 48) : 40;
  const int room = plan.cache_present ? 120 : 128;  // of a pixel; find_problem says why
  const int wanted = fine - exponent_above(mean), least = least_fraction_bits(world);
  plan.fraction_bits = std::clamp(std::min(wanted, room - sum - plan.integer_bits), -64, 96);
  if (most < 0x1p-84)
    throw PlanError(fmt::format(
        "plan: pixel.fraction_bits has no value: 96 bits, the most there are, cannot hold a mean "
        "radiance of {:.3g}; expected brighter lamps",
        most));
  if (loaded)
    throw PlanError(fmt::format(
        "{}: pixel.integer_bits has no value: the largest contribution of its photons takes {} "
        "bits, at most 96 can be had; expected photons of less power",
        *loaded, plan.integer_bits));
  if (plan.integer_bits > 96)
    throw PlanError(fmt::format(
        "plan: pixel.integer_bits has no value: the largest contribution takes {} bits, at most 96 "
        "can be had, for a mean radiance of {:.3g}; expected dimmer lamps",
        plan.integer_bits, most));
  if (plan.fraction_bits < std::min(least, 96))
    throw PlanError(fmt::format(
        "plan: pixel.fraction_bits has no value: {} integer bits for the largest contribution, {} "
        "for the number of contributions and {} down to 2^-24 of the mean radiance {:.3g} exceed "
        "the {} bits of a pixel; fewer position or probability bits, or a larger r2_floor, would "
        "fit",
        plan.integer_bits, sum, least, most, room));
  why["pixel.fraction_bits"] =
      fmt::format("2^-{} of the surfaces' mean radiance, about {:.3g} W/(m^2 sr)",
                  plan.fraction_bits + exponent_above(mean), mean);
  why["pixel.integer_bits"] =
      "the largest k * power / (pi r2_floor) * weight, so that nothing overflows";
}

// Beats of plain lines before an SDRAM, from which whole photons come: of at least 128 bits where
// as many of them are taken at once, a line's, or the lanes' where there is no leaf cache between.
int sdram_beat_bits(const Plan& plan) {
  const int most = plan.cache_bytes == 0 ? plan.lanes : plan.bucket;
  int photons = 1;
  while (8 * plan.photon_bytes * photons < 128 && 2 * photons <= most) photons *= 2;
  return 8 * plan.photon_bytes * photons;
}

// The shortest compressed slot whose offsets have two thirds of a position's bits: leaves of most
// maps then fit in a line.
int compressed_photon_bytes(Plan plan) {
  for (plan.photon_bytes = 4; plan.photon_bytes < 32; ++plan.photon_bytes)
    if (plan.line_bytes() % 16 == 0 && plan.offset_bits() >= 2 * plan.position_bits &&
        plan.axis_offset_bits() >= std::max(1, plan.position_bits - plan.corner_bits()))
      break;
  return plan.photon_bytes;
}

}  // namespace

MapsNeeded maps_needed(const World& world, int gather_rays) {
  MapsNeeded needed;
  const int depth = world.scene().max_depth;
  std::string nothing;  // why there is neither
  if (!(world.diffuse_area() > 0)) nothing = "no surface has a diffuse lobe";
  if (depth >= 0 && depth < 3)
    nothing = fmt::format("paths of at most {} segments end before it", depth);
  needed.global = nothing.empty() && gather_rays > 0;
  needed.global_reason = !nothing.empty()   ? nothing
                         : gather_rays == 0 ? "no final gather rays were asked for"
                                            : "final gather rays end in it";
  needed.caustic = nothing.empty() && world.has_delta();
  needed.caustic_reason = !nothing.empty() ? nothing
                          : needed.caustic ? "mirrors or glass throw light on diffuse surfaces"
                                           : "no surface is a mirror or glass";
  return needed;
}

void check_plan_makes_an_image(const Plan& plan, const std::string& name,
                               const std::vector<std::string>& assignments) {
  if (plan.k != 1 || !(plan.global.present || plan.caustic.present)) return;
  throw_problem(PlanProblem{"gather.k",
                            "is 1, and where it finds a photon its estimate is (k-1)/k = 0; "
                            "expected k of at least 2 for an image"},
                name, assignments);
}

std::string why_pixels_are_coarse(const Plan& plan, const World& world) {
  const int least = std::min(least_fraction_bits(world), 96);
  if (plan.fraction_bits >= least) return "";
  return fmt::format(
      "pixel.fraction_bits is {}: a pixel's steps are above 2^-24 of what all lamps give, and "
      "light is lost in them; expected at least {}",
      plan.fraction_bits, least);
}

std::string why_positions_are_coarse(const Plan& plan, const PhotonPass& global) {
  const int wanted = extra_position_bits(global, plan.extent);
  // Three bits too few still make an image.
  if (wanted <= 7 || wanted + 16 - plan.position_bits <= 3) return "";
  return fmt::format(
      "nearly all photons lie within 2^-{} of scene.extent, too little for positions of {} bits: "
      "their light is blurred or lost; smaller surroundings, a scene.extent no larger than the "
      "scene, or --set photon.position_bits=24 help",
      wanted + 3, plan.position_bits);
}

double default_radius(double share, int k, double area, uint64_t photons) {
  return std::sqrt(share * static_cast<double>(k) * area / (kPi * static_cast<double>(photons)));
}

std::string bucket_reason(const Plan& plan) {
  return fmt::format("a line of {} bytes", plan.line_bytes());
}

std::string order_reason(const Plan& plan) {
  if (!plan.global.present) return "there are no final gather queries to order";
  if (plan.reorder_key == ReorderKey::kNone)
    return "rays of a tile are made together; no reorder buffer follows";
  return "the reorder buffer brings neighbours together; the frame need not";
}

PlannedFrame make_plan(const World& world, const PlanRequest& request, const PhotonPass& global,
                       const PhotonPass& caustic) {
  PlannedFrame result;
  Plan& plan = result.plan;
  PlanReasons& why = result.reasons;
  if (request.k < 1 || request.k > 256)
    throw PlanError(
        fmt::format("plan: gather.k is {}, expected an integer from 1 to 256", request.k));
  if (request.radius && !(*request.radius >= 0 && std::isfinite(*request.radius)))
    throw PlanError("plan: the radius must be a finite number of at least 0");
  if (request.format_error && !(*request.format_error > 0 && *request.format_error < 1))
    throw PlanError("plan: the error must lie between 0 and 1");

  const Scene& scene = world.scene();
  plan.scene = scene.name;
  plan.origin = {world.cube_origin().x, world.cube_origin().y, world.cube_origin().z};
  plan.extent = world.cube_extent();
  why["scene.origin"] = "around all surfaces";
  why["scene.extent"] = "the longest edge of the box around all surfaces, and a little";
  plan.k = request.k;
  plan.width = scene.film.width;
  plan.height = scene.film.height;
  plan.spp = request.spp;
  plan.gather_rays = request.gather_rays;
  why["gather.k"] = why["frame.spp"] = why["frame.gather_rays"] = "as asked for, or by default";
  why["frame.width"] = why["frame.height"] = "the film's, or as asked for";
  // What is set by hand counts from the beginning, for whatever follows from it, and at the end.
  const auto set_by_hand = [&] {
    for (const std::string& line : request.set) {
      set_plan_line(plan, line);
      why[line.substr(0, line.find('='))] = "set by hand";
    }
  };

  // Formats of photons.
  if (const auto color = common_color(global, caustic)) {
    plan.channels = 1;
    plan.channel_color = {color->x, color->y, color->z};
    why["photon.channels"] = why["photon.channel_color"] = "all photons have this one colour";
  } else if (global.photons.empty() && caustic.photons.empty()) {
    plan.channels = 1;
    why["photon.channels"] = why["photon.channel_color"] = "there are no photons";
  } else {
    why["photon.channels"] = why["photon.channel_color"] = "photons of several colours";
  }
  int octaves = 1;
  for (const PhotonPass* pass : {&global, &caustic}) {
    double smallest = std::numeric_limits<double>::infinity(), largest = 0;
    for (const Photon& p : pass->photons)
      if (const double power = max_component(p.power); power > 0) {
        smallest = std::min(smallest, power);
        largest = std::max(largest, power);
      }
    if (largest > 0)
      octaves = std::max(octaves, exponent_above(largest) - exponent_above(smallest) + 1);
  }
  // An exponent for each octave, and one because rounding may carry into the next.
  plan.exponent_bits = std::clamp(clog2(static_cast<uint64_t>(octaves) + 1), 1, 5);
  why["photon.exponent_bits"] = fmt::format("powers span {} octaves", octaves);
  // A photon of 16 bytes has room for 4 more.
  const int wanted = extra_position_bits(global, plan.extent), extra = std::min(wanted, 4);
  plan.position_bits += extra;
  why["photon.position_bits"] =
      extra > 0
          ? fmt::format("98 % of the photons lie within 2^-{} of the cube; --format-error chooses",
                        wanted + 3)
          : "default; --format-error chooses";
  why["photon.mantissa_bits"] = "default, as RGB9E5; --format-error chooses";
  why["photon.direction_bits"] = why["gather.normal_bits"] = "default; --format-error chooses";
  why["gather.reciprocal_bits"] = why["pixel.weight_bits"] =
      "default, far finer than a mantissa; --format-error chooses";
  set_by_hand();
  throw_problem(channel_problem(plan), "plan", request.set);
  choose_maps(plan, world, request, global, caustic, why);
  if (request.format_error) {
    double smallest = plan.extent;
    for (const MapPlan* m : {&plan.global, &plan.caustic})
      if (m->present && m->radius > 0) smallest = std::min(smallest, m->radius);
    choose_formats(plan, *request.format_error, smallest, why);
    set_by_hand();
    choose_maps(plan, world, request, global, caustic, why);  // power units follow from mantissas
  }
  if (plan.compressed()) {
    plan.photon_bytes = compressed_photon_bytes(plan);
    set_by_hand();
    // A part of a line is a beat.
    plan.beat_bits = 8 * plan.photon_bytes * std::min(plan.lanes, plan.bucket);
    set_by_hand();
    why["photon.photon_bytes"] =
        fmt::format("{} bits relative to the line for the {} of a position and an exponent",
                    plan.offset_bits(), 3 * plan.position_bits + plan.exponent_bits);
  } else {
    if (plan.photon_bits() > 8 * plan.photon_bytes) plan.photon_bytes = 32;
    why["photon.photon_bytes"] =
        fmt::format("{} of {} bits used", plan.photon_bits(), 8 * plan.photon_bytes);
  }
  why["photon.lines"] = "plain unless it is asked for";
  why["photon.further_percent"] = "used where photon.lines is compressed";
  why["photon.bucket"] = bucket_reason(plan);

  // The gather.
  why["gather.r2_floor"] = "photons are not known closer than one position unit";
  why["gather.epsilon_factor"] = why["gather.epsilon_shift"] = why["gather.leaf_limit"] =
      "exact search";
  why["gatherer.contexts"] = "hides the latency of the memory";
  plan.lanes = std::min(plan.lanes, plan.bucket);
  why["gatherer.lanes"] = fmt::format("a line of {} photons in {} cycles", plan.bucket,
                                      plan.bucket / std::max(1, plan.lanes));
  const auto way =
      static_cast<uint64_t>(plan.line_bytes()) * static_cast<uint64_t>(plan.cache_ways);
  const uint64_t map_bytes = (plan.memory_lines(plan.global) + plan.memory_lines(plan.caustic)) *
                             static_cast<uint64_t>(plan.line_bytes());
  const uint64_t sets =
      map_bytes <= kCachedMapBytes
          ? std::bit_ceil((map_bytes + way - 1) / way)
          : std::bit_floor(std::max<uint64_t>(1, static_cast<uint64_t>(plan.cache_bytes) / way));
  plan.cache_bytes = static_cast<int>(way * sets);
  // What no board holds says nothing of its memory: the frame is golden's and the RTL's alone.
  const bool no_board = plan.sdram_bytes() > Plan::kSdramBytes;
  if (map_bytes > kBoardBlockRamBytes && !no_board) plan.photon_memory = PhotonMemory::kSdram;
  set_by_hand();
  const bool cache_holds_maps =
      plan.cache_bytes > 0 && map_bytes > 0 && static_cast<uint64_t>(plan.cache_bytes) >= map_bytes;
  why["gatherer.cache_bytes"] = fmt::format(
      "{} lines of {} bytes{}", plan.cache_bytes / plan.line_bytes(), plan.line_bytes(),
      cache_holds_maps
          ? fmt::format(", all {} of the maps", plan.lines(plan.global) + plan.lines(plan.caustic))
          : "");
  why["gatherer.nodes_per_cycle"] = why["gatherer.candidates_per_cycle"] =
      why["gatherer.powers_per_cycle"] = "the smallest gatherer; more make it faster";
  why["gatherer.cache_ways"] = "fewer conflicts for little area";
  why["gatherer.cache_misses"] = "keeps the memory port busy";
  if (plan.photon_memory == PhotonMemory::kSdram && !plan.compressed())
    plan.beat_bits = sdram_beat_bits(plan);
  why["gatherer.beat_bits"] =
      plan.compressed() ? "a part of a line"
      : plan.beat_bits == 128
          ? "a 128-bit memory port"
          : fmt::format("whole photons of {} bytes, as they come from an SDRAM", plan.photon_bytes);

  // Reordering and the sampler.
  if (!plan.global.present || cache_holds_maps) plan.reorder_key = ReorderKey::kNone;
  why["reorder.key"] = !plan.global.present ? "there are no final gather queries to reorder"
                       : cache_holds_maps
                           ? "the leaf cache holds the maps: each line is fetched once in any order"
                           : "Hilbert-prefix bins drained by a sweep save most traffic";
  why["reorder.drain"] = "neighbouring bins follow each other";
  why["reorder.packets"] = "a pool of some tens of kilobytes";
  why["reorder.bins"] = "a bin a cell";
  why["reorder.cell_bits"] = "8 cells an axis; finer ones do not fill";
  why["sampler.cell_bits"] = fmt::format("{0} x {0} cells over the sphere", 1 << plan.cell_bits);
  why["sampler.probability_bits"] = "empty cells keep a floor of one part in 2^this";
  plan.u_bits = std::max(plan.u_bits, plan.total_bits() + 8);
  why["sampler.u_bits"] =
      fmt::format("at least 8 bits more than the {} of the total", plan.total_bits());
  why["sampler.v_bits"] = "the ray is jittered below it";
  why["sampler.combine"] =
      "keeps every direction likely that either the photon or the cosine table finds likely";
  why["sampler.levels"] = "a photon counts for its own cell alone";
  why["sampler.cosine_samples"] = "used where sampler.combine is weighted";
  for (const char* line :
       {"present", "records", "hits", "passes", "accuracy", "radius", "probe_rays", "radius_min",
        "radius_max", "angle_bits", "weight_bits", "glossy", "gradients"})
    why[std::string("cache.") + line] =
        plan.cache_present ? "by default" : "no irradiance cache unless it is asked for";
  why["board.gatherers"] = "one behind the dispatcher; more where a board has room";
  why["board.photon_memory"] =
      no_board ? fmt::format("the maps take {} KiB of an SDRAM, which has {}: no board has room",
                             plan.sdram_bytes() / 1024, Plan::kSdramBytes / 1024)
               : fmt::format("the maps have {} KiB, block RAM serves up to {}", map_bytes / 1024,
                             kBoardBlockRamBytes / 1024);
  why["board.cache_bytes"] = "used before an SDRAM: some 26 block RAMs of an LFE5U-85F";
  why["board.sdram_khz"] = "most routed tops reach it; set by hand where one reaches less, or more";
  why["board.refreshes_ahead"] = "each when it is due; set by hand where an SDRAM binds";
  why["board.replay_queries"] = "the rate of a board without its link";
  why["board.lut_ram_words"] =
      "LUTs save block RAM, which is short where several gatherers share it";
  why["board.shared_nodes"] = "a node memory each; set by hand where a board lacks block RAM";
  why["board.parity"] = "set by hand where flipped bits must be told";
  why["board.self_test"] = "set by hand where a board must try itself";

  // The frame.
  why["frame.first_rays"] = why["frame.mean_rays"] = "one pass, the same number of rays everywhere";
  why["frame.shadow_rays"] = "samples of a pixel share its shadow rays' strata";
  why["frame.first_shadow_rays"] = why["frame.mean_shadow_rays"] =
      "one pass, the same number of shadow rays everywhere";
  why["frame.table_photons"] = "tables of all photons around a point";
  why["frame.direction_bin_bits"] = "used where frame.order is direction_bins";
  why["frame.tile"] = "rays of a tile are made together";
  const uint64_t tile_samples = static_cast<uint64_t>(plan.tile) *
                                static_cast<uint64_t>(plan.tile) * static_cast<uint64_t>(plan.spp);
  const uint64_t samples = static_cast<uint64_t>(plan.width) * static_cast<uint64_t>(plan.height) *
                           static_cast<uint64_t>(plan.spp);
  plan.batch_tiles = samples <= kBatchSamples
                         ? 0
                         : static_cast<int>(std::max<uint64_t>(1, kBatchSamples / tile_samples));
  why["frame.batch_tiles"] = plan.batch_tiles == 0
                                 ? "the samples of the frame fit in the host's memory"
                                 : "about a million samples at a time in the host's memory";
  choose_pixel(plan, world, request, why);
  set_by_hand();
  why.try_emplace("frame.order", order_reason(plan));
  if (plan.cache_bytes == 0)
    for (const char* line : {"gatherer.cache_ways", "gatherer.cache_misses"})
      if (why[line] != "set by hand") why[line] = "used where gatherer.cache_bytes is not 0";
  derive_plan(plan);
  check_plan(plan, "plan", request.set);
  check_plan_makes_an_image(plan, "--k", request.set);  // by default it is more
  return result;
}

}  // namespace photonloom
