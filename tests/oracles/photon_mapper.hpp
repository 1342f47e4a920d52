// SPDX-License-Identifier: Apache-2.0
// The textbook photon mapper in double, cosine-distributed gather rays, so that only transport is
// judged; and its layers held against the path tracer's.
#pragma once
#include <tbb/parallel_for.h>

#include <array>
#include <cmath>

#include "golden/numeric/elementary.hpp"
#include "golden/transport/light_paths.hpp"
#include "golden/transport/light_splats.hpp"
#include "golden/transport/sampling.hpp"
#include "golden/unit/reference_gather.hpp"
#include "tests/catch.hpp"
#include "tests/oracles/scenes.hpp"
#include "tests/oracles/statistics.hpp"

namespace photonloom::oracle {

enum Layer { kEmission, kDirectLayer, kCaustic, kIndirect, kLayers };
inline constexpr const char* kNames[kLayers] = {"emission", "direct", "caustic", "indirect"};
using Layers = std::array<double, kLayers>;

inline constexpr int kSize = 24, kBatches = 6;
inline constexpr int kNeighbours = 30;

// A radius^2 that holds twice the neighbours at the mean density.
inline double radius2(const World& world, uint64_t photons) {
  return 2 * kNeighbours * world.diffuse_area() / (kPi * static_cast<double>(photons));
}

// Photons with the density estimate that goes with their number.
class Map {
 public:
  Map(const World& world, uint64_t photons, const PhotonPass& pass)
      : r2_(radius2(world, photons)), photons_(pass.photons) {}
  Rgb estimate(const DiffuseHit& x) const {
    std::vector<ReferenceNeighbour> found;
    photons_.find(x.position, x.normal, kNeighbours, r2_, found);
    return photons_.irradiance(found, kNeighbours, r2_, 0, Kernel::kFlat);
  }

 private:
  double r2_;
  ReferenceGather photons_;
};

class PhotonMapper {
 public:
  // A caustic is sharp, and the kernel carries light from where the camera does not see it, such as
  // from under a ball, to where it does: the caustic map has more photons, so that its kernel is
  // smaller.
  PhotonMapper(const World& world, uint64_t photons, uint64_t caustic_photons, uint64_t effort,
               uint64_t seed)
      : world_(world),
        caster_(make_double_bvh(world)),
        camera_samples_(256 * effort),
        gather_samples_(16 * effort),
        seed_(seed),
        light_paths_(world, Photons::kOnDiffuse),
        global_(world, photons, trace_global_photons(world, *caster_, photons, seed)),
        caustic_(world, caustic_photons,
                 trace_caustic_photons(world, *caster_, caustic_photons, seed)) {}

  // Mean over the image of each layer's green channel. Camera samples and the caustic map, seen
  // where they are sharp, take more samples a pixel than final gather rays do.
  Layers image() const {
    std::vector<Layers> pixels(kSize * kSize);
    tbb::parallel_for(0, kSize * kSize, [&](int i) {
      Layers& p = pixels[static_cast<size_t>(i)];
      p = {};
      for (uint64_t s = 0; s < camera_samples_; ++s) add_sample(i, s, p);
    });
    Layers mean{};
    for (const Layers& p : pixels)
      for (size_t l = 0; l < kLayers; ++l) mean[l] += p[l] / (kSize * kSize);
    if (light_paths_.needed()) mean[kIndirect] += shown_by_light_paths();
    return mean;
  }

 private:
  static constexpr uint64_t kRays = 4;

  const LightPaths* joined_paths() const { return light_paths_.needed() ? &light_paths_ : nullptr; }

  double shown_by_light_paths() const {
    const uint64_t paths = camera_samples_ * kSize * kSize;
    const Scene& scene = world_.scene();
    const auto sums =
        splat_light_paths(light_paths_, *caster_, scene.film, Lens(scene),
                          FilterTable(scene.film.filter), paths, seed_, Phase::kLightSplat);
    double sum = 0;
    for (const SplatSum& s : sums) sum += s.indirect.y;
    return sum / (kSize * kSize) / static_cast<double>(paths);
  }

