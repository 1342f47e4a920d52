// SPDX-License-Identifier: Apache-2.0
#include "golden/transport/path.hpp"

#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "golden/numeric/memory.hpp"
#include "golden/transport/bidirectional.hpp"
#include "golden/transport/camera.hpp"
#include "golden/transport/direct.hpp"
#include "golden/transport/film_filter.hpp"
#include "golden/transport/light_paths.hpp"
#include "golden/transport/light_splats.hpp"
#include "golden/transport/roulette.hpp"
#include "golden/transport/sampling.hpp"
#include "golden/transport/visibility.hpp"

namespace photonloom {
namespace {

constexpr int kTile = 8;  // edge in pixels

// Dimensions of one bounce.
enum PathDimension : uint64_t {
  kPathLobe,
  kPathDirection,
  kPathChoice,
  kPathPoint,
  kPathRoulette,
  kPathPart,
  kPathOpening
};

// How the ray under way left its last non-delta surface.
struct LobeRay {
  bool exists = false;
  bool diffuse = false;
  bool from_first = false;     // the surface was the first non-delta hit
  bool through_delta = false;  // delta surfaces since
  ShadingPoint x;
  double pdf = 0;  // lobe probability included
};

// The layer of an emitter that this ray finds.
Rgb& layer_of(const LobeRay& lobe, PathSample& out) {
  if (!lobe.exists) return out.emission;
  if (!lobe.from_first) return out.indirect;
  if (!lobe.through_delta) return out.direct;
  return lobe.diffuse ? out.caustic : out.indirect;
}

// Leaves a non-delta surface by one of its lobes; false: absorbed.
bool leave_by_lobe(const Hit& hit, const Surface& s, double choice, const Vec2& u, Vec3& direction,
                   Rgb& throughput, double& ior2, LobeRay& lobe) {
  const double p = s.diffuse_probability();
  lobe.diffuse = choice < p;
  lobe.exists = true;
  lobe.through_delta = false;
  lobe.x = shading_point(hit, s);
  direction = lobe.diffuse ? sample_diffuse(s, u) : sample_glossy(s, u);
  lobe.pdf = lobe.diffuse ? p * diffuse_pdf(s, direction) : (1 - p) * glossy_pdf(s, direction);
  if (!(lobe.pdf > 0)) return false;
  throughput *=
      (lobe.diffuse ? diffuse_times_cosine(s, direction) : glossy_times_cosine(s, direction)) /
      lobe.pdf;
  if (s.transmits() && !s.above(direction)) ior2 *= s.relative_ior() * s.relative_ior();
  return !is_black(throughput);
}

// A path of so many segments may take another one.
bool has_depth(const Scene& scene, uint64_t segments) {
  return scene.max_depth < 0 || segments < static_cast<uint64_t>(scene.max_depth);
}

PathSample trace_sample(const World& world, const RayCaster& caster, const Lens& lens,
                        const LightPaths& light_paths, std::span<const LightVertex> light_vertices,
                        int px, int py, const PixelNumbers& numbers) {
  const Scene& scene = world.scene();
  const Vec2 jitter = numbers.pair(0, 0);
  const CameraRay camera = lens.through(px + jitter.x, py + jitter.y,
                                        lens.has_aperture() ? numbers.pair(0, 1) : Vec2(0));
  PathSample out;
  out.place = jitter;
  Ray ray = camera.ray;
  const auto opening = [&](uint64_t segment) {
    return world.has_openings() ? numbers.unit(segment, kPathOpening) : 0;
  };
  Hit hit = first_hit(world, caster, camera, opening(1));
  if (hit.valid()) {
    out.normal = hit.shading_normal;
    out.depth = hit.distance;
    out.albedo = world.albedo(hit, ray.direction);
  }
  Rgb throughput(1);
  double ior2 = 1;
  LobeRay lobe;
  for (uint64_t segment = 1; hit.valid(); ++segment) {
    const Rgb radiance = world.emission(hit, ray.direction);
    if (!is_black(radiance)) {
      const bool shared = lobe.exists && !lobe.through_delta;
      const double w = shared ? found_weight(world, lobe.x, lobe.pdf, hit, ray.direction) : 1.0;
      layer_of(lobe, out) += throughput * radiance * w;
    }
    if (!has_depth(scene, segment)) break;
    const Surface s = make_surface(world, hit, ray.direction,
                                   world.has_choices() ? numbers.unit(segment, kPathPart) : 0);
    if (s.black()) break;
    if (s.is_delta()) {
      Rgb weight;
      double factor;
      if (!sample_delta(s, numbers.unit(segment, kPathLobe), Carried::kRadiance, ray.direction,
                        weight, factor))
        break;
      throughput *= weight;
      ior2 *= factor;
      lobe.through_delta = true;
    } else {
      const double p = s.diffuse_probability();
      const DirectLight light =
          direct_light(world, caster, hit, s, numbers.unit(segment, kPathChoice),
                       numbers.pair(segment, kPathPoint), {p, 1 - p});
      (lobe.exists ? out.indirect : out.direct) += throughput * (light.diffuse + light.glossy);
      out.indirect += throughput * light_paths.connect(caster, light_vertices, hit, s, segment,
                                                       LightPaths::Walk::kCamera);
      const bool first = !lobe.exists;
      if (!leave_by_lobe(hit, s, numbers.unit(segment, kPathLobe),
                         numbers.pair(segment, kPathDirection), ray.direction, throughput, ior2,
                         lobe))
        break;
      lobe.from_first = first;
    }
    if (!survives(throughput, segment, scene.rr_depth, numbers.unit(segment, kPathRoulette), ior2))
      break;
    ray.origin = hit.position;
    hit = caster.closest(ray, &hit);
    hit = pass_openings(world, caster, ray, hit, opening(segment + 1));
  }
  if (!hit.valid() && world.environment()) {
    const Rgb radiance = world.environment()->radiance(ray.direction);
    const bool shared = lobe.exists && !lobe.through_delta;
    const double w = shared ? escaped_weight(world, lobe.x, lobe.pdf, ray.direction) : 1.0;
    layer_of(lobe, out) += throughput * radiance * w;
  }
  return out;
}

// Sums of one pixel.
struct PixelSum {
  PathSample sum;
  Rgb samples{0}, square{0};                                 // of whole samples
  Rgb splat_variance{0};                                     // of the mean
  Rgb splat_direct{0}, splat_caustic{0}, splat_indirect{0};  // times the samples
  int hits = 0;                                              // samples that met a surface
  void add(const PathSample& s) {
    sum.emission += s.emission;
    sum.direct += s.direct;
    sum.caustic += s.caustic;
    sum.indirect += s.indirect;
    sum.albedo += s.albedo;
    sum.normal += s.normal;
    sum.depth += s.depth;
    hits += s.depth > 0;
    const Rgb total = s.emission + s.direct + s.caustic + s.indirect;
    samples += total;
    square += total * total;
  }
};

const char* const kColour[3] = {".R", ".G", ".B"};
const char* const kAxis[3] = {".X", ".Y", ".Z"};

// Channels in the order in which write_pixel fills them.
void add_channels(Image& image) {
  for (const char* c : {"R", "G", "B"}) image.add(c);
  for (const char* layer : {"emission", "direct", "caustic", "indirect", "albedo", "error"})
    for (const char* c : kColour) image.add(std::string(layer) + c);
  for (const char* c : kAxis) image.add(std::string("N") + c);
  image.add("Z");
}

// `weight`: what the samples in the light of p.sum count together; `variance`: of the pixel's mean,
// without splats.
void write_pixel(Image& image, size_t pixel, const PixelSum& p, double n, double weight,
                 const Rgb& variance) {
  const auto put = [&](size_t channel, double value) {
    image.channels[channel].pixels[pixel] = static_cast<float>(value);
  };
  const Rgb total = p.sum.emission + p.sum.direct + p.sum.caustic + p.sum.indirect;
  for (int c = 0; c < 3; ++c) {
    const size_t i = static_cast<size_t>(c);
    put(i, total[c] / weight);
    put(3 + i, p.sum.emission[c] / weight);
    put(6 + i, p.sum.direct[c] / weight);
    put(9 + i, p.sum.caustic[c] / weight);
    put(12 + i, p.sum.indirect[c] / weight);
    put(15 + i, p.sum.albedo[c] / n);
    put(18 + i, n > 1 ? std::sqrt(variance[c] + p.splat_variance[c]) : 0);
    put(21 + i, p.sum.normal[c] / n);
  }
  put(24, p.hits > 0 ? p.sum.depth / p.hits : 0);
}

// Of the mean of a pixel's own samples.
Rgb variance_of(const PixelSum& p, double n) {
  Rgb variance(0);
  for (int c = 0; c < 3 && n > 1; ++c) {
    const double sample = p.samples[c] / n;
    variance[c] = std::max(0.0, p.square[c] / n - sample * sample) / (n - 1);
  }
  return variance;
}

// Light of the samples of one pixel, as it counts in one of the pixels around it.
struct WeightedLight {
  Rgb emission{0}, direct{0}, caustic{0}, indirect{0};
  double weight = 0;
  void add(const WeightedLight& w) {
    emission += w.emission;
    direct += w.direct;
    caustic += w.caustic;
    indirect += w.indirect;
    weight += w.weight;
  }
  void add(const PathSample& s, double w) {
    emission += s.emission * w;
    direct += s.direct * w;
    caustic += s.caustic * w;
    indirect += s.indirect * w;
    weight += w;
  }
};

// What samples count in all pixels around them, collected from one band of rows after the other, so
// that each pixel's sum has one order.
class FilteredFilm {
 public:
  FilteredFilm(const FilterTable& filter, int width, int height)
      : filter_(filter),
        width_(width),
        height_(height),
        edge_(2 * filter.reach() + 1),
        blocks_(size(width * kTile * edge_ * edge_)),
        light_(size(width * height)),
        pixels_(size(width * height)) {}

