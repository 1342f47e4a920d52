// SPDX-License-Identifier: Apache-2.0
// How the samples of a tile share the light of a few records: lookups to the irradiance cache, the
// records' reach, and the light that samples take (docs/irradiance_cache.md).
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "golden/pipeline/batch.hpp"
#include "golden/pipeline/light.hpp"
#include "golden/pipeline/light_gradient.hpp"
#include "golden/plan/quantiser.hpp"
#include "golden/transport/sampling.hpp"
#include "golden/unit/irradiance_cache.hpp"

namespace photonloom {

// A sample's table gather: whether it was answered, and its photons.
using Table = std::pair<bool, std::span<const GatherPhoton>>;

template <Arithmetic kArithmetic>
class TileCache {
  static constexpr bool kGolden = LightValues<kArithmetic>::kGolden;
  using Value = typename LightValues<kArithmetic>::Value;
  using QueryWeight = typename LightValues<kArithmetic>::QueryWeight;

 public:
  // All three outlive this.
  TileCache(const FrameInput& in, FrameUnits& units, FrameCounts& counts, const Shader& shader)
      : in_(in), plan_(in.plan), units_(units), counts_(counts), shader_(shader) {}

  // A batch whose tiles end at these entries.
  void begin(const BatchSamples& samples, const std::vector<WaitingSample>& entries,
             const std::vector<size_t>& tile_ends) {
    samples_ = &samples;
    entries_ = &entries;
    tile_ends_ = &tile_ends;
    roles_.assign(entries.size(), Role::kAlone);
    shared_.assign(entries.size(), {});
    record_light_.assign(entries.size(), {});
    if (has_gradients()) gradient_of_.assign(entries.size(), 0);
    gradients_.clear();
    tile_begin_ = tile_ = 0;
  }

  // Looks up the samples of a chunk, tile by tile; a tile that ends is looked up again where the
  // plan says so.
  void ask(size_t begin, size_t end, std::span<const Table> tables) {
    tables_ = tables;
    for (size_t at = begin; at < end;) {
      if (at == tile_begin_) {
        clear_ = true;
        owners_.clear();
      }
      const size_t tile_end = (*tile_ends_)[tile_], until = std::min(end, tile_end);
      look_up(at, until, begin, true);
      at = until;
      if (until < tile_end) break;
      if (plan_.cache_passes == 2) look_up(tile_begin_, tile_end, begin, false);
      counts_.cache_most_records = std::max<uint64_t>(counts_.cache_most_records, owners_.size());
      tile_begin_ = tile_end;
      ++tile_;
    }
  }

  // Whether an entry's rays are a record's; whether it takes others' light and needs no rays.
  bool is_record(size_t entry) const { return roles_[entry] == Role::kRecord; }
  bool is_sharing(size_t entry) const { return roles_[entry] == Role::kSharing; }

  // What a record's ray found.
  void add_to_record(size_t entry, const Value& value, const RayGradient& gradient) {
    add(record_light_[entry], value);
    if (has_gradients()) gradients_[gradient_of_[entry]].add(value, gradient);
  }
  bool has_gradients() const { return plan_.cache_gradients != CacheGradients::kNone; }

  // Calls add_share(entry, value) with what each sample takes of its records' light.
  template <class F>
  void share_light(F&& add_share) {
    const size_t entries = entries_->size();
    std::vector<Value> values(entries);
    SharedCounts shared;
    parallel(entries, [&](size_t entry) {
      const Shared& s = shared_[entry];
      if (s.count == 0) return;
      uint32_t total = 0;
      for (uint32_t i = 0; i < s.count; ++i) total += s.weight[i];
      const Rgb weight = (*entries_)[entry].weight * kPi;
      ShaderCounts own;
      ClampCounts clamps;
      QueryWeight share{};  // of each record's light; the same where no gradient turns it
      for (uint32_t i = 0; i < s.count; ++i) {
        const Value& light = record_light_[s.entry[i]];
        if (has_gradients())
          share = share_of(weight * change_between(s.entry[i], entry, clamps), own);
        else if (i == 0)
          share = share_of(weight, own);
        if constexpr (kGolden)
          add(values[entry], shader_.interpolated(light, s.weight[i], total, share));
        else
          add(values[entry], light * share * (static_cast<double>(s.weight[i]) / total));
      }
      shared.take(own);
      shared.take(clamps);
    });
    shared.give(counts_);
    for (size_t entry = 0; entry < entries; ++entry) add_share(entry, values[entry]);
  }

