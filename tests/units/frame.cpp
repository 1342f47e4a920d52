// SPDX-License-Identifier: Apache-2.0
// The frame: exact sums, one image whatever the threads, batches and orders; golden near reference.
#include "golden/pipeline/frame.hpp"

#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "golden/numeric/elementary.hpp"
#include "golden/pipeline/prepare.hpp"
#include "golden/transport/camera.hpp"
#include "golden/transport/light_paths.hpp"
#include "golden/transport/path.hpp"
#include "golden/unit/cdf_sampler.hpp"
#include "tests/catch.hpp"
#include "tests/oracles/scenes.hpp"

using namespace photonloom;
using namespace photonloom::oracle;

namespace {

// A room `edge` wide with a lamp below the ceiling, a red wall, a mirror ball and a glass ball.
Scene room(double edge, bool balls, bool colour = true) {
  Scene s;
  s.name = "room";
  const int white = add_diffuse(s, Rgb(0.7));
  const int red = colour ? add_diffuse(s, Rgb(0.6, 0.1, 0.1)) : white;
  add_room(s, white, Vec3(0), Vec3(edge));
  add_quad(s, red, Vec3(1e-3 * edge, 0, 0), Vec3(0, edge, 0), Vec3(0, 0, edge));
  // Emits downwards.
  add_quad(s, white, Vec3(0.35, 0.999, 0.35) * edge, Vec3(0.3, 0, 0) * edge, Vec3(0, 0, 0.3) * edge)
      .radiance = Rgb(10);
  if (balls) {
    add_sphere(s, add_mirror(s), Vec3(0.3, 0.2, 0.6) * edge, 0.2 * edge);
    add_sphere(s, add_glass(s, 1.5), Vec3(0.7, 0.2, 0.4) * edge, 0.2 * edge);
  }
  set_camera(s, Vec3(0.5, 0.5, 0.02) * edge, Vec3(0.5, 0.45, 1) * edge, Vec3(0, 1, 0), 80, 24, 24);
  return s;
}

FrameRequest small_request() {
  FrameRequest r;
  r.photons = 20000;
  r.caustic_photons = 10000;
  r.k = 20;
  r.spp = 4;
  r.gather_rays = 4;
  return r;
}

Image rendered(const PreparedFrame& frame, Arithmetic arithmetic = Arithmetic::kGolden,
               FrameCounts* counts = nullptr) {
  FrameUnits units = make_golden_units(frame.plan);
  FrameCounts own;
  return render_frame(frame.input(arithmetic), units, counts ? *counts : own);
}

PreparedFrame prepared(const Scene& scene, const FrameRequest& request,
                       Arithmetic arithmetic = Arithmetic::kGolden) {
  return prepare_frame(std::make_unique<World>(scene), request, arithmetic, nullptr);
}

bool same_bytes(const Image& a, const Image& b) {
  if (a.channels.size() != b.channels.size()) return false;
  for (size_t i = 0; i < a.channels.size(); ++i)
    if (a.channels[i].name != b.channels[i].name || a.channels[i].pixels != b.channels[i].pixels)
      return false;
  return true;
}

}  // namespace

TEST_CASE(
    "a plan without room for its maps' further lines is refused before anything is rendered") {
  FrameRequest request = small_request();
  request.set = {"photon.lines=compressed", "photon.photon_bytes=10", "gatherer.beat_bits=320",
                 "photon.further_percent=0"};
  for (const bool only_plan : {false, true})
    CHECK_THROWS_WITH(prepare_frame(std::make_unique<World>(room(2, true)), request,
                                    Arithmetic::kGolden, nullptr, only_plan),
                      ContainsSubstring("expected photon.further_percent of at least"));
}

TEST_CASE("layers add up to the image and every layer has light") {
  FrameCounts counts;
  const PreparedFrame frame = prepared(room(1, true), small_request());
  const Image image = rendered(frame, Arithmetic::kGolden, &counts);
  for (const char* c : {"R", "G", "B"}) {
    double worst = 0;
    for (size_t i = 0; i < image.find(c)->pixels.size(); ++i) {
      double sum = 0;
      for (const char* layer : {"direct.", "caustic.", "indirect.", "emission."})
        sum += static_cast<double>(image.find(std::string(layer) + c)->pixels[i]);
      const double total = static_cast<double>(image.find(c)->pixels[i]);
      worst = std::max(worst, std::fabs(sum - total) / std::max(total, 1e-30));
    }
    CHECK(worst < 4e-7);  // four roundings to float
  }
  for (const char* name : {"direct.R", "caustic.R", "indirect.R", "emission.R", "albedo.G", "Z",
                           "photonDensity.Y", "error.R"})
    CHECK(channel_mean(image, name) > 0);
  CHECK(counts.camera_samples == 24 * 24 * 4);
  CHECK(counts.table_gathers > 0);
  CHECK(counts.table_gathers == counts.caustic_queries);
  CHECK(counts.directions == 4 * counts.table_gathers);
  CHECK(counts.final_gathers > counts.directions / 2);
  CHECK(counts.unmatched == 0);
  CHECK(counts.unanswered == 0);
  CHECK(counts.shader.weights == 0);
  CHECK(counts.shader.direct == 0);
}

