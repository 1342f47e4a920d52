// SPDX-License-Identifier: Apache-2.0
#include "study/measures.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <any>
#include <cmath>
#include <map>
#include <stdexcept>

#include "golden/plan/plan_file.hpp"
#include "golden/planner/resources.hpp"
#include "golden/unit/cdf_sampler.hpp"
#include "rtl/generate/hardware.hpp"
#include "study/bounded_search.hpp"
#include "study/layout_traffic.hpp"
#include "study/ray_means.hpp"
#include "study/routed.hpp"
#include "study/traffic.hpp"

namespace photonloom {
namespace {

// Of the image that noise is measured against, twice; their seeds are far from those of frames.
constexpr int kConvergedRays = 256;
constexpr uint64_t kConvergedSeed = uint64_t{1} << 32;
constexpr int kConvergedShadowRays = 256;

// The cache's other lines as a plan has them that says nothing of it.
Plan without_cache(Plan plan) {
  const Plan usual;
  plan.cache_present = false;
  plan.cache_records = usual.cache_records;
  plan.cache_hits = usual.cache_hits;
  plan.cache_passes = usual.cache_passes;
  plan.cache_accuracy = usual.cache_accuracy;
  plan.cache_radius = usual.cache_radius;
  plan.cache_probe_rays = usual.cache_probe_rays;
  plan.cache_radius_min = usual.cache_radius_min;
  plan.cache_radius_max = usual.cache_radius_max;
  plan.cache_angle_bits = usual.cache_angle_bits;
  plan.cache_weight_bits = usual.cache_weight_bits;
  plan.cache_glossy = usual.cache_glossy;
  plan.cache_gradients = usual.cache_gradients;
  return plan;
}

// The plan with usual lines where they leave the image as it is, those of how units work; or as it
// is where no plan may have both these and the others. One for points that differ in nothing else,
// so that what they share is the same bytes whoever made it.
Plan image_plan(const Plan& of) {
  const Plan defaults;
  std::map<std::string, std::any> usual;
  Plan::visit(defaults, [&](const char* section, const char* key, const auto& value, auto, auto,
                            const char*) { usual[fmt::format("{}.{}", section, key)] = value; });
  Plan plan = of;
  Plan::visit(
      plan, [&](const std::string& section, const char* key, auto& value, auto, auto, const char*) {
        if (section == "gatherer" || section == "reorder" || section == "board")
          value = std::any_cast<std::decay_t<decltype(value)>>(
              usual.at(fmt::format("{}.{}", section, key)));
      });
  try {
    check_plan(plan);
  } catch (const PlanError&) {
    return of;
  }
  return plan;
}

}  // namespace

Plan cosine_plan(const Plan& of) {
  const Plan usual;
  Plan plan = without_cache(of);
  plan.cell_bits = usual.cell_bits;
  plan.probability_bits = usual.probability_bits;
  plan.u_bits = usual.u_bits;
  plan.v_bits = usual.v_bits;
  plan.combine = TableCombine::kCosine;
  plan.levels = usual.levels;
  plan.cosine_samples = usual.cosine_samples;
  plan.first_rays = 0;
  plan.mean_rays = usual.mean_rays;
  plan.table_photons = TablePhotons::kAll;
  return plan;
}

Plan direct_plan(const Plan& of) {
  Plan plan = cosine_plan(of);
  plan.gather_rays = 0;
  return plan;
}

PointRun::PointRun(StudyScene& scene, const Study& study, const Plan& plan, uint64_t seed,
                   std::string work_dir)
    : scene_(scene), study_(study), plan_(plan), seed_(seed), work_dir_(std::move(work_dir)) {}

void PointRun::prepare() {
  if (prepared_) return;
  for (const bool is_caustic : {false, true}) {
    const MapPlan& map = plan_.map(is_caustic);
    auto& pass = passes_[is_caustic];
    pass = std::make_shared<const PhotonPass>();
    if (map.present) {
      // The path that fills a map is stored whole, and of another seed there may be more photons
      // than the plan's lines hold.
      const uint64_t room = plan_.room(map);
      for (uint64_t stored = map.photons;;) {
        pass = scene_.photons(is_caustic, stored, seed_);
        if (pass->photons.size() <= room) break;
        stored -= std::min(stored - 1, pass->photons.size() - room);
      }
    }
    PackCounts counts;
    maps_[is_caustic] = build_photon_map(pack_photons(pass->photons, plan_, map, &counts), plan_);
    packed_.zeroed += counts.zeroed;
    packed_.saturated += counts.saturated;
  }
  prepared_ = true;
}

Image PointRun::render(const Plan& plan, Arithmetic arithmetic, FrameUnits& units,
                       FrameCounts& counts, uint64_t ray_seed) {
  prepare();
  std::unique_ptr<ReferenceGather> exact[2];
  if (arithmetic == Arithmetic::kReference)
    for (const bool is_caustic : {false, true})
      exact[is_caustic] = std::make_unique<ReferenceGather>(
          in_map_order(passes_[is_caustic]->photons, maps_[is_caustic]));
  const FrameInput input{.world = scene_.world(),
                         .caster = scene_.caster(),
                         .plan = plan,
                         .global = maps_[0],
                         .caustic = maps_[1],
                         .reference_global = exact[0].get(),
                         .reference_caustic = exact[1].get(),
                         .seed = seed_,
                         .ray_seed = ray_seed,
                         .arithmetic = arithmetic};
  return render_frame(input, units, counts);
}

const Planes& PointRun::golden() {
  if (!golden_) {
    FrameUnits units = make_golden_units(plan_);
    auto watched =
        std::make_unique<WatchedGatherer>(plan_, static_cast<size_t>(study_.gather_queries));
    WatchedGatherer& window = *watched;
    units.photon_gatherer = std::move(watched);
    const Image image = render(plan_, Arithmetic::kGolden, units, counts_, seed_);
    golden_ = std::make_unique<Planes>(planes_of(image, "", "the golden frame"));
    walks_ = std::make_unique<Planes>(planes_of(image, "emission", "the golden frame"));
    const Planes direct = planes_of(image, "direct", "the golden frame");
    for (size_t c = 0; c < 3; ++c)
      for (size_t p = 0; p < direct.c[c].size(); ++p) walks_->c[c][p] += direct.c[c][p];
    gather_counters_ = window.counters();
    watched_ = window.kept();
  }
  return *golden_;
}

const Planes& PointRun::walks() { return golden(), *walks_; }

const ConvergedFrames& PointRun::converged() {
  if (converged_) return *converged_;
  Plan plan = cosine_plan(plan_);
  plan.gather_rays = kConvergedRays;
  check_plan(plan);
  converged_ = scene_.converged(fmt::format("{} {}", plan_hash_text(plan), seed_), [&] {
    ConvergedFrames frames;
    for (uint64_t i = 0; i < 2; ++i) {
      FrameUnits units = make_golden_units(plan);
      FrameCounts counts;
      (i == 0 ? frames.b1 : frames.b2) = planes_of(
          render(plan, Arithmetic::kGolden, units, counts, kConvergedSeed + 2 * seed_ + i), "",
          "the converged frame");
    }
    frames.mean = frames.b1;
    for (size_t c = 0; c < 3; ++c)
      for (size_t p = 0; p < frames.mean.c[c].size(); ++p)
        frames.mean.c[c][p] = (frames.b1.c[c][p] + frames.b2.c[c][p]) / 2;
    return frames;
  });
  return *converged_;
}

const Planes& PointRun::reference() {
  if (!reference_) {
    const Plan plan = image_plan(plan_);
    reference_ = scene_.converged(
        fmt::format("reference arithmetic {} {}", plan_hash_text(plan), seed_), [&] {
          FrameUnits units = make_golden_units(plan);
          FrameCounts counts;
          ConvergedFrames frame;
          frame.mean = planes_of(render(plan, Arithmetic::kReference, units, counts, seed_), "",
                                 "the frame in reference arithmetic");
          return frame;
        });
  }
  return reference_->mean;
}

const FrameCounts& PointRun::counts() { return golden(), counts_; }
const Counters& PointRun::gather_counters() { return golden(), gather_counters_; }
const std::vector<GatherQuery>& PointRun::watched_queries() { return golden(), watched_; }
const PhotonMap& PointRun::map(bool is_caustic) { return prepare(), maps_[is_caustic]; }
const PackCounts& PointRun::packed() { return prepare(), packed_; }

size_t block_of(const Planes& image, size_t pixel) {
  const auto width = static_cast<size_t>(image.width), height = static_cast<size_t>(image.height);
  return pixel / width * kBlockEdge / height * kBlockEdge + pixel % width * kBlockEdge / width;
}

double root_of_squares(const Blocks& differences) {
  double sum = 0;
  for (const double d : differences) sum += d * d;
  return std::sqrt(sum);
}

Blocks half_differences(const std::vector<double>& values, int width, int height) {
  constexpr size_t kEdge = 8;
  const auto w = static_cast<size_t>(width), h = static_cast<size_t>(height);
  // Of even size, so that the halves of a cell have as many pixels, but for the last ones'.
  const size_t across = (w + 2 * kEdge - 1) / (2 * kEdge) * 2,
               down = (h + 2 * kEdge - 1) / (2 * kEdge) * 2;
  Blocks differences(kEdge * kEdge, 0.0);
  for (size_t y = 0; y < h; ++y)
    for (size_t x = 0; x < w; ++x) {
      const double v = values[y * w + x] / static_cast<double>(values.size());
      differences[y / down * kEdge + x / across] += (x + y) % 2 == 0 ? v : -v;
    }
  return differences;
}

namespace {

// The unit whose resources stand apart.
constexpr const char* kGatherer = unit_name<PhotonGatherer>;

double total(const Blocks& blocks) {
  double sum = 0;
  for (const double b : blocks) sum += b;
  return sum;
}

// Image columns: relmse, flip, bias, worst of `a` against b1 and b2, which may be the same.
Measurement image_errors(const Planes& a, const Planes& b1, const Planes& b2, const Planes& mean) {
  for (const Planes* other : {&b1, &b2, &mean}) require_same_size(a, *other);
  const size_t pixels = a.c[0].size();
  const double n = 3.0 * static_cast<double>(pixels);
  const std::vector<double> flips = hdr_flip(a, mean);
  Blocks relmse(kBlocks, 0.0), flip(kBlocks, 0.0), bias(kBlocks, 0.0);
  double sum = 0, worst = 0;
  for (size_t c = 0; c < 3; ++c)
    for (size_t p = 0; p < pixels; ++p) sum += mean.c[c][p];
  for (size_t p = 0; p < pixels; ++p) {
    const size_t block = block_of(a, p);
    flip[block] += flips[p] / static_cast<double>(pixels);
    for (size_t c = 0; c < 3; ++c) {
      const double v = a.c[c][p], b = mean.c[c][p];
      relmse[block] += (v - b1.c[c][p]) * (v - b2.c[c][p]) / (b * b + 0.01) / n;
      bias[block] += (v - b) / sum;
      worst = std::max(worst, std::fabs(v - b));
    }
  }
  Measurement m;
  m.values = {total(relmse), total(flip), total(bias), worst / (sum / n)};
  m.blocks = {{"relmse", relmse}, {"flip", flip}, {"bias", bias}};
  return m;
}

// What pixel p adds to relMSE, beside image_errors, for the noise of the camera's walks: that of
// this seed gives way to what it is in the mean. Their squared distance from their own mean is
// taken off and its expectation added. A few pixels that see a lamp in a mirror would else hide
// what plans differ in.
double walk_correction(PointRun& run, const WalkNoise& noise, size_t p) {
  const SceneReferences& r = run.scene().references();
  const Planes& walks = run.walks();
  double sum = 0;
  for (size_t c = 0; c < 3; ++c) {
    const double d = walks.c[c][p] - noise.mean.c[c][p], b = r.mean.c[c][p];
    // The mean that d is measured from has noise of its own.
    const double expected = noise.variance.c[c][p] * (1 + 1 / noise.frames);
    sum += (expected - d * d) / (b * b + 0.01);
  }
  return sum / (3.0 * static_cast<double>(walks.c[0].size()));
}

Measurement measure_visible(PointRun& run) {
  const SceneReferences& r = run.scene().references();
  Measurement m = image_errors(run.golden(), r.b1, r.b2, r.mean);
  // What is known of the walks' noise is that of one shadow ray a sample.
  if (run.plan().shadow_rays > 1) return m;
  const auto walks = run.scene().walk_noise(run.plan().spp);
  Blocks& relmse = m.blocks["relmse"];
  for (size_t p = 0; p < r.mean.c[0].size(); ++p)
    relmse[block_of(r.mean, p)] += walk_correction(run, *walks, p);
  m.values[0] = total(relmse);
  return m;
}

// The standard error of relMSE from the references' own noise alone, as the two differ. That of a
// pixel's channels is taken as one.
double reference_error(const Planes& a, const SceneReferences& r) {
  require_same_size(a, r.mean);
  double sum = 0;
  for (size_t p = 0; p < a.c[0].size(); ++p) {
    double pixel = 0;
    for (size_t c = 0; c < 3; ++c) {
      const double b = r.mean.c[c][p], d = r.b1.c[c][p] - r.b2.c[c][p], e = a.c[c][p] - b;
      pixel += std::sqrt(e * e * d * d + d * d * d * d / 4) / (b * b + 0.01) / 3;
    }
    sum += pixel * pixel;
  }
  return std::sqrt(sum) / static_cast<double>(a.c[0].size());
}

Measurement measure_lot(PointRun& run) {
  const SceneReferences& r = run.scene().references();
  const Planes& a = run.golden();
  if (run.study().frame_width == 0) return {{reference_error(a, r), 0.0}, {}};
  require_same_size(a, r.mean);
  const size_t pixels = a.c[0].size();
  const auto walks = run.scene().walk_noise(run.plan().spp);
  const bool one_shadow_ray = run.plan().shadow_rays == 1;
  std::vector<double> relmse(pixels, 0.0);
  for (size_t p = 0; p < pixels; ++p) {
    for (size_t c = 0; c < 3; ++c) {
      const double v = a.c[c][p], b = r.mean.c[c][p];
      relmse[p] += (v - r.b1.c[c][p]) * (v - r.b2.c[c][p]) / (b * b + 0.01) / 3;
    }
    if (one_shadow_ray) relmse[p] += static_cast<double>(pixels) * walk_correction(run, *walks, p);
  }
  // What the references' noise adds to how pixels differ is in it.
  const Blocks halves = half_differences(relmse, a.width, a.height),
               flip_halves = half_differences(hdr_flip(a, r.mean), a.width, a.height);
  return {{root_of_squares(halves), root_of_squares(flip_halves)},
          {{"relmse", halves}, {"flip", flip_halves}}};
}

Measurement measure_formats(PointRun& run) {
  const Planes& c = run.reference();
  Measurement m = image_errors(run.golden(), c, c, c);
  m.values.push_back(static_cast<double>(run.packed().zeroed));
  m.values.push_back(static_cast<double>(run.packed().saturated));
  return m;
}

// What points with other caches share: the frame without one.
struct Uncached {
  Planes image;
  double gathers = 0;  // samples with final gather rays
};

std::shared_ptr<const Uncached> uncached(PointRun& run) {
  const Plan plan = without_cache(run.plan());
  return run.scene().shared<Uncached>(
      fmt::format("frame without a cache {} {}", plan_hash_text(plan), run.seed()), [&] {
        PointRun without(run.scene(), run.study(), plan, run.seed(), run.work_dir());
        return Uncached{without.golden(), static_cast<double>(without.counts().table_gathers)};
      });
}

// The plan's irradiance cache beside the same frame without one.
Measurement measure_caching(PointRun& run) {
  const std::shared_ptr<const Uncached> without = uncached(run);
  const Planes& c = without->image;
  Measurement m = image_errors(run.golden(), c, c, c);
  const FrameCounts& counts = run.counts();
  const auto part = [](double a, double b) { return b > 0 ? a / b : kNoValue; };
  const double all = without->gathers;
  const double rays = all * run.plan().gather_rays;
  const double cast = (all - static_cast<double>(counts.cache_hits)) * run.plan().gather_rays +
                      static_cast<double>(counts.probe_rays);
  m.values.insert(m.values.end(), {part(static_cast<double>(counts.cache_hits), all),
                                   1 - part(cast, rays), static_cast<double>(counts.cache_records),
                                   static_cast<double>(counts.cache_most_records),
                                   static_cast<double>(counts.cache_full)});
  return m;
}

Measurement measure_noise(PointRun& run) {
  const ConvergedFrames& c = run.converged();
  Measurement m = image_errors(run.golden(), c.b1, c.b2, c.mean);
  m.values.resize(1);
  m.blocks = {{"relmse", m.blocks["relmse"]}};
  const FrameCounts& counts = run.counts();
  const double samples = static_cast<double>(counts.camera_samples);
  m.values.push_back(static_cast<double>(counts.directions) / samples);
  m.values.push_back(static_cast<double>(counts.table_gathers) / samples);
  m.values.push_back(static_cast<double>(counts.below_horizon) / samples);
  return m;
}

// A frame without final gathers.
Planes direct_frame(PointRun& run, const Plan& plan, uint64_t ray_seed, FrameCounts& counts) {
  check_plan(plan);
  FrameUnits units = make_golden_units(plan);
  return planes_of(run.render(plan, Arithmetic::kGolden, units, counts, ray_seed), "",
                   "the frame of direct light");
}

Measurement measure_shadows(PointRun& run) {
  const Plan plan = direct_plan(run.plan());
  Plan converged = plan;
  converged.shadow_rays = kConvergedShadowRays;
  converged.first_shadow_rays = 0;
  converged.mean_shadow_rays = Plan().mean_shadow_rays;
  const auto exact = run.scene().converged(
      fmt::format("shadows {} {}", plan_hash_text(converged), run.seed()), [&] {
        ConvergedFrames frames;
        FrameCounts counts;
        frames.b1 = direct_frame(run, converged, kConvergedSeed + 2 * run.seed(), counts);
        frames.b2 = direct_frame(run, converged, kConvergedSeed + 2 * run.seed() + 1, counts);
        frames.mean = frames.b1;
        for (size_t c = 0; c < 3; ++c)
          for (size_t p = 0; p < frames.mean.c[c].size(); ++p)
            frames.mean.c[c][p] = (frames.b1.c[c][p] + frames.b2.c[c][p]) / 2;
        return frames;
      });
  FrameCounts counts;
  const Planes image = direct_frame(run, plan, run.seed(), counts);
  Measurement m = image_errors(image, exact->b1, exact->b2, exact->mean);
  m.values.resize(1);
  m.blocks = {{"relmse", m.blocks["relmse"]}};
  const double samples = static_cast<double>(counts.camera_samples);
  m.values.push_back(static_cast<double>(counts.shadow_rays) / samples);
  m.values.push_back(static_cast<double>(counts.emitter_rays_cast + counts.cosine_rays_cast) /
                     samples);
  m.values.push_back(static_cast<double>(counts.emitter_rays_cast) / samples);
  return m;
}

Measurement measure_gather(PointRun& run) {
  const Counters& counted = run.gather_counters();
  const auto queries = static_cast<double>(counted.at("queries"));
  Measurement m;
  if (queries == 0 || run.watched_queries().empty()) {
    m.values.assign(measure("gather").columns.size(), kNoValue);
    return m;
  }
  const Plan& plan = run.plan();
  const GatherCost cost =
      run.study().rtl_cycles
          ? gather_cost_rtl(plan, run.map(false), run.map(true), run.watched_queries(),
                            run.study().latency, run.work_dir())
          : gather_cost_model(plan, run.map(false), run.map(true), run.watched_queries(),
                              run.study().latency);
  const auto per_query = [&](const char* name) {
    return static_cast<double>(counted.at(name)) / queries;
  };
  const FrameCounts& frame = run.counts();
  const auto tables = static_cast<double>(frame.table_gathers);
  const double sample =
      tables == 0 ? 0
                  : sampler_cycles(plan, static_cast<double>(counted.at("photons out")) / tables,
                                   plan.gather_rays);
  const double before = tables + static_cast<double>(frame.caustic_queries);
  const double frame_cycles = std::max(before * cost.cycles, tables * sample) +
                              static_cast<double>(frame.final_gathers) * cost.cycles;
  m.values = {cost.cycles,         cost.from_rtl ? 1.0 : 0.0, cost.bytes,        per_query("nodes"),
              per_query("leaves"), per_query("insertions"),   per_query("full"), cost.load.nodes,
              cost.load.leaves,    cost.load.insertions,      cost.load.misses,  sample,
              frame_cycles};
  return m;
}

Measurement measure_bounds(PointRun& run) {
  const BoundedSearch b =
      bounded_search(run.plan(), run.map(false), run.map(true), run.watched_queries());
  Measurement m;
  m.values = {b.recall, b.light, b.spread, b.spread_scaled, b.light_known, b.spread_known};
  return m;
}

Measurement measure_resources(PointRun& run) {
  const Plan& plan = run.plan();
  UnitResources all, gatherer;
  for (const std::string& unit : units_present(plan)) {
    const UnitResources r = estimate_resources(plan, unit);
    all.lut += r.lut;
    all.ff += r.ff;
    all.dsp += r.dsp;
    all.ebr += r.ebr;
    if (unit == kGatherer) gatherer = r;
  }
  const double bytes =
      static_cast<double>(plan.memory_lines(plan.global) + plan.memory_lines(plan.caustic)) *
      plan.line_bytes();
  Measurement m;
  m.values = {gatherer.lut,
              gatherer.ff,
              gatherer.dsp,
              gatherer.ebr,
              all.lut,
              all.ff,
              all.dsp,
              all.ebr,
              static_cast<double>(plan.photon_bits()),
              bytes,
              static_cast<double>(board_memories(plan).total())};
  return m;
}

Measurement measure_routed(PointRun& run) {
  const RoutedResources r = routed_gatherer(run.plan(), run.work_dir() + "/routed");
  Measurement m;
  m.values = {r.lut, r.ff, r.dsp, r.ebr, r.mhz};
  return m;
}

std::string no_settings(const Study&, const StudyScene&) { return "1"; }

}  // namespace

const std::vector<Measure>& measures() {
  static const std::vector<Measure> all = {
      {"visible",
       "error against path tracing",
       {{"relmse", "", "mean (a - b1)(a - b2) / (b^2 + 0.01)"},
        {"flip", "", "mean HDR-FLIP"},
        {"bias", "", "ratio of the means, minus 1"},
        {"worst", "", "largest difference of a pixel's channel over the mean"}},
       measure_visible,
       [](const Study&, const StudyScene& s) { return "references " + s.references().signature; }},
      {"lot",
       "standard error of visible from which pixels of a frame the film holds, and from the "
       "references",
       {{"relmse", "", "of visible.relmse"}, {"flip", "", "of visible.flip"}},
       measure_lot,
       [](const Study&, const StudyScene& s) {
         return "references " + s.references().signature + ", halves";
       }},
      {"formats",
       "error against reference arithmetic on the same photons",
       {{"relmse", "", "mean (a - c)^2 / (c^2 + 0.01)"},
        {"flip", "", "mean HDR-FLIP"},
        {"bias", "", "ratio of the means, minus 1"},
        {"worst", "", "largest difference of a pixel's channel over the mean"},
        {"zeroed", "photons", "whose power became 0"},
        {"saturated", "photons", "whose power was clipped"}},
       measure_formats,
       no_settings},
      {"caching",
       "an irradiance cache beside the same frame without one",
       {{"relmse", "", "mean (a - c)^2 / (c^2 + 0.01)"},
        {"flip", "", "mean HDR-FLIP"},
        {"bias", "", "ratio of the means, minus 1"},
        {"worst", "", "largest difference of a pixel's channel over the mean"},
        {"avoided", "", "part of the samples without a final gather of their own"},
        {"rays_saved", "",
         "part of the final gather rays that were not sent, a probe's rays counted"},
        {"records", "", "samples whose final gather others share"},
        {"most_records", "", "of a tile"},
        {"full", "samples", "that would have become a record of a full tile"}},
       measure_caching,
       no_settings},
      {"noise",
       "of final gather rays: error against the converged image of the same photons and walks",
       {{"relmse", "", "mean (a - c1)(a - c2) / (c^2 + 0.01)"},
        {"rays", "", "final gather rays a camera sample"},
        {"tables", "", "table gathers a camera sample"},
        {"below", "", "rays a camera sample that went below the horizon"}},
       measure_noise,
       [](const Study&, const StudyScene&) {
         return fmt::format("{} rays, twice", kConvergedRays);
       }},
      {"shadows",
       "of shadow rays: error of direct light against the converged one of the same walks",
       {{"relmse", "", "mean (a - c1)(a - c2) / (c^2 + 0.01)"},
        {"asked", "", "shadow rays a camera sample, of both kinds"},
        {"rays", "", "of them, those that were not known to be dark before"},
        {"emitter_rays", "", "of these, those towards an emitter"}},
       measure_shadows,
       [](const Study&, const StudyScene&) {
         return fmt::format("{} rays, twice", kConvergedShadowRays);
       }},
      {"ray_means",
       "whether final gather rays find the light that cosine-sampled ones find: 64 seeds of rays "
       "beside many times the rays",
       ray_means_columns(), measure_ray_means, ray_means_settings},
      {"gather",
       "cycles and bytes",
       {{"cycles", "cycles", "a final gather"},
        {"source", "", "1: from the RTL; 0: from the model fitted to it"},
        {"bytes", "bytes", "read at the line port a final gather"},
        {"nodes", "", "inner nodes a gather, all of the frame"},
        {"leaves", "", "leaves a gather, all of the frame"},
        {"insertions", "", "candidates that entered the list a gather, all of the frame"},
        {"found", "", "part of the gathers that found k"},
        {"sample_nodes", "", "inner nodes, of the queries that cycles are of"},
        {"sample_leaves", "", "their leaves"},
        {"sample_insertions", "", "their insertions"},
        {"sample_misses", "", "their lines that the cache had not"},
        {"table_cycles", "cycles", "a camera sample's table and directions"},
        {"frame_cycles", "cycles", "a frame"}},
       measure_gather,
       [](const Study& s, const StudyScene&) {
         return fmt::format("{} queries {} latency {} fit {}", s.rtl_cycles ? "rtl" : "model",
                            s.gather_queries, s.latency, cycle_fit_signature());
       }},
      {"bounds",
       "what epsilon and the leaf limit leave out, beside the exact search of the same queries",
       {{"recall", "", "part of the exact search's photons that is found"},
        {"light", "", "sum of the estimates over the exact ones', minus 1"},
        {"spread", "", "root mean square difference over the exact ones' root mean square"},
        {"spread_scaled", "", "the same, with one factor that makes light 0"},
        {"light_known", "", "light, with the radius cut where the search left something out"},
        {"spread_known", "", "spread, with that radius"}},
       measure_bounds,
       [](const Study& s, const StudyScene&) {
         return fmt::format("{} queries", s.gather_queries);
       }},
      {"resources",
       "logic and memory, predicted",
       {{"gatherer_lut", "LUT-equivalents", "the gatherer"},
        {"gatherer_ff", "flip-flops", "the gatherer"},
        {"gatherer_dsp", "multipliers", "the gatherer"},
        {"gatherer_ebr", "block RAMs", "the gatherer"},
        {"lut", "LUT-equivalents", "all units"},
        {"ff", "flip-flops", "all units"},
        {"dsp", "multipliers", "all units"},
        {"ebr", "block RAMs", "all units"},
        {"photon_bits", "bits", "of a photon"},
        {"map_bytes", "bytes", "lines of both maps"},
        {"board_ebr", "block RAMs", "a board's whole top"}},
       measure_resources,
       no_settings},
      {kRouted,
       "the gatherer placed and routed by the open FPGA flow, with the first seed alone",
       {{"lut", "LUT-equivalents", "the gatherer"},
        {"ff", "flip-flops", "the gatherer"},
        {"dsp", "multipliers", "the gatherer"},
        {"ebr", "block RAMs", "the gatherer"},
        {"mhz", "MHz", "Fmax of one placement"}},
       measure_routed,
       no_settings},
      {"traffic", "bytes from the photon map in the plan's order and in others", traffic_columns(),
       measure_traffic, traffic_settings},
      {"layouts", "bytes from the photon map in other layouts", layout_columns(), measure_layouts,
       layout_settings}};
  return all;
}

const Measure& measure(const std::string& name) {
  for (const Measure& m : measures())
    if (name == m.name) return m;
  throw std::logic_error("no measure " + name);
}

std::vector<std::pair<std::string, std::vector<std::string>>> measure_names() {
  std::vector<std::pair<std::string, std::vector<std::string>>> names;
  for (const Measure& m : measures()) {
    names.emplace_back(m.name, std::vector<std::string>{});
    for (const Column& c : m.columns) names.back().second.emplace_back(c.name);
  }
  return names;
}

}  // namespace photonloom
