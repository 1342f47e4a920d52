// SPDX-License-Identifier: Apache-2.0
#include "golden/pipeline/frame.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "golden/numeric/memory.hpp"
#include "golden/numeric/octahedral.hpp"
#include "golden/pipeline/batch.hpp"
#include "golden/pipeline/light.hpp"
#include "golden/pipeline/ray_budget.hpp"
#include "golden/pipeline/shadow_pass.hpp"
#include "golden/pipeline/splat_film.hpp"
#include "golden/pipeline/tile_cache.hpp"
#include "golden/plan/quantiser.hpp"
#include "golden/transport/film_filter.hpp"
#include "golden/transport/light_paths.hpp"
#include "golden/transport/light_splats.hpp"
#include "golden/transport/sampling.hpp"
#include "golden/unit/cdf_sampler.hpp"

namespace photonloom {
namespace {

// Rays and packets of one call to the units; bounds the memory, changes nothing else.
constexpr size_t kChunk = size_t{1} << 15;
constexpr uint32_t kNone = ~uint32_t{0};

// What the first hits of a pixel show, summed over its samples.
struct Features {
  Rgb albedo{0};
  Vec3 normal{0};
  double depth = 0, density = 0;
  uint32_t hits = 0;
};

// (sqrt(5) - 1) / 2, in 2^-64: its first n multiples, modulo 1, leave gaps of three lengths at most
// for every n (three-gap theorem, Sós 1958).
constexpr uint64_t kGoldenRatio = 0x9E3779B97F4A7C15;

template <Arithmetic kArithmetic>
class Renderer {
  static constexpr bool kGolden = LightValues<kArithmetic>::kGolden;
  using Value = typename LightValues<kArithmetic>::Value;
  using QueryWeight = typename LightValues<kArithmetic>::QueryWeight;

 public:
  Renderer(const FrameInput& in, FrameUnits& units, FrameCounts& counts, Progress* progress)
      : in_(in),
        plan_(in.plan),
        units_(units),
        counts_(counts),
        progress_(progress),
        shader_(in.plan),
        spp_(static_cast<size_t>(in.plan.spp)),
        rays_(static_cast<size_t>(in.plan.gather_rays)),
        first_rays_(static_cast<size_t>(in.plan.first_rays)),
        ray_seed_(in.ray_seed.value_or(in.seed)),
        filter_(in.world.scene().film.filter),
        light_paths_(in.world, Photons::kOnDiffuse),
        batch_{pixels_, spp_},
        shadows_(in),
        cache_(in, units, counts, shader_),
        place_(static_cast<size_t>(in.plan.width) * static_cast<size_t>(in.plan.height), kNone) {
    make_channels();
    if (!filter_.is_plain_box()) film_.emplace(plan_, filter_);
  }

  Image render() {
    units_.photon_gatherer->load(in_.global, in_.caustic);
    show_light_paths();
    const int tiles_x = (plan_.width + plan_.tile - 1) / plan_.tile;
    const int tiles = tiles_x * ((plan_.height + plan_.tile - 1) / plan_.tile);
    const int step = plan_.batch_tiles > 0 ? plan_.batch_tiles : tiles;
    for (int first = 0; first < tiles; first += step) {
      pixels_.clear();
      tile_ends_.clear();
      tile_begins_.clear();
      for (int tile = first; tile < std::min(tiles, first + step); ++tile) {
        const int x0 = tile % tiles_x * plan_.tile, y0 = tile / tiles_x * plan_.tile;
        tile_begins_.push_back(pixels_.size());
        for (int y = y0; y < std::min(plan_.height, y0 + plan_.tile); ++y)
          for (int x = x0; x < std::min(plan_.width, x0 + plan_.tile); ++x) {
            place_[pixel_number(x, y)] = static_cast<uint32_t>(pixels_.size());
            pixels_.push_back(static_cast<uint32_t>(pixel_number(x, y)));
          }
        tile_ends_.push_back(pixels_.size() * spp_);
      }
      render_batch();
      for (const uint32_t pixel : pixels_) place_[pixel] = kNone;
    }
    if (film_) film_->finish(image_, splats_);
    return std::move(image_);
  }

 private:
  size_t pixel_number(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(plan_.width) + static_cast<size_t>(x);
  }
  // Whether samples count in other pixels than their own too; their layers are kept apart then.
  bool filtered() const { return film_.has_value(); }
  Layers<Value>& layers_of(size_t entry) { return layers_[filtered() ? entry : entry / spp_]; }
  uint32_t pixel_of(size_t entry) const { return batch_.pixel_of(entry); }
  uint32_t sample_of(size_t entry) const { return batch_.sample_of(entry); }
  Random random_of(size_t entry) const { return batch_.random_of(in_, entry); }