TEST_CASE(
    "the image is the same with any number of threads, batch, order, pool and chunk of cache") {
  PreparedFrame frame = prepared(room(1, true), small_request());
  Image one;
  {
    const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
    const PreparedFrame alone = prepared(room(1, true), small_request());
    one = rendered(alone);
    CHECK(plan_text(alone.plan) == plan_text(frame.plan));
  }
  CHECK(same_bytes(rendered(frame), one));
  for (const char* line :
       {"frame.batch_tiles=1", "frame.tile=5", "reorder.key=none", "reorder.key=hash",
        "reorder.drain=fullest", "reorder.packets=1", "gatherer.contexts=1", "frame.order=pixel",
        "frame.order=direction_bins", "frame.direction_bin_bits=1", "frame.batch_tiles=0"}) {
    INFO(line);
    set_plan_line(frame.plan, line);
    CHECK(same_bytes(rendered(frame), one));
  }
}

namespace {

// A point lamp, a glass ball and a mirror, a floor of rough metal, a rough plastic wall: light that
// no photon carries.
Scene lamp_room() {
  Scene s;
  add_room(s, add_diffuse(s, Rgb(0.5)), Vec3(0), Vec3(1));
  Bsdf rough;
  rough.kind = BsdfKind::kRoughConductor;
  rough.alpha_u = rough.alpha_v = 0.5;
  rough.specular = Rgb(0.9, 0.7, 0.5);
  add_quad(s, add_bsdf(s, rough), Vec3(0, 1e-3, 0), Vec3(0, 0, 1), Vec3(1, 0, 0));
  rough.kind = BsdfKind::kRoughPlastic;
  rough.specular = Rgb(1);
  rough.diffuse = Rgb(0.5);
  rough.ior = 2;
  add_quad(s, add_bsdf(s, rough), Vec3(0, 0, 1 - 1e-3), Vec3(0, 1, 0), Vec3(1, 0, 0));
  add_sphere(s, add_glass(s, 1.5), Vec3(0.45, 0.45, 0.6), 0.2);
  add_sphere(s, add_mirror(s), Vec3(0.8, 0.25, 0.5), 0.12);
  Light lamp;
  lamp.position = Vec3(0.45, 0.8, 0.6);
  lamp.intensity = Rgb(1);
  s.lights.push_back(lamp);
  set_camera(s, Vec3(0.5, 0.6, 0.02), Vec3(0.5, 0.3, 1), Vec3(0, 1, 0), 70, 24, 24);
  return s;
}

}  // namespace

TEST_CASE("light that mirrors and glass throw onto rough surfaces is the path tracer's") {
  const Scene scene = lamp_room();
  FrameRequest request = small_request();
  request.photons = 60000;
  request.caustic_photons = 60000;
  request.spp = 64;
  const PreparedFrame frame = prepared(scene, request);
  FrameCounts counts;
  const Image image = rendered(frame, Arithmetic::kGolden, &counts);
  CHECK(counts.shader.direct == 0);
  const World world(scene);
  PathOptions options;
  options.spp = 256;
  const Image path = render_path(world, *make_double_bvh(world), options);
  for (const char* c : {"R", "G", "B"}) {
    INFO(c << ": " << channel_mean(image, c) << ", path tracer " << channel_mean(path, c));
    CHECK(channel_mean(image, c) == Approx(channel_mean(path, c)).epsilon(0.02));
  }
}

TEST_CASE("light paths beside photons leave to the maps what diffuse lobes throw back") {
  const World world(lamp_room());
  const auto caster = make_double_bvh(world);
  const LightPaths beside(world, Photons::kOnDiffuse), all(world, Photons::kNone);
  const Lens lens(world.scene());
  std::vector<LightVertex> some, every;
  uint64_t plain = 0, rough = 0, splats = 0;
  for (uint64_t i = 0; i < 2000; ++i) {
    const Random random(7, Phase::kLightPath, i);
    all.trace(*caster, random, every);
    for (const LightVertex& v : every) plain += v.first && v.surface.diffuse_probability() == 1;
    beside.trace(*caster, random, some);
    for (const LightVertex& v : some) {
      rough += v.first;
      if (v.first) CHECK(v.surface.diffuse_probability() < 1);
      Splat splat;
      if (!beside.splat(*caster, lens, Vec2(0), v, splat)) continue;
      ++splats;
      CHECK(is_black(splat.caustic));
    }
  }
  CHECK(plain > 0);
  CHECK(rough > 0);
  CHECK(splats > 0);
}

TEST_CASE("light paths reach final gather rays by rough surfaces that these meet") {
  const World world(lamp_room());
  const auto caster = make_double_bvh(world);
  const LightPaths beside(world, Photons::kOnDiffuse);
  // From the right wall down to the floor of rough metal.
  const Hit hit = caster->closest({Vec3(0.5, 0.5, 0.2), Vec3(1, 0, 0)}, nullptr);
  REQUIRE(hit.valid());
  const DiffuseHit x{hit.position, Vec3(-1, 0, 0), Vec3(-1, 0, 0), hit, 1, nullptr};
  const Vec3 down = glm::normalize(Vec3(-1, -1, 0.5));
  double without = 0, with = 0;
  for (uint64_t ray = 0; ray < 400; ++ray) {
    without += trace_gather(world, *caster, x, down, 0, 0, ray, 1).radiance.y;
    with += trace_gather(world, *caster, x, down, 0, 0, ray, 1, &beside).radiance.y;
  }
  CHECK(with > 1.01 * without);
}

