// SPDX-License-Identifier: Apache-2.0
#include "golden/transport/microfacet.hpp"

#include <algorithm>
#include <cmath>

#include "golden/numeric/elementary.hpp"
#include "golden/transport/sampling.hpp"

namespace photonloom {
namespace {

constexpr double kLog2E = 1.44269504088896340736;

}  // namespace

double MicrofacetSurface::density(const Vec3& m) const {
  if (!(m.z > 0)) return 0;
  const double x = m.x / alpha_u, y = m.y / alpha_v, z2 = m.z * m.z;
  const double scale = kPi * alpha_u * alpha_v;
  if (kind == Microfacets::kGgx) {
    const double t = x * x + y * y + z2;
    return 1 / (scale * t * t);
  }
  return exp2_exact(-(x * x + y * y) / z2 * kLog2E) / (scale * z2 * z2);
}

double MicrofacetSurface::seen(const Vec3& v, const Vec3& m) const {
  // The front of a facet is seen from the front of the surface only.
  if (!(glm::dot(v, m) * v.z > 0)) return 0;
  const double x = alpha_u * v.x, y = alpha_v * v.y;
  const double tan2 = (x * x + y * y) / (v.z * v.z);  // (alpha tan)^2
  if (tan2 == 0) return 1;
  if (kind == Microfacets::kGgx) return 2 / (1 + std::sqrt(1 + tan2));
  const double a = 1 / std::sqrt(tan2);
  if (a >= 1.6) return 1;
  return (3.535 * a + 2.181 * a * a) / (1 + 2.276 * a + 2.577 * a * a);
}

Vec3 MicrofacetSurface::sample(const Vec3& in, const Vec2& u) const {
  if (kind == Microfacets::kGgx) {
    const Vec3 stretched = glm::normalize(Vec3(alpha_u * in.x, alpha_v * in.y, in.z));
    const double across = stretched.x * stretched.x + stretched.y * stretched.y;
    const Vec3 t1 =
        across > 0 ? Vec3(-stretched.y, stretched.x, 0) / std::sqrt(across) : Vec3(1, 0, 0);
    const Vec3 t2 = glm::cross(stretched, t1);
    Vec2 d = sample_disk(u);
    const double s = (1 + stretched.z) / 2;
    d.y = (1 - s) * std::sqrt(std::max(0.0, 1 - d.x * d.x)) + s * d.y;
    const Vec3 h =
        t1 * d.x + t2 * d.y + stretched * std::sqrt(std::max(0.0, 1 - d.x * d.x - d.y * d.y));
    return glm::normalize(Vec3(alpha_u * h.x, alpha_v * h.y, std::max(1e-12, h.z)));
  }
  // Slopes are normally distributed.
  const double r = std::sqrt(-log2_exact(std::max(1 - u.x, 0x1p-60)) / kLog2E);
  const Vec2 slope = cos_sin_turns(u.y) * r;
  return glm::normalize(Vec3(alpha_u * slope.x, alpha_v * slope.y, 1));
}

double MicrofacetSurface::pdf(const Vec3& in, const Vec3& m) const {
  if (kind == Microfacets::kGgx)
    return density(m) * seen(in, m) * std::fabs(glm::dot(in, m)) / std::fabs(in.z);
  return density(m) * m.z;
}

Vec3 reflect(const Vec3& in, const Vec3& normal) {
  return normal * (2 * glm::dot(in, normal)) - in;
}

bool refract(const Vec3& in, const Vec3& normal, double ior, Vec3& out) {
  const double cos_in = glm::dot(in, normal);
  const double cos2 = 1 - (1 - cos_in * cos_in) / (ior * ior);
  if (cos2 <= 0) return false;
  out = glm::normalize(normal * (cos_in / ior - std::sqrt(cos2)) - in / ior);
  return true;
}

double refraction_jacobian(const Vec3& in, const Vec3& out, const Vec3& m, double ior) {
  const double sum = glm::dot(in, m) + ior * glm::dot(out, m);
  return ior * ior * std::fabs(glm::dot(out, m)) / (sum * sum);
}

}  // namespace photonloom
