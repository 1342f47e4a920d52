// SPDX-License-Identifier: Apache-2.0
// When a stream's driver or taker holds back. Each role has its own random stream, derived from one
// seed and the role's name, so that adding a stream changes no other.
#pragma once
#include <cstdint>
#include <string>

namespace photonloom {

// "none", "bernoulli:P" (holds back with probability P, default 0.5), "bursts" (idle and busy
// spells of geometric length), "adversary" (acts on what the other side just showed: takes as late
// and offers as suddenly as it can).
struct StallPolicy {
  enum class Kind { kNone, kBernoulli, kBursts, kAdversary };
  Kind kind = Kind::kNone;
  double probability = 0;

  // Throws std::runtime_error naming `text` and what is expected.
  static StallPolicy parse(const std::string& text);
  std::string text() const;
};

// Hashed counter as a small random stream.
class RoleRandom {
 public:
  RoleRandom(uint64_t seed, const std::string& role);
  uint64_t bits();
  uint64_t below(uint64_t n) { return bits() % n; }  // n > 0
  bool chance(double p) { return static_cast<double>(bits() >> 11) * 0x1p-53 < p; }

 private:
  uint64_t state_;
};

class Stall {
 public:
  Stall(const StallPolicy& policy, uint64_t seed, const std::string& role);
  // Whether to hold back in this cycle; call once a cycle. A source passes whether the other side
  // was ready in the last cycle, a taker whether it was offered something.
  bool holds_source(bool other_ready);
  bool holds_taker(bool other_valid);

 private:
  bool holds();
  StallPolicy policy_;
  RoleRandom random_;
  bool idle_ = false;
  uint64_t left_ = 0;
};

}  // namespace photonloom