TEST_CASE("light paths in the image: the same in any batch and with any threads, also filtered") {
  for (const FilterKind kind : {FilterKind::kBox, FilterKind::kGaussian}) {
    Scene scene = lamp_room();
    scene.film.filter = {kind, kind == FilterKind::kBox ? 0.5 : 2, 0.5};
    PreparedFrame frame = prepared(scene, small_request());
    Image one;
    {
      const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
      one = rendered(frame);
    }
    for (const char* line : {"frame.batch_tiles=1", "frame.order=pixel", "reorder.key=hash"}) {
      INFO(line);
      set_plan_line(frame.plan, line);
      CHECK(same_bytes(rendered(frame), one));
    }
  }
}

namespace {

// A request whose frame has two passes.
FrameRequest adaptive_request() {
  FrameRequest r = small_request();
  r.gather_rays = 12;
  r.set = {"frame.first_rays=2", "frame.mean_rays=4", "frame.tile=6"};
  return r;
}

}  // namespace

TEST_CASE("two passes: the mean number of rays, the same image in any order and with any threads") {
  PreparedFrame frame = prepared(room(1, true), adaptive_request());
  FrameCounts counts;
  Image one;
  {
    const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
    one = rendered(frame, Arithmetic::kGolden, &counts);
  }
  CHECK(counts.unmatched == 0);
  CHECK(counts.unanswered == 0);
  const auto samples = static_cast<double>(counts.caustic_queries);
  CHECK(static_cast<double>(counts.directions) / samples == Approx(4).epsilon(0.02));
  CHECK(static_cast<double>(counts.table_gathers) > 1.5 * samples);
  for (const char* line : {"reorder.key=none", "reorder.key=hash", "reorder.drain=fullest",
                           "reorder.packets=1", "gatherer.contexts=1"}) {
    INFO(line);
    set_plan_line(frame.plan, line);
    CHECK(same_bytes(rendered(frame), one));
  }
  // Rays go where noise is: more to some samples, and the image is another.
  set_plan_line(frame.plan, "frame.first_rays=0");
  set_plan_line(frame.plan, "frame.gather_rays=4");
  CHECK(!same_bytes(rendered(frame), one));
}

TEST_CASE(
    "two passes of shadow rays: the mean number, the same image in any order and with any "
    "threads") {
  FrameRequest request = small_request();
  request.gather_rays = 2;
  request.set = {"frame.shadow_rays=64", "frame.first_shadow_rays=2", "frame.mean_shadow_rays=4",
                 "frame.tile=12"};
  PreparedFrame frame = prepared(room(1, true), request);
  FrameCounts counts;
  Image one;
  {
    const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
    one = rendered(frame, Arithmetic::kGolden, &counts);
  }
  // The lamp fills little of the hemisphere: rays along the cosine show next to no noise.
  CHECK(counts.emitter_rays_cast > counts.shadow_rays / 2);
  CHECK(counts.cosine_rays_cast < counts.shadow_rays / 2);
  for (const char* line :
       {"reorder.key=none", "reorder.key=hash", "reorder.drain=fullest", "reorder.packets=1",
        "gatherer.contexts=1", "frame.order=pixel", "frame.order=direction_bins"}) {
    INFO(line);
    set_plan_line(frame.plan, line);
    CHECK(same_bytes(rendered(frame), one));
  }
  // As many everywhere: the same mean, and another image. The other layers do not know of it.
  set_plan_line(frame.plan, "frame.first_shadow_rays=0");
  set_plan_line(frame.plan, "frame.shadow_rays=4");
  FrameCounts fixed;
  const Image even = rendered(frame, Arithmetic::kGolden, &fixed);
  CHECK(static_cast<double>(counts.shadow_rays) ==
        Approx(static_cast<double>(fixed.shadow_rays)).epsilon(0.005));
  CHECK(even.find("direct.G")->pixels != one.find("direct.G")->pixels);
  CHECK(even.find("indirect.G")->pixels == one.find("indirect.G")->pixels);
}

TEST_CASE("a lamp without a size has no noise, and no second shadow rays") {
  Scene scene = room(1, false);
  std::erase_if(scene.shapes, [](const Shape& shape) { return shape.radiance.has_value(); });
  Light lamp;
  lamp.kind = LightKind::kPoint;
  lamp.position = Vec3(0.5, 0.9, 0.5);
  lamp.intensity = Rgb(1);
  scene.lights.push_back(lamp);
  FrameRequest request = small_request();
  request.set = {"frame.shadow_rays=64", "frame.first_shadow_rays=2", "frame.mean_shadow_rays=8"};
  FrameCounts counts;
  rendered(prepared(scene, request), Arithmetic::kGolden, &counts);
  CHECK(counts.shadow_rays == 2 * 2 * counts.camera_samples);
}