  // The entry that a packet belongs to; kNone for one that no question of this batch explains.
  uint32_t entry_of(uint32_t pixel, uint32_t sample) const {
    if (pixel >= place_.size() || place_[pixel] == kNone || sample >= spp_) return kNone;
    const size_t entry = size_t{place_[pixel]} * spp_ + sample;
    return entries_[entry].diffuse ? static_cast<uint32_t>(entry) : kNone;
  }

  void render_batch() {
    const size_t entries = pixels_.size() * spp_;
    entries_.assign(entries, {});
    layers_.assign(filtered() ? entries : pixels_.size(), {});
    places_.assign(filtered() ? entries : 0, {});
    totals_.assign(entries, Value{});
    features_.assign(pixels_.size(), {});
    gathers_ = plan_.global.present && rays_ > 0;
    const bool adaptive = gathers_ && first_rays_ > 0;
    if (adaptive) halves_.assign(2 * entries, Value{});
    begin_pass(0, std::vector<uint32_t>(entries, static_cast<uint32_t>(!gathers_  ? 0
                                                                       : adaptive ? first_rays_
                                                                                  : rays_)));
    shadows_.begin(batch_, entries);
    caching_ = gathers_ && plan_.cache_present;
    if (caching_) cache_.begin(batch_, entries_, tile_ends_);
    {
      const ProgressPhase phase(progress_, "camera", entries, "samples");
      for (size_t begin = 0, end; begin < entries; begin = end) {
        end = chunk_end(begin, 1);
        walk_cameras(begin, end);
        ask_at_camera_hits(begin, end);
        phase.advance(end - begin);
      }
    }
    if (gathers_) gather_finally("final gather");
    if (caching_)
      cache_.share_light([&](size_t entry, const Value& value) { add_layers(entry, value); });
    // Both numbers of rays follow from first passes alone: that of one kind of light must not know
    // the second pass of another.
    std::vector<uint32_t> second;
    if (adaptive)
      second = second_rays(plan_, gather_passes(plan_), pixels_, tile_begins_,
                           [&](size_t entry, size_t) { return first_pass_of(entry); });
    if (shadows_.has_two())
      shadows_.plan_second(pixels_, tile_begins_, [&](size_t entry) { return light_seen(entry); });
    if (adaptive) {
      begin_pass(first_rays_, second);
      {
        const ProgressPhase phase(progress_, "second tables", entries, "samples");
        for (size_t begin = 0, end; begin < entries; begin = end) {
          end = chunk_end(begin, 1);
          ask_at_camera_hits(begin, end);
          phase.advance(end - begin);
        }
      }
      gather_finally("second gather");
      for (size_t entry = 0; entry < entries; ++entry) {
        Value first = halves_[2 * entry];
        add(first, halves_[2 * entry + 1]);
        add_layers(entry, scaled(first, first_rays_, first_rays_ + rays_of(entry)));
      }
    }
    if (shadows_.has_two()) cast_second_shadows();
    shadows_.count(counts_);
    finish_pixels();
    if (film_) film_->splat(batch_, place_, kNone, layers_, places_);
  }

  // All light of a sample that first passes and whatever has but one pass found; but not that of a
  // first pass of shadow rays.
  Rgb light_seen(size_t entry) const {
    Rgb light;
    for (int c = 0; c < 3; ++c) {
      light[c] = radiance(totals_[entry], c);
      if (!halves_.empty())
        light[c] += radiance(halves_[2 * entry], c) + radiance(halves_[2 * entry + 1], c);
    }
    return light;
  }

  FirstPass first_pass_of(size_t entry) const {
    FirstPass seen;
    seen.casts = entries_[entry].diffuse;
    const Rgb direct = shadows_.has_two() ? shadows_.direct(entry) : Rgb(0);
    for (int c = 0; c < 3; ++c) {
      const double even = radiance(halves_[2 * entry], c);
      const double odd = radiance(halves_[2 * entry + 1], c);
      seen.light[c] = radiance(totals_[entry], c) + even + odd + direct[c];
      seen.difference[c] = even - odd;
    }
    return seen;
  }

  // Shadow rays of the second pass, and the direct light of both.
  void cast_second_shadows() {
    const ProgressPhase phase(progress_, "second shadow rays", entries_.size(), "samples");
    std::vector<Value> direct(entries_.size());
    SharedCounts shared;
    parallel(entries_.size(), [&](size_t entry) {
      shadows_.cast_second(entry);
      ShaderCounts own;
      direct[entry] = value_of(shadows_.direct(entry), own);
      shared.take(own);
    });
    shared.give(counts_);
    for (size_t entry = 0; entry < entries_.size(); ++entry) {
      add(layers_of(entry).direct, direct[entry]);
      add(totals_[entry], direct[entry]);
    }
    phase.advance(entries_.size());
  }

