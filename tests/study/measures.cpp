// SPDX-License-Identifier: Apache-2.0
// Means, standard errors and ratios over seeds; the noise of camera walks in visible error; points
// of a hypercube; results as text.
#include <algorithm>
#include <cmath>
#include <set>

#include "golden/numeric/random.hpp"
#include "study/collector.hpp"
#include "study/error_model.hpp"
#include "study/measures.hpp"
#include "study/plan_search.hpp"
#include "study/point_plan.hpp"
#include "study/points.hpp"
#include "tests/catch.hpp"
#include "tests/command/run.hpp"

using namespace photonloom;

namespace {

// Nearly normal, variance 1.
double noise(uint64_t seed, uint64_t i, uint64_t j) {
  double sum = 0;
  for (uint64_t n = 0; n < 12; ++n) sum += to_unit(hash_bits(seed, i, j, n));
  return sum - 6;
}

// relmse of a point: each block a mean of its own and noise of every seed; `shared` of it is the
// baseline's too.
Result made(uint64_t trial, uint64_t seed, double scale, double shared, uint64_t which) {
  Result r;
  r.key = {"s", "p", seed};
  Measurement& m = r.measures["visible"].figures;
  m.values = {0, 0, 0, 0};
  Blocks blocks(kBlocks);
  for (size_t j = 0; j < blocks.size(); ++j) {
    const double common = noise(trial, seed, j),
                 own = noise(trial + 1000000 * which, seed, j + 100);
    blocks[j] = scale * (1 + static_cast<double>(j % 5)) *
                (1 + 0.1 * (shared * common + std::sqrt(1 - shared * shared) * own));
    m.values[0] += blocks[j];
  }
  m.blocks["relmse"] = blocks;
  return r;
}

}  // namespace

TEST_CASE("stated standard errors are what means over other seeds show") {
  double error2 = 0, ratio_error2 = 0, sum = 0, sum2 = 0, ratio_sum = 0, ratio_sum2 = 0;
  const int trials = 400;
  for (int t = 0; t < trials; ++t) {
    std::vector<Result> point, baseline;
    for (const uint64_t seed : {1, 2, 3}) {
      point.push_back(made(static_cast<uint64_t>(t), seed, 2, 0.8, 1));
      baseline.push_back(made(static_cast<uint64_t>(t), seed, 1, 0.8, 2));
    }
    const Mean m = means_of(point, baseline).at("visible.relmse");
    error2 += m.error * m.error;
    ratio_error2 += m.ratio_error * m.ratio_error;
    sum += m.mean;
    sum2 += m.mean * m.mean;
    ratio_sum += m.ratio;
    ratio_sum2 += m.ratio * m.ratio;
  }
  const double n = trials;
  const double spread = std::sqrt((sum2 - sum * sum / n) / (n - 1));
  const double ratio_spread = std::sqrt((ratio_sum2 - ratio_sum * ratio_sum / n) / (n - 1));
  CHECK(std::sqrt(error2 / n) == Approx(spread).epsilon(0.15));
  CHECK(std::sqrt(ratio_error2 / n) == Approx(ratio_spread).epsilon(0.15));
  CHECK(ratio_sum / n == Approx(2).epsilon(0.01));
  // The same seeds: the ratio knows more than the two means do.
  CHECK(ratio_spread / 2 < spread / (sum / n));
}

TEST_CASE("the baseline's ratio to itself is one, without error") {
  std::vector<Result> point;
  for (const uint64_t seed : {1, 2, 3}) point.push_back(made(5, seed, 1, 0.5, 1));
  const Mean m = means_of(point, point).at("visible.relmse");
  CHECK(m.ratio == 1);
  CHECK(m.ratio_error == 0);
  CHECK(m.error > 0);
}

TEST_CASE("a Latin hypercube takes each part of each line once") {
  const std::vector<LineChoice> choices = {
      {"gather.k", {}, 1, 20, true, false},
      {"radius_scale", {}, 0.5, 2.0, false, true},
      {"gatherer.lanes", {"1", "2", "4", "8"}, 0, 0, true, false}};
  const auto points = latin_hypercube(choices, 20, 3);
  REQUIRE(points.size() == 20);
  std::set<std::string> ks;
  std::map<std::string, int> lanes;
  std::set<int> parts;
  for (const LineValues& p : points) {
    ks.insert(p[0].second);
    ++lanes[p[2].second];
    parts.insert(static_cast<int>(20 * std::log(std::stod(p[1].second) / 0.5) / std::log(4.0)));
  }
  CHECK(ks.size() == 20);
  CHECK(parts.size() == 20);
  for (const char* v : {"1", "2", "4", "8"}) CHECK(lanes[v] == 5);
  CHECK(points == latin_hypercube(choices, 20, 3));
  CHECK(points != latin_hypercube(choices, 20, 4));
}