namespace {

// Means of a layer in 4 x 4 blocks of the image and of all of it, over seeds of the final gather
// rays and shadow rays with everything else fixed, and their squared standard errors.
struct Means {
  std::vector<double> mean, variance;
};
Means over_ray_seeds(const PreparedFrame& frame, const std::string& layer, uint64_t first,
                     uint64_t seeds) {
  std::vector<double> sum(17, 0.0), sum2(17, 0.0);
  for (uint64_t seed = first; seed < first + seeds; ++seed) {
    FrameUnits units = make_golden_units(frame.plan);
    FrameInput input = frame.input(Arithmetic::kGolden);
    input.ray_seed = seed;
    FrameCounts counts;
    const Image image = render_frame(input, units, counts);
    std::vector<double> blocks(17, 0.0);
    for (const char* channel : {".R", ".G", ".B"}) {
      const std::vector<float>& pixels = image.find(layer + channel)->pixels;
      for (size_t i = 0; i < pixels.size(); ++i) {
        blocks[i / 24 / 6 * 4 + i % 24 / 6] += static_cast<double>(pixels[i]);
        blocks[16] += static_cast<double>(pixels[i]);
      }
    }
    for (size_t b = 0; b < blocks.size(); ++b) {
      sum[b] += blocks[b];
      sum2[b] += blocks[b] * blocks[b];
    }
  }
  Means m;
  const auto n = static_cast<double>(seeds);
  for (size_t b = 0; b < sum.size(); ++b) {
    m.mean.push_back(sum[b] / n);
    m.variance.push_back((sum2[b] - sum[b] * sum[b] / n) / (n * (n - 1)));
  }
  return m;
}

// |z| of the whole image below 3, of the blocks as 17 normal numbers have it.
void check_same_light(const Means& got, const Means& expected) {
  double chi2 = 0;
  for (size_t b = 0; b < 17; ++b) {
    const double d = got.mean[b] - expected.mean[b];
    const double z = d / std::sqrt(got.variance[b] + expected.variance[b]);
    CAPTURE(b, z, got.mean[b], expected.mean[b]);
    CHECK(std::fabs(z) < (b == 16 ? 3 : 4));
    if (b < 16) chi2 += z * z;
  }
  // 16 blocks: 99.9 % lie below 39.
  CHECK(chi2 < 45);
}

}  // namespace

TEST_CASE("two passes of shadow rays are unbiased: 64 ray seeds against as many fixed rays",
          "[slow]") {
  FrameRequest request = small_request();
  request.spp = 1;
  const Scene scene = room(1, true);
  const std::vector<std::string> fixed = {"frame.gather_rays=0", "frame.shadow_rays=16"};
  const std::vector<std::vector<std::string>> settings = {
      {"frame.gather_rays=0", "frame.shadow_rays=16", "frame.first_shadow_rays=2",
       "frame.mean_shadow_rays=4", "frame.tile=6"},
      // Both kinds of two passes at once.
      {"frame.gather_rays=4", "frame.first_rays=2", "frame.mean_rays=3", "frame.shadow_rays=16",
       "frame.first_shadow_rays=2", "frame.mean_shadow_rays=4"}};
  request.set = fixed;
  const Means expected = over_ray_seeds(prepared(scene, request), "direct", 1000, 64);
  for (const auto& lines : settings) {
    request.set = lines;
    INFO(lines.front());
    check_same_light(over_ray_seeds(prepared(scene, request), "direct", 1, 64), expected);
  }
}

TEST_CASE("every table and both passes are unbiased: 64 ray seeds against 64 times the rays",
          "[slow]") {
  FrameRequest request = small_request();
  request.spp = 1;
  request.set = {"sampler.combine=cosine", "frame.gather_rays=16"};
  const Scene scene = room(1, true);
  // 16 seeds of 16 rays: 64 times the 4 rays below.
  const Means expected = over_ray_seeds(prepared(scene, request), "indirect", 1000, 16);
  const std::vector<std::vector<std::string>> settings = {
      {"sampler.combine=sum", "sampler.levels=4", "frame.table_photons=indirect"},
      {"sampler.combine=product", "sampler.levels=5"},
      {"sampler.combine=weighted", "sampler.levels=2"},
      // Cells without photons, which keep one part of 2^6: of 2^16 64 seeds would see too few rays
      // for a normal distribution.
      {"sampler.combine=photons", "sampler.probability_bits=6"},
      {"sampler.combine=product", "sampler.probability_bits=6"},
      {"sampler.levels=3", "frame.gather_rays=12", "frame.first_rays=2", "frame.mean_rays=4",
       "frame.tile=6"}};
  for (const auto& lines : settings) {
    request.set = {"frame.gather_rays=4"};
    request.set.insert(request.set.end(), lines.begin(), lines.end());
    std::string name;
    for (const std::string& line : lines) name += line + " ";
    INFO(name);
    check_same_light(over_ray_seeds(prepared(scene, request), "indirect", 1, 64), expected);
  }
}