  // The samples of pixel (x, y) of the band from row `first` on.
  void begin(int x, int y, int first) {
    std::fill_n(block(x, y - first), edge_ * edge_, WeightedLight());
  }
  void add(int x, int y, int first, const PathSample& s) {
    const int reach = filter_.reach();
    WeightedLight* to = block(x, y - first);
    for (int v = -reach; v <= reach; ++v)
      for (int u = -reach; u <= reach; ++u) to++->add(s, filter_.weight(u, v, s.place));
  }
  void end(int x, int y, const PixelSum& sum) { pixels_[size(y * width_ + x)] = sum; }

  void collect(int first) {
    const int reach = filter_.reach(), last = std::min(first + kTile, height_) - 1;
    tbb::parallel_for(std::max(0, first - reach), std::min(height_, last + reach + 1), [&](int y) {
      for (int x = 0; x < width_; ++x) {
        WeightedLight& sum = light_[size(y * width_ + x)];
        for (int v = std::max(first, y - reach); v <= std::min(last, y + reach); ++v)
          for (int u = std::max(0, x - reach); u <= std::min(width_ - 1, x + reach); ++u)
            sum.add(block(u, v - first)[(y - v + reach) * edge_ + x - u + reach]);
      }
    });
  }

  void write(Image& image, double n) {
    tbb::parallel_for(0, height_, [&](int y) {
      for (int x = 0; x < width_; ++x) write(image, x, y, n);
    });
  }