 private:
  // How a sample comes by its indirect light.
  enum class Role : uint8_t {
    kAlone,    // its own gather
    kRecord,   // its own gather, which is a record's
    kSharing,  // records of others
  };
  // The records whose light a sample takes, by the entries that they belong to.
  struct Shared {
    uint32_t count = 0;
    CacheList entry{}, weight{};
  };

  // Whether an entry takes part in the cache.
  bool looks_up(size_t entry) const {
    return (*entries_)[entry].diffuse && ((*entries_)[entry].first || plan_.cache_glossy);
  }

  void look_up(size_t from, size_t to, size_t begin, bool insert) {
    std::vector<uint32_t> asking;
    for (size_t entry = from; entry < to; ++entry)
      if (looks_up(entry) && (insert ? tables_[entry - begin].first : shared_[entry].count > 0))
        asking.push_back(static_cast<uint32_t>(entry));
    lookups_.resize(asking.size());
    SharedCounts shared;
    parallel(asking.size(), [&](size_t i) {
      const WaitingSample& e = (*entries_)[asking[i]];
      CacheLookup& lookup = lookups_[i];
      lookup = {};
      lookup.pixel = samples_->pixel_of(asking[i]);
      lookup.sample = samples_->sample_of(asking[i]);
      lookup.insert = insert;
      lookup.normal = quantise_normal(plan_, e.x.shading_normal);
      if (!insert) {  // counted when it was looked up first
        lookup.position = quantise_position(plan_, e.x.position);
        return;
      }
      ClampCounts clamps;
      lookup.position = quantise_position(plan_, e.x.position, &clamps);
      const Reciprocal falloff = cache_falloff(
          plan_, split_sphere_radius(asking[i], tables_[asking[i] - begin].second), &clamps);
      lookup.falloff = falloff.mantissa;
      lookup.falloff_exponent = falloff.exponent;
      shared.take(clamps);
    });
    shared.give(counts_);
    if (lookups_.empty()) return;
    if (insert) {
      lookups_.front().clear = clear_;
      clear_ = false;
      counts_.cache_samples += asking.size();
      if (plan_.cache_radius == CacheRadius::kProbe)
        counts_.probe_rays += asking.size() * static_cast<size_t>(plan_.cache_probe_rays);
    }
    found_.clear();
    units_.irradiance_cache->process(lookups_, found_);
    if (found_.size() > asking.size()) counts_.unmatched += found_.size() - asking.size();
    for (size_t i = 0; i < asking.size(); ++i) {
      if (i >= found_.size()) {
        ++counts_.unanswered;
        continue;
      }
      const CacheResult& r = found_[i];
      const size_t entry = asking[i];
      if (r.pixel != lookups_[i].pixel || r.sample != lookups_[i].sample || !take_hits(entry, r)) {
        ++counts_.unmatched;
        continue;
      }
      if (!insert) continue;
      if (r.inserted) {
        roles_[entry] = Role::kRecord;
        shared_[entry] = {1, {static_cast<uint32_t>(entry)}, {1}};
        owners_.push_back(static_cast<uint32_t>(entry));
        if (has_gradients()) {
          gradient_of_[entry] = static_cast<uint32_t>(gradients_.size());
          gradients_.emplace_back();
        }
        ++counts_.cache_records;
      } else if (r.count > 0) {
        roles_[entry] = Role::kSharing;
        ++counts_.cache_hits;
      } else {
        ++counts_.cache_full;
      }
    }
  }

