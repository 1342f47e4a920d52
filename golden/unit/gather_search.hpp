// SPDX-License-Identifier: Apache-2.0
// The golden search as a CPU likes it: the same photons, the same order of visits and the same
// counts as search_gather, on a map laid out for vector instructions, at three levels of them.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "golden/plan/plan.hpp"
#include "golden/unit/photon_map.hpp"

namespace photonloom::search {

// Plain data only: the files that are compiled for newer processors share nothing else with the
// rest of the program, so that no function compiled for them can be called on an older one.

inline constexpr uint32_t kBlock = 8;          // slots that are looked at together
inline constexpr uint32_t kMaxK = 256;         // of a plan
inline constexpr uint32_t kKeys = kMaxK + 16;  // room that a search needs for its list
inline constexpr uint64_t kNoKey = INT64_MAX;  // above every key
inline constexpr int kKeyBits = 62;
inline constexpr uint32_t kGroup = 8;  // queries that are best asked at once

// A map in memory. A photon that was found travels as the key d^2 << index_bits | index.
struct MapView {
  const uint32_t* nodes = nullptr;      // heap order; axis << 30 | split
  const void* coordinates = nullptr;    // a block: 8 x, 8 y, 8 z, of 16 or 32 bits
  const int16_t* directions = nullptr;  // a block: 8 decoded (x, y), 8 (z, 0)
  const uint64_t* powers = nullptr;     // a slot: mantissas in bits 0, 16, 32, exponent in bit 48
  uint32_t lines = 0;
  uint32_t bucket = 0;
  uint32_t blocks = 0;      // of a line
  uint32_t block_mask = 0;  // slots of a block that exist, but in the last line
  uint64_t count = 0;       // photons
  int index_bits = 0;
  uint64_t r2_max = 0;
};

struct QueryView {
  uint32_t position[3];
  int16_t normal[3];  // decoded; not used where back-side photons count
};

struct Settings {
  uint32_t k = 1;
  uint32_t leaf_limit = ~0u;  // ~0: none
  uint64_t epsilon_factor = 1;
  int epsilon_shift = 0;
};

struct Outcome {
  uint32_t count, nodes, leaves, insertions;
};

// Answers n queries. keys: 64-byte aligned, kKeys of them for each query; the first `count` become
// its result in ascending order.
using Search = void (*)(const MapView&, const Settings&, const QueryView*, uint32_t n,
                        uint64_t* keys, Outcome*);
// Exact sums of the powers of n photons, by channel.
using Flux = void (*)(const MapView&, const uint64_t* keys, uint32_t n, uint64_t* flux);

// One level's functions. search[coordinates have 32 bits][back-side photons are rejected]
// [epsilon is in use].
struct Level {
  const char* name;
  Search search[2][2][2];
  Flux flux;
};

extern const Level kScalar;
#if defined(__x86_64__)
extern const Level kAvx2;
extern const Level kAvx512;
#endif

// Levels that this machine can run, scalar first, fastest last.
std::vector<const Level*> available_levels();

// The fastest, or the one that the environment variable PHOTONLOOM_SIMD names (scalar, avx2,
// avx512). Throws std::runtime_error for a name that is not one or that this machine cannot run.
const Level& chosen_level();

// A photon map laid out for the search.
class Map {
 public:
  // Whether a key of kKeyBits bits holds every candidate of this map: bits of r2_max and of an
  // index. Otherwise only search_gather serves.
  static bool fits(const PhotonMap& map, const MapPlan& map_plan);

  Map(const PhotonMap& map, const Plan& plan, const MapPlan& map_plan);
  const MapView& view() const { return view_; }
  bool wide() const { return wide_; }
  // Nodes and coordinates: what a search reads that does not look at directions.
  uint64_t search_bytes() const;

 private:
  struct Free {
    void operator()(void* p) const;
  };
  template <class T>
  using Array = std::unique_ptr<T[], Free>;
  template <class T>
  static Array<T> allocate(size_t n);

  MapView view_;
  bool wide_ = false;
  uint64_t coordinate_bytes_ = 0;
  Array<uint32_t> nodes_;
  Array<uint16_t> narrow_;
  Array<uint32_t> wide_coordinates_;
  Array<int16_t> directions_;
  Array<uint64_t> powers_;
};

}  // namespace photonloom::search
