// SPDX-License-Identifier: Apache-2.0
#include "golden/pipeline/gather_diagnosis.hpp"

#include <fmt/core.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "golden/numeric/memory.hpp"
#include "golden/numeric/octahedral.hpp"
#include "golden/numeric/random.hpp"

namespace photonloom {

struct GatherWatch::Record {
  GatherTally tally[2];
  std::vector<Pixel> pixels;
};

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// More photons than this many times the plan's are not advised: the radius takes the rest.
constexpr double kMostPhotons = 16;
// A light is starved when it has less than this part of an even share of the photons.
constexpr double kStarvedShare = 0.25;

void count(GatherTally& tally, uint32_t found, uint32_t k) {
  ++tally.gathers;
  tally.none += found == 0;
  tally.few += found > 0 && found < k;
}

class Watched final : public InFront<PhotonGatherer> {
 public:
  Watched(std::unique_ptr<PhotonGatherer> unit, const Plan& plan,
          std::shared_ptr<GatherWatch::Record> record)
      : InFront<PhotonGatherer>({unit.get()}),
        unit_(std::move(unit)),
        k_(static_cast<uint32_t>(plan.k)),
        record_(std::move(record)) {}

  void process(std::span<const GatherQuery> in, std::vector<GatherResult>& results,
               std::vector<GatherPhoton>& photons) override {
    const size_t before = results.size();
    unit_->process(in, results, photons);
    // A faulty unit may give more or fewer.
    const size_t answered = std::min(in.size(), results.size() - before);
    for (size_t i = 0; i < answered; ++i) {
      const GatherQuery& query = in[i];
      if (query.flush) continue;
      const uint32_t found = results[before + i].count;
      count(record_->tally[query.map != 0], found, k_);
      if (query.map || query.pixel >= record_->pixels.size()) continue;
      GatherWatch::Pixel& pixel = record_->pixels[query.pixel];
      if (found < k_ && pixel.tally.none + pixel.tally.few == 0) {
        pixel.position = query.position;
        pixel.normal = query.normal;
      }
      count(pixel.tally, found, k_);
      pixel.found += found;
    }
  }
  Counters counters() const override { return unit_->counters(); }

