// SPDX-License-Identifier: Apache-2.0
#include "study/ray_means.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "golden/plan/plan_file.hpp"

namespace photonloom {
namespace {

// Of the plan's rays, and of the cosine's, each of which has four times the plan's rays: 1,024
// times the rays in all. All settings share the cosine's light, whose error is skewed where a rare
// ray meets a caustic, so that it has to be far below theirs. Far from the seeds of frames and of
// converged images.
constexpr uint64_t kSeeds = 64, kCosineSeeds = 256;
constexpr int kCosineRays = 4;
constexpr uint64_t kFirstSeed = uint64_t{1} << 33, kFirstCosineSeed = uint64_t{1} << 34;

// Light of the image's blocks, channels added, and of the whole image in the last place: means
// over ray seeds and their squared standard errors.
struct RayMeans {
  std::array<double, kBlocks + 1> mean{}, variance{};
  double saturated = 0;  // weights a ray that did not fit
};

RayMeans ray_means(PointRun& run, const Plan& plan, uint64_t first, uint64_t seeds) {
  RayMeans m;
  std::array<double, kBlocks + 1> squares{};
  uint64_t saturated = 0, rays = 0;
  for (uint64_t i = 0; i < seeds; ++i) {
    FrameUnits units = make_golden_units(plan);
    FrameCounts counts;
    const Planes image = planes_of(
        run.render(plan, Arithmetic::kGolden, units, counts, first + seeds * run.seed() + i), "",
        "the golden frame");
    saturated += counts.shader.weights + counts.shader.direct;
    rays += counts.directions;
    std::array<double, kBlocks + 1> light{};
    for (const std::vector<double>& channel : image.c)
      for (size_t p = 0; p < channel.size(); ++p) {
        light[block_of(image, p)] += channel[p];
        light[kBlocks] += channel[p];
      }
    // Welford's running mean and sum of squares.
    for (size_t b = 0; b < light.size(); ++b) {
      const double d = light[b] - m.mean[b];
      m.mean[b] += d / static_cast<double>(i + 1);
      squares[b] += d * (light[b] - m.mean[b]);
    }
  }
  const auto n = static_cast<double>(seeds);
  for (size_t b = 0; b < squares.size(); ++b) m.variance[b] = squares[b] / (n * (n - 1));
  m.saturated = static_cast<double>(saturated) / static_cast<double>(std::max<uint64_t>(1, rays));
  return m;
}

}  // namespace

std::vector<Column> ray_means_columns() {
  return {{"bias", "", "light over that of the cosine's rays, minus 1"},
          {"bias_error", "", "its standard error"},
          {"z", "", "bias over its standard error"},
          {"worst_z", "", "the same of the block of the image where it is farthest from 0"},
          {"chi2", "", "sum of z^2 over the blocks"},
          {"saturated", "", "channels a ray that did not fit the pixel"}};
}

Measurement measure_ray_means(PointRun& run) {
  Plan cosine = cosine_plan(run.plan());
  cosine.gather_rays =
      kCosineRays * (run.plan().first_rays > 0 ? run.plan().mean_rays : run.plan().gather_rays);
  const auto expected = run.scene().shared<RayMeans>(
      fmt::format("ray means {} {}", plan_hash_text(cosine), run.seed()),
      [&] { return ray_means(run, cosine, kFirstCosineSeed, kCosineSeeds); });
  const RayMeans got = ray_means(run, run.plan(), kFirstSeed, kSeeds);
  double chi2 = 0, worst = 0;
  const auto z_of = [&](size_t b) {
    const double error = std::sqrt(got.variance[b] + expected->variance[b]);
    return error > 0 ? (got.mean[b] - expected->mean[b]) / error : 0;
  };
  for (size_t b = 0; b < kBlocks; ++b) {
    const double z = z_of(b);
    chi2 += z * z;
    if (std::fabs(z) > std::fabs(worst)) worst = z;
  }
  const double bias = got.mean[kBlocks] / expected->mean[kBlocks] - 1;
  const double z = z_of(kBlocks);
  Measurement m;
  m.values = {bias, z == 0 ? 0 : bias / z, z, worst, chi2, got.saturated};
  return m;
}

std::string ray_means_settings(const Study&, const StudyScene&) {
  return fmt::format("1 {} seeds beside {} of {} times the rays", kSeeds, kCosineSeeds,
                     kCosineRays);
}

}  // namespace photonloom