  // A pass casts rays [first_tag, first_tag + count) of each sample.
  void begin_pass(size_t first_tag, const std::vector<uint32_t>& counts) {
    first_tag_ = first_tag;
    ray_begins_.assign(1, 0);
    for (const uint32_t n : counts) ray_begins_.push_back(ray_begins_.back() + n);
    directions_.assign(ray_begins_.back(), {});
    if constexpr (kGolden) slot_of_.assign(ray_begins_.back(), kNone);
    gradients_.assign(cache_.has_gradients() ? ray_begins_.back() : 0, {});
  }
  bool second_pass() const { return first_tag_ > 0; }
  size_t rays_of(size_t entry) const { return ray_begins_[entry + 1] - ray_begins_[entry]; }
  // A ray's place in directions_ and slot_of_; none for a tag that this pass has not.
  std::optional<size_t> place_of(size_t entry, size_t tag) const {
    if (tag < first_tag_ || tag - first_tag_ >= rays_of(entry)) return std::nullopt;
    return ray_begins_[entry] + tag - first_tag_;
  }
  // Samples from `begin` on with about kChunk rays and `others` packets each.
  size_t chunk_end(size_t begin, size_t others) const {
    size_t end = begin + 1, work = rays_of(begin) + others;
    while (end < entries_.size() && work + rays_of(end) + others <= kChunk)
      work += rays_of(end++) + others;
    return end;
  }

  void gather_finally(const char* name) {
    const ProgressPhase phase(progress_, name, ray_begins_.back(), "rays");
    std::vector<Ray> rays;
    const auto take = [&](size_t entry) {
      for (size_t place = ray_begins_[entry]; place < ray_begins_[entry + 1]; ++place)
        rays.push_back({entry, place});
    };
    const auto cast = [&] {
      for (size_t begin = 0; begin < rays.size(); begin += kChunk) {
        const size_t count = std::min(kChunk, rays.size() - begin);
        cast_final_gathers(std::span(rays).subspan(begin, count));
        phase.advance(count);
      }
      rays.clear();
    };
    if (plan_.order == FrameOrder::kPixel) {
      // Samples stay tile by tile, so that nothing but the order of rays changes.
      std::vector<size_t> places(pixels_.size());
      std::iota(places.begin(), places.end(), size_t{0});
      std::sort(places.begin(), places.end(),
                [&](size_t a, size_t b) { return pixels_[a] < pixels_[b]; });
      for (const size_t place : places) {
        for (size_t sample = 0; sample < spp_; ++sample) take(place * spp_ + sample);
        if (rays.size() >= kChunk) cast();
      }
    } else if (plan_.order == FrameOrder::kDirectionBins) {
      size_t entry = 0;
      for (const size_t end : tile_ends_) {
        for (; entry < end; ++entry) take(entry);
        sort_by_direction(rays);
        cast();
      }
    } else {
      for (size_t entry = 0; entry < entries_.size(); ++entry) {
        take(entry);
        if (rays.size() >= kChunk) cast();
      }
    }
    cast();
    if constexpr (kGolden) {
      GatherQuery flush{};
      flush.flush = 1;
      gather_reordered({&flush, 1});
      for (const uint32_t slot : slot_of_) counts_.unanswered += slot != kNone;
      slots_.clear();
      free_slots_.clear();
    }
  }

  // Named conversion of light that no photon carries.
  Value value_of(const Rgb& radiance, ShaderCounts& counts) const {
    if constexpr (kGolden)
      return shader_.pixel(radiance, counts);
    else
      return (void)counts, radiance;
  }
  QueryWeight query_weight(const Rgb& weight, bool is_caustic, ShaderCounts& counts) const {
    if constexpr (kGolden)
      return shader_.weight(weight, is_caustic, counts);
    else
      return (void)is_caustic, (void)counts, weight;
  }

  // What walks join their vertices with; null: nothing.
  const LightPaths* joined_paths() const { return light_paths_.needed() ? &light_paths_ : nullptr; }

  // As many light paths as camera samples.
  void show_light_paths() {
    if (!light_paths_.needed()) return;
    const uint64_t paths = place_.size() * spp_;
    const ProgressPhase phase(progress_, "light paths", paths, "paths");
    const Scene& scene = in_.world.scene();
    splats_ = splat_light_paths(light_paths_, in_.caster, scene.film, Lens(scene), filter_, paths,
                                in_.seed, Phase::kLightSplat);
    for (SplatSum& s : splats_) {
      s.indirect /= static_cast<double>(paths);
      s.square /= static_cast<double>(paths) * static_cast<double>(paths);
    }
    phase.advance(paths);
  }