 private:
  static size_t size(int n) { return static_cast<size_t>(n); }
  WeightedLight* block(int x, int row) {
    return &blocks_[size((row * width_ + x) * edge_ * edge_)];
  }
  // Light over weight; nothing where lobes took all weight away.
  void write(Image& image, int x, int y, double n) {
    const size_t pixel = size(y * width_ + x);
    const WeightedLight& l = light_[pixel];
    PixelSum p = pixels_[pixel];
    const bool counts = l.weight > 0;
    const double weight = counts ? l.weight : 1;
    // Splats are means already.
    const double share = counts ? weight / n : 0;
    p.sum.direct = p.splat_direct * share;
    p.sum.caustic = p.splat_caustic * share;
    p.sum.indirect = p.splat_indirect * share;
    p.sum.emission = Rgb(0);
    if (counts) {
      p.sum.emission = l.emission;
      p.sum.direct += l.direct;
      p.sum.caustic += l.caustic;
      p.sum.indirect += l.indirect;
    }
    Rgb variance(0);
    const int reach = filter_.reach();
    for (int v = std::max(0, y - reach); v <= std::min(height_ - 1, y + reach); ++v)
      for (int u = std::max(0, x - reach); u <= std::min(width_ - 1, x + reach); ++u)
        variance += variance_of(pixels_[size(v * width_ + u)], n) *
                    (filter_.mean_square(x - u) * filter_.mean_square(y - v));
    write_pixel(image, pixel, p, n, weight, variance * (n * n / (weight * weight)));
  }