namespace {

// Keeps what comes.
class KeepingBuffer final : public ReorderBuffer {
 public:
  explicit KeepingBuffer(std::vector<GatherQuery>& kept) : kept_(kept) {}
  void process(std::span<const GatherQuery> in, std::vector<GatherQuery>& out) override {
    for (const GatherQuery& query : in)
      if (!query.flush) kept_.push_back(query);
    out.insert(out.end(), in.begin(), in.end());
  }
  Counters counters() const override { return {}; }

 private:
  std::vector<GatherQuery>& kept_;
};

// Keeps the bin of every direction that it samples, by pixel, sample and ray.
class KeepingSampler final : public CdfSampler {
 public:
  using Bins = std::map<std::array<uint32_t, 3>, size_t>;
  KeepingSampler(const Plan& plan, Bins& bins)
      : golden_(make_golden_cdf_sampler(plan)), plan_(plan), bins_(bins) {}
  void process(std::span<const SamplerInput> in, std::vector<Sample>& out) override {
    const size_t first = out.size();
    golden_->process(in, out);
    for (size_t i = first; i < out.size(); ++i)
      bins_[{out[i].pixel, out[i].sample, out[i].tag}] =
          direction_bin(plan_, sampled_code(out[i]).code);
  }
  Counters counters() const override { return {}; }

 private:
  std::unique_ptr<CdfSampler> golden_;
  const Plan& plan_;
  Bins& bins_;
};

// Keeps u of the requests of each pixel and sample, by ray, as a part of 1.
class KeepingRequests final : public CdfSampler {
 public:
  using Numbers = std::map<std::array<uint32_t, 2>, std::map<uint32_t, double>>;
  KeepingRequests(const Plan& plan, Numbers& numbers)
      : golden_(make_golden_cdf_sampler(plan)), bits_(plan.u_bits), numbers_(numbers) {}
  void process(std::span<const SamplerInput> in, std::vector<Sample>& out) override {
    for (const SamplerInput& packet : in) {
      if (packet.kind == 0) table_ = {packet.pixel, packet.sample};
      if (packet.kind == 2)
        numbers_[table_][packet.tag] = std::ldexp(static_cast<double>(packet.u), -bits_);
    }
    golden_->process(in, out);
  }
  Counters counters() const override { return {}; }

 private:
  std::unique_ptr<CdfSampler> golden_;
  int bits_;
  Numbers& numbers_;
  std::array<uint32_t, 2> table_{};
};

KeepingRequests::Numbers numbers_of(const PreparedFrame& frame) {
  KeepingRequests::Numbers numbers;
  FrameUnits units = make_golden_units(frame.plan);
  units.cdf_sampler = std::make_unique<KeepingRequests>(frame.plan, numbers);
  FrameCounts counts;
  render_frame(frame.input(Arithmetic::kGolden), units, counts);
  return numbers;
}

}  // namespace

TEST_CASE("a sample's rays are stratified in u: one a stratum, in two passes both together") {
  PreparedFrame frame = prepared(room(1, true), adaptive_request());
  const KeepingRequests::Numbers two_passes = numbers_of(frame);
  REQUIRE(two_passes.size() > 500);
  std::set<size_t> counts;
  double farthest = 0, mean = 0;
  for (const auto& [sample, numbers] : two_passes) {
    std::vector<double> sorted;
    for (const auto& [ray, u] : numbers) {
      REQUIRE(ray == sorted.size());
      sorted.push_back(u);
    }
    mean += sorted.front() / static_cast<double>(two_passes.size());
    std::sort(sorted.begin(), sorted.end());
    const auto n = static_cast<double>(sorted.size());
    double gap = sorted.front() + 1 - sorted.back();
    for (size_t i = 1; i < sorted.size(); ++i) gap = std::max(gap, sorted[i] - sorted[i - 1]);
    farthest = std::max(farthest, gap * n);
    counts.insert(sorted.size());
  }
  CHECK(counts.size() > 3);
  // The largest of three gaps: 1 + 2 / sqrt(5) of 1 / n at most; of random numbers ln n and more.
  CHECK(farthest <= 1 + 2 / std::sqrt(5.0) + 1e-6);
  CHECK(mean == Approx(0.5).margin(4 / std::sqrt(12.0 * static_cast<double>(two_passes.size()))));

  set_plan_line(frame.plan, "frame.first_rays=0");
  for (const auto& [sample, numbers] : numbers_of(frame))
    for (const auto& [ray, u] : numbers)
      REQUIRE(static_cast<size_t>(u * static_cast<double>(numbers.size())) == ray);
}