  void walk_cameras(size_t begin, size_t end) {
    struct Walk {
      Value direct, indirect, emission;
      Rgb albedo;
      Vec3 normal;
      double depth;
      Vec2 place;
    };
    std::vector<Walk> walks(end - begin);
    SharedCounts shared;
    parallel(end - begin, [&](size_t i) {
      const uint32_t pixel = pixel_of(begin + i);
      const CameraSample s = trace_camera(
          in_.world, in_.caster, static_cast<int>(pixel % static_cast<uint32_t>(plan_.width)),
          static_cast<int>(pixel / static_cast<uint32_t>(plan_.width)), sample_of(begin + i),
          in_.seed, shadows_.casts() ? ShadowRays::kLater : ShadowRays::kWithPath, joined_paths());
      if (shadows_.casts()) shadows_.cast_first(begin + i, s);
      // Of two passes of shadow rays direct light is known after the second.
      const Rgb direct = !shadows_.casts()    ? s.direct
                         : shadows_.has_two() ? Rgb(0)
                                              : shadows_.direct(begin + i);
      ShaderCounts own;
      walks[i] = {value_of(direct, own),
                  value_of(s.indirect, own),
                  value_of(s.emission, own),
                  s.albedo,
                  s.normal,
                  s.depth,
                  s.place};
      shared.take(own);
      entries_[begin + i] = {s.diffuse && !is_black(s.weight), s.first, s.x, s.weight};
    });
    shared.give(counts_);
    for (size_t i = 0; i < walks.size(); ++i) {
      const Walk& w = walks[i];
      Layers<Value>& layers = layers_of(begin + i);
      if (filtered())
        places_[begin + i] = {static_cast<uint8_t>(FilterTable::place(w.place.x)),
                              static_cast<uint8_t>(FilterTable::place(w.place.y))};
      add(layers.direct, w.direct);
      add(layers.indirect, w.indirect);
      add(layers.emission, w.emission);
      Value& total = totals_[begin + i];
      add(total, w.direct);
      add(total, w.indirect);
      add(total, w.emission);
      Features& f = features_[(begin + i) / spp_];
      f.albedo += w.albedo;
      f.normal += w.normal;
      f.depth += w.depth;
      f.hits += w.depth > 0;
    }
    counts_.camera_samples += walks.size();
  }

  GatherQuery camera_query(size_t entry, bool is_caustic) const {
    const WaitingSample& e = entries_[entry];
    const OctCode normal = oct_encode(e.x.normal, plan_.normal_bits);
    return {.pixel = pixel_of(entry),
            .sample = sample_of(entry),
            .tag = static_cast<uint32_t>(plan_.gather_rays),
            .map = is_caustic,
            .flush = 0,
            .want_photons = !is_caustic,
            .position = quantise_position(plan_, e.x.position, &counts_.clamps),
            .normal = {normal.u, normal.v}};
  }

  // A caustic query and a table gather for every diffuse hit; the tables' photons and the requests
  // for directions to the sampler.
  void ask_at_camera_hits(size_t begin, size_t end) {
    queries_.clear();
    std::vector<uint8_t> asked_caustic(end - begin, 0), asked_table(end - begin, 0);
    for (size_t entry = begin; entry < end; ++entry) {
      if (!entries_[entry].diffuse) continue;
      if (plan_.caustic.present && kGolden && !second_pass()) {
        queries_.push_back(camera_query(entry, true));
        asked_caustic[entry - begin] = 1;
        ++counts_.caustic_queries;
      }
      if (gathers_ && rays_of(entry) > 0) {
        queries_.push_back(camera_query(entry, false));
        asked_table[entry - begin] = 1;
        ++counts_.table_gathers;
      }
    }
    if constexpr (!kGolden)
      if (!second_pass()) estimate_caustics_in_double(begin, end);
    if (queries_.empty() && !caching_) return;
    results_.clear();
    photons_.clear();
    units_.photon_gatherer->process(queries_, results_, photons_);

    inputs_.clear();
    tables_.assign(caching_ ? end - begin : 0, {});
    size_t next_photon = 0;
    ShaderCounts saturated;
    for (const GatherResult& r : results_) {
      const uint32_t entry = entry_of(r.pixel, r.sample);
      std::vector<uint8_t>& asked = r.map ? asked_caustic : asked_table;
      const size_t photons = r.map ? 0 : std::min<size_t>(r.count, photons_.size() - next_photon);
      if (r.flush || entry == kNone || entry < begin || entry >= end || !asked[entry - begin] ||
          r.tag != static_cast<uint32_t>(plan_.gather_rays)) {
        ++counts_.unmatched;
        next_photon += photons;
        continue;
      }
      asked[entry - begin] = 0;
      count(r);
      const WaitingSample& e = entries_[entry];
      if (r.map) {
        if constexpr (kGolden)
          add_caustic(entry, shader_.contribution(r, shader_.weight(e.weight, true, saturated)));
        continue;
      }
      if (e.first && !second_pass()) features_[entry / spp_].density += shader_.photon_density(r);
      const std::span<const GatherPhoton> table{photons_.data() + next_photon, photons};
      next_photon += photons;
      if (caching_)
        tables_[entry - begin] = {true, table};
      else
        request_directions(entry, table);
    }
    counts_.shader.weights += saturated.weights;
    counts_.shader.not_finite += saturated.not_finite;
    for (const auto* asked : {&asked_caustic, &asked_table})
      counts_.unanswered += static_cast<uint64_t>(std::count(asked->begin(), asked->end(), 1));
    counts_.unmatched += photons_.size() - next_photon;

    if (caching_) {
      cache_.ask(begin, end, tables_);
      for (size_t entry = begin; entry < end; ++entry) {
        const auto& [answered, photons] = tables_[entry - begin];
        if (answered && !cache_.is_sharing(entry)) request_directions(entry, photons);
      }
    }
    if (inputs_.empty()) return;
    samples_.clear();
    units_.cdf_sampler->process(inputs_, samples_);
    for (const Sample& s : samples_) {
      const uint32_t entry = entry_of(s.pixel, s.sample);
      const std::optional<size_t> place = entry == kNone ? std::nullopt : place_of(entry, s.tag);
      if (!place || s.total == 0 || directions_[*place].probability != 0) {
        ++counts_.unmatched;
        continue;
      }
      directions_[*place] = sampled_code(s);
    }
    counts_.directions += samples_.size();
  }