 private:
  std::unique_ptr<PhotonGatherer> unit_;
  uint32_t k_;
  std::shared_ptr<GatherWatch::Record> record_;
};

// The lights of a scene by name: a shape's primitives are one.
struct Lights {
  Lights(const World& world) {
    std::map<std::string, uint32_t> seen;
    for (const Emitter& e : world.emitters()) {
      const uint32_t shape =
          e.primitive >= 0 ? world.primitives()[static_cast<size_t>(e.primitive)].shape : 0;
      const std::string id = e.primitive >= 0 ? world.scene().shapes[shape].id : "";
      const std::string name = !id.empty()        ? fmt::format("`{}`", id)
                               : e.primitive >= 0 ? fmt::format("of shape {}", shape)
                                                  : fmt::format("number {}", e.light);
      const auto [at, is_new] = seen.emplace(name, static_cast<uint32_t>(names.size()));
      if (is_new) names.push_back(name);
      of_emitter.push_back(at->second);
    }
  }
  std::vector<std::string> names;
  std::vector<uint32_t> of_emitter;
};

// What stands around a gather that found fewer than k.
struct Around {
  double kth = kInfinity;  // distance to the k-th photon
  uint32_t light = ~0u;    // of more than half of the k nearest
};

Vec3 position_of(const Plan& plan, const UVec3& q) {
  Vec3 x;
  for (int i = 0; i < 3; ++i)
    x[i] = plan.origin[static_cast<size_t>(i)] +
           (static_cast<double>(q[static_cast<size_t>(i)]) + 0.5) * plan.position_unit();
  return x;
}

// The smallest value that at least three quarters do not exceed.
double three_quarters(std::vector<double> values) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>((3 * values.size()) / 4);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Three digits are enough; upwards, so that the k-th photon stays within.
double rounded_up(double x) {
  const double step =
      std::pow(10.0, std::floor(std::log10(x)) - 2);  // not golden: advice for people
  return step > 0 ? std::ceil(x / step) * step : x;
}

Advice advice_for(Shortage shortage, const Plan& plan, double radius, double kth) {
  // k photons lie within `kth` of a gather now; with f times the photons within kth / sqrt(f).
  const double wanted = std::isfinite(kth) ? kth / radius : kMostPhotons;
  const double reach = std::isfinite(kth) ? kth : kMostPhotons * radius;
  const double f =
      shortage == Shortage::kNoPhoton ? 1 : std::clamp(wanted * wanted, 1.0, kMostPhotons);
  Advice a;
  a.k = plan.k;
  // Where k are not found at any distance, fewer than k photons in all are no advice.
  const uint64_t fewest = std::isfinite(kth) ? 1 : static_cast<uint64_t>(plan.k);
  a.photons = static_cast<uint64_t>(
      std::ceil(f * static_cast<double>(std::max(fewest, plan.global.photons))));
  a.radius = rounded_up(std::max(radius, reach / std::sqrt(f)));
  if (a.photons > plan.global.photons) a.options = fmt::format("--photons {} ", a.photons);
  a.options += fmt::format("--set global.radius={:.4g}", a.radius);
  return a;
}

std::string message_for(const ShortRegion& r, const Plan& plan, double radius, double kth,
                        size_t pixels) {
  const std::string where =
      fmt::format("{:.0f} % of the image is short of photons",
                  100.0 * static_cast<double>(r.pixels) / static_cast<double>(pixels));
  const std::string found = fmt::format("its gathers find {:.1f} of k = {}", r.found, plan.k);
  const std::string reach = std::isfinite(kth)
                                ? fmt::format("k photons lie within {:.3g}", kth)
                                : std::string("there are no k photons on that side at all");
  std::string text;
  if (r.shortage == Shortage::kNoPhoton)
    text =
        fmt::format("{}: most gathers find no photon within the radius of {:.3g}, where {}; try {}",
                    where, radius, reach, r.advice.options);
  else if (r.shortage == Shortage::kFewPhotons)
    text =
        fmt::format("{}: {}, fewer than k photons lie within the radius of {:.3g} and {}; try {}",
                    where, found, radius, reach, r.advice.options);
  else
    text = fmt::format(
        "{}: {}, since the light {} that shines there has only {} of {} photons and {}; try {}",
        where, found, r.light, r.light_photons, r.photons, reach, r.advice.options);
  if (r.advice.photons > plan.global.photons && std::isfinite(kth))
    text += fmt::format(", or without more memory, but blurred further, --set global.radius={:.4g}",
                        rounded_up(kth));
  return text;
}

}  // namespace

GatherWatch::GatherWatch(const Plan& plan) : plan_(plan), record_(std::make_shared<Record>()) {
  with_memory_for_pixels(plan.width, plan.height, [&] {
    record_->pixels.resize(static_cast<size_t>(plan.width) * static_cast<size_t>(plan.height));
  });
}

std::unique_ptr<PhotonGatherer> GatherWatch::wrap(std::unique_ptr<PhotonGatherer> unit) {
  return std::make_unique<Watched>(std::move(unit), plan_, record_);
}

const GatherTally& GatherWatch::tally(bool is_caustic) const { return record_->tally[is_caustic]; }
const std::vector<GatherWatch::Pixel>& GatherWatch::pixels() const { return record_->pixels; }

const char* shortage_name(Shortage shortage) {
  if (shortage == Shortage::kNoPhoton) return "no photon within the radius";
  if (shortage == Shortage::kFewPhotons) return "fewer than k photons";
  return "a starved light";
}