  // False for an answer that no cache with these records gives.
  bool take_hits(size_t entry, const CacheResult& r) {
    if (r.count > static_cast<uint32_t>(plan_.cache_hits)) return false;
    if (r.inserted ? r.count > 0 || r.number != owners_.size() : false) return false;
    Shared shared;
    shared.count = r.count;
    for (uint32_t i = 0; i < r.count; ++i) {
      if (r.record[i] >= owners_.size() || r.weight[i] == 0) return false;
      shared.entry[i] = owners_[r.record[i]];
      shared.weight[i] = r.weight[i];
    }
    if (r.count > 0) shared_[entry] = shared;
    return true;
  }

  // Harmonic mean distance to what lights or surrounds x, scene units; 0 where nothing is known.
  double split_sphere_radius(size_t entry, std::span<const GatherPhoton> photons) const {
    double inverse = 0;
    uint32_t known = 0;
    if (plan_.cache_radius == CacheRadius::kPhotons) {
      for (const GatherPhoton& p : photons) {
        if (p.index >= in_.global.slots.size()) continue;
        const double flight = in_.global.slots[p.index].flight;
        if (!(flight > 0)) continue;
        inverse += 1 / flight;
        ++known;
      }
      return known > 0 ? known / inverse : 0;
    }
    const WaitingSample& e = (*entries_)[entry];
    const Random random = samples_->random_of(in_, entry);
    const Vec3& n = e.x.shading_normal;
    const Vec3 side =
        glm::normalize(std::fabs(n.x) < 0.5 ? Vec3(0, n.z, -n.y) : Vec3(n.z, 0, -n.x));
    const Vec3 other = glm::cross(n, side);
    const auto rays = static_cast<uint32_t>(plan_.cache_probe_rays);
    for (uint32_t ray = 0; ray < rays; ++ray) {
      const double u = (ray + random.unit(ray, 5)) / rays;
      const Vec3 d = sample_cosine(Vec2(u, random.unit(ray, 6)));
      const Vec3 direction = side * d.x + other * d.y + n * d.z;
      if (!(glm::dot(direction, e.x.normal) > 0)) continue;
      const Hit hit = in_.caster.closest({e.x.position, direction}, &e.x.hit);
      ++known;
      if (hit.valid() && hit.distance > 0) inverse += 1 / hit.distance;
    }
    return inverse > 0 ? known / inverse : known > 0 ? plan_.extent : 0;
  }

  // What a record's light is multiplied with at a sample, for its gradients.
  Rgb change_between(size_t record, size_t entry, ClampCounts& clamps) const {
    if (record == entry) return Rgb(1);
    const DiffuseHit &from = (*entries_)[record].x, &to = (*entries_)[entry].x;
    const Vec3 turn = to.shading_normal - from.shading_normal;
    const Vec3 way = (to.position - from.position) / plan_.extent;
    Rgb change;
    for (size_t c = 0; c < 3; ++c)
      change[static_cast<int>(c)] = gradients_[gradient_of_[record]].factor(
          c, light_of(record_light_[record], c), turn, way, clamps);
    return change;
  }
  QueryWeight share_of(const Rgb& weight, ShaderCounts& counts) const {
    if constexpr (kGolden)
      return shader_.share(weight, counts);
    else
      return (void)counts, weight;
  }

  const FrameInput& in_;
  const Plan& plan_;
  FrameUnits& units_;
  FrameCounts& counts_;
  const Shader& shader_;

  // Of the batch.
  const BatchSamples* samples_ = nullptr;
  const std::vector<WaitingSample>* entries_ = nullptr;
  const std::vector<size_t>* tile_ends_ = nullptr;
  std::vector<Role> roles_;
  std::vector<Shared> shared_;
  std::vector<Value> record_light_;    // of the samples that are records
  std::vector<uint32_t> gradient_of_;  // their place in gradients_
  std::vector<RecordGradient<kArithmetic>> gradients_;
  size_t tile_ = 0, tile_begin_ = 0;  // the one whose samples look up
  bool clear_ = false;                // its first lookup has not been sent
  std::vector<uint32_t> owners_;      // entries of its records

  // Of the call.
  std::span<const Table> tables_;  // of a chunk's entries
  std::vector<CacheLookup> lookups_;
  std::vector<CacheResult> found_;
};

}  // namespace photonloom
