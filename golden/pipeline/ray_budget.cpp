// SPDX-License-Identifier: Apache-2.0
#include "golden/pipeline/ray_budget.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "golden/pipeline/light.hpp"

namespace photonloom {
namespace {

// Added to a squared radiance that noise is relative to, as in relMSE.
constexpr double kDarkest = 0.01;

// Every other pixel of a tile.
struct HalfTile {
  double noise = 0;  // of a ray, relative to the half's mean
  double samples = 0;
};
using Halves = std::vector<std::array<HalfTile, 2>>;  // by tile

class Batch {
 public:
  Batch(const Plan& plan, std::span<const uint32_t> pixels, std::span<const size_t> tile_begins)
      : pixels_(pixels),
        tile_begins_(tile_begins),
        width_(static_cast<uint32_t>(plan.width)),
        spp_(static_cast<size_t>(plan.spp)) {}

  size_t tiles() const { return tile_begins_.size(); }
  size_t samples() const { return pixels_.size() * spp_; }
  size_t spp() const { return spp_; }

  // Calls f(half, first sample, behind its last) for each pixel of a tile.
  template <class F>
  void for_each_pixel(size_t tile, F&& f) const {
    const size_t end = tile + 1 < tiles() ? tile_begins_[tile + 1] : pixels_.size();
    for (size_t pixel = tile_begins_[tile]; pixel < end; ++pixel) {
      const size_t half = (pixels_[pixel] % width_ + pixels_[pixel] / width_) % 2;
      f(half, pixel * spp_, (pixel + 1) * spp_);
    }
  }

 private:
  std::span<const uint32_t> pixels_;
  std::span<const size_t> tile_begins_;
  uint32_t width_;
  size_t spp_;
};

Halves noise_of(const Batch& batch, const std::function<FirstPass(size_t)>& first_pass) {
  Halves halves(batch.tiles());
  parallel(batch.tiles(), [&](size_t tile) {
    std::array<Rgb, 2> mean{Rgb(0), Rgb(0)}, noise{Rgb(0), Rgb(0)};
    std::array<double, 2> pixels{};
    batch.for_each_pixel(tile, [&](size_t h, size_t begin, size_t end) {
      ++pixels[h];
      for (size_t sample = begin; sample < end; ++sample) {
        const FirstPass seen = first_pass(sample);
        halves[tile][h].samples += seen.diffuse;
        mean[h] += seen.light;
        noise[h] += seen.difference * seen.difference;
      }
    });
    for (size_t h = 0; h < 2; ++h) {
      if (!(halves[tile][h].samples > 0)) continue;
      double sum = 0;
      for (int c = 0; c < 3; ++c) {
        const double b = mean[h][c] / (pixels[h] * static_cast<double>(batch.spp()));
        sum += noise[h][c] / (b * b + kDarkest);
      }
      halves[tile][h].noise = std::sqrt(sum / halves[tile][h].samples);
    }
  });
  return halves;
}

// Rays a sample of one half of each tile, by the noise of the other half.
std::vector<double> wanted_rays(const Plan& plan, const Halves& halves, size_t h) {
  const size_t tiles = halves.size(), other = 1 - h;
  double noise = 0, known = 0, samples = 0;
  for (const auto& tile : halves) {
    noise += tile[other].noise * tile[other].samples;
    known += tile[other].samples;
    samples += tile[h].samples;
  }
  const double mean_noise = known > 0 ? noise / known : 0;
  // None wants less than an eighth of the mean, for noise that a few samples did not show.
  std::vector<double> wish(tiles, 1.0);
  if (mean_noise > 0)
    for (size_t tile = 0; tile < tiles; ++tile) {
      const HalfTile& seen = halves[tile][other];
      wish[tile] = std::max(seen.samples > 0 ? seen.noise / mean_noise : 1.0, 0.125);
    }
  // What the most rays cut off goes to the others.
  const double most = static_cast<double>(plan.gather_rays - plan.first_rays);
  double factor = 0;
  for (int round = 0; round < 8; ++round) {
    double left = samples * (plan.mean_rays - plan.first_rays), open = 0;
    for (size_t tile = 0; tile < tiles; ++tile) {
      if (factor * wish[tile] >= most && round > 0)
        left -= most * halves[tile][h].samples;
      else
        open += wish[tile] * halves[tile][h].samples;
    }
    if (!(open > 0)) break;
    factor = std::max(factor, left / open);
  }
  for (double& rays : wish) rays = std::min(factor * rays, most);
  return wish;
}

}  // namespace

std::vector<uint32_t> second_rays(const Plan& plan, std::span<const uint32_t> pixels,
                                  std::span<const size_t> tile_begins,
                                  const std::function<FirstPass(size_t sample)>& first_pass) {
  const Batch batch(plan, pixels, tile_begins);
  const Halves halves = noise_of(batch, first_pass);
  const double most = static_cast<double>(plan.gather_rays - plan.first_rays);
  std::vector<uint32_t> counts(batch.samples(), 0);
  for (size_t h = 0; h < 2; ++h) {
    const std::vector<double> rays = wanted_rays(plan, halves, h);
    for (size_t tile = 0; tile < batch.tiles(); ++tile) {
      // Whole rays, so that a tile's add up to what it wants.
      double given = 0, wanted = 0;
      batch.for_each_pixel(tile, [&](size_t half, size_t begin, size_t end) {
        if (half != h) return;
        for (size_t sample = begin; sample < end; ++sample) {
          if (!first_pass(sample).diffuse) continue;
          wanted += rays[tile];
          const double n = std::min(std::floor(wanted - given), most);
          given += n;
          counts[sample] = static_cast<uint32_t>(n);
        }
      });
    }
  }
  return counts;
}

}  // namespace photonloom
