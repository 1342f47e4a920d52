// SPDX-License-Identifier: Apache-2.0
#include "golden/unit/irradiance_cache.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "golden/plan/plan_file.hpp"
#include "golden/unit/backend.hpp"

namespace photonloom {

namespace {

uint64_t squared_distance(const UVec3& a, const UVec3& b) {
  uint64_t sum = 0;
  for (size_t c = 0; c < 3; ++c) {
    const int64_t d = int64_t{a[c]} - int64_t{b[c]};
    sum += static_cast<uint64_t>(d * d);
  }
  return sum;
}

}  // namespace

UVec3 quantise_normal(const Plan& plan, const Vec3& normal) {
  const double scale = std::ldexp(0.5, plan.normal_bits);
  const auto top = static_cast<double>(ones(plan.normal_bits));
  UVec3 q;
  for (int i = 0; i < 3; ++i)
    q[static_cast<size_t>(i)] =
        static_cast<uint32_t>(std::clamp(std::floor((normal[i] + 1) * scale), 0.0, top));
  return q;
}

Reciprocal cache_falloff(const Plan& plan, double radius, ClampCounts* counts) {
  const double kept =
      std::clamp(radius, plan.cache_radius_min * plan.extent, plan.cache_radius_max * plan.extent);
  const double reach = plan.cache_accuracy * kept / plan.position_unit();
  const auto limit = static_cast<double>(ones(plan.r2_bits() - 1));
  const double square = std::floor(reach * reach), taken = std::clamp(square, 1.0, limit);
  if (counts) {
    counts->radii += kept != radius;
    counts->reaches += taken != square;
  }
  return reciprocal(static_cast<uint64_t>(taken), plan.cache_falloff_bits());
}

uint32_t cache_weight(const Plan& plan, const CacheRecord& record, const UVec3& position,
                      const UVec3& normal) {
  const int w = plan.cache_falloff_bits(), b = plan.cache_weight_bits;
  const uint64_t d2 = squared_distance(record.position, position);
  const uint64_t n2 = squared_distance(record.normal, normal);
  const int e = static_cast<int>(record.falloff.exponent);
  if (d2 >> e >> 1 || n2 >> plan.cache_angle_bits) return 0;
  const uint64_t a = e + 1 >= w ? d2 >> (e + 1 - w) : d2 << (w - e - 1);  // < 2^w
  const uint64_t far = a * record.falloff.mantissa >> (2 * w - 1 - b);
  const uint64_t off = (n2 << b) >> plan.cache_angle_bits;
  const uint64_t one = uint64_t{1} << b;
  return static_cast<uint32_t>(one > far + off ? one - far - off : 0);
}

namespace {

class GoldenIrradianceCache final : public IrradianceCache {
 public:
  explicit GoldenIrradianceCache(const Plan& plan) : plan_(plan) {}

  void process(std::span<const CacheLookup> in, std::vector<CacheResult>& out) override {
    out.reserve(out.size() + in.size());
    for (const CacheLookup& lookup : in) out.push_back(look_up(lookup));
  }

  Counters counters() const override {
    return {{"lookups", lookups_},
            {"hits", hits_},
            {"records made", records_made_},
            {"records read", records_read_},
            {"full", full_}};
  }

 private:
  CacheResult look_up(const CacheLookup& lookup) {
    ++lookups_;
    if (lookup.clear) records_.clear();
    records_read_ += records_.size();
    CacheResult result{};
    result.pixel = lookup.pixel;
    result.sample = lookup.sample;
    for (size_t i = 0; i < records_.size(); ++i) {
      const uint32_t weight = cache_weight(plan_, records_[i], lookup.position, lookup.normal);
      if (weight > 0) add(result, static_cast<uint32_t>(i), weight);
    }
    hits_ += result.count > 0;
    if (result.count > 0 || !lookup.insert) return result;
    if (records_.size() == static_cast<size_t>(plan_.cache_records)) {
      ++full_;
      result.full = 1;
      return result;
    }
    ++records_made_;
    result.inserted = 1;
    result.number = static_cast<uint32_t>(records_.size());
    records_.push_back({lookup.position, lookup.normal, {lookup.falloff, lookup.falloff_exponent}});
    return result;
  }

  // Keeps the heaviest, of equal ones the earlier.
  void add(CacheResult& result, uint32_t record, uint32_t weight) const {
    const auto most = static_cast<size_t>(plan_.cache_hits);
    size_t at = result.count;
    while (at > 0 && result.weight[at - 1] < weight) --at;
    if (at == most) return;
    for (size_t i = std::min<size_t>(result.count, most - 1); i > at; --i) {
      result.record[i] = result.record[i - 1];
      result.weight[i] = result.weight[i - 1];
    }
    result.record[at] = record;
    result.weight[at] = weight;
    if (result.count < most) ++result.count;
  }

  const Plan plan_;
  std::vector<CacheRecord> records_;  // of the tile
  uint64_t lookups_ = 0, hits_ = 0, records_made_ = 0, records_read_ = 0, full_ = 0;
};

}  // namespace

std::unique_ptr<IrradianceCache> make_golden_irradiance_cache(const Plan& plan) {
  check_plan(plan);
  return std::make_unique<GoldenIrradianceCache>(plan);
}

}  // namespace photonloom
