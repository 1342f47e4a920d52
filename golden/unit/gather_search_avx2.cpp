// SPDX-License-Identifier: Apache-2.0
#if defined(__x86_64__)
#include <immintrin.h>

#include "golden/unit/gather_search_impl.hpp"

namespace photonloom::search {
namespace {

// For each set of four lanes, the 32-bit lanes that bring them to the front.
struct CompressTable {
  alignas(32) int32_t lanes[16][8];
  constexpr CompressTable() : lanes() {
    for (int set = 0; set < 16; ++set) {
      int to = 0;
      for (int lane = 0; lane < 4; ++lane)
        if (set >> lane & 1) {
          lanes[set][to++] = 2 * lane;
          lanes[set][to++] = 2 * lane + 1;
        }
      while (to < 8) lanes[set][to++] = 0;
    }
  }
};
constexpr CompressTable kCompress;

// Four keys; a block is two vectors. Keys have at most 63 bits, so signed comparisons serve. See
// gather_search_scalar.cpp.
struct Avx2 {
  static constexpr uint32_t kLanes = 4;
  static constexpr bool kInRegisters = true;
  using Vector = __m256i;
  static Vector load(const uint64_t* p) {
    return _mm256_load_si256(reinterpret_cast<const __m256i*>(p));
  }
  static void store(uint64_t* p, Vector v) { _mm256_store_si256(reinterpret_cast<__m256i*>(p), v); }
  static Vector fill(uint64_t x) { return _mm256_set1_epi64x(static_cast<long long>(x)); }
  static Vector min(Vector a, Vector b) {
    return _mm256_blendv_epi8(a, b, _mm256_cmpgt_epi64(a, b));
  }
  static Vector max(Vector a, Vector b) {
    return _mm256_blendv_epi8(b, a, _mm256_cmpgt_epi64(a, b));
  }

  static Vector exchange(Vector v, uint32_t stride, uint32_t size, bool down) {
    const Vector one = _mm256_set_epi64x(-1, 0, -1, 0), two = _mm256_set_epi64x(-1, -1, 0, 0);
    const Vector other =
        stride == 2 ? _mm256_permute4x64_epi64(v, 0x4e) : _mm256_permute4x64_epi64(v, 0xb1);
    const Vector flip = size < kLanes ? two : _mm256_set1_epi64x(down ? -1 : 0);
    const Vector high = _mm256_xor_si256(stride == 2 ? two : one, flip);
    return _mm256_blendv_epi8(min(v, other), max(v, other), high);
  }

  static Vector shift_in(Vector at, Vector below) {
    return _mm256_blend_epi32(_mm256_permute4x64_epi64(at, 0x93),
                              _mm256_permute4x64_epi64(below, 0x93), 0x03);
  }

  static uint32_t below(Vector x, Vector at, uint32_t lane) {
    return static_cast<uint32_t>(
               _mm256_movemask_pd(_mm256_castsi256_pd(_mm256_cmpgt_epi64(at, x)))) >>
               lane &
           1;
  }
  struct Query {
    explicit Query(const QueryView& q)
        : x(fill(q.position[0])),
          y(fill(q.position[1])),
          z(fill(q.position[2])),
          normal_xy(_mm256_set1_epi32(
              static_cast<int>(static_cast<uint32_t>(static_cast<uint16_t>(q.normal[1])) << 16 |
                               static_cast<uint16_t>(q.normal[0])))),
          normal_z(_mm256_set1_epi32(static_cast<uint16_t>(q.normal[2]))) {}
    Vector x, y, z;
    __m256i normal_xy, normal_z;
  };

  static Vector widen(const uint16_t* p) {
    return _mm256_cvtepu16_epi64(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(p)));
  }
  static Vector widen(const uint32_t* p) {
    return _mm256_cvtepu32_epi64(_mm_load_si128(reinterpret_cast<const __m128i*>(p)));
  }

  template <class Coordinate, bool kFacing>
  static uint32_t pass(const MapView& map, uint32_t block, uint64_t first, const Query& q,
                       uint64_t bound, uint32_t exist, uint64_t* passed) {
    const Coordinate* at =
        static_cast<const Coordinate*>(map.coordinates) + size_t{block} * (3 * kBlock);
    const auto distance = [&](uint32_t half) {
      const Vector dx = _mm256_sub_epi64(widen(at + half), q.x);
      const Vector dy = _mm256_sub_epi64(widen(at + kBlock + half), q.y);
      const Vector dz = _mm256_sub_epi64(widen(at + 2 * kBlock + half), q.z);
      return _mm256_add_epi64(_mm256_add_epi64(_mm256_mul_epi32(dx, dx), _mm256_mul_epi32(dy, dy)),
                              _mm256_mul_epi32(dz, dz));
    };
    const Vector limit = fill(bound);
    const Vector d2[2] = {distance(0), distance(4)};
    const auto outside = [&](Vector d) {
      return static_cast<uint32_t>(
          _mm256_movemask_pd(_mm256_castsi256_pd(_mm256_cmpgt_epi64(d, limit))));
    };
    uint32_t mask = exist & ~(outside(d2[0]) | outside(d2[1]) << 4);
    if (mask == 0) return 0;
    if (kFacing) {
      const __m256i* direction =
          reinterpret_cast<const __m256i*>(map.directions + size_t{block} * (4 * kBlock));
      const __m256i dot = _mm256_add_epi32(_mm256_madd_epi16(direction[0], q.normal_xy),
                                           _mm256_madd_epi16(direction[1], q.normal_z));
      mask &= static_cast<uint32_t>(
          _mm256_movemask_ps(_mm256_castsi256_ps(_mm256_cmpgt_epi32(dot, _mm256_setzero_si256()))));
    }
    const __m128i shift = _mm_cvtsi32_si128(map.index_bits);
    const auto pack_half = [&](uint32_t half, uint32_t set, uint64_t* to) {
      const Vector index = _mm256_add_epi64(fill(first + half), _mm256_set_epi64x(3, 2, 1, 0));
      const Vector key = _mm256_or_si256(_mm256_sll_epi64(d2[half / 4], shift), index);
      const Vector order =
          _mm256_load_si256(reinterpret_cast<const __m256i*>(kCompress.lanes[set]));
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), _mm256_permutevar8x32_epi32(key, order));
      return static_cast<uint32_t>(__builtin_popcount(set));
    };
    const uint32_t m = pack_half(0, mask & 15, passed);
    return m + pack_half(4, mask >> 4, passed + m);
  }

  static void flux(const MapView& map, const uint64_t* keys, uint32_t n, uint64_t* flux) {
    const uint64_t mask = (uint64_t{1} << map.index_bits) - 1;
    Vector sum = fill(0);
    const Vector shifts = _mm256_set_epi64x(0, 32, 16, 0);
    const Vector low = _mm256_set_epi64x(0, 0xffff, 0xffff, 0xffff);
    for (uint32_t i = 0; i < n; ++i) {
      const uint64_t power = map.powers[keys[i] & mask];
      const Vector mantissas = _mm256_and_si256(_mm256_srlv_epi64(fill(power), shifts), low);
      sum = _mm256_add_epi64(
          sum, _mm256_sll_epi64(mantissas, _mm_cvtsi64_si128(static_cast<long long>(power >> 48))));
    }
    alignas(32) uint64_t channels[4];
    store(channels, sum);
    for (int c = 0; c < 3; ++c) flux[c] = channels[c];
  }
};

}  // namespace

const Level kAvx2 = make_level<Avx2>("avx2");

}  // namespace photonloom::search
#endif