TEST_CASE("final gathers come in the order that the plan names") {
  PreparedFrame frame = prepared(room(1, true), small_request());
  Plan& plan = frame.plan;
  plan.tile = 10;  // 24 x 24 pixels: tiles at the borders are smaller
  for (const FrameOrder order : {FrameOrder::kPixel, FrameOrder::kTile, FrameOrder::kDirectionBins})
    for (const int batch : {0, 2}) {
      plan.order = order;
      plan.batch_tiles = batch;
      std::vector<GatherQuery> kept;
      KeepingSampler::Bins bins;
      FrameUnits units = make_golden_units(plan);
      units.reorder_buffer = std::make_unique<KeepingBuffer>(kept);
      units.cdf_sampler = std::make_unique<KeepingSampler>(plan, bins);
      FrameCounts counts;
      render_frame(frame.input(Arithmetic::kGolden), units, counts);
      REQUIRE(kept.size() == counts.final_gathers);
      // The key by which docs/reordering.md sorts: batch, tile, bin, place of the pixel, sample,
      // ray.
      const auto key = [&](const GatherQuery& q) {
        const int x = static_cast<int>(q.pixel) % 24, y = static_cast<int>(q.pixel) / 24;
        const int tile = y / 10 * 3 + x / 10;
        const bool tiles = order != FrameOrder::kPixel;
        return std::array<size_t, 6>{
            batch ? static_cast<size_t>(tile / batch) : 0,
            tiles ? static_cast<size_t>(tile) : 0,
            order == FrameOrder::kDirectionBins ? bins.at({q.pixel, q.sample, q.tag}) : 0,
            q.pixel,
            q.sample,
            q.tag};
      };
      INFO("order " << static_cast<int>(order) << ", batch " << batch);
      CHECK(std::is_sorted(kept.begin(), kept.end(),
                           [&](const auto& a, const auto& b) { return key(a) < key(b); }));
    }
}

TEST_CASE("another seed gives another image, the same one the same") {
  FrameRequest request = small_request();
  const Image a = rendered(prepared(room(1, false), request));
  CHECK(same_bytes(a, rendered(prepared(room(1, false), request))));
  request.seed = 2;
  CHECK(!same_bytes(a, rendered(prepared(room(1, false), request))));
}

TEST_CASE("golden is near reference on the same photons, queries and directions") {
  for (const bool balls : {false, true}) {
    const PreparedFrame frame = prepared(room(1, balls), small_request(), Arithmetic::kReference);
    const Image golden = rendered(frame), reference = rendered(frame, Arithmetic::kReference);
    for (const char* name : {"R", "G", "B", "indirect.R", "indirect.G"}) {
      const double g = channel_mean(golden, name), r = channel_mean(reference, name);
      INFO(name << ": golden " << g << ", reference " << r);
      // 16-bit positions, 9-bit mantissas: a relative error of some 2^-9 of a pixel, no bias.
      CHECK(std::fabs(g / r - 1) < 2e-3);
    }
    CHECK(golden.find("direct.R")->pixels == reference.find("direct.R")->pixels);
    CHECK(golden.find("photonDensity.Y")->pixels == reference.find("photonDensity.Y")->pixels);
  }
}

TEST_CASE("a scene scaled by 1e-3 or 1e3 gives the same image") {
  const Image one = rendered(prepared(room(1, true), small_request()));
  for (const double scale : {1e-3, 1e3}) {
    const Image other = rendered(prepared(room(scale, true), small_request()));
    for (const char* name : {"R", "direct.G", "indirect.B", "caustic.R"}) {
      INFO(name << " at scale " << scale);
      // The same random numbers: only paths that roundings turn away differ.
      CHECK(channel_mean(other, name) == Approx(channel_mean(one, name)).epsilon(0.01));
    }
    CHECK(channel_mean(other, "Z") == Approx(scale * channel_mean(one, "Z")).epsilon(1e-3));
    CHECK(channel_mean(other, "photonDensity.Y") * scale * scale ==
          Approx(channel_mean(one, "photonDensity.Y")).epsilon(0.01));
  }
}

TEST_CASE("a lamp 1e-3 of the room's height below the ceiling leaks no light onto it") {
  for (const double scale : {1e-2, 1.0, 1e3}) {
    Scene s = room(scale, false);
    set_camera(s, Vec3(0.5, 0.3, 0.5) * scale, Vec3(0.5, 1, 0.51) * scale, Vec3(0, 0, 1), 90, 24,
               24);
    const Image image = rendered(prepared(s, small_request()));
    int ceiling = 0, lit = 0, seen = 0;
    for (size_t i = 0; i < 24 * 24; ++i) {
      // The lamp emits 10; every other pixel here shows ceiling or wall.
      if (image.find("emission.R")->pixels[i] > 0 || image.find("N.Y")->pixels[i] > -1) continue;
      ++ceiling;
      lit += image.find("direct.R")->pixels[i] > 0;
      seen += image.find("indirect.R")->pixels[i] > 0;
    }
    INFO("scale " << scale);
    CHECK(ceiling > 100);
    CHECK(lit == 0);
    CHECK(seen == ceiling);
  }
}

TEST_CASE("a light far outside of the scene loses nothing to the pixel's format") {
  // Most of its power passes by; the floor's irradiance is 1 at every distance.
  for (const double distance : {10.0, 1e3, 1e6, 1e9}) {
    Scene s;
    add_quad(s, add_diffuse(s, Rgb(0.5)), Vec3(-1, 0, -1), Vec3(0, 0, 2), Vec3(2, 0, 0));
    Light light;
    light.position = Vec3(0, distance, 0);
    light.intensity = Rgb(distance * distance);
    s.lights.push_back(light);
    set_camera(s, Vec3(0, 3, 0), Vec3(0), Vec3(0, 0, 1), 30, 8, 8);
    s.max_depth = 2;
    const PreparedFrame frame = prepared(s, small_request(), Arithmetic::kReference);
    INFO("distance " << distance);
    CHECK(channel_mean(rendered(frame), "R") ==
          Approx(channel_mean(rendered(frame, Arithmetic::kReference), "R")).epsilon(1e-6));
  }
}

