// SPDX-License-Identifier: Apache-2.0
// One of the combinations of same_image.hpp.
#include "tests/rtl/same_image.hpp"

using namespace photonloom::test;

TEST_CASE("the image is the same whatever the timing") {
  LawFrame frame(false);
  frame.check(2);
}
