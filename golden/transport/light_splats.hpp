// SPDX-License-Identifier: Apache-2.0
// Light paths that end at the camera: what they add to the pixels that see them.
#pragma once
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "golden/numeric/random.hpp"
#include "golden/transport/camera.hpp"
#include "golden/transport/film_filter.hpp"
#include "golden/transport/light_paths.hpp"
#include "golden/transport/path_sample.hpp"

namespace photonloom {

// Sums of the splats of one pixel.
struct SplatSum {
  Rgb direct{0}, caustic{0}, indirect{0}, square{0};
};

// Paths 0 to `paths` - 1 of a phase in blocks, added up in the order of their numbers, so that the
// sums do not depend on threads; over `paths` they are the pixels' mean radiance. With a filter a
// splat counts in the pixels around it, over what a pixel's camera samples count in the mean.
// trace(random, path) makes a light path, splat_of(u, path, number, out) shows one of its vertices
// and size(path) counts them.
template <class LightPath, class Trace, class Size, class Show>
std::vector<SplatSum> splat_light_paths(const Film& film, const Lens& lens,
                                        const FilterTable& filter, uint64_t paths, uint64_t seed,
                                        Phase phase, Trace&& trace, Size&& size, Show&& splat_of) {
  // A bounce that no light path reaches: the numbers of its points on the lens.
  constexpr uint64_t kSplatLens = uint64_t{1} << 40;
  std::vector<SplatSum> sums(static_cast<size_t>(film.width) * static_cast<size_t>(film.height));
  constexpr uint64_t kBlock = 4096, kBlocks = 64;
  std::vector<std::vector<Splat>> splats(kBlocks);
  const auto add = [&](const Splat& s, int x, int y, double weight) {
    SplatSum& sum = sums[static_cast<size_t>(y * film.width + x)];
    const Rgb direct = s.direct * weight, caustic = s.caustic * weight,
              indirect = s.indirect * weight, all = direct + caustic + indirect;
    sum.direct += direct;
    sum.caustic += caustic;
    sum.indirect += indirect;
    sum.square += all * all;
  };
  const int reach = filter.reach();
  for (uint64_t first = 0; first < paths; first += kBlock * kBlocks) {
    tbb::parallel_for(uint64_t{0}, kBlocks, [&](uint64_t b) {
      splats[b].clear();
      LightPath path;
      const uint64_t begin = first + b * kBlock, end = std::min(begin + kBlock, paths);
      for (uint64_t i = begin; i < end; ++i) {
        const Random random(seed, phase, i);
        trace(random, path);
        for (uint64_t number = 0; number < size(path); ++number) {
          const Vec2 u = lens.has_aperture() ? Vec2(random.unit(kSplatLens, 2 * number),
                                                    random.unit(kSplatLens, 2 * number + 1))
                                             : Vec2(0);
          Splat splat;
          if (splat_of(u, path, number, splat)) splats[b].push_back(splat);
        }
      }
    });
    for (const auto& block : splats)
      for (const Splat& s : block) {
        const int x = static_cast<int>(s.x), y = static_cast<int>(s.y);
        if (filter.is_plain_box()) {
          add(s, x, y, 1);
          continue;
        }
        for (int v = std::max(0, y - reach); v <= std::min(film.height - 1, y + reach); ++v)
          for (int u = std::max(0, x - reach); u <= std::min(film.width - 1, x + reach); ++u)
            add(s, u, v,
                filter.weight(u - x, v - y, Vec2(s.x - x, s.y - y)) /
                    (filter.mean_sum(u, film.width) * filter.mean_sum(v, film.height)));
      }
  }
  return sums;
}

// The same of LightPaths.
inline std::vector<SplatSum> splat_light_paths(const LightPaths& light_paths,
                                               const RayCaster& caster, const Film& film,
                                               const Lens& lens, const FilterTable& filter,
                                               uint64_t paths, uint64_t seed, Phase phase) {
  using Vertices = std::vector<LightVertex>;
  return splat_light_paths<Vertices>(
      film, lens, filter, paths, seed, phase,
      [&](const Random& random, Vertices& path) { light_paths.trace(caster, random, path); },
      [](const Vertices& path) { return path.size(); },
      [&](const Vec2& u, const Vertices& path, size_t number, Splat& out) {
        return light_paths.splat(caster, lens, u, path[number], out);
      });
}

}  // namespace photonloom
