// SPDX-License-Identifier: Apache-2.0
// Randomness is a hash of what is sampled, never a shared stream: equal arguments give equal
// numbers on every machine.
#pragma once
#include <cstdint>

namespace photonloom {

// Finaliser of SplitMix64 (Steele, Lea, Flood 2014): a bijection of 64-bit words.
constexpr uint64_t mix64(uint64_t x) {
  x ^= x >> 30;
  x *= 0xbf58476d1ce4e5b9ull;
  x ^= x >> 27;
  x *= 0x94d049bb133111ebull;
  x ^= x >> 31;
  return x;
}

// 64 random bits for one dimension of one decision.
constexpr uint64_t hash_bits(uint64_t seed, uint64_t index, uint64_t bounce, uint64_t dimension) {
  uint64_t h = mix64(seed + 0x9e3779b97f4a7c15ull);
  h = mix64(h ^ (index + 0x9e3779b97f4a7c15ull));
  return mix64(h ^ (bounce * 0xd1342543de82ef95ull + dimension * 0x9e3779b97f4a7c15ull +
                    0x2545f4914f6cdd1dull));
}

// Uniform in [0, 1): the top 53 bits, exact in a double.
constexpr double to_unit(uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1p-53; }

// What a stream of decisions is for; keeps the dimensions of different phases apart.
enum class Phase : uint64_t {
  kCamera = 1,
  kGlobalPhoton,
  kCausticPhoton,
  kGather,
  kDirect,
  kSampler,
  kPath,
  kShadow,
  kLightPath,  // beside photons
  kLightSplat
};

// Numbers for one walk: (seed, phase, index) fixed, bounce and dimension given per call.
class Random {
 public:
  constexpr Random(uint64_t seed, Phase phase, uint64_t index)
      : seed_(mix64(seed ^ (static_cast<uint64_t>(phase) << 56))), index_(index) {}
  constexpr uint64_t bits(uint64_t bounce, uint64_t dimension) const {
    return hash_bits(seed_, index_, bounce, dimension);
  }
  constexpr double unit(uint64_t bounce, uint64_t dimension) const {
    return to_unit(bits(bounce, dimension));
  }

 private:
  uint64_t seed_, index_;
};

}  // namespace photonloom
