// SPDX-License-Identifier: Apache-2.0
// The load that gatherers are measured with, photons and final-gather queries of a scene; what a
// gather costs as golden counts it; and the measurement.
#pragma once
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "golden/numeric/octahedral.hpp"
#include "golden/numeric/output_file.hpp"
#include "golden/plan/quantiser.hpp"
#include "golden/transport/world.hpp"
#include "golden/unit/backend.hpp"
#include "golden/unit/pack_photons.hpp"
#include "rtl/generate/data_files.hpp"
#include "verilator_tb/rig/number_options.hpp"
#include "verilator_tb/unit/backends.hpp"

namespace photonloom {

// What both benches are told.
struct LoadOptions {
  std::string scene = data_dir() + "/scenes/cornell.xml", json, work = "build/cosim";
  uint64_t seed = 1;
  int size = 48, samples = 1, rays = 16;

  // `scene_option` as for CLI11: with dashes an option, else an argument.
  void add_to(CLI::App& app, const std::string& scene_option) {
    app.add_option(scene_option, scene, "Scene file.");
    app.add_option("--size", size, "Pixels along each edge.");
    app.add_option("--samples", samples, "Samples a pixel.")->check(CLI::PositiveNumber);
    app.add_option("--gather-rays", rays, "Final gather rays a sample.");
    add_seed_option(app, seed, "Seed.");
    app.add_option("--json", json, "Write the table here too.");
    app.add_option("--work", work, "Folder of Verilated models.");
  }
};

// Final-gather queries in a frame's order, pixel, sample, ray: cosine-distributed rays from what
// the camera sees.
inline std::vector<GatherQuery> final_gather_queries(const World& world, const RayCaster& caster,
                                                     const Plan& plan, const LoadOptions& o) {
  std::vector<GatherQuery> queries;
  const auto gather = [&](int px, int py, uint32_t sample) {
    const auto pixel = static_cast<uint32_t>(py * o.size + px);
    const CameraSample x = trace_camera(world, caster, px, py, sample, o.seed);
    if (!x.diffuse) return;
    const Vec3 n = x.x.normal;
    const Vec3 side = glm::normalize(std::fabs(n.x) < 0.5 ? glm::cross(n, Vec3(1, 0, 0))
                                                          : glm::cross(n, Vec3(0, 1, 0)));
    const Vec3 up = glm::cross(n, side);
    // Stratified in both coordinates of the unit disk's polar map; within the strata each sample
    // has its own place, that of the first in their middle (steps of the golden and the plastic
    // ratio).
    const int edge = static_cast<int>(std::sqrt(static_cast<double>(o.rays)));
    double whole;
    const double along = std::modf(0.5 + sample * 0.6180339887498949, &whole),
                 around = std::modf(0.5 + sample * 0.7548776662466927, &whole);
    for (int ray = 0; ray < o.rays; ++ray) {
      const double u = (ray % edge + along) / edge, v = (ray / edge % edge + around) / edge;
      const double r = std::sqrt(u), phi = 2 * 3.14159265358979323846 * v;
      const Vec3 direction = glm::normalize(side * (r * std::cos(phi)) + up * (r * std::sin(phi)) +
                                            n * std::sqrt(1 - u));
      const GatherSample y = trace_gather(world, caster, x.x, direction, pixel, sample,
                                          static_cast<uint64_t>(ray), o.seed);
      if (!y.diffuse) continue;
      GatherQuery q{};
      q.pixel = pixel;
      q.sample = sample;
      q.tag = static_cast<uint32_t>(ray);
      q.position = quantise_position(plan, y.y.position);
      const OctCode code = oct_encode(y.y.normal, plan.normal_bits);
      q.normal = {code.u, code.v};
      queries.push_back(q);
    }
  };
  for (int py = 0; py < o.size; ++py)
    for (int px = 0; px < o.size; ++px)
      for (int sample = 0; sample < o.samples; ++sample)
        gather(px, py, static_cast<uint32_t>(sample));
  return queries;
}

// The queries in the order in which golden's reorder buffer lets them go.
inline std::vector<GatherQuery> reordered(const Plan& plan, std::vector<GatherQuery> queries) {
  GatherQuery flush{};
  flush.flush = 1;
  queries.push_back(flush);
  std::vector<GatherQuery> ordered;
  make_golden_reorder_buffer(plan)->process(queries, ordered);
  ordered.pop_back();
  return ordered;
}

class SceneGathers {
 public:
  explicit SceneGathers(const LoadOptions& o)
      : options_(o), world_(scene(o)), caster_(make_double_bvh(world_)) {}

  // At least `count`: a path is stored to its end.
  std::vector<Photon> photons(uint64_t count) const {
    return trace_global_photons(world_, *caster_, count, options_.seed).photons;
  }
  // `count` of them: a path that would overfill the map is cut.
  std::vector<Photon> stored_photons(uint64_t count) const {
    std::vector<Photon> stored = photons(count);
    if (stored.size() > count) stored.resize(count);
    return stored;
  }
  std::vector<GatherQuery> queries(const Plan& plan) const {
    return final_gather_queries(world_, *caster_, plan, options_);
  }
  // A plan of the scene's cube, of a map of `count` photons whose powers are those of `photons`,
  // and of the frame; the rest as it comes.
  Plan plan(const std::vector<Photon>& photons, uint64_t count) const {
    Plan plan;
    plan.origin = {world_.cube_origin().x, world_.cube_origin().y, world_.cube_origin().z};
    plan.extent = world_.cube_extent();
    plan.global = {.present = true, .photons = count};
    plan.global.power_exponent = choose_power_exponent(photons, plan);
    plan.global.r2_max = plan.caustic.r2_max = plan.r2_limit();  // no radius
    plan.width = plan.height = options_.size;
    plan.gather_rays = options_.rays;
    return plan;
  }

