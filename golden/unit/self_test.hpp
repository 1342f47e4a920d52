// SPDX-License-Identifier: Apache-2.0
// A board's power-up self-test: small maps and queries of its own, written as a host would, and the
// signature that their results must have (docs/board.md).
#pragma once
#include <cstdint>
#include <vector>

#include "golden/plan/plan.hpp"

namespace photonloom {

struct SelfTest {
  // WRITEs one behind the other: an address of the link's address space, how many words, the words.
  // The last but one starts the replayer, whose results are waited for; the last sets it back.
  std::vector<uint32_t> words;
  uint32_t results = 0;    // of the queries and the flush behind them
  uint64_t signature = 0;  // of them, in order, as golden has them
};

// The same for the same plan. Photons and queries lie all over the cube, with every power and
// direction; where lines are compressed, as far apart as leaves with one line each allow.
SelfTest make_self_test(const Plan& plan);

}  // namespace photonloom