  void add_caustic(size_t entry, const Value& value) {
    Layers<Value>& layers = layers_of(entry);
    add(entries_[entry].first ? layers.caustic : layers.indirect, value);
    add(totals_[entry], value);
  }

  // One table: header, photons, requests. The rays of a sample are stratified in u; those of two
  // passes, whose number is not known with the first, are points of one Kronecker sequence.
  void request_directions(size_t entry, std::span<const GatherPhoton> photons) {
    const OctCode normal = oct_encode(entries_[entry].x.normal, plan_.normal_bits);
    SamplerInput header{};
    header.kind = 0;
    header.pixel = pixel_of(entry);
    header.sample = sample_of(entry);
    header.normal = {normal.u, normal.v};
    inputs_.push_back(header);
    const bool all = plan_.table_photons == TablePhotons::kAll;
    for (const GatherPhoton& p : photons) {
      // A faulty unit's index may be any.
      if (!all && !(p.index < in_.global.slots.size() && in_.global.slots[p.index].indirect))
        continue;
      SamplerInput photon{};
      photon.kind = 1;
      photon.mantissa = p.mantissa;
      photon.exponent = p.exponent;
      photon.direction = p.direction;
      inputs_.push_back(photon);
    }
    const Random random = random_of(entry);
    const size_t rays = rays_of(entry);
    for (size_t stratum = 0; stratum < rays; ++stratum) {
      const size_t ray = first_tag_ + stratum;
      SamplerInput request{};
      request.kind = 2;
      request.tag = static_cast<uint32_t>(ray);
      if (plan_.first_rays > 0) {
        request.u = (random.bits(0, 0) + ray * kGoldenRatio) >> (64 - plan_.u_bits);
      } else {
        const UInt128 u =
            (UInt128{stratum} << plan_.u_bits) + (random.bits(ray, 0) >> (64 - plan_.u_bits));
        request.u = static_cast<uint64_t>(u / rays);
      }
      request.v = {static_cast<uint32_t>(random.bits(ray, 1) >> (64 - plan_.v_bits)),
                   static_cast<uint32_t>(random.bits(ray, 2) >> (64 - plan_.v_bits))};
      inputs_.push_back(request);
    }
  }

  // A final gather ray of this pass: its sample, and its place in directions_ and slot_of_.
  struct Ray {
    size_t entry, place;
  };

  // Direction bin by direction bin, each bin as it was.
  void sort_by_direction(std::vector<Ray>& rays) const {
    const auto bin = [&](const Ray& ray) {
      return direction_bin(plan_, directions_[ray.place].code);
    };
    std::vector<size_t> next(direction_bins(plan_) + 1, 0);
    for (const Ray& ray : rays) ++next[bin(ray) + 1];
    std::partial_sum(next.begin(), next.end(), next.begin());
    std::vector<Ray> sorted(rays.size());
    for (const Ray& ray : rays) sorted[next[bin(ray)]++] = ray;
    rays = std::move(sorted);
  }

