// SPDX-License-Identifier: Apache-2.0
// The load that gatherers are measured with: final-gather queries of a scene.
#pragma once
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "golden/numeric/octahedral.hpp"
#include "golden/plan/quantiser.hpp"
#include "golden/transport/world.hpp"
#include "golden/unit/backend.hpp"

namespace photonloom {

// Final-gather queries in pixel order: cosine-distributed rays from what the camera sees.
inline std::vector<GatherQuery> final_gather_queries(const World& world, const RayCaster& caster,
                                                     const Plan& plan, int size, int rays,
                                                     uint64_t seed) {
  std::vector<GatherQuery> queries;
  for (int py = 0; py < size; ++py)
    for (int px = 0; px < size; ++px) {
      const uint32_t pixel = static_cast<uint32_t>(py * size + px);
      const CameraSample x = trace_camera(world, caster, px, py, 0, seed);
      if (!x.diffuse) continue;
      const Vec3 n = x.x.normal;
      const Vec3 side = glm::normalize(std::fabs(n.x) < 0.5 ? glm::cross(n, Vec3(1, 0, 0))
                                                            : glm::cross(n, Vec3(0, 1, 0)));
      const Vec3 up = glm::cross(n, side);
      for (int ray = 0; ray < rays; ++ray) {
        // Stratified in both coordinates of the unit disk's polar map.
        const int edge = static_cast<int>(std::sqrt(static_cast<double>(rays)));
        const double u = (ray % edge + 0.5) / edge, v = (ray / edge % edge + 0.5) / edge;
        const double r = std::sqrt(u), phi = 2 * 3.14159265358979323846 * v;
        const Vec3 direction = glm::normalize(side * (r * std::cos(phi)) +
                                              up * (r * std::sin(phi)) + n * std::sqrt(1 - u));
        const GatherSample y =
            trace_gather(world, caster, x.x, direction, pixel, 0, static_cast<uint64_t>(ray), seed);
        if (!y.diffuse) continue;
        GatherQuery q{};
        q.pixel = pixel;
        q.tag = static_cast<uint32_t>(ray);
        q.position = quantise_position(plan, y.y.position);
        const OctCode code = oct_encode(y.y.normal, plan.normal_bits);
        q.normal = {code.u, code.v};
        queries.push_back(q);
      }
    }
  return queries;
}

// The queries in the order in which golden's reorder buffer lets them go.
inline std::vector<GatherQuery> reordered(const Plan& plan, std::vector<GatherQuery> queries) {
  GatherQuery flush{};
  flush.flush = 1;
  queries.push_back(flush);
  std::vector<GatherQuery> ordered;
  make_golden_reorder_buffer(plan)->process(queries, ordered);
  ordered.pop_back();
  return ordered;
}

}  // namespace photonloom
