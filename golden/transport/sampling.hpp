// SPDX-License-Identifier: Apache-2.0
// Maps from the unit square to directions and disks, and the numbers that feed them.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "golden/numeric/elementary.hpp"
#include "golden/numeric/random.hpp"
#include "golden/numeric/vec.hpp"

namespace photonloom {

// Unit disk, uniform.
inline Vec2 sample_disk(const Vec2& u) { return std::sqrt(u.x) * cos_sin_turns(u.y); }

// Hemisphere around +z, density cos/pi.
inline Vec3 sample_cosine(const Vec2& u) {
  const Vec2 d = sample_disk(u);
  return Vec3(d.x, d.y, std::sqrt(std::max(0.0, 1.0 - u.x)));
}

// Cone around +z with the solid angle 2 pi h, uniform; h = 1 - cos of the half angle.
inline Vec3 sample_cone(const Vec2& u, double h) {
  const double rise = u.x * h;  // 1 - z, without cancellation in narrow cones
  return Vec3(std::sqrt(std::max(0.0, rise * (2.0 - rise))) * cos_sin_turns(u.y), 1.0 - rise);
}

inline Vec3 sample_sphere(const Vec2& u) { return sample_cone(u, 2.0); }

// Weight of the first of two strategies (Veach 1997, power heuristic with exponent 2).
inline double power_heuristic(double first, double second) {
  const double ratio = second / first;
  return 1.0 / (1.0 + ratio * ratio);
}

// Numbers for the samples of one pixel: Owen-scrambled Sobol' pairs with the order of samples
// shuffled for each dimension (Burley 2020, "Practical Hash-based Owen Scrambling"). Each number is
// uniform on its own; those of one pixel's successive samples are spread evenly in the first
// bounces and independent further on. Everything is a hash of (seed, phase, pixel, sample, bounce,
// dimension).
class PixelNumbers {
 public:
  PixelNumbers(uint64_t seed, Phase phase, uint64_t pixel, uint64_t sample)
      : random_(seed, phase, pixel), sample_(sample) {}

  Vec2 pair(uint64_t bounce, uint64_t dimension) const {
    const uint64_t key = random_.bits(bounce, dimension);
    if (bounce > kSpreadBounces) {
      const uint64_t x = mix64(key + sample_ * 0x9e3779b97f4a7c15ull);
      return Vec2(to_unit(x), to_unit(mix64(x + 0x2545f4914f6cdd1dull)));
    }
    const uint64_t key2 = mix64(key ^ (sample_ >> 32));
    const uint32_t order =
        reverse(laine_karras(reverse(static_cast<uint32_t>(sample_)), static_cast<uint32_t>(key)));
    return Vec2(number(order, static_cast<uint32_t>(key2)),
                number(second_dimension(order), static_cast<uint32_t>(key2 >> 32)));
  }
  double unit(uint64_t bounce, uint64_t dimension) const { return pair(bounce, dimension).x; }

 private:
  static constexpr uint64_t kSpreadBounces = 2;

  static constexpr uint32_t reverse(uint32_t x) {
    x = (x >> 16) | (x << 16);
    x = ((x & 0x00ff00ffu) << 8) | ((x >> 8) & 0x00ff00ffu);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x >> 4) & 0x0f0f0f0fu);
    x = ((x & 0x33333333u) << 2) | ((x >> 2) & 0x33333333u);
    return ((x & 0x55555555u) << 1) | ((x >> 1) & 0x55555555u);
  }
  // Owen scrambling of a bit-reversed word (Laine and Karras 2011, constants of Vegdahl 2021).
  static constexpr uint32_t laine_karras(uint32_t x, uint32_t key) {
    x ^= x * 0x3d20adeau;
    x += key;
    x *= (key >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
  }
  // Sobol' numbers, bit-reversed: the first dimension is the index itself; the generator matrix of
  // the second is Pascal's triangle mod 2: bit j is the sum of the bits i with j a subset of i.
  static constexpr uint32_t second_dimension(uint32_t x) {
    x ^= (x & 0xaaaaaaaau) >> 1;
    x ^= (x & 0xccccccccu) >> 2;
    x ^= (x & 0xf0f0f0f0u) >> 4;
    x ^= (x & 0xff00ff00u) >> 8;
    return x ^ ((x & 0xffff0000u) >> 16);
  }
  // 32 scrambled bits, and 21 hashed ones below them.
  static constexpr double number(uint32_t reversed, uint32_t key) {
    const uint64_t high = reverse(laine_karras(reversed, key));
    const uint64_t low = mix64((high << 32) | key) >> 43;
    return static_cast<double>((high << 21) | low) * 0x1p-53;
  }

  Random random_;
  uint64_t sample_;
};

}  // namespace photonloom
