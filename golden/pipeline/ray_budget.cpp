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
// Shadows' edges are narrower than a tile.
constexpr int kShadowEdge = 4;

// Every other pixel of a square, one kind of ray.
struct HalfSquare {
  double noise = 0;  // of a ray, relative to the half's mean
  double samples = 0;
};
using Halves = std::vector<std::array<HalfSquare, 2>>;  // of square q, kind k at q * kinds + k

class Batch {
 public:
  Batch(const Plan& plan, int edge, std::span<const uint32_t> pixels,
        std::span<const size_t> tile_begins)
      : width_(static_cast<uint32_t>(plan.width)), spp_(static_cast<size_t>(plan.spp)) {
    const auto tile_edge = static_cast<uint32_t>(plan.tile);
    const auto across = (tile_edge + static_cast<uint32_t>(edge) - 1) / static_cast<uint32_t>(edge);
    squares_of_tile_ = size_t{across} * across;
    samples_ = pixels.size() * spp_;
    for (size_t tile = 0; tile < tile_begins.size(); ++tile) {
      const size_t end = tile + 1 < tile_begins.size() ? tile_begins[tile + 1] : pixels.size();
      const size_t first = squares_.size();
      squares_.resize(first + squares_of_tile_);
      for (size_t place = tile_begins[tile]; place < end; ++place) {
        const uint32_t x = pixels[place] % width_, y = pixels[place] / width_;
        const uint32_t column = x % tile_edge / static_cast<uint32_t>(edge),
                       row = y % tile_edge / static_cast<uint32_t>(edge);
        squares_[first + row * across + column].push_back({place * spp_, (x + y) % 2});
      }
    }
  }

  size_t squares() const { return squares_.size(); }
  bool begins_tile(size_t square) const { return square % squares_of_tile_ == 0; }
  size_t samples() const { return samples_; }
  size_t spp() const { return spp_; }

  // Calls f(half, first sample, behind its last) for each pixel of a square.
  template <class F>
  void for_each_pixel(size_t square, F&& f) const {
    for (const Pixel& pixel : squares_[square]) f(pixel.half, pixel.begin, pixel.begin + spp_);
  }

 private:
  struct Pixel {
    size_t begin;  // its first sample
    size_t half;
  };
  uint32_t width_;
  size_t spp_, samples_ = 0, squares_of_tile_ = 1;
  std::vector<std::vector<Pixel>> squares_;
};

using SeenOf = std::function<FirstPass(size_t sample, size_t kind)>;

Halves noise_of(const Batch& batch, size_t kinds, const SeenOf& first_pass) {
  Halves halves(batch.squares() * kinds);
  parallel(halves.size(), [&](size_t i) {
    const size_t square = i / kinds, kind = i % kinds;
    std::array<Rgb, 2> mean{Rgb(0), Rgb(0)}, noise{Rgb(0), Rgb(0)};
    std::array<double, 2> pixels{};
    batch.for_each_pixel(square, [&](size_t h, size_t begin, size_t end) {
      ++pixels[h];
      for (size_t sample = begin; sample < end; ++sample) {
        const FirstPass seen = first_pass(sample, kind);
        halves[i][h].samples += seen.casts;
        mean[h] += seen.light;
        noise[h] += seen.difference * seen.difference;
      }
    });
    for (size_t h = 0; h < 2; ++h) {
      if (!(halves[i][h].samples > 0)) continue;
      double sum = 0;
      for (int c = 0; c < 3; ++c) {
        const double b = mean[h][c] / (pixels[h] * static_cast<double>(batch.spp()));
        sum += noise[h][c] / (b * b + kDarkest);
      }
      halves[i][h].noise = std::sqrt(sum / halves[i][h].samples);
    }
  });
  return halves;
}

// Rays a sample of one half of each square, by the noise of the other half.
std::vector<double> wanted_rays(const TwoPasses& passes, const Halves& halves, size_t h) {
  const size_t squares = halves.size(), other = 1 - h;
  double noise = 0, known = 0, samples = 0;
  for (const auto& square : halves) {
    noise += square[other].noise * square[other].samples;
    known += square[other].samples;
    samples += square[h].samples;
  }
  const double mean_noise = known > 0 ? noise / known : 0;
  if (!(mean_noise > 0) && !passes.without_noise) return std::vector<double>(squares, 0.0);
  // None wants less than an eighth of the mean, for noise that a few samples did not show.
  std::vector<double> wish(squares, 1.0);
  if (mean_noise > 0)
    for (size_t square = 0; square < squares; ++square) {
      const HalfSquare& seen = halves[square][other];
      wish[square] = std::max(seen.samples > 0 ? seen.noise / mean_noise : 1.0, 0.125);
    }
  // What the most rays cut off goes to the others.
  const double most = static_cast<double>(passes.most - passes.first);
  double factor = 0;
  for (int round = 0; round < 8; ++round) {
    double left = samples * (passes.mean - passes.first), open = 0;
    for (size_t square = 0; square < squares; ++square) {
      if (factor * wish[square] >= most && round > 0)
        left -= most * halves[square][h].samples;
      else
        open += wish[square] * halves[square][h].samples;
    }
    if (!(open > 0)) break;
    factor = std::max(factor, left / open);
  }
  for (double& rays : wish) rays = std::min(factor * rays, most);
  return wish;
}

}  // namespace

TwoPasses gather_passes(const Plan& plan) {
  return {.first = plan.first_rays,
          .mean = plan.mean_rays,
          .most = plan.gather_rays,
          .edge = plan.tile};
}

TwoPasses shadow_passes(const Plan& plan) {
  return {.kinds = 2,
          .first = plan.first_shadow_rays,
          .mean = plan.mean_shadow_rays,
          .most = plan.shadow_rays,
          .edge = std::min(plan.tile, kShadowEdge),
          .without_noise = false};
}

std::vector<uint32_t> second_rays(const Plan& plan, const TwoPasses& passes,
                                  std::span<const uint32_t> pixels,
                                  std::span<const size_t> tile_begins, const SeenOf& first_pass) {
  const Batch batch(plan, passes.edge, pixels, tile_begins);
  const Halves halves = noise_of(batch, passes.kinds, first_pass);
  const double most = static_cast<double>(passes.most - passes.first);
  std::vector<uint32_t> counts(batch.samples() * passes.kinds, 0);
  for (size_t h = 0; h < 2; ++h) {
    const std::vector<double> rays = wanted_rays(passes, halves, h);
    // Whole rays, so that a tile's add up to what it wants, of each kind.
    std::vector<double> given(passes.kinds), wanted(passes.kinds);
    for (size_t i = 0; i < halves.size(); ++i) {
      const size_t square = i / passes.kinds, kind = i % passes.kinds;
      if (batch.begins_tile(square)) given[kind] = wanted[kind] = 0;
      batch.for_each_pixel(square, [&](size_t half, size_t begin, size_t end) {
        if (half != h) return;
        for (size_t sample = begin; sample < end; ++sample) {
          if (!first_pass(sample, kind).casts) continue;
          wanted[kind] += rays[i];
          const double n = std::min(std::floor(wanted[kind] - given[kind]), most);
          given[kind] += n;
          counts[sample * passes.kinds + kind] = static_cast<uint32_t>(n);
        }
      });
    }
  }
  return counts;
}

}  // namespace photonloom
