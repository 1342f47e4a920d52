// SPDX-License-Identifier: Apache-2.0
// The irradiance cache as an HLS kernel: points in, the heaviest records of the tile that cover
// them out (docs/irradiance_cache.md). Mirrors golden/unit/irradiance_cache.cpp.
//
// One pipelined loop with an initiation interval of 1: a turn compares a point with a record. The
// dependencies that allow it: best_, a comparison with registers; whether a point becomes a record,
// which the next lookup must know, is decided kDecideTurns after its last record was read.
#pragma once
#include "hls_kernels/irradiance_cache/timing.hpp"
#include "hls_kernels/vocabulary.hpp"

namespace photonloom_hls {

template <class T>
class IrradianceCache {
  template <int W>
  using uint = typename T::template uint<W>;
  template <int W>
  using sint = typename T::template sint<W>;
  using Lookup = CacheLookup<T>;
  using Result = CacheResult<T>;

  static constexpr int kN2Bits = 2 * kNormalBits + 2;
  static constexpr int kWideBits = kR2Bits + kCacheFalloffBits;
  static constexpr int kFarBits = kCacheWeightBits + 2;
  static constexpr int kDecideTurns = CacheTiming::kDecideTurns;
  using Weight = uint<kCacheWeightBits + 1>;
  using Number = uint<kCacheRecordBits>;
  using Count = uint<clog2(kCacheRecords + 1)>;
  using Hits = uint<kCacheHitBits>;

 public:
  static constexpr unsigned kInterval = 1;

  struct StreamPlaces {};  // it has no stream within

  // As after reset.
  IrradianceCache() { records_count_ = 0; }

  // Takes `packets` lookups and gives an answer to each.
  void run(typename T::template stream<Lookup>& in, typename T::template stream<Result>& out,
           const uint<32>& packets) {
    uint<32> taken = 0;
    bool under_way = false;
    Lookup lookup = {};
    Count next = 0;
    uint<clog2(kDecideTurns + 1)> waited = 0;
    for (uint<48> turn = 0; turn < packets * (kCacheRecords + kDecideTurns + 2) + 1; ++turn) {
      HLS_PIPELINE(kInterval);
      HLS_DISTANCE(records_, kDecideTurns);
      if (!under_way) {
        if (taken == packets) break;
        lookup = in.read();
        taken += 1;
        under_way = true;
        if (lookup.clear == 1) records_count_ = 0;
        next = 0;
        waited = 0;
        hits_ = 0;
        for (int i = 0; i < kCacheHits; ++i) {
          HLS_UNROLL
          weights_[i] = 0;
          numbers_[i] = 0;
        }
      } else if (next != records_count_) {
        keep(next, weight_of(records_[index(next)], lookup));
        next += 1;
      } else if (waited != kDecideTurns) {
        waited += 1;
      } else {
        out.write(answer(lookup));
        under_way = false;
      }
    }
  }

 private:
  // 2^B (1 - d^2 / reach^2 - n^2 / 2^AngleBits), 0 where that is not positive.
  static Weight weight_of(const Lookup& record, const Lookup& point) {
    uint<kR2Bits> d2 = 0;
    uint<kN2Bits> n2 = 0;
    for (int axis = 0; axis < 3; ++axis) {
      HLS_UNROLL
      const sint<kPositionBits + 1> d = point.position[axis] - record.position[axis];
      d2 = d2 + d * d;
      const sint<kNormalBits + 1> n = point.normal[axis] - record.normal[axis];
      n2 = n2 + n * n;
    }
    // Both with their bits behind the point; what reaches above it is out of reach.
    uint<kWideBits> wide = d2;
    wide = wide << kCacheFalloffBits >> 1 >> index(record.falloff_exponent);
    const uint<kCacheFalloffBits> near = T::template slice<kCacheFalloffBits>(wide, 0);
    uint<kN2Bits + kCacheWeightBits> turned = n2;
    turned = turned << kCacheWeightBits >> kCacheAngleBits;
    const uint<kCacheWeightBits> turn = T::template slice<kCacheWeightBits>(turned, 0);
    const uint<2 * kCacheFalloffBits + 1> product = near * record.falloff;
    const uint<kFarBits> far =
        T::template slice<kFarBits>(product, 2 * kCacheFalloffBits - 1 - kCacheWeightBits);
    const uint<kFarBits + 1> sum = far + turn;
    const uint<kFarBits + 1> one = 1u << kCacheWeightBits;
    Weight weight = 0;
    if (wide >> kCacheFalloffBits == 0 && turned >> kCacheWeightBits == 0 && sum < one)
      weight = one - sum;
    return weight;
  }

  // The heaviest stand first, of equal ones the earlier.
  void keep(const Count& record, const Weight& weight) {
    HLS_PARTITION(weights_, 1)
    HLS_PARTITION(numbers_, 1)
    if (weight == 0) return;
    for (int i = kCacheHits - 1; i >= 0; --i) {
      HLS_UNROLL
      const bool here = weights_[i] < weight;
      const bool before = i > 0 && weights_[i > 0 ? i - 1 : 0] < weight;
      if (before) {
        weights_[i] = weights_[i > 0 ? i - 1 : 0];
        numbers_[i] = numbers_[i > 0 ? i - 1 : 0];
      } else if (here) {
        weights_[i] = weight;
        numbers_[i] = record;
      }
    }
    if (hits_ != kCacheHits) hits_ += 1;
  }

  Result answer(const Lookup& lookup) {
    Result result;
    result.zero();
    result.pixel = lookup.pixel;
    result.sample = lookup.sample;
    result.count = hits_;
    for (int i = 0; i < kCacheHits; ++i) {
      HLS_UNROLL
      result.record[i] = numbers_[i];
      result.weight[i] = weights_[i];
    }
    if (hits_ == 0 && lookup.insert == 1) {
      if (records_count_ == kCacheRecords) {
        result.full = 1;
      } else {
        result.inserted = 1;
        result.number = records_count_;
        records_[index(records_count_)] = lookup;
        records_count_ += 1;
      }
    }
    return result;
  }

  Lookup records_[kCacheRecords];  // of the tile
  Count records_count_;
  Weight weights_[kCacheHits];  // of the lookup under way
  Number numbers_[kCacheHits];
  Hits hits_;
};

}  // namespace photonloom_hls
