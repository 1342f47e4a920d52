// SPDX-License-Identifier: Apache-2.0
// Distributions of microfacet normals (Walter et al. 2007, "Microfacet Models for Refraction
// through Rough Surfaces"), in a frame whose z axis is the surface's normal. Directions are unit
// vectors.
#pragma once
#include "golden/numeric/vec.hpp"
#include "golden/scene/scene.hpp"

namespace photonloom {

struct MicrofacetSurface {
  Microfacets kind = Microfacets::kBeckmann;
  double alpha_u = 0.1, alpha_v = 0.1;  // along x and y

  // Area of facets with the normal m (z > 0) per area of the surface and solid angle.
  double density(const Vec3& m) const;
  // Smith's share of facets with the normal m that are seen from v. Beckmann: Walter's rational
  // approximation, as Mitsuba has it.
  double seen(const Vec3& v, const Vec3& m) const;
  double shadowing(const Vec3& a, const Vec3& b, const Vec3& m) const {
    return seen(a, m) * seen(b, m);
  }

  // A normal for light that arrives from `in` (z > 0), and its density per solid angle. GGX: of the
  // visible normals (Heitz 2018). Beckmann: of all normals in proportion to their projected area,
  // for which `seen` need not be exact.
  Vec3 sample(const Vec3& in, const Vec2& u) const;
  double pdf(const Vec3& in, const Vec3& m) const;
};

// The mirror's direction, and by Snell's law the one through a surface of this index (other side
// over the side of `in`); false: total reflection.
Vec3 reflect(const Vec3& in, const Vec3& normal);
bool refract(const Vec3& in, const Vec3& normal, double ior, Vec3& out);

// What refraction by facets does to solid angles: of normals per solid angle of `out`.
double refraction_jacobian(const Vec3& in, const Vec3& out, const Vec3& m, double ior);

}  // namespace photonloom
