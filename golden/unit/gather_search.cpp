// SPDX-License-Identifier: Apache-2.0
#include "golden/unit/gather_search.hpp"

#if defined(__linux__)
#include <sys/mman.h>
#endif

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <new>
#include <stdexcept>

#include "golden/numeric/bits.hpp"
#include "golden/numeric/octahedral.hpp"

namespace photonloom::search {
namespace {

// Large arrays start at a huge page and ask for such pages: a search touches
// many of their pages.
constexpr size_t kHugePage = size_t{1} << 21;

bool machine_has(const char* name) {
#if defined(__x86_64__)
  if (std::strcmp(name, "avx2") == 0)
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("popcnt");
  if (std::strcmp(name, "avx512") == 0)
    return __builtin_cpu_supports("popcnt") && __builtin_cpu_supports("avx512f") &&
           __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512dq");
#endif
  return std::strcmp(name, "scalar") == 0;
}

std::vector<const Level*> all_levels() {
#if defined(__x86_64__)
  return {&kScalar, &kAvx2, &kAvx512};
#else
  return {&kScalar};
#endif
}

}  // namespace

std::vector<const Level*> available_levels() {
  std::vector<const Level*> levels;
  for (const Level* level : all_levels())
    if (machine_has(level->name)) levels.push_back(level);
  return levels;
}

const Level& chosen_level() {
  const char* const wanted = std::getenv("PHOTONLOOM_SIMD");
  if (!wanted || !*wanted) return *available_levels().back();
  for (const Level* level : all_levels())
    if (std::strcmp(level->name, wanted) == 0) {
      if (!machine_has(wanted))
        throw std::runtime_error(std::string("PHOTONLOOM_SIMD=") + wanted +
                                 ": this machine does not have these instructions");
      return *level;
    }
  throw std::runtime_error(std::string("PHOTONLOOM_SIMD=") + wanted +
                           ": expected scalar, avx2 or avx512");
}

void Map::Free::operator()(void* p) const { std::free(p); }

template <class T>
Map::Array<T> Map::allocate(size_t n) {
  const size_t alignment = n * sizeof(T) >= kHugePage ? kHugePage : 64;
  const size_t bytes = (n * sizeof(T) + alignment - 1) / alignment * alignment;
  T* const p = static_cast<T*>(std::aligned_alloc(alignment, bytes));
  if (!p) throw std::bad_alloc();
#if defined(__linux__)
  // Advice: without such pages the search is only slower.
  if (alignment == kHugePage) madvise(p, bytes, MADV_HUGEPAGE);
#endif
  std::memset(p, 0, bytes);
  return Array<T>(p);
}

bool Map::fits(const PhotonMap& map, const MapPlan& map_plan) {
  return std::bit_width(map_plan.r2_max) + clog2(map.slots.size()) <= kKeyBits;
}

Map::Map(const PhotonMap& map, const Plan& plan, const MapPlan& map_plan)
    : wide_(plan.position_bits > 16) {
  const uint32_t bucket = static_cast<uint32_t>(map.bucket);
  view_.lines = map.lines;
  view_.bucket = bucket;
  view_.blocks = std::max(1u, bucket / kBlock);
  view_.block_mask = bucket < kBlock ? (1u << bucket) - 1 : 0xff;
  view_.count = map.count;
  view_.index_bits = clog2(map.slots.size());
  view_.r2_max = map_plan.r2_max;
  if (map.lines == 0) return;

  nodes_ = allocate<uint32_t>(map.lines);
  for (uint32_t i = 1; i < map.lines; ++i) nodes_[i] = map.nodes[i].axis << 30 | map.nodes[i].split;

  const size_t blocks = size_t{map.lines} * view_.blocks;
  coordinate_bytes_ = blocks * 3 * kBlock * (wide_ ? sizeof(uint32_t) : sizeof(uint16_t));
  if (wide_) {
    wide_coordinates_ = allocate<uint32_t>(blocks * 3 * kBlock);
  } else {
    narrow_ = allocate<uint16_t>(blocks * 3 * kBlock);
  }
  directions_ = allocate<int16_t>(blocks * 4 * kBlock);
  powers_ = allocate<uint64_t>(map.slots.size());
  tbb::parallel_for(tbb::blocked_range<size_t>(0, map.count, 8192), [&](const auto& range) {
    for (size_t i = range.begin(); i < range.end(); ++i) {
      const PackedPhoton& photon = map.slots[i];
      const size_t block = i / bucket * view_.blocks + i % bucket / kBlock;
      const size_t slot = i % bucket % kBlock;
      for (size_t c = 0; c < 3; ++c) {
        const size_t place = (block * 3 + c) * kBlock + slot;
        if (wide_) {
          wide_coordinates_[place] = photon.position[c];
        } else {
          narrow_[place] = static_cast<uint16_t>(photon.position[c]);
        }
      }
      const IVec3 direction = oct_decode(photon.direction, plan.direction_bits);
      int16_t* const to = directions_.get() + block * (4 * kBlock);
      to[2 * slot] = static_cast<int16_t>(direction[0]);
      to[2 * slot + 1] = static_cast<int16_t>(direction[1]);
      to[2 * kBlock + 2 * slot] = static_cast<int16_t>(direction[2]);
      powers_[i] = uint64_t{photon.power.mantissa[0]} | uint64_t{photon.power.mantissa[1]} << 16 |
                   uint64_t{photon.power.mantissa[2]} << 32 | uint64_t{photon.power.exponent} << 48;
    }
  });
  view_.nodes = nodes_.get();
  view_.coordinates = wide_ ? static_cast<const void*>(wide_coordinates_.get()) : narrow_.get();
  view_.directions = directions_.get();
  view_.powers = powers_.get();
}

uint64_t Map::search_bytes() const { return view_.lines * sizeof(uint32_t) + coordinate_bytes_; }

}  // namespace photonloom::search
