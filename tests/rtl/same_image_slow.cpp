// SPDX-License-Identifier: Apache-2.0
// More combinations of same_image.hpp, and the smallest configuration: no deadlock.
#include "tests/rtl/same_image.hpp"

using namespace photonloom::test;

TEST_CASE("the smallest configuration and some combinations") {
  LawFrame frame(false);
  frame.check_smallest();
  frame.check(5);
}

TEST_CASE("also with epsilon and a leaf limit that bites") {
  LawFrame frame(true);
  for (const uint64_t combination : {3, 8}) frame.check(combination);
}

TEST_CASE("many combinations, exact search") {
  LawFrame frame(false);
  for (uint64_t combination = 100; combination < 112; ++combination) frame.check(combination);
}

TEST_CASE("many combinations, approximate search") {
  LawFrame frame(true);
  frame.check_smallest();
  for (uint64_t combination = 200; combination < 212; ++combination) frame.check(combination);
}
