// SPDX-License-Identifier: Apache-2.0
// What the search for a plan within an error takes from the plans that it confirmed.
#include "study/plan_search.hpp"

#include "tests/catch.hpp"

using namespace photonloom;

TEST_CASE("confirmed plans with a rare bright path do not make others hopeless") {
  CHECK(usual_margin({1.04}) == 1.04);
  CHECK(usual_margin({1.04, 2.2}) == 1.04);
  CHECK(usual_margin({2.2, 1.04, 1.1}) == 1.04);
  // Two that are alike meet the same path.
  CHECK(usual_margin({1.04, 1.6, 1.61}) == 1.04);
  CHECK(usual_margin({1.3, 1.6, 1.2, 1.04, 1.1}) == 1.1);
}