TEST_CASE("golden is near reference in a small room on a wide ground") {
  Scene s = room(1, false);
  add_quad(s, add_diffuse(s, Rgb(0.7)), Vec3(-1000, 0, -1000), Vec3(0, 0, 2000), Vec3(2000, 0, 0));
  FrameRequest request = small_request();
  request.photons = 100000;
  const PreparedFrame frame = prepared(s, request, Arithmetic::kReference);
  INFO(frame.plan.position_bits << " position bits");
  CHECK(channel_mean(rendered(frame), "indirect.G") ==
        Approx(channel_mean(rendered(frame, Arithmetic::kReference), "indirect.G")).epsilon(0.01));
  // Without a wide ground nothing changes.
  CHECK(prepared(room(1, true), small_request()).plan.position_bits == 16);
}

TEST_CASE("one light colour takes one channel") {
  FrameRequest request = small_request();
  const PreparedFrame grey = prepared(room(1, true, false), request);
  CHECK(grey.plan.channels == 1);
  const Image image = rendered(grey);
  CHECK(image.find("R")->pixels == image.find("G")->pixels);
  // Three channels of the same photons see the same; only the sampler's table, which adds the
  // channels, rounds otherwise.
  request.set = {"photon.channels=3", "photon.channel_color=[1, 1, 1]"};
  const PreparedFrame three = prepared(room(1, true, false), request);
  CHECK(three.plan.channels == 3);
  const Image coloured = rendered(three);
  CHECK(coloured.find("R")->pixels == coloured.find("B")->pixels);
  CHECK(channel_mean(coloured, "R") == Approx(channel_mean(image, "R")).epsilon(0.01));
  CHECK(prepared(room(1, true), small_request()).plan.channels == 3);
}

TEST_CASE("only what the scene needs is planned") {
  const Plan plain = prepared(room(1, false), small_request()).plan;
  CHECK(!plain.caustic.present);
  CHECK(plain.global.present);
  CHECK(plain.line_bits() == 12);  // 20,000 photons in lines of 8
  FrameRequest request = small_request();
  request.gather_rays = 0;
  const PreparedFrame direct = prepared(room(1, false), request);
  CHECK(!direct.plan.global.present);
  CHECK(channel_mean(rendered(direct), "indirect.R") == 0);
  Scene shallow = room(1, true);
  shallow.max_depth = 2;
  const PreparedFrame two = prepared(shallow, small_request());
  CHECK(!two.plan.global.present);
  CHECK(!two.plan.caustic.present);
  CHECK(channel_mean(rendered(two), "direct.R") > 0);
}

TEST_CASE("k = 1 is refused, with a radius too: a result with its one photon counts (k - 1) / k") {
  FrameRequest request = small_request();
  request.k = 1;
  CHECK_THROWS_AS(prepared(room(1, false), request), PlanError);
  for (const double radius : {0.1, 0.0}) {
    request.radius = radius;
    CHECK_THROWS_AS(prepared(room(1, false), request), PlanError);
  }
}

namespace {

FrameRequest cached_request(const std::vector<std::string>& lines = {}) {
  FrameRequest r = small_request();
  r.set = {"cache.present=true", "cache.records=1024"};
  r.set.insert(r.set.end(), lines.begin(), lines.end());
  return r;
}

double indirect_difference(const Image& a, const Image& b) {
  double difference = 0, sum = 0;
  for (const char* name : {"indirect.R", "indirect.G", "indirect.B"})
    for (size_t i = 0; i < a.find(name)->pixels.size(); ++i) {
      const auto x = static_cast<double>(a.find(name)->pixels[i]);
      difference += std::fabs(x - static_cast<double>(b.find(name)->pixels[i]));
      sum += x;
    }
  return difference / sum;
}

}  // namespace

TEST_CASE("a cached image is the same in every order, batch and number of threads") {
  for (const char* passes : {"cache.passes=1", "cache.passes=2"}) {
    PreparedFrame frame = prepared(room(1, true), cached_request({passes}));
    FrameCounts counts;
    const Image one = rendered(frame, Arithmetic::kGolden, &counts);
    CHECK(counts.cache_hits > counts.cache_samples / 4);
    CHECK(counts.cache_hits + counts.cache_records + counts.cache_full == counts.cache_samples);
    CHECK(counts.directions == 4 * (counts.table_gathers - counts.cache_hits));
    CHECK(counts.unmatched == 0);
    CHECK(counts.unanswered == 0);
    {
      const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
      CHECK(same_bytes(rendered(frame), one));
    }
    for (const char* line : {"frame.batch_tiles=1", "reorder.key=none", "reorder.key=hash",
                             "reorder.drain=fullest", "reorder.packets=1"}) {
      INFO(line);
      set_plan_line(frame.plan, line);
      CHECK(same_bytes(rendered(frame), one));
    }
    set_plan_line(frame.plan, "frame.tile=5");  // other tiles, other records
    CHECK(!same_bytes(rendered(frame), one));
  }
}