  const FilterTable& filter_;
  int width_, height_, edge_;
  std::vector<WeightedLight> blocks_;  // of the band's pixels
  std::vector<WeightedLight> light_;
  std::vector<PixelSum> pixels_;
};

Image traced(const World& world, const RayCaster& caster, const PathOptions& options) {
  const Film film = world.scene().film;
  Image image;
  image.width = film.width;
  image.height = film.height;
  add_channels(image);
  const Lens lens(world.scene());
  const int tiles_x = (film.width + kTile - 1) / kTile, tiles_y = (film.height + kTile - 1) / kTile;
  const uint64_t pixels = static_cast<uint64_t>(film.width) * static_cast<uint64_t>(film.height);
  const uint64_t samples = pixels * static_cast<uint64_t>(options.spp);
  const LightPaths light_paths(world, Photons::kNone);
  const FilterTable filter(film.filter);
  const Bidirectional bidirectional(world, caster);
  const bool both = options.bidirectional, light = !both && light_paths.needed();
  std::vector<SplatSum> splats;
  if (both) {
    splats = splat_light_paths<LightSubpath>(
        film, lens, filter, samples, options.seed, Phase::kCausticPhoton,
        [&](const Random& random, LightSubpath& path) { bidirectional.trace_light(random, path); },
        [](const LightSubpath& path) { return path.vertices.size(); },
        [&](const Vec2& u, const LightSubpath& path, size_t number, Splat& out) {
          return bidirectional.splat(lens, u, path, number, out);
        });
  } else if (light) {
    splats = splat_light_paths(light_paths, caster, film, lens, filter, samples, options.seed,
                               Phase::kCausticPhoton);
  }
  std::optional<FilteredFilm> filtered;
  if (!filter.is_plain_box()) filtered.emplace(filter, film.width, film.height);
  const ProgressPhase phase(options.progress, "path tracing", samples, "samples");
  const auto render_tile = [&](int tile) {
    const int x0 = tile % tiles_x * kTile, y0 = tile / tiles_x * kTile;
    std::vector<LightVertex> vertices;
    LightSubpath subpath;
    for (int y = y0; y < std::min(y0 + kTile, film.height); ++y)
      for (int x = x0; x < std::min(x0 + kTile, film.width); ++x) {
        const uint64_t pixel =
            static_cast<uint64_t>(y) * static_cast<uint64_t>(film.width) + static_cast<uint64_t>(x);
        PixelSum sum;
        if (filtered) filtered->begin(x, y, y0);
        for (int i = 0; i < options.spp; ++i) {
          const uint64_t sample = static_cast<uint64_t>(i);
          const Random random(options.seed, Phase::kDirect, hash_bits(pixel, sample, 0, 0));
          const PixelNumbers numbers(options.seed, Phase::kPath, pixel, sample);
          if (both) bidirectional.trace_light(random, subpath);
          if (light) light_paths.trace(caster, random, vertices);
          const PathSample path =
              both ? bidirectional.sample(lens, x, y, numbers, subpath)
                   : trace_sample(world, caster, lens, light_paths, vertices, x, y, numbers);
          sum.add(path);
          if (filtered) filtered->add(x, y, y0, path);
        }
        if (!splats.empty()) {
          // Sums over all paths to the pixel's mean, times spp as the samples' sums are.
          const SplatSum& s = splats[pixel];
          const double scale = options.spp / static_cast<double>(samples);
          sum.splat_direct = s.direct * scale;
          sum.splat_caustic = s.caustic * scale;
          sum.splat_indirect = s.indirect * scale;
          sum.splat_variance =
              s.square / (static_cast<double>(samples) * static_cast<double>(samples));
        }
        if (filtered) {
          filtered->end(x, y, sum);
        } else {
          sum.sum.direct += sum.splat_direct;
          sum.sum.caustic += sum.splat_caustic;
          sum.sum.indirect += sum.splat_indirect;
          write_pixel(image, pixel, sum, options.spp, options.spp, variance_of(sum, options.spp));
        }
        phase.advance(static_cast<uint64_t>(options.spp));
      }
  };
  if (filtered) {
    for (int row = 0; row < tiles_y; ++row) {
      tbb::parallel_for(row * tiles_x, (row + 1) * tiles_x, render_tile);
      filtered->collect(row * kTile);
    }
    filtered->write(image, options.spp);
  } else {
    tbb::parallel_for(0, tiles_x * tiles_y, render_tile);
  }
  return image;
}

}  // namespace

Image render_path(const World& world, const RayCaster& caster, const PathOptions& options) {
  const Film& film = world.scene().film;
  return with_memory_for_pixels(film.width, film.height,
                                [&] { return traced(world, caster, options); });
}

}  // namespace photonloom
