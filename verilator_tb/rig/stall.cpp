// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/rig/stall.hpp"

#include <fmt/core.h>

#include <stdexcept>

#include "golden/numeric/random.hpp"
#include "golden/numeric/strict_number.hpp"

namespace photonloom {

StallPolicy StallPolicy::parse(const std::string& text) {
  if (text == "none") return {};
  if (text == "bursts") return {Kind::kBursts, 0};
  if (text == "adversary") return {Kind::kAdversary, 0};
  if (text.starts_with("bernoulli:")) {
    const auto p = strict_number<double>(text.substr(10));
    if (p && *p >= 0 && *p < 1) return {Kind::kBernoulli, *p};
  }
  throw std::runtime_error(
      fmt::format("stall policy {}: expected none, bernoulli:P with P in [0, 1), bursts or "
                  "adversary",
                  text));
}

std::string StallPolicy::text() const {
  switch (kind) {
    case Kind::kNone:
      return "none";
    case Kind::kBernoulli:
      return fmt::format("bernoulli:{}", probability);
    case Kind::kBursts:
      return "bursts";
    case Kind::kAdversary:
      break;
  }
  return "adversary";
}

RoleRandom::RoleRandom(uint64_t seed, const std::string& role) : state_(mix64(seed + 1)) {
  for (const char c : role) state_ = mix64(state_ ^ static_cast<unsigned char>(c));
}

uint64_t RoleRandom::bits() { return mix64(state_ += 0x9e3779b97f4a7c15ull); }

Stall::Stall(const StallPolicy& policy, uint64_t seed, const std::string& role)
    : policy_(policy), random_(seed, role) {}

bool Stall::holds() {
  if (policy_.kind == StallPolicy::Kind::kNone) return false;
  if (policy_.kind == StallPolicy::Kind::kBernoulli) return random_.chance(policy_.probability);
  if (left_ == 0) {  // spells of mean 16, now and then much longer
    idle_ = !idle_;
    left_ = 1 + random_.below(random_.below(8) == 0 ? 128 : 24);
  }
  --left_;
  return idle_;
}

bool Stall::holds_source(bool other_ready) {
  if (policy_.kind != StallPolicy::Kind::kAdversary) return holds();
  if (!other_ready) return false;  // offers what is not expected to be taken
  if (left_ > 0) {
    --left_;
    return true;
  }
  left_ = random_.below(5);
  return false;
}

bool Stall::holds_taker(bool other_valid) {
  if (policy_.kind != StallPolicy::Kind::kAdversary) return holds();
  if (!other_valid) return true;  // never ready before something is offered
  if (left_ > 0) {
    --left_;
    return true;
  }
  left_ = random_.below(random_.below(16) == 0 ? 64 : 5);
  return false;
}

}  // namespace photonloom
