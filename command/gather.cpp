// SPDX-License-Identifier: Apache-2.0
// photonloom gather: the k nearest photons of points, so that anyone can check the gather.
#include <fmt/core.h>
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "command/command.hpp"
#include "command/console.hpp"
#include "command/frame_options.hpp"
#include "command/tell.hpp"
#include "golden/numeric/elementary.hpp"
#include "golden/numeric/output_file.hpp"
#include "golden/plan/plan_file.hpp"
#include "golden/plan/quantiser.hpp"
#include "golden/planner/plan_fit.hpp"
#include "golden/unit/pack_photons.hpp"
#include "golden/unit/photon_file.hpp"
#include "golden/unit/photon_gatherer.hpp"
#include "golden/unit/reference_gather.hpp"

namespace photonloom {
namespace {

using Json = nlohmann::ordered_json;

constexpr size_t kChunk = 4096;  // queries answered and written at a time

struct GatherOptions {
  std::string photons, queries, output, plan, arithmetic = "golden", kernel = "flat";
  int k = 50;
  double radius = 0;
  std::vector<std::string> set;
  ThreadsOption threads;
};

// An integer of a field of `bits` bits: a decimal string where a double might not hold it.
Json integer(uint64_t value, int bits) {
  return bits > 53 ? Json(std::to_string(value)) : Json(value);
}

Json rgb(const Rgb& c) { return {c.x, c.y, c.z}; }

// What all of a run's answers share.
struct Job {
  Plan plan;
  PhotonFile file;
  std::vector<QueryPoint> queries;
  PhotonMap map;
  PackCounts pack_counts;
  double unit2 = 1;  // a squared position unit in scene units
};

// Lines that no gather reads do not matter here.
bool is_unread(const std::string& line) {
  const std::string section = line.substr(0, line.find('.'));
  const std::vector<std::string> unread{"caustic", "reorder", "sampler", "cache",
                                        "board",   "frame",   "pixel"};
  return line == "scene.name" || line == "gather.reciprocal_bits" ||
         std::find(unread.begin(), unread.end(), section) != unread.end();
}

// Throws PlanError where lines of --set make a plan that no plan file may be.
void check_lines(Plan plan) {
  // A map of no photons can be gathered from; in a plan it is not present.
  for (MapPlan* map : {&plan.global, &plan.caustic}) map->present = map->photons > 0;
  derive_plan(plan);
  if (const auto problem = find_problem(plan); problem && !is_unread(problem->line))
    throw PlanError(fmt::format("--set: {} {}", problem->line, problem->what));
}

Job prepare(const GatherOptions& o) {
  Job job;
  Plan& plan = job.plan;
  job.file = read_photon_file(o.photons);
  job.queries = read_query_file(o.queries);
  if (!o.plan.empty()) plan = read_plan(o.plan);
  for (const std::string& line : o.set) set_plan_line(plan, line);
  plan.k = o.k;
  Cube cube{Vec3(plan.origin[0], plan.origin[1], plan.origin[2]), plan.extent};
  const auto all_in = [&] {
    return std::all_of(job.file.photons.begin(), job.file.photons.end(),
                       [&](const Photon& p) { return holds(cube, p.position); }) &&
           std::all_of(job.queries.begin(), job.queries.end(),
                       [&](const QueryPoint& q) { return holds(cube, q.position); });
  };
  if (!o.plan.empty()) {
    if (!all_in())
      throw std::runtime_error(
          fmt::format("{}: a photon or a query lies outside this plan's cube", o.plan));
  } else {
    if (job.file.cube) cube = *job.file.cube;
    if (!job.file.cube || !all_in()) cube = cube_around(job.file.photons, job.queries);
    plan.origin = {cube.origin.x, cube.origin.y, cube.origin.z};
    plan.extent = cube.extent;
    if (const auto problem = extent_problem(plan))
      throw std::runtime_error(
          fmt::format("{}: its photons and the queries of {} lie in a cube {} wide; its edge {}",
                      o.photons, o.queries, plan.extent, problem->what));
  }
  MapPlan& map = plan.global;
  map.present = true;
  map.photons = job.file.photons.size();
  map.radius = o.radius;
  map.r2_max = radius_to_r2_max(plan, o.radius);
  if (o.plan.empty()) map.power_exponent = choose_power_exponent(job.file.photons, plan);
  plan.caustic = map;
  if (!o.set.empty()) check_lines(plan);
  if (o.arithmetic == "golden" && !channels_hold(plan, job.file.photons))
    throw std::runtime_error(
        fmt::format("{}: photon.channels is 1, but photons of {} have other colours than "
                    "photon.channel_color; expected 3",
                    o.plan.empty() ? "--set" : o.plan, o.photons));
  const std::vector<PackedPhoton> packed =
      pack_photons(job.file.photons, plan, map, &job.pack_counts);
  job.map = build_photon_map(packed, plan);
  job.unit2 = plan.position_unit() * plan.position_unit();
  return job;
}

void gather_golden(const Job& job, OutputFile& out, const ProgressPhase& phase) {
  const Plan& plan = job.plan;
  const PhotonMap empty = build_photon_map({}, plan);
  const auto unit = make_golden_photon_gatherer(plan);
  unit->load(job.map, empty);
  const double power_unit = std::ldexp(1.0, plan.global.power_exponent);
  for (size_t begin = 0; begin < job.queries.size(); begin += kChunk) {
    const size_t end = std::min(begin + kChunk, job.queries.size());
    std::vector<GatherQuery> in;
    for (size_t i = begin; i < end; ++i) {
      GatherQuery query{};
      query.want_photons = 1;
      query.position = quantise_position(plan, job.queries[i].position);
      const OctCode normal = oct_encode(job.queries[i].normal, plan.normal_bits);
      query.normal = {normal.u, normal.v};
      in.push_back(query);
    }
    std::vector<GatherResult> results;
    std::vector<GatherPhoton> photons;
    unit->process(in, results, photons);
    size_t next = 0;
    for (size_t i = 0; i < in.size(); ++i) {
      const GatherResult& r = results[i];
      Json line;
      line["query"] = begin + i;
      line["position"] = in[i].position;
      line["normal"] = in[i].normal;
      line["count"] = r.count;
      line["full"] = r.full != 0;
      line["r2"] = integer(r.r2, plan.r2_bits());
      line["r2_scene"] = static_cast<double>(r.r2) * job.unit2;
      Json units = Json::array();
      Rgb flux(0);
      for (int c = 0; c < plan.channels; ++c)
        units.push_back(integer(r.flux[static_cast<size_t>(c)], plan.flux_bits()));
      for (int c = 0; c < 3; ++c) {
        const size_t channel = plan.channels == 3 ? static_cast<size_t>(c) : 0;
        flux[c] = static_cast<double>(r.flux[channel]) * power_unit;
        if (plan.channels == 1) flux[c] *= plan.channel_color[static_cast<size_t>(c)];
      }
      line["flux"] = rgb(flux);
      line["flux_units"] = std::move(units);
      const double c = r.full ? static_cast<double>(plan.k - 1) / plan.k : 1.0;
      line["irradiance"] =
          rgb(flux * (c / (kPi * static_cast<double>(std::max(r.r2, plan.r2_floor)) * job.unit2)));
      Json numbers = Json::array(), indices = Json::array(), d2 = Json::array();
      for (uint32_t j = 0; j < r.count; ++j, ++next) {
        numbers.push_back(job.map.source[photons[next].index]);
        indices.push_back(photons[next].index);
        d2.push_back(integer(photons[next].d2, plan.r2_bits()));
      }
      line["photons"] = std::move(numbers);
      line["indices"] = std::move(indices);
      line["d2"] = std::move(d2);
      line["nodes"] = r.nodes;
      line["leaves"] = r.leaves;
      line["insertions"] = r.insertions;
      out.write(line.dump());
      out.write("\n");
    }
    phase.advance(end - begin);
  }
}

void gather_reference(const Job& job, const GatherOptions& o, OutputFile& out,
                      const ProgressPhase& phase) {
  const ReferenceGather gather(in_map_order(job.file.photons, job.map));
  const Kernel kernel = o.kernel == "flat" ? Kernel::kFlat : Kernel::kEpanechnikov;
  const double infinity = std::numeric_limits<double>::infinity();
  const double r2_max = o.radius > 0 ? o.radius * o.radius : infinity;
  for (size_t begin = 0; begin < job.queries.size(); begin += kChunk) {
    const size_t end = std::min(begin + kChunk, job.queries.size());
    std::vector<std::string> lines(end - begin);
    tbb::parallel_for(tbb::blocked_range<size_t>(begin, end), [&](const auto& range) {
      std::vector<ReferenceNeighbour> found;
      for (size_t i = range.begin(); i < range.end(); ++i) {
        const QueryPoint& query = job.queries[i];
        gather.find(query.position, query.normal, o.k, r2_max, found);
        const double r2 = ReferenceGather::radius2(found, o.k, r2_max);
        Json line;
        line["query"] = i;
        line["count"] = found.size();
        line["full"] = found.size() == static_cast<size_t>(o.k);
        // JSON has no infinity: null.
        line["r2"] = std::isfinite(r2) ? Json(r2 / job.unit2) : Json(nullptr);
        line["r2_scene"] = std::isfinite(r2) ? Json(r2) : Json(nullptr);
        line["flux"] = rgb(gather.flux(found));
        // The floor that golden has, r2_floor position units, keeps coincident photons finite.
        line["irradiance"] = rgb(gather.irradiance(
            found, o.k, r2_max, static_cast<double>(job.plan.r2_floor) * job.unit2, kernel));
        Json numbers = Json::array(), d2 = Json::array();
        for (const ReferenceNeighbour& n : found) {
          numbers.push_back(job.map.source[n.index]);
          d2.push_back(n.d2);
        }
        line["photons"] = std::move(numbers);
        line["d2_scene"] = std::move(d2);
        lines[i - begin] = line.dump() + "\n";
      }
    });
    for (const std::string& line : lines) out.write(line);
    phase.advance(end - begin);
  }
}

const Shortcut kDecided[] = {{"--k", {"gather.k"}},
                             {"--radius", {"global.radius", "caustic.radius"}},
                             {"--photons", {"global.photons", "global.present"}}};

// Refuses a line of --set that no gather reads. Lines of the gatherer stay: others are valid only
// beside theirs.
void refuse_without_effect(const std::string& line, const GatherOptions& o) {
  const std::string name = line.substr(0, line.find('='));
  const bool of_the_points =
      name == "scene.origin" || name == "scene.extent" || name == "global.power_exponent";
  if (of_the_points && o.plan.empty())
    throw UsageError(fmt::format("--set {}: without --plan, photons and queries decide it", line));
  if (is_unread(name)) throw UsageError(fmt::format("--set {}: has no effect on a gather", line));
  // Units of positions alone, and what makes room for them.
  const std::vector<std::string> of_reference{"scene.origin",         "scene.extent",
                                              "photon.position_bits", "photon.photon_bytes",
                                              "gatherer.beat_bits",   "gather.r2_floor"};
  if (o.arithmetic == "reference" &&
      std::find(of_reference.begin(), of_reference.end(), name) == of_reference.end())
    throw UsageError(
        fmt::format("--set {}: has no effect on a gather with --arithmetic reference", line));
}

void gather(const GatherOptions& o) {
  o.threads.apply();
  if (o.kernel != "flat" && o.arithmetic == "golden")
    throw UsageError("--kernel epanechnikov needs --arithmetic reference: golden's kernel is flat");
  check_set_lines(o.set);
  for (const Shortcut& shortcut : kDecided) refuse_decided(o.set, shortcut);
  check_set_values(o.set);
  for (const std::string& line : o.set) refuse_without_effect(line, o);
  check_outputs({o.output}, {o.photons, o.queries, o.plan});
  const Job job = prepare(o);
  OutputFile out(o.output);
  ConsoleProgress progress;
  {
    const ProgressPhase phase(&progress, "gather", job.queries.size(), "queries");
    if (o.arithmetic == "golden") {
      gather_golden(job, out, phase);
    } else {
      gather_reference(job, o, out, phase);
    }
  }
  out.commit();
  const Plan& plan = job.plan;
  tell(
      "{} queries, {} photons; position unit {} = {} / 2^{}, cube from ({}, {}, {}); power "
      "unit 2^{} W; {} photons became zero, {} saturated\n",
      job.queries.size(), job.file.photons.size(), plan.position_unit(), plan.extent,
      plan.position_bits, plan.origin[0], plan.origin[1], plan.origin[2],
      plan.global.power_exponent, job.pack_counts.zeroed, job.pack_counts.saturated);
}

void add_gather(CLI::App& app) {
  auto o = std::make_shared<GatherOptions>();
  CLI::App* c =
      app.add_subcommand("gather", "The k nearest photons of points, to check the gather");
  c->footer(
      "Reads photons (PLY vertices x y z, dx dy dz to where the light came from, power_r power_g\n"
      "power_b in W; what `photonloom photons` writes, or any tool) and queries (PLY vertices x y "
      "z,\n"
      "nx ny nz); float or double, ASCII or binary. Directions need not have unit length.\n"
      "A photon is a candidate if it is within the radius and direction . normal > 0; the answer "
      "is\n"
      "the k nearest candidates, ties by index, the photon's address in the built map.\n"
      "Writes one JSON object a line and query:\n"
      "  count, full     photons found; whether they are k\n"
      "  r2, r2_scene    squared distance of the k-th, else of the radius; in position units\n"
      "                  squared (golden: an exact integer) and in scene units squared. Without a\n"
      "                  radius and k photons: golden the largest r2 there is, reference null\n"
      "  flux            sum of the photons' power, W; golden also flux_units, exact integers\n"
      "  irradiance      flux c / (pi max(r2, r2_floor)), W per unit^2; c = (k-1)/k if full, else "
      "1\n"
      "  photons         numbers of the photons in the file from 0, nearest first\n"
      "  golden          position, normal (as quantised), indices, d2 of each photon, and what "
      "the\n"
      "                  search visited: nodes, leaves, insertions\n"
      "  reference       d2_scene of each photon\n"
      "Integers of fields wider than 53 bits are decimal strings.\n"
      "Golden works in the default formats (16-bit positions in the file's cube, or where it has\n"
      "none or a query is outside, in the smallest cube around all points), or in --plan's; --set\n"
      "changes a line of it that a gather reads.\n\n"
      "Example: photonloom gather --photons map.ply --queries q.ply --k 50 -o out.jsonl\n"
      "         photonloom gather --photons map.ply --queries q.ply --k 8 --radius 0.1\n"
      "                    --set photon.position_bits=20 -o out.jsonl");
  c->add_option("--photons", o->photons, "Photons (PLY)")->required()->type_name("FILE");
  c->add_option("--queries", o->queries, "Points that ask (PLY)")->required()->type_name("FILE");
  c->add_option("-o,--output", o->output, "JSON lines to write")->required()->type_name("FILE");
  c->add_option("--k", o->k, "Photons in an estimate")
      ->check(CLI::Range(1, 256))
      ->capture_default_str()
      ->type_name("K");
  c->add_option("--radius", o->radius, "Maximum radius in scene units, 0 for none")
      ->check(radius_number())
      ->capture_default_str()
      ->type_name("R");
  c->add_option("--arithmetic", o->arithmetic,
                "golden: exact integers in the plan's formats; reference: doubles")
      ->check(CLI::IsMember({"golden", "reference"}))
      ->capture_default_str();
  c->add_option("--kernel", o->kernel,
                "Of the irradiance: flat, or (reference only) epanechnikov, 2 (1 - d^2/r^2)")
      ->check(CLI::IsMember({"flat", "epanechnikov"}))
      ->capture_default_str();
  c->add_option("--plan", o->plan,
                "Formats and cube from this plan; k and radius are still the options'")
      ->type_name("PLAN");
  c->add_option("--set", o->set, "Change a line of the plan: section.key=value")
      ->type_name("LINE")
      ->allow_extra_args(false);
  o->threads.add_to(*c);
  c->callback([o] { gather(*o); });
}

const Command gather_command(45, add_gather);

}  // namespace
}  // namespace photonloom
