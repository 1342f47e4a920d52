// SPDX-License-Identifier: Apache-2.0
// Rays against single primitives, in double, and the rules that keep a ray from meeting the surface
// it leaves.
//
// Nothing here is an absolute epsilon. A ray never meets the primitive it starts on (a sphere: only
// its other side). Against neighbours, whose plane may pass the origin by rounding, the origin is
// moved along the geometric normal, to the side the ray leaves to, by 2^-46 of the largest
// coordinate: positions are rounded to 2^-53 of it, a few operations each.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "golden/transport/world.hpp"

namespace photonloom {

// Barycentric coordinates of the vertices a, b, c; x, y on a disk; a point of an uneven primitive's
// unit shape; unused for others.
struct Meeting {
  double t = 0;
  Vec3 coordinates{0};
};

// A point moved off its surface towards `direction`.
inline Vec3 leave_surface(const Vec3& position, const Vec3& normal, const Vec3& direction) {
  const double size = max_component(glm::abs(position));
  const double shift = size * 0x1p-46;
  return position + normal * (glm::dot(normal, direction) < 0 ? -shift : shift);
}

// The ray's part of the watertight test (Woop, Benthin, Wald 2013, "Watertight Ray/Triangle
// Intersection"): a shear that makes the ray the z axis.
struct Shear {
  int kx, ky, kz;
  double sx, sy, sz;
  explicit Shear(const Vec3& d) {
    const Vec3 a = glm::abs(d);
    kz = a.x > a.y ? (a.x > a.z ? 0 : 2) : (a.y > a.z ? 1 : 2);
    kx = kz == 2 ? 0 : kz + 1;
    ky = kx == 2 ? 0 : kx + 1;
    if (d[kz] < 0) std::swap(kx, ky);
    sz = 1.0 / d[kz];
    sx = d[kx] * sz;
    sy = d[ky] * sz;
  }
};

// Where the ray meets the triangle's plane; coordinates are not normalised. False: nowhere.
struct Crossing {
  double u, v, w, t;
};
inline bool cross_plane(const Vec3& va, const Vec3& vb, const Vec3& vc, const Vec3& origin,
                        const Shear& s, Crossing& out) {
  const Vec3 a = va - origin, b = vb - origin, c = vc - origin;
  const double ax = a[s.kx] - s.sx * a[s.kz], ay = a[s.ky] - s.sy * a[s.kz];
  const double bx = b[s.kx] - s.sx * b[s.kz], by = b[s.ky] - s.sy * b[s.kz];
  const double cx = c[s.kx] - s.sx * c[s.kz], cy = c[s.ky] - s.sy * c[s.kz];
  out.u = cx * by - cy * bx;
  out.v = ax * cy - ay * cx;
  out.w = bx * ay - by * ax;
  const double det = out.u + out.v + out.w;
  if (det == 0) return false;
  out.t = (out.u * a[s.kz] + out.v * b[s.kz] + out.w * c[s.kz]) * s.sz / det;
  return true;
}

// Edges belong to both of their triangles: no ray passes between neighbours.
inline bool meet_triangle(const Vec3& va, const Vec3& vb, const Vec3& vc, const Vec3& origin,
                          const Shear& s, Meeting& m) {
  Crossing c;
  if (!cross_plane(va, vb, vc, origin, s, c)) return false;
  if ((c.u < 0 || c.v < 0 || c.w < 0) && (c.u > 0 || c.v > 0 || c.w > 0)) return false;
  if (!(c.t > 0)) return false;
  m.t = c.t;
  m.coordinates = Vec3(c.u, c.v, c.w) / (c.u + c.v + c.w);
  return true;
}

// `leaving`: the origin lies on this very sphere.
inline bool meet_sphere(const Primitive& p, const Vec3& origin, const Vec3& direction, bool leaving,
                        Meeting& m) {
  const Vec3 oc = origin - p.a;
  const double b = glm::dot(oc, direction);
  if (leaving) {
    m.t = -2 * b;
    return b < 0;
  }
  const Vec3 across = oc - direction * b;
  const double disc = p.b.x * p.b.x - glm::dot(across, across);
  if (!(disc >= 0)) return false;
  const double root = std::sqrt(disc);
  m.t = -b - root > 0 ? -b - root : root - b;
  return m.t > 0;
}

inline bool meet_disk(const Primitive& p, const Vec3& origin, const Vec3& direction, Meeting& m) {
  const double slope = glm::dot(p.normal, direction);
  if (slope == 0) return false;
  m.t = glm::dot(p.normal, p.a - origin) / slope;
  if (!(m.t > 0)) return false;
  const Vec3 q = origin + direction * m.t - p.a;
  const double bb = glm::dot(p.b, p.b), cc = glm::dot(p.c, p.c), bc = glm::dot(p.b, p.c);
  const double qb = glm::dot(q, p.b), qc = glm::dot(q, p.c), det = bb * cc - bc * bc;
  const double x = (qb * cc - qc * bc) / det, y = (qc * bb - qb * bc) / det;
  m.coordinates = Vec3(x, y, 0);
  return x * x + y * y <= 1;
}

// `leaving`: the origin lies on this very cylinder, which has no caps.
inline bool meet_cylinder(const Primitive& p, const Vec3& origin, const Vec3& direction,
                          bool leaving, Meeting& m) {
  const double length = glm::length(p.b);
  const Vec3 along = p.b / length, oc = origin - p.a;
  const Vec3 o = oc - along * glm::dot(oc, along);
  const Vec3 d = direction - along * glm::dot(direction, along);
  const double slope2 = glm::dot(d, d);
  if (!(slope2 > 0)) return false;
  const double nearest = -glm::dot(o, d) / slope2;
  const auto reaches = [&](double t) {
    const double height = glm::dot(oc + direction * t, along);
    m.t = t;
    return t > 0 && height >= 0 && height <= length;
  };
  if (leaving) return reaches(2 * nearest);
  const Vec3 across = o + d * nearest;
  const double disc = p.c.x * p.c.x - glm::dot(across, across);
  if (!(disc >= 0)) return false;
  const double root = std::sqrt(disc / slope2);
  return reaches(nearest - root) || reaches(nearest + root);
}

// Into the unit shape of an uneven primitive: of which a point, or a direction without translation.
inline glm::dmat3 to_unit_shape(const Primitive& p) {
  return glm::inverse(glm::dmat3(p.b, p.c, p.axis));
}

// `leaving`: the origin lies on this very ellipsoid, or on this very cylinder, which has no caps.
// Coordinates are of the unit shape; t is the ray's own.
inline bool meet_uneven(const Primitive& p, const Vec3& origin, const Vec3& direction, bool leaving,
                        Meeting& m) {
  const glm::dmat3 to_unit = to_unit_shape(p);
  const Vec3 oc = to_unit * (origin - p.a), d = to_unit * direction;
  const bool tube = p.kind == PrimitiveKind::kUnevenCylinder;
  const Vec3 o = tube ? Vec3(oc.x, oc.y, 0) : oc, slope = tube ? Vec3(d.x, d.y, 0) : d;
  const double slope2 = glm::dot(slope, slope);
  if (!(slope2 > 0)) return false;
  const double nearest = -glm::dot(o, slope) / slope2;
  const auto reaches = [&](double t) {
    m.t = t;
    m.coordinates = oc + d * t;
    return t > 0 && (!tube || (m.coordinates.z >= 0 && m.coordinates.z <= 1));
  };
  if (leaving) return reaches(2 * nearest);
  const Vec3 across = o + slope * nearest;
  const double disc = 1 - glm::dot(across, across);
  if (!(disc >= 0)) return false;
  const double root = std::sqrt(disc / slope2);
  return reaches(nearest - root) || reaches(nearest + root);
}

// Any primitive but a triangle.
inline bool meet_round(const Primitive& p, const Vec3& origin, const Vec3& direction, bool leaving,
                       Meeting& m) {
  switch (p.kind) {
    case PrimitiveKind::kSphere:
      return meet_sphere(p, origin, direction, leaving, m);
    case PrimitiveKind::kCylinder:
      return meet_cylinder(p, origin, direction, leaving, m);
    case PrimitiveKind::kUnevenSphere:
    case PrimitiveKind::kUnevenCylinder:
      return meet_uneven(p, origin, direction, leaving, m);
    default:
      return !leaving && meet_disk(p, origin, direction, m);
  }
}

// Whether the round surface on which a segment ends stands in its way before: one that ends on the
// inside of a sphere or tube, from outside. Casters take no other notice of the end's own surface.
inline bool own_wall_before(const World& world, const Ray& ray, const Hit* from,
                            const Hit& to_hit) {
  const Primitive& p = world.primitives()[to_hit.primitive];
  if (p.kind == PrimitiveKind::kTriangle || p.kind == PrimitiveKind::kDisk) return false;
  if (from && from->primitive == to_hit.primitive) return false;  // a chord
  Meeting m;
  return meet_round(p, to_hit.position, -ray.direction, true, m) &&
         m.t < glm::length(to_hit.position - ray.origin);
}

// Position on the primitive itself and normals.
Hit finish_hit(const World& world, uint32_t primitive, const Ray& ray, const Meeting& m,
               uint32_t instance = ~0u);

void primitive_bounds(const Primitive& p, Vec3& lower, Vec3& upper);

}  // namespace photonloom