TEST_CASE("a result reads back as it was written, and any changed byte is seen") {
  Result r = made(1, 2, 1, 0, 1);
  r.measures["visible"].settings = "references 0123";
  r.measures["gather"].figures.values = {std::nan(""), 0.1};
  r.seconds = 1.25;
  const std::string text = result_text(r);
  const Result back = parse_result(text);
  CHECK(result_text(back) == text);
  CHECK(back.key == r.key);
  CHECK(back.measures.at("visible").figures.blocks == r.measures.at("visible").figures.blocks);
  CHECK(std::isnan(back.measures.at("gather").figures.values[0]));
  for (size_t i = 0; i < text.size(); ++i) {
    std::string damaged = text;
    damaged[i] = static_cast<char>(damaged[i] ^ 4);
    CHECK_THROWS_AS(parse_result(damaged), std::runtime_error);
    CHECK_THROWS_AS(parse_result(text.substr(0, i)), std::runtime_error);
  }
}

TEST_CASE("the error's model learns which lines cost error, and knows how well") {
  Plan base;
  base.global = {true, 65536, 0, 0.1, 0};
  // A scene that has noise of few global photons, blur, and positions that round; nothing else.
  const auto truth = [&](const Plan& p) {
    const double area = p.k / 50.0 * 65536 / static_cast<double>(p.global.photons);
    return 0.6 + 0.1 * 65536 / static_cast<double>(p.global.photons) + 0.3 * area +
           0.05 * std::ldexp(1.0, 2 * (10 - p.position_bits)) / area;
  };
  const auto made = [&](int k, uint64_t photons, int bits) {
    Plan p = base;
    p.k = k;
    p.global.photons = photons;
    p.global.radius =
        base.global.radius * std::sqrt(k / 50.0 * 65536 / static_cast<double>(photons));
    p.position_bits = bits;
    return p;
  };
  const auto sample = [&](const Plan& p) {
    return ErrorSample{error_terms(p, base),
                       {std::log2(p.k), std::log2(static_cast<double>(p.global.photons)),
                        static_cast<double>(p.position_bits)},
                       truth(p)};
  };
  std::vector<ErrorSample> samples;
  for (const Plan& p : {base, made(8, 65536, 16), made(50, 8192, 16), made(8, 8192, 16),
                        made(50, 65536, 10), made(16, 16384, 12), made(24, 8192, 16),
                        made(50, 12000, 16), made(24, 65536, 10), made(16, 65536, 11)})
    samples.push_back(sample(p));
  const ErrorModel model(samples);
  // Of what it has seen and of what lies between.
  for (const Plan& p : {base, made(8, 8192, 16), made(12, 16384, 16), made(24, 32768, 11)}) {
    const ErrorSample s = sample(p);
    CHECK(model.predict(s.terms, s.place) == Approx(s.error).epsilon(0.05));
  }
  CHECK(model.cross_validated() > 0);
  CHECK(model.cross_validated() < 0.25);
  for (const double part : model.parts(samples[3].terms)) CHECK(part >= 0);
  // Worse lines never help.
  const auto predicted = [&](const Plan& p) {
    const ErrorSample s = sample(p);
    return model.predict(s.terms, s.place);
  };
  CHECK(predicted(made(8, 8192, 9)) > predicted(made(8, 8192, 12)));
  CHECK(predicted(made(8, 2048, 16)) > predicted(made(8, 8192, 16)));
}

TEST_CASE("the bound of a run is above what nineteen of twenty runs have") {
  // Errors of runs of a frame; the measured mean is off by its own standard error.
  const double truth = 0.01, run_error = 0.001, pixel_error = 0.0005;
  const int seeds = 6, trials = 4000;
  int above = 0;
  for (uint64_t t = 0; t < trials; ++t) {
    MeasuredError e;
    e.mean = truth + pixel_error * noise(t, 1, 1) + run_error / std::sqrt(seeds) * noise(t, 2, 1);
    e.seed_error = run_error / std::sqrt(seeds);
    e.pixel_error = pixel_error;
    e.seeds = seeds;
    above += truth + run_error * noise(t, 3, 1) > e.bound() ? 1 : 0;
  }
  CHECK(above > 0.03 * trials);
  CHECK(above < 0.07 * trials);
}