  void cast_final_gathers(std::span<const Ray> rays) {
    const auto tag_of = [&](const Ray& ray) {
      return first_tag_ + ray.place - ray_begins_[ray.entry];
    };
    ray_gathers_.resize(rays.size());
    SharedCounts shared;
    parallel(ray_gathers_.size(), [&](size_t i) {
      Gather& g = ray_gathers_[i] = {};
      const size_t entry = rays[i].entry, ray = tag_of(rays[i]);
      const WaitingSample& e = entries_[entry];
      const SampledCode& sampled = directions_[rays[i].place];
      if (!e.diffuse || sampled.probability == 0) return;
      const Random random = random_of(entry);
      const Vec3 unfolded =
          sample_direction(plan_, sampled, random.unit(ray, 3), random.unit(ray, 4));
      const double inverse_pdf = sample_inverse_pdf(plan_, sampled, unfolded);
      const Vec3 direction = unfolded / std::sqrt(glm::dot(unfolded, unfolded));
      const double cosine = glm::dot(direction, e.x.shading_normal);
      if (!(cosine > 0) || !(glm::dot(direction, e.x.normal) > 0)) {
        g.below = true;
        return;
      }
      const uint32_t pixel = pixel_of(entry), sample = sample_of(entry);
      const GatherSample s = trace_gather(in_.world, in_.caster, e.x, direction, pixel, sample, ray,
                                          ray_seed_, joined_paths());
      // A record keeps the light that a white surface would send on.
      ClampCounts clamps;
      const Rgb to_pixel = caching_ && cache_.is_record(entry) ? Rgb(1 / kPi) : e.weight;
      if (caching_ && cache_.has_gradients() && cache_.is_record(entry)) {
        const bool straight = s.diffuse && s.y.segments == e.x.segments + 1;
        gradients_[rays[i].place] =
            ray_gradient(plan_, e.x, direction, straight ? &s.y : nullptr, clamps);
      }
      // The second pass knows how many rays there are in all.
      const Rgb weight =
          to_pixel * (cosine * inverse_pdf / static_cast<double>(first_tag_ + rays_of(entry)));
      ShaderCounts own;
      g.glossy = value_of(weight * s.radiance, own);
      if (s.diffuse && !is_black(s.weight)) {
        g.asks = true;
        g.weight = query_weight(weight * s.weight, false, own);
        if constexpr (kGolden) {
          const OctCode normal = oct_encode(s.y.normal, plan_.normal_bits);
          g.query = {.pixel = pixel,
                     .sample = sample,
                     .tag = static_cast<uint32_t>(ray),
                     .map = 0,
                     .flush = 0,
                     .want_photons = 0,
                     .position = quantise_position(plan_, s.y.position, &clamps),
                     .normal = {normal.u, normal.v}};
        } else {
          g.estimate = estimate_in_double(*in_.reference_global, plan_.global, s.y, g.weight);
        }
      }
      shared.take(own);
      shared.take(clamps);
    });
    shared.give(counts_);

    queries_.clear();
    for (size_t i = 0; i < ray_gathers_.size(); ++i) {
      const Gather& g = ray_gathers_[i];
      counts_.below_horizon += g.below;
      counts_.final_gathers += g.asks;
      add_ray(rays[i].entry, tag_of(rays[i]), g.glossy, false);
      if constexpr (!kGolden) {
        if (g.asks) add_ray(rays[i].entry, tag_of(rays[i]), g.estimate, true);
      } else {
        if (!g.asks) continue;
        slot_of_[rays[i].place] = take_slot(g.weight);
        queries_.push_back(g.query);
      }
    }
    if constexpr (kGolden) gather_reordered(queries_);
  }

  // What a final gather ray found. That of a first pass waits for the number of all rays.
  void add_ray(size_t entry, size_t ray, const Value& value, bool from_diffuse) {
    if (first_rays_ > 0 && !second_pass()) {
      add(halves_[2 * entry + ray % 2], value);
    } else if (caching_ && cache_.is_record(entry)) {
      RayGradient gradient;
      if (cache_.has_gradients()) gradient = gradients_[*place_of(entry, ray)];
      if (!from_diffuse) gradient.way = {};
      cache_.add_to_record(entry, value, gradient);
    } else {
      add_layers(entry, value);
    }
  }
  void add_layers(size_t entry, const Value& value) {
    add(layers_of(entry).indirect, value);
    add(totals_[entry], value);
  }

  uint32_t take_slot(const QueryWeight& weight) {
    if (free_slots_.empty()) {
      slots_.push_back(weight);
      return static_cast<uint32_t>(slots_.size() - 1);
    }
    const uint32_t slot = free_slots_.back();
    free_slots_.pop_back();
    slots_[slot] = weight;
    return slot;
  }