GatherDiagnosis diagnose_gathers(const GatherWatch& watch, const PreparedFrame& frame,
                                 std::optional<uint64_t> seed) {
  const Plan& plan = frame.plan;
  const std::vector<GatherWatch::Pixel>& pixels = watch.pixels();
  GatherDiagnosis d;
  for (const bool is_caustic : {false, true}) d.tally[is_caustic] = watch.tally(is_caustic);
  d.no_photon.resize(pixels.size());
  d.few_photons.resize(pixels.size());
  d.starved_light.resize(pixels.size());
  std::vector<uint32_t> shortened;  // numbers of pixels
  for (size_t p = 0; p < pixels.size(); ++p) {
    const GatherTally& t = pixels[p].tally;
    if (t.gathers == 0) continue;
    const auto n = static_cast<double>(t.gathers);
    d.no_photon[p] = static_cast<float>(static_cast<double>(t.none) / n);
    d.few_photons[p] = static_cast<float>(static_cast<double>(t.few) / n);
    if (static_cast<double>(pixels[p].found) < kShortOfK * plan.k * n)
      shortened.push_back(static_cast<uint32_t>(p));
  }
  const std::vector<Photon>& photons = frame.global_pass.photons;
  if (shortened.empty() || photons.empty() || !(plan.global.radius > 0)) return d;

  // Which light a photon is of follows from the number of its path.
  const World& world = *frame.world;
  const Lights lights(world);
  std::vector<uint32_t> light_of(photons.size(), 0);
  std::vector<uint64_t> of_light(lights.names.size(), 0);
  for (size_t i = 0; seed && i < photons.size(); ++i) {
    const Random random(*seed, Phase::kGlobalPhoton, photons[i].path);
    ++of_light[light_of[i] = lights.of_emitter[world.choose_emitter(random.unit(0, 0))]];
  }
  const ReferenceGather gather(photons);
  std::vector<Around> around(shortened.size());
  tbb::parallel_for(size_t{0}, shortened.size(), [&](size_t i) {
    const GatherWatch::Pixel& pixel = pixels[shortened[i]];
    const IVec3 n = oct_decode({pixel.normal[0], pixel.normal[1]}, plan.normal_bits);
    std::vector<ReferenceNeighbour> found;
    gather.find(position_of(plan, pixel.position), Vec3(n[0], n[1], n[2]), plan.k, kInfinity,
                found);
    if (found.size() == static_cast<size_t>(plan.k)) around[i].kth = std::sqrt(found.back().d2);
    std::vector<uint32_t> votes(lights.names.size(), 0);
    for (const ReferenceNeighbour& f : found)
      if (2 * ++votes[light_of[f.index]] > found.size()) around[i].light = light_of[f.index];
  });

  const double even =
      static_cast<double>(photons.size()) / static_cast<double>(lights.names.size());
  const auto starved = [&](uint32_t light) {
    return seed && light != ~0u && lights.names.size() > 1 &&
           static_cast<double>(of_light[light]) < kStarvedShare * even;
  };
  struct Gathered {
    uint64_t pixels = 0;
    double found = 0, gathers = 0;
    std::vector<double> kth;
  };
  std::map<std::pair<Shortage, uint32_t>, Gathered> regions;
  for (size_t i = 0; i < shortened.size(); ++i) {
    const uint32_t p = shortened[i];
    const GatherTally& t = pixels[p].tally;
    const bool is_starved = starved(around[i].light);
    if (is_starved) d.starved_light[p] = d.no_photon[p] + d.few_photons[p];
    const Shortage shortage = is_starved               ? Shortage::kStarvedLight
                              : 2 * t.none > t.gathers ? Shortage::kNoPhoton
                                                       : Shortage::kFewPhotons;
    Gathered& r = regions[{shortage, is_starved ? around[i].light : 0}];
    ++r.pixels;
    r.found += static_cast<double>(pixels[p].found);
    r.gathers += static_cast<double>(t.gathers);
    r.kth.push_back(around[i].kth);
  }
  for (auto& [key, r] : regions) {
    if (static_cast<double>(r.pixels) < kShortPart * static_cast<double>(pixels.size())) continue;
    ShortRegion region;
    region.shortage = key.first;
    region.pixels = r.pixels;
    region.found = r.found / r.gathers;
    if (region.shortage == Shortage::kStarvedLight) {
      region.light = lights.names[key.second];
      region.light_photons = of_light[key.second];
      region.photons = photons.size();
    }
    const double kth = three_quarters(r.kth);
    region.advice = advice_for(region.shortage, plan, plan.global.radius, kth);
    region.message = message_for(region, plan, plan.global.radius, kth, pixels.size());
    d.regions.push_back(std::move(region));
  }
  std::stable_sort(d.regions.begin(), d.regions.end(),
                   [](const ShortRegion& a, const ShortRegion& b) { return a.pixels > b.pixels; });
  return d;
}

void GatherDiagnosis::add_layers(Image& image) const {
  const std::pair<const char*, const std::vector<float>*> layers[] = {
      {"noPhoton.Y", &no_photon},
      {"fewPhotons.Y", &few_photons},
      {"starvedLight.Y", &starved_light}};
  for (const auto& [name, values] : layers) {
    image.add(name);
    image.channels.back().pixels = *values;
  }
}

}  // namespace photonloom
