// SPDX-License-Identifier: Apache-2.0
#include "bench/room.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "golden/numeric/random.hpp"

namespace photonloom::bench {
namespace {

// The room is the unit cube, seen from inside; blocks stand on its floor y = 0.
struct Box {
  Vec3 low, high;
};
const Box kRoom{Vec3(0), Vec3(1)};
const Box kBlocks[] = {{Vec3(0.15, 0, 0.5), Vec3(0.42, 0.6, 0.8)},
                       {Vec3(0.55, 0, 0.2), Vec3(0.85, 0.28, 0.5)}};
constexpr double kLamp = 0.12;  // half its edge, in the middle of the ceiling

struct RoomHit {
  Vec3 position, normal;
};

// The nearest wall of the room or side of a block along a ray that starts inside the room.
RoomHit cast(const Vec3& from, const Vec3& direction) {
  double nearest = std::numeric_limits<double>::infinity();
  RoomHit hit{};
  const auto take = [&](double t, int axis, double side) {
    nearest = t;
    hit.position = from + direction * t;
    hit.normal = Vec3(0);
    hit.normal[axis] = side;
  };
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0) continue;
    const double wall = direction[axis] > 0 ? kRoom.high[axis] : kRoom.low[axis];
    const double t = (wall - from[axis]) / direction[axis];
    if (t < nearest) {
      take(t, axis, direction[axis] > 0 ? -1 : 1);
      hit.position[axis] = wall;
    }
  }
  for (const Box& block : kBlocks) {
    double enter = 0, leave = nearest;
    int axis = -1;
    for (int a = 0; a < 3; ++a) {
      const double inverse = 1 / direction[a];
      const double t0 = (block.low[a] - from[a]) * inverse,
                   t1 = (block.high[a] - from[a]) * inverse;
      const double first = std::min(t0, t1), last = std::max(t0, t1);
      if (first > enter) {
        enter = first;
        axis = a;
      }
      leave = std::min(leave, last);
    }
    if (axis >= 0 && enter < leave && enter > 1e-9) {
      const double side = direction[axis] > 0 ? -1 : 1;
      take(enter, axis, side);
      hit.position[axis] = side < 0 ? block.low[axis] : block.high[axis];
    }
  }
  return hit;
}

Vec3 diffuse_direction(const Vec3& normal, double u, double v) {
  const double r = std::sqrt(u), phi = 2 * M_PI * v;
  return Frame(normal).to_world(
      Vec3(r * std::cos(phi), r * std::sin(phi), std::sqrt(std::max(1e-12, 1 - u))));
}

UVec3 quantise(const Vec3& x) {
  const double cells = static_cast<double>(1 << kPositionBits);
  UVec3 q;
  for (int c = 0; c < 3; ++c)
    q[static_cast<size_t>(c)] =
        static_cast<uint32_t>(std::clamp(std::floor(x[c] * cells), 0.0, cells - 1));
  return q;
}

RoomHit camera_hit(size_t i, size_t n) {
  const size_t edge = static_cast<size_t>(std::ceil(std::sqrt(static_cast<double>(n))));
  const double x = (static_cast<double>(i % edge) + 0.5) / static_cast<double>(edge) - 0.5;
  const double y = 0.5 - (static_cast<double>(i / edge) + 0.5) / static_cast<double>(edge);
  return cast(Vec3(0.5, 0.5, 0.02), glm::normalize(Vec3(x * 1.4, y * 1.4, 1)));
}

}  // namespace

std::vector<UVec3> trace_photons(size_t n, uint64_t seed) {
  std::vector<UVec3> photons;
  for (uint64_t path = 0; photons.size() < n; ++path) {
    const Random random(seed, Phase::kGlobalPhoton, path);
    RoomHit at;
    at.position = Vec3(0.5 + kLamp * (2 * random.unit(0, 0) - 1), 1,
                       0.5 + kLamp * (2 * random.unit(0, 1) - 1));
    at.normal = Vec3(0, -1, 0);
    for (uint64_t bounce = 0; photons.size() < n; ++bounce) {
      at = cast(at.position,
                diffuse_direction(at.normal, random.unit(bounce, 2), random.unit(bounce, 3)));
      photons.push_back(quantise(at.position));
      if (random.unit(bounce, 4) > 0.6) break;  // the albedo
    }
  }
  return photons;
}

std::vector<UVec3> camera_hits(size_t n) {
  std::vector<UVec3> hits(n);
  for (size_t i = 0; i < n; ++i) hits[i] = quantise(camera_hit(i, n).position);
  return hits;
}

std::vector<UVec3> gather_hits(size_t n, size_t rays, uint64_t seed) {
  std::vector<UVec3> hits(n);
  const size_t cameras = (n + rays - 1) / rays;
  for (size_t i = 0; i < n; ++i) {
    const RoomHit from = camera_hit(i / rays, cameras);
    const Random random(seed, Phase::kGather, i);
    hits[i] = quantise(
        cast(from.position, diffuse_direction(from.normal, random.unit(0, 0), random.unit(0, 1)))
            .position);
  }
  return hits;
}

double surface_area() {
  double area = 6;
  for (const Box& block : kBlocks) {
    const Vec3 e = block.high - block.low;
    area += 2 * (e.x * e.y + e.y * e.z);  // the sides; the top makes up for the floor below
  }
  return area * std::ldexp(1.0, 2 * kPositionBits);
}

}  // namespace photonloom::bench