TEST_CASE("halves of a film by lot tell the variance of its mean") {
  // A smooth picture, and noise of which the variance is known; odd sizes too.
  for (const auto& [width, height] : {std::pair(64, 64), std::pair(37, 50)}) {
    const auto pixels = static_cast<size_t>(width * height);
    double told = 0;
    for (uint64_t trial = 0; trial < 40; ++trial) {
      std::vector<double> values(pixels);
      for (size_t p = 0; p < pixels; ++p)
        values[p] = 2 + std::sin(0.05 * static_cast<double>(p % static_cast<size_t>(width))) +
                    0.5 * noise(trial, p, 3);
      for (const double d : half_differences(values, width, height)) told += d * d / 40;
    }
    INFO(width << "x" << height);
    CHECK(told == Approx(0.25 / static_cast<double>(pixels)).epsilon(0.1));
  }
}

TEST_CASE("visible error is in the mean over seeds that of the frames as they are") {
  Study study;
  study.scenes = {test::source("scenes/cornell.xml")};
  study.width = study.height = 16;
  study.seeds = {1};
  study.reference_spp = 128;
  study.base = {
      {"photons", "2000"}, {"gather.k", "8"}, {"frame.spp", "16"}, {"frame.gather_rays", "2"}};
  const test::Scratch scratch;
  StudyScene scene(study.scenes[0], study);
  scene.load_references(study, scratch / "references", nullptr);
  const Plan plan = plan_of_point(scene, study, {}).plan;
  const SceneReferences& r = scene.references();
  constexpr uint64_t kSeeds = 32;
  double visible = 0, sum = 0, squares = 0;
  for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
    PointRun run(scene, study, plan, seed, scratch / "work");
    const Planes& a = run.golden();
    double plain = 0;
    for (size_t c = 0; c < 3; ++c)
      for (size_t p = 0; p < a.c[c].size(); ++p) {
        const double v = a.c[c][p], b = r.mean.c[c][p];
        plain += (v - r.b1.c[c][p]) * (v - r.b2.c[c][p]) / (b * b + 0.01);
      }
    plain /= 3.0 * static_cast<double>(a.c[0].size());
    const double relmse = measure("visible").run(run).values[0], d = relmse - plain;
    visible += relmse / kSeeds, sum += d, squares += d * d;
  }
  const double mean = sum / kSeeds;
  const double error = std::sqrt((squares / kSeeds - mean * mean) / (kSeeds - 1));
  INFO("visible " << visible << ", more than the frames' own by " << mean << " +- " << error);
  CHECK(std::fabs(mean) <= 3.5 * error);
  CHECK(error < 0.25 * visible);
}

TEST_CASE("frames are compared with references of their size alone, and with some at all") {
  Study study;
  study.scenes = {test::source("scenes/cornell.xml")};
  study.width = study.height = 8;
  study.seeds = {1};
  study.reference_spp = 2;
  study.base = {
      {"photons", "500"}, {"gather.k", "4"}, {"frame.spp", "1"}, {"frame.gather_rays", "2"}};
  const test::Scratch scratch;
  StudyScene scene(study.scenes[0], study);
  Plan plan = plan_of_point(scene, study, {}).plan;
  {
    PointRun run(scene, study, plan, 1, scratch / "work");
    for (const char* name : {"visible", "lot"})
      CHECK_THROWS_WITH(measure(name).run(run), "cornell: no references were loaded");
  }
  scene.load_references(study, scratch / "references", nullptr);
  for (int Plan::*const edge : {&Plan::width, &Plan::height})
    for (const int pixels : {3, 9, 64}) {
      plan.*edge = pixels;
      PointRun run(scene, study, plan, 1, scratch / "work");
      for (const char* name : {"visible", "lot"})
        CHECK_THROWS_WITH(measure(name).run(run),
                          Catch::Matchers::StartsWith("the images differ in size"));
      plan.*edge = 8;
    }
}
