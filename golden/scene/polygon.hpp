// SPDX-License-Identifier: Apache-2.0
// What readers of mesh files share.
#pragma once
#include <fmt/core.h>

#include <array>
#include <cmath>
#include <vector>

#include "golden/scene/mesh.hpp"

namespace photonloom {

inline bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// Splits a polygon into a fan. A corner that lies on an edge of a larger polygon gives a triangle
// without area, which is left out; a polygon without any area is refused. `place()` says where it
// stands.
template <class Place>
void add_polygon(Mesh& mesh, const std::vector<uint32_t>& corners, Place&& place) {
  bool any = false;
  for (size_t i = 2; i < corners.size(); ++i) {
    const std::array<uint32_t, 3> t = {corners[0], corners[i - 1], corners[i]};
    if (no_area(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]])) continue;
    mesh.triangles.push_back(t);
    any = true;
  }
  // Whose squares are no numbers.
  constexpr double kFarthest = 1e100;
  if (!any)
    for (const uint32_t corner : corners)
      if (const double far = max_component(glm::abs(mesh.positions[corner])); far > kFarthest)
        throw SceneError(
            fmt::format("{}: a corner of the face lies {:g} from the origin, expected "
                        "at most {:g}",
                        place(), far, kFarthest));
  if (!any)
    throw SceneError(fmt::format("{}: the face has no area, expected a proper triangle", place()));
}

}  // namespace photonloom