  // Final gather queries through the reorder buffer and the gatherer to their pixels. Weights wait
  // on the host for the results, which come in the order of the reorder buffer.
  void gather_reordered(std::span<const GatherQuery> queries) {
    if constexpr (kGolden) {
      reordered_.clear();
      units_.reorder_buffer->process(queries, reordered_);
      results_.clear();
      photons_.clear();
      units_.photon_gatherer->process(reordered_, results_, photons_);
      counts_.unmatched += photons_.size();
      result_entries_.assign(results_.size(), kNone);
      result_slots_.assign(results_.size(), kNone);
      for (size_t i = 0; i < results_.size(); ++i) {
        const GatherResult& r = results_[i];
        if (r.flush) continue;
        const uint32_t entry = entry_of(r.pixel, r.sample);
        const std::optional<size_t> place =
            entry == kNone || r.map ? std::nullopt : place_of(entry, r.tag);
        uint32_t* slot = place ? &slot_of_[*place] : nullptr;
        if (!slot || *slot == kNone) {
          ++counts_.unmatched;
          continue;
        }
        result_entries_[i] = entry;
        result_slots_[i] = *slot;
        *slot = kNone;
        count(r);
      }
      values_.resize(results_.size());
      parallel(results_.size(), [&](size_t i) {
        if (const uint32_t slot = result_slots_[i]; slot != kNone)
          values_[i] = shader_.contribution(results_[i], slots_[slot]);
      });
      for (size_t i = 0; i < results_.size(); ++i) {
        if (result_slots_[i] == kNone) continue;
        add_ray(result_entries_[i], results_[i].tag, values_[i], true);
        free_slots_.push_back(result_slots_[i]);
      }
    } else {
      (void)queries;
    }
  }

  void count(const GatherResult& r) {
    counts_.clamped += r.clamped;
    counts_.full += r.full;
  }

  // The estimate of docs/frame.md with nothing quantised.
  Rgb estimate_in_double(const ReferenceGather& map, const MapPlan& m, const DiffuseHit& hit,
                         const Rgb& weight) const {
    thread_local std::vector<ReferenceNeighbour> found;
    const double r2_max =
        m.radius > 0 ? m.radius * m.radius : std::numeric_limits<double>::infinity();
    const double r2_floor =
        static_cast<double>(plan_.r2_floor) * plan_.position_unit() * plan_.position_unit();
    map.find(hit.position, hit.normal, plan_.k, r2_max, found);
    return weight * map.irradiance(found, plan_.k, r2_max, r2_floor, Kernel::kFlat);
  }

  void estimate_caustics_in_double(size_t begin, size_t end) {
    if constexpr (!kGolden) {
      if (!plan_.caustic.present) return;
      std::vector<Rgb> values(end - begin, Rgb(0));
      parallel(values.size(), [&](size_t i) {
        const WaitingSample& e = entries_[begin + i];
        if (e.diffuse)
          values[i] = estimate_in_double(*in_.reference_caustic, plan_.caustic, e.x, e.weight);
      });
      for (size_t i = 0; i < values.size(); ++i) {
        if (!entries_[begin + i].diffuse) continue;
        add_caustic(begin + i, values[i]);
        ++counts_.caustic_queries;
      }
    }
  }

  double radiance(const Value& value, int c) const {
    if constexpr (kGolden)
      return shader_.radiance(value[static_cast<size_t>(c)]);
    else
      return value[c];
  }

  void make_channels() {
    image_.width = plan_.width;
    image_.height = plan_.height;
    for (const char* name : {"R",          "G",
                             "B",          "direct.R",
                             "direct.G",   "direct.B",
                             "caustic.R",  "caustic.G",
                             "caustic.B",  "indirect.R",
                             "indirect.G", "indirect.B",
                             "emission.R", "emission.G",
                             "emission.B", "error.R",
                             "error.G",    "error.B",
                             "albedo.R",   "albedo.G",
                             "albedo.B",   "N.X",
                             "N.Y",        "N.Z",
                             "Z",          "photonDensity.Y"})
      image_.add(name);
  }