 private:
  static Scene scene(const LoadOptions& o) {
    Scene scene = load_scene(o.scene);
    scene.film.width = scene.film.height = o.size;
    return scene;
  }
  LoadOptions options_;
  World world_;
  std::unique_ptr<RayCaster> caster_;
};

// Means over the queries, as golden counts, and the cycles that a gatherer's busiest port needs.
struct GatherMeans {
  double nodes = 0, leaves = 0, insertions = 0, bound = 0;
};

inline GatherMeans gather_means(const Plan& plan, std::span<const GatherResult> results,
                                size_t queries) {
  GatherMeans cost;
  for (const GatherResult& r : results) {
    cost.nodes += r.nodes;
    cost.leaves += r.leaves;
    cost.insertions += r.insertions;
  }
  for (double* sum : {&cost.nodes, &cost.leaves, &cost.insertions})
    *sum /= static_cast<double>(queries);
  cost.bound = std::max({cost.nodes / plan.nodes_per_cycle, cost.leaves * plan.bucket / plan.lanes,
                         cost.insertions / plan.candidates_per_cycle,
                         (plan.k + 1.0) / plan.powers_per_cycle});
  return cost;
}

// The map alone, without a caustic one.
inline std::vector<GatherResult> golden_gathers(const Plan& plan, const PhotonMap& map,
                                                std::span<const GatherQuery> queries) {
  PhotonMap none;
  none.bucket = plan.bucket;
  std::vector<GatherResult> results;
  std::vector<GatherPhoton> photons;
  const auto golden = make_golden_photon_gatherer(plan);
  golden->load(map, none);
  golden->process(queries, results, photons);
  return results;
}

// The mean of what golden finds as the k-th photon's squared distance.
inline uint64_t mean_r2(const Plan& plan, const PhotonMap& map,
                        std::span<const GatherQuery> queries) {
  double sum = 0;
  for (const GatherResult& r : golden_gathers(plan, map, queries)) sum += static_cast<double>(r.r2);
  return static_cast<uint64_t>(sum / static_cast<double>(queries.size()));
}

struct GatherRun {
  size_t queries = 0;
  GatherMeans cost;
  double cycles = 0;              // of a gather, fill and drain included
  double cycles_per_second = 0;   // of the simulation
  Counters counters, before;      // after the queries, and before them
  std::vector<QueueFill> queues;  // where RunOptions::watch_queues asks for them

  double counted(const char* name) const {
    return static_cast<double>(counters.at(name) - before.at(name));
  }
  // What every row has of a run.
  nlohmann::json row() const {
    return {{"queries", queries},    {"nodes", cost.nodes},
            {"leaves", cost.leaves}, {"insertions", cost.insertions},
            {"bound", cost.bound},   {"cycles_per_gather", cycles}};
  }
};

// `in` goes into the RTL, whose results must be golden's of `order`, which is `in` or, where the
// RTL reorders, what comes of it. `queries` of them are none that flush.
inline GatherRun run_gathers(ClockedPhotonGatherer& rtl, const Plan& plan, const PhotonMap& map,
                             std::span<const GatherQuery> in, std::span<const GatherQuery> order,
                             size_t queries) {
  const std::vector<GatherResult> expected = golden_gathers(plan, map, order);
  PhotonMap none;
  none.bucket = plan.bucket;
  rtl.load(map, none);
  GatherRun run;
  run.queries = queries;
  run.cost = gather_means(plan, expected, queries);
  run.before = rtl.counters();
  const uint64_t first = rtl.cycles();
  const auto start = std::chrono::steady_clock::now();
  std::vector<GatherResult> results;
  std::vector<GatherPhoton> photons;
  rtl.process(in, results, photons);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (results != expected || !photons.empty())
    throw std::runtime_error(fmt::format("k = {}: RTL and golden differ", plan.k));
  const auto cycles = static_cast<double>(rtl.cycles() - first);
  run.cycles = cycles / static_cast<double>(queries);
  run.cycles_per_second = cycles / seconds;
  run.counters = rtl.counters();
  run.queues = rtl.queue_fills();
  return run;
}

// Writes the rows where they are asked for, names the goals that were missed; the exit status.
inline int report(const std::string& bench, const LoadOptions& o, const nlohmann::json& rows,
                  const std::vector<std::string>& missed) {
  if (!o.json.empty()) write_file(o.json, nlohmann::json{{bench, rows}}.dump(2) + "\n");
  for (const std::string& miss : missed) fmt::print(stderr, "{}: goal missed: {}\n", bench, miss);
  return missed.empty() ? 0 : 1;
}

// The command line of a bench, then `run`; the exit status.
template <class Run>
int bench_program(CLI::App& app, int argc, char** argv, Run run) {
  check_values(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    return run();
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}

}  // namespace photonloom