TEST_CASE("records that reach no one else give the image without a cache") {
  const Image without = rendered(prepared(room(1, true), small_request()));
  FrameCounts counts;
  const Image alone =
      rendered(prepared(room(1, true), cached_request({"cache.accuracy=0", "cache.records=4096"})),
               Arithmetic::kGolden, &counts);
  CHECK(counts.cache_records == counts.cache_samples);
  CHECK(counts.clamps.reaches == counts.cache_samples);
  CHECK(indirect_difference(alone, without) < 1e-5);
  // Nor do tiles that have no room for records.
  const Image full =
      rendered(prepared(room(1, true), cached_request({"cache.accuracy=0", "cache.records=1"})),
               Arithmetic::kGolden, &counts);
  CHECK(counts.cache_full > 0);
  CHECK(indirect_difference(full, without) < 1e-5);
}

TEST_CASE("each line of the cache changes what it says") {
  const auto run = [](const std::vector<std::string>& lines) {
    FrameCounts counts;
    Image image =
        rendered(prepared(room(1, true), cached_request(lines)), Arithmetic::kGolden, &counts);
    return std::pair(std::move(image), counts);
  };
  const auto [usual, counts] = run({});
  CHECK(run({"cache.accuracy=0.02"}).second.cache_records > counts.cache_records);
  CHECK(run({"cache.angle_bits=18"}).second.cache_records < counts.cache_records);
  CHECK(run({"cache.radius_max=0.001"}).second.cache_records > counts.cache_records);
  CHECK(run({"cache.radius_max=0.001"}).second.clamps.radii > counts.clamps.radii);
  CHECK(run({"cache.radius_min=0.25"}).second.cache_records < counts.cache_records);
  CHECK(run({"cache.records=2"}).second.cache_full > counts.cache_full);
  CHECK(run({"cache.glossy=true"}).second.cache_samples >= counts.cache_samples);
  const FrameCounts probed = run({"cache.radius=probe"}).second;
  CHECK(probed.probe_rays == 4 * probed.cache_samples);
  CHECK(counts.probe_rays == 0);
  for (const char* line :
       {"cache.hits=1", "cache.passes=1", "cache.weight_bits=4", "cache.radius=probe",
        "cache.gradients=translation", "cache.gradients=both"}) {
    INFO(line);
    CHECK(!same_bytes(run({line}).first, usual));
  }
  CHECK(!same_bytes(run({"cache.radius=probe", "cache.probe_rays=9"}).first,
                    run({"cache.radius=probe"}).first));
}

TEST_CASE("a cached image is near the one without, in both arithmetics") {
  const PreparedFrame frame = prepared(room(1, false), cached_request(), Arithmetic::kReference);
  const Image golden = rendered(frame), reference = rendered(frame, Arithmetic::kReference);
  const Image without = rendered(prepared(room(1, false), small_request()));
  for (const char* name : {"indirect.R", "indirect.G"}) {
    const double g = channel_mean(golden, name), r = channel_mean(reference, name);
    INFO(name << ": golden " << g << ", reference " << r << ", without "
              << channel_mean(without, name));
    CHECK(std::fabs(g / r - 1) < 2e-3);
    CHECK(std::fabs(g / channel_mean(without, name) - 1) < 3e-2);
  }
}

TEST_CASE("a frame of instances is that of explicit copies, byte by byte") {
  Scene copies = room(1, false);
  copies.film = {12, 12};
  Scene instanced = copies;
  // A tetrahedron, faceted.
  Shape piece;
  piece.bsdf = add_diffuse(copies, Rgb(0.4, 0.6, 0.2));
  add_diffuse(instanced, Rgb(0.4, 0.6, 0.2));
  piece.mesh.positions = {{0, 0, 0}, {0.2, 0, 0}, {0.1, 0.25, 0.05}, {0.1, 0.05, 0.2}};
  piece.mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  for (int i = 0; i < 6; ++i) {
    const Vec2 c = cos_sin_turns(0.13 * i);
    Mat4 m(1);
    m[0] = {c.x, 0, -c.y, 0};
    m[2] = {c.y, 0, c.x, 0};
    m[3] = {0.15 + 0.12 * i, 0.1 + 0.05 * i, 0.4 + 0.05 * (i % 3), 1};
    Shape copy = piece;
    for (Vec3& p : copy.mesh.positions) p = Vec3(m * glm::dvec4(p, 1));
    copies.shapes.push_back(copy);
    instanced.instances.push_back({0, m});
  }
  piece.group = 0;
  instanced.shapes.push_back(piece);
  FrameRequest request = small_request();
  request.radius = 0.2;
  request.photons = 5000;
  const Image a = rendered(prepared(copies, request)), b = rendered(prepared(instanced, request));
  CHECK(same_bytes(a, b));
  instanced.instances.back().to_world[3].x += 0.01;
  CHECK_FALSE(same_bytes(a, rendered(prepared(instanced, request))));
}
