// SPDX-License-Identifier: Apache-2.0
#include "golden/numeric/sha256.hpp"

#include <array>
#include <bit>

#include "golden/numeric/bits.hpp"

namespace photonloom {
namespace {

// floor(2^32 * p^(1/n)) mod 2^32: the first 32 bits of the fraction of a square or cube root, from
// which FIPS 180-4 takes its constants.
constexpr uint32_t root_fraction(uint64_t p, int n) {
  // Largest x < 2^35 with x^n <= p * 2^(32 n); x^3 < 2^105.
  uint64_t low = 0, high = uint64_t{1} << 38;
  while (high - low > 1) {
    const uint64_t x = low + (high - low) / 2;
    const UInt128 power = n == 2 ? UInt128{x} * x : UInt128{x} * x * x;
    if (power <= UInt128{p} << (32 * n))
      low = x;
    else
      high = x;
  }
  return static_cast<uint32_t>(low);
}

template <size_t kCount>
constexpr std::array<uint32_t, kCount> prime_roots(int n) {
  std::array<uint32_t, kCount> roots{};
  size_t found = 0;
  for (uint64_t p = 2; found < kCount; ++p) {
    bool prime = true;
    for (uint64_t d = 2; d * d <= p; ++d) prime &= p % d != 0;
    if (prime) roots[found++] = root_fraction(p, n);
  }
  return roots;
}

constexpr std::array<uint32_t, 8> kStart = prime_roots<8>(2);
constexpr std::array<uint32_t, 64> kRound = prime_roots<64>(3);

}  // namespace

Sha256::Sha256() {
  for (size_t i = 0; i < 8; ++i) state_[i] = kStart[i];
}

void Sha256::block(const unsigned char* bytes) {
  std::array<uint32_t, 64> w;
  for (size_t i = 0; i < 16; ++i)
    w[i] = uint32_t{bytes[4 * i]} << 24 | uint32_t{bytes[4 * i + 1]} << 16 |
           uint32_t{bytes[4 * i + 2]} << 8 | uint32_t{bytes[4 * i + 3]};
  for (size_t i = 16; i < 64; ++i) {
    const uint32_t a = w[i - 15], b = w[i - 2];
    w[i] = w[i - 16] + (std::rotr(a, 7) ^ std::rotr(a, 18) ^ (a >> 3)) + w[i - 7] +
           (std::rotr(b, 17) ^ std::rotr(b, 19) ^ (b >> 10));
  }
  uint32_t s[8];
  for (size_t i = 0; i < 8; ++i) s[i] = state_[i];
  for (size_t i = 0; i < 64; ++i) {
    const uint32_t e = s[4], a = s[0];
    const uint32_t t1 = s[7] + (std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25)) +
                        ((e & s[5]) ^ (~e & s[6])) + kRound[i] + w[i];
    const uint32_t t2 = (std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22)) +
                        ((a & s[1]) ^ (a & s[2]) ^ (s[1] & s[2]));
    for (size_t j = 7; j > 0; --j) s[j] = s[j - 1];
    s[4] += t1;
    s[0] = t1 + t2;
  }
  for (size_t i = 0; i < 8; ++i) state_[i] += s[i];
}

void Sha256::add(std::string_view bytes) {
  length_ += bytes.size();
  for (const char c : bytes) {
    pending_[filled_++] = static_cast<unsigned char>(c);
    if (filled_ == 64) {
      block(pending_);
      filled_ = 0;
    }
  }
}

std::string Sha256::hex() {
  const uint64_t bits = 8 * length_;
  add(std::string_view("\x80", 1));
  while (filled_ != 56) add(std::string_view("\0", 1));
  for (int i = 7; i >= 0; --i) {
    const char byte = static_cast<char>(bits >> (8 * i));
    add(std::string_view(&byte, 1));
  }
  std::string text;
  for (const uint32_t word : state_)
    for (int i = 28; i >= 0; i -= 4) text += "0123456789abcdef"[(word >> i) & 15];
  return text;
}

}  // namespace photonloom
