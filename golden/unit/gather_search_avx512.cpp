// SPDX-License-Identifier: Apache-2.0
#if defined(__x86_64__)
#include <immintrin.h>

#include "golden/unit/gather_search_impl.hpp"

namespace photonloom::search {
namespace {

// Eight keys, one block at a time. See gather_search_scalar.cpp.
struct Avx512 {
  static constexpr uint32_t kLanes = 8;
  static constexpr bool kInRegisters = true;
  using Vector = __m512i;
  static Vector load(const uint64_t* p) { return _mm512_load_si512(p); }
  static void store(uint64_t* p, Vector v) { _mm512_store_si512(p, v); }
  static Vector fill(uint64_t x) { return _mm512_set1_epi64(static_cast<long long>(x)); }
  static Vector min(Vector a, Vector b) { return _mm512_min_epu64(a, b); }
  static Vector max(Vector a, Vector b) { return _mm512_max_epu64(a, b); }

  static Vector exchange(Vector v, uint32_t stride, uint32_t size, bool down) {
    constexpr uint8_t kBit[5] = {0, 0xaa, 0xcc, 0, 0xf0};  // lanes whose number has this bit
    Vector other;
    if (stride == 4) {
      other = _mm512_shuffle_i64x2(v, v, 0x4e);
    } else if (stride == 2) {
      other = _mm512_permutex_epi64(v, 0x4e);
    } else {
      other = _mm512_permutex_epi64(v, 0xb1);
    }
    const uint8_t flip = size < kLanes ? kBit[size] : (down ? 0xff : 0);
    const __mmask8 high = static_cast<__mmask8>(kBit[stride] ^ flip);
    return _mm512_mask_blend_epi64(high, min(v, other), max(v, other));
  }

  static Vector shift_in(Vector at, Vector below) { return _mm512_alignr_epi64(at, below, 7); }

  static uint32_t below(Vector x, Vector at, uint32_t lane) {
    return _mm512_cmplt_epu64_mask(x, at) >> lane & 1;
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
    return _mm512_cvtepu16_epi64(_mm_load_si128(reinterpret_cast<const __m128i*>(p)));
  }
  static Vector widen(const uint32_t* p) {
    return _mm512_cvtepu32_epi64(_mm256_load_si256(reinterpret_cast<const __m256i*>(p)));
  }

  template <class Coordinate, bool kFacing>
  static uint32_t pass(const MapView& map, uint32_t block, uint64_t first, const Query& q,
                       uint64_t bound, uint32_t exist, uint64_t* passed) {
    const Coordinate* at =
        static_cast<const Coordinate*>(map.coordinates) + size_t{block} * (3 * kBlock);
    const Vector dx = _mm512_sub_epi64(widen(at), q.x);
    const Vector dy = _mm512_sub_epi64(widen(at + kBlock), q.y);
    const Vector dz = _mm512_sub_epi64(widen(at + 2 * kBlock), q.z);
    const Vector d2 =
        _mm512_add_epi64(_mm512_add_epi64(_mm512_mul_epi32(dx, dx), _mm512_mul_epi32(dy, dy)),
                         _mm512_mul_epi32(dz, dz));
    __mmask8 mask = _mm512_mask_cmple_epu64_mask(static_cast<__mmask8>(exist), d2, fill(bound));
    if (mask == 0) return 0;
    if (kFacing) {
      const __m256i* direction =
          reinterpret_cast<const __m256i*>(map.directions + size_t{block} * (4 * kBlock));
      const __m256i dot = _mm256_add_epi32(_mm256_madd_epi16(direction[0], q.normal_xy),
                                           _mm256_madd_epi16(direction[1], q.normal_z));
      mask = _mm256_mask_cmpgt_epi32_mask(mask, dot, _mm256_setzero_si256());
    }
    const Vector lanes = _mm512_set_epi64(7, 6, 5, 4, 3, 2, 1, 0);
    const Vector key = _mm512_or_si512(_mm512_sll_epi64(d2, _mm_cvtsi32_si128(map.index_bits)),
                                       _mm512_add_epi64(fill(first), lanes));
    _mm512_storeu_si512(passed, _mm512_maskz_compress_epi64(mask, key));
    return static_cast<uint32_t>(__builtin_popcount(mask));
  }

  static void flux(const MapView& map, const uint64_t* keys, uint32_t n, uint64_t* flux) {
    const Vector mask = fill((uint64_t{1} << map.index_bits) - 1), low = fill(0xffff);
    Vector sum[3] = {fill(0), fill(0), fill(0)};
    for (uint32_t i = 0; i < n; i += kLanes) {
      const uint32_t left = n - i;
      const __mmask8 some = static_cast<__mmask8>(left >= kLanes ? 0xff : (1u << left) - 1);
      const Vector index = _mm512_and_si512(load(keys + i), mask);
      const Vector power =
          _mm512_mask_i64gather_epi64(fill(0), some, index, map.powers, sizeof(uint64_t));
      const Vector exponent = _mm512_srli_epi64(power, 48);
      const auto add = [&](Vector& to, Vector mantissa) {
        to = _mm512_add_epi64(to, _mm512_sllv_epi64(_mm512_and_si512(mantissa, low), exponent));
      };
      add(sum[0], power);
      add(sum[1], _mm512_srli_epi64(power, 16));
      add(sum[2], _mm512_srli_epi64(power, 32));
    }
    for (int c = 0; c < 3; ++c) flux[c] = static_cast<uint64_t>(_mm512_reduce_add_epi64(sum[c]));
  }
};

}  // namespace

const Level kAvx512 = make_level<Avx512>("avx512");

}  // namespace photonloom::search
#endif