  void add_sample(int pixel, uint64_t sample, Layers& p) const {
    const CameraSample c = trace_camera(world_, *caster_, pixel % kSize, pixel / kSize, sample,
                                        seed_, ShadowRays::kWithPath, joined_paths());
    const double share = 1 / static_cast<double>(camera_samples_);
    p[kEmission] += c.emission.y * share;
    p[kDirectLayer] += c.direct.y * share;
    p[kIndirect] += c.indirect.y * share;
    if (!c.diffuse) return;
    p[c.first ? kCaustic : kIndirect] += (c.weight * caustic_.estimate(c.x)).y * share;
    if (sample >= gather_samples_) return;
    const uint64_t number = static_cast<uint64_t>(pixel);
    const Random r(seed_, Phase::kSampler, (number << 32) | sample);
    for (uint64_t ray = 0; ray < kRays; ++ray) {
      const Vec3 d =
          Frame(c.x.shading_normal).to_world(sample_cosine({r.unit(ray, 0), r.unit(ray, 1)}));
      const GatherSample g =
          trace_gather(world_, *caster_, c.x, d, number, sample, ray, seed_, joined_paths());
      Rgb radiance = g.radiance;
      if (g.diffuse) radiance += g.weight * global_.estimate(g.y);
      p[kIndirect] +=
          (c.weight * radiance).y * (kPi / static_cast<double>(kRays * gather_samples_));
    }
  }

  const World& world_;
  std::unique_ptr<RayCaster> caster_;
  uint64_t camera_samples_, gather_samples_;  // a pixel
  uint64_t seed_;
  LightPaths light_paths_;
  Map global_, caustic_;
};

// Mean and standard error of each layer from independent batches.
template <class Batch>
std::array<Estimate, kLayers> in_batches(Batch&& batch) {
  std::array<Tally, kLayers> tallies;
  for (uint64_t b = 0; b < kBatches; ++b) {
    const Layers mean = batch(b);
    for (size_t l = 0; l < kLayers; ++l) tallies[l].add(mean[l]);
  }
  std::array<Estimate, kLayers> out;
  for (size_t l = 0; l < kLayers; ++l) out[l] = tallies[l].estimate();
  return out;
}

// Emission and direct light agree within 1 %, indirect light within 3 %, the caustic layer within
// what is stated. `effort` multiplies the photon mapper's photons and samples.
inline void check_layers(const char* name, const Scene& scene, int path_spp, uint64_t seed,
                         double caustic, uint64_t effort = 1) {
  const World world(scene);
  const auto caster = make_embree(world);
  const auto path = in_batches([&](uint64_t b) {
    PathOptions options;
    options.spp = path_spp;
    options.seed = batch_seed(seed, b);
    const Image image = render_path(world, *caster, options);
    Layers mean;
    for (size_t l = 0; l < kLayers; ++l)
      mean[l] = channel_mean(image, std::string(kNames[l]) + ".G");
    return mean;
  });
  const auto photons = in_batches([&](uint64_t b) {
    return PhotonMapper(world, 60000 * effort, 240000 * effort, effort, batch_seed(seed, 100 + b))
        .image();
  });
  const double stated[kLayers] = {0.01, 0.01, caustic, 0.03};
  for (size_t l = 0; l < kLayers; ++l) {
    const double error = std::hypot(path[l].error, photons[l].error);
    INFO(name << ", seed " << seed << ", " << kNames[l] << ": path " << path[l].mean << " +- "
              << path[l].error << ", photons " << photons[l].mean << " +- " << photons[l].error);
    CHECK(error <= stated[l] * path[l].mean / 4);
    CHECK(std::fabs(path[l].mean - photons[l].mean) <= stated[l] * path[l].mean);
  }
}

// Five walls, open to the camera; lamp or not.
inline Scene room(bool lamp) {
  Scene s;
  const int white = add_diffuse(s, Rgb(0.7)), red = add_diffuse(s, Rgb(0.6, 0.3, 0.1)),
            green = add_diffuse(s, Rgb(0.1, 0.6, 0.1));
  const Vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  add_quad(s, white, Vec3(0), z, x);
  add_quad(s, white, y, x, z);
  add_quad(s, white, z, y, x);
  add_quad(s, red, Vec3(0), y, z);
  add_quad(s, green, x, z, y);
  if (lamp) add_quad(s, -1, Vec3(0.3, 0.998, 0.3), x * 0.4, z * 0.4).radiance = Rgb(10);
  set_camera(s, Vec3(0.5, 0.5, -1.4), Vec3(0.5, 0.5, 0), y, 40, kSize, kSize);
  return s;
}

}  // namespace photonloom::oracle
