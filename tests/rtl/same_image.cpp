// SPDX-License-Identifier: Apache-2.0
// A sample of the combinations of same_image.hpp, and the smallest configuration: no deadlock.
#include "tests/rtl/same_image.hpp"

using namespace photonloom::test;

TEST_CASE("the image is the same whatever the timing") {
  LawFrame frame(false);
  frame.check_smallest();
  for (const uint64_t combination : {2, 5}) frame.check(combination);
}

TEST_CASE("also with epsilon and a leaf limit that bites") {
  LawFrame frame(true);
  for (const uint64_t combination : {3, 8}) frame.check(combination);
}
