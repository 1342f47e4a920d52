// SPDX-License-Identifier: Apache-2.0
// A film whose samples count in several pixels (docs/frame.md, "Film"): sums of light
// times lobes, exact where light is, so that neither order nor threads show.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "golden/image/image.hpp"
#include "golden/pipeline/batch.hpp"
#include "golden/pipeline/light.hpp"
#include "golden/plan/plan.hpp"
#include "golden/transport/film_filter.hpp"
#include "golden/transport/light_splats.hpp"

namespace photonloom {

template <Arithmetic kArithmetic>
class SplatFilm {
  using Value = typename LightValues<kArithmetic>::Value;
  using Sum = typename LightValues<kArithmetic>::FilmSum;

 public:
  SplatFilm(const Plan& plan, const FilterTable& filter)
      : plan_(plan),
        filter_(filter),
        pixels_(static_cast<size_t>(plan.width) * static_cast<size_t>(plan.height)),
        spread_(pixels_.size(), Rgb(0)) {}

  // Variance of a pixel's own samples.
  Rgb& spread(size_t pixel) { return spread_[pixel]; }

  // Adds a batch's samples to all pixels in which they count. Each pixel collects its own.
  // place[p] is pixel p's in samples.pixels, or absent.
  void splat(const BatchSamples& samples, const std::vector<uint32_t>& place, uint32_t absent,
             const std::vector<Layers<Value>>& layers,
             const std::vector<std::array<uint8_t, 2>>& within) {
    int x0 = plan_.width, y0 = plan_.height, x1 = 0, y1 = 0;
    for (const uint32_t pixel : samples.pixels) {
      const int x = static_cast<int>(pixel) % plan_.width;
      const int y = static_cast<int>(pixel) / plan_.width;
      x0 = std::min(x0, x);
      x1 = std::max(x1, x);
      y0 = std::min(y0, y);
      y1 = std::max(y1, y);
    }
    const int reach = filter_.reach();
    x0 = std::max(0, x0 - reach);
    y0 = std::max(0, y0 - reach);
    x1 = std::min(plan_.width - 1, x1 + reach);
    y1 = std::min(plan_.height - 1, y1 + reach);
    const auto columns = static_cast<size_t>(x1 - x0 + 1);
    parallel(columns * static_cast<size_t>(y1 - y0 + 1), [&](size_t i) {
      const int x = x0 + static_cast<int>(i % columns), y = y0 + static_cast<int>(i / columns);
      Pixel sum;
      around(x, y, [&](int u, int v) {
        const uint32_t at = place[number(u, v)];
        if (at == absent) return;
        for (size_t entry = at * samples.spp; entry < (at + 1) * samples.spp; ++entry) {
          const int32_t w =
              filter_.weight(x - u, within[entry][0]) * filter_.weight(y - v, within[entry][1]);
          if (w == 0) continue;
          const Layers<Value>& l = layers[entry];
          sum.layers.direct.add(l.direct, w);
          sum.layers.caustic.add(l.caustic, w);
          sum.layers.indirect.add(l.indirect, w);
          sum.layers.emission.add(l.emission, w);
          sum.weight += w;
        }
      });
      Pixel& film = pixels_[number(x, y)];
      film.layers.direct.add(sum.layers.direct);
      film.layers.caustic.add(sum.layers.caustic);
      film.layers.indirect.add(sum.layers.indirect);
      film.layers.emission.add(sum.layers.emission);
      film.weight += sum.weight;
    });
  }

  // Light over weight, pixel by pixel, into the image's first 18 channels: light, its four layers,
  // error. Nothing where lobes took all weight away. `light_paths`: what they add to each pixel's
  // indirect light, filtered already; empty: nothing.
  void finish(Image& image, const std::vector<SplatSum>& light_paths) const {
    const auto n = static_cast<double>(plan_.spp);
    parallel(pixels_.size(), [&](size_t p) {
      const Pixel& film = pixels_[p];
      if (film.weight <= 0) return;
      const auto whole = static_cast<double>(film.weight);
      const auto set = [&](size_t channel, double value) {
        image.channels[channel].pixels[p] = static_cast<float>(value);
      };
      const auto mean = [&](const Sum& sum, size_t c) {
        if constexpr (LightValues<kArithmetic>::kGolden)
          return std::ldexp(sum[c], -plan_.fraction_bits) / whole;
        else
          return sum[c] / whole;
      };
      const Layers<Sum>& l = film.layers;
      Sum sum = l.direct;
      for (const Sum* layer : {&l.caustic, &l.indirect, &l.emission}) sum.add(*layer);
      Rgb variance(0);
      const int x = static_cast<int>(p) % plan_.width, y = static_cast<int>(p) / plan_.width;
      around(x, y, [&](int u, int v) {
        variance +=
            spread_[number(u, v)] * (filter_.mean_square(x - u) * filter_.mean_square(y - v));
      });
      const double share = whole / (int64_t{1} << (2 * FilterTable::kOneBits));
      for (size_t c = 0; c < 3; ++c) {
        const int i = static_cast<int>(c);
        const double splat = light_paths.empty() ? 0 : light_paths[p].indirect[i];
        const double square = light_paths.empty() ? 0 : light_paths[p].square[i];
        set(c, mean(sum, c) + splat);
        set(3 + c, mean(l.direct, c));
        set(6 + c, mean(l.caustic, c));
        set(9 + c, mean(l.indirect, c) + splat);
        set(12 + c, mean(l.emission, c));
        const double own = std::sqrt(n * variance[i]) / share;
        set(15 + c, square > 0 ? std::sqrt(own * own + square) : own);
      }
    });
  }

 private:
  // Sums over samples, times their weights.
  struct Pixel {
    Layers<Sum> layers;
    int64_t weight = 0;
  };

  size_t number(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(plan_.width) + static_cast<size_t>(x);
  }

  // Calls f(x, y) for the pixels within the filter's reach of (x, y), row by row.
  template <class F>
  void around(int x, int y, F&& f) const {
    const int reach = filter_.reach();
    for (int v = std::max(0, y - reach); v <= std::min(plan_.height - 1, y + reach); ++v)
      for (int u = std::max(0, x - reach); u <= std::min(plan_.width - 1, x + reach); ++u) f(u, v);
  }

  const Plan& plan_;
  const FilterTable& filter_;
  std::vector<Pixel> pixels_;
  std::vector<Rgb> spread_;
};

}  // namespace photonloom
