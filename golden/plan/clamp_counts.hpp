// SPDX-License-Identifier: Apache-2.0
// What the host's named conversions could not keep as it was and took as the nearest that there is
// (docs/extremes.md, "What saturates, and what says so").
#pragma once
#include <cstdint>

namespace photonloom {

struct ClampCounts {
  uint64_t positions = 0;  // outside of the cube
  uint64_t radii = 0;      // of records, not within cache.radius_min and cache.radius_max
  uint64_t reaches = 0;    // of records, whose square is below 1 or beyond its bits
  uint64_t gradients = 0;  // numbers of a ray's gradient beyond 2^31 - 1
  uint64_t changes = 0;    // channels of a record's light that would change by more than -1 to 1

  // Calls f(name, member) for each, with the name it has in the JSON of commands.
  template <class F>
  static void visit(F&& f) {
    f("outside_positions", &ClampCounts::positions);
    f("clamped_radii", &ClampCounts::radii);
    f("clamped_reaches", &ClampCounts::reaches);
    f("saturated_gradients", &ClampCounts::gradients);
    f("clamped_changes", &ClampCounts::changes);
  }
};

}  // namespace photonloom