  // Mean and variance of a pixel's own samples.
  void finish_pixels() {
    const double n = static_cast<double>(spp_);
    parallel(pixels_.size(), [&](size_t p) {
      const auto set = [&](size_t channel, double value) {
        image_.channels[channel].pixels[pixels_[p]] = static_cast<float>(value);
      };
      Value sum{};
      if (filtered()) {
        for (size_t s = 0; s < spp_; ++s) add(sum, totals_[p * spp_ + s]);
      } else {
        const Layers<Value>& l = layers_[p];
        for (const Value* layer : {&l.direct, &l.caustic, &l.indirect, &l.emission})
          add(sum, *layer);
      }
      for (int c = 0; c < 3; ++c) {
        const auto i = static_cast<size_t>(c);
        double variance = 0;
        const double mean = radiance(sum, c) / n;
        for (size_t s = 0; s < spp_; ++s) {
          const double d = radiance(totals_[p * spp_ + s], c) - mean;
          variance += d * d;
        }
        if (filtered()) {
          if (spp_ > 1) film_->spread(pixels_[p])[c] = variance / (n - 1);
        } else {
          const Layers<Value>& l = layers_[p];
          const double splat = splats_.empty() ? 0 : splats_[pixels_[p]].indirect[c];
          const double square = splats_.empty() ? 0 : splats_[pixels_[p]].square[c];
          set(i, mean + splat);
          set(3 + i, radiance(l.direct, c) / n);
          set(6 + i, radiance(l.caustic, c) / n);
          set(9 + i, radiance(l.indirect, c) / n + splat);
          set(12 + i, radiance(l.emission, c) / n);
          set(15 + i, spp_ > 1 ? std::sqrt(variance / (n * (n - 1)) + square) : 0.0);
        }
        set(18 + i, features_[p].albedo[c] / n);
        set(21 + i, features_[p].normal[c] / n);
      }
      set(24, features_[p].hits ? features_[p].depth / features_[p].hits : 0.0);
      set(25, features_[p].density / n);
    });
  }

  const FrameInput& in_;
  const Plan& plan_;
  FrameUnits& units_;
  FrameCounts& counts_;
  Progress* progress_;
  const Shader shader_;
  const size_t spp_, rays_, first_rays_;
  const uint64_t ray_seed_;
  const FilterTable filter_;
  const LightPaths light_paths_;
  std::vector<SplatSum> splats_;  // of light paths, by pixel; empty: none
  const BatchSamples batch_;
  ShadowPass shadows_;
  TileCache<kArithmetic> cache_;
  bool gathers_ = false;  // whether samples send final gather rays
  Image image_;
  std::optional<SplatFilm<kArithmetic>> film_;  // where samples count in several pixels

  // Of the batch.
  std::vector<uint32_t> pixels_;                // in packet order
  std::vector<uint32_t> place_;                 // of a pixel in pixels_
  std::vector<size_t> tile_begins_;             // in pixels_
  std::vector<WaitingSample> entries_;          // a sample each
  std::vector<Layers<Value>> layers_;           // of pixels; filtered: of samples
  std::vector<std::array<uint8_t, 2>> places_;  // filtered: of samples within their pixel
  std::vector<Value> totals_;                   // of samples
  std::vector<Features> features_;
  std::vector<Value> halves_;  // of a first pass: even and odd rays of each sample
  // Of the pass.
  size_t first_tag_ = 0;
  std::vector<size_t> ray_begins_;       // of a sample in directions_
  std::vector<SampledCode> directions_;  // probability 0: not answered yet
  bool caching_ = false;
  std::vector<RayGradient> gradients_;  // of rays, where records have them
  std::vector<size_t> tile_ends_;       // in entries
  std::vector<uint32_t> slot_of_;       // a final gather query's place in slots_
  std::vector<QueryWeight> slots_;
  std::vector<uint32_t> free_slots_;

  // Of the call; they keep their memory from call to call.
  struct Gather {
    bool below = false, asks = false;
    Value glossy{};
    Value estimate{};  // where no unit gives it
    QueryWeight weight{};
    GatherQuery query{};
  };
  std::vector<Gather> ray_gathers_;
  std::vector<GatherQuery> queries_, reordered_;
  std::vector<GatherResult> results_;
  std::vector<uint32_t> result_entries_, result_slots_;
  std::vector<PixelValue> values_;
  std::vector<GatherPhoton> photons_;
  std::vector<SamplerInput> inputs_;
  std::vector<Sample> samples_;
  std::vector<Table> tables_;
};

}  // namespace

FrameUnits make_golden_units(const Plan& plan) {
  FrameUnits units;
  for_each_unit([&](auto unit) { units.of(unit) = make_golden(unit, plan); });
  return units;
}

Image render_frame(const FrameInput& in, FrameUnits& units, FrameCounts& counts,
                   Progress* progress) {
  const std::string tiles = in.plan.batch_tiles == 0 ? "all" : std::to_string(in.plan.batch_tiles);
  const std::string what = fmt::format(
      "a frame of {}x{} pixels, {} samples of each (frame.spp), {} tiles at a time "
      "(frame.batch_tiles)",
      in.plan.width, in.plan.height, in.plan.spp, tiles);
  return with_memory_for(what, [&] {
    if (in.arithmetic == Arithmetic::kReference)
      return Renderer<Arithmetic::kReference>(in, units, counts, progress).render();
    return Renderer<Arithmetic::kGolden>(in, units, counts, progress).render();
  });
}

}  // namespace photonloom
