// SPDX-License-Identifier: Apache-2.0
#include "golden/transport/bsdf.hpp"

#include <cmath>

#include "golden/transport/sampling.hpp"

namespace photonloom {
namespace {

Vec3 reflect(const Vec3& in, const Vec3& normal) {
  return normal * (2 * glm::dot(in, normal)) - in;
}

// Snell. False: total reflection.
bool refract(const Vec3& in, const Vec3& normal, double ior, Vec3& out) {
  const double cos_in = glm::dot(in, normal);
  const double cos2 = 1 - (1 - cos_in * cos_in) / (ior * ior);
  if (cos2 <= 0) return false;
  out = glm::normalize(normal * (cos_in / ior - std::sqrt(cos2)) - in / ior);
  return true;
}

double cos_lobe(const Surface& s, const Vec3& out) {
  return glm::dot(reflect(s.in, s.shading_normal), out);
}

}  // namespace

double Surface::diffuse_probability() const {
  const double d = mean(diffuse()), g = mean(glossy());
  return d > 0 ? d / (d + g) : 0;
}

Surface make_surface(const World& world, const Hit& hit, const Vec3& ray_direction) {
  Surface s;
  s.front = glm::dot(hit.normal, ray_direction) < 0;
  s.in = -ray_direction;
  s.normal = s.front ? hit.normal : -hit.normal;
  s.shading_normal = s.front ? hit.shading_normal : -hit.shading_normal;
  s.bsdf = world.bsdf(hit.shape, s.front);
  if (glm::dot(s.shading_normal, s.in) <= 0) s.bsdf = nullptr;
  return s;
}

Rgb diffuse_times_cosine(const Surface& s, const Vec3& out) {
  return s.above(out) ? s.diffuse() * (glm::dot(s.shading_normal, out) / kPi) : Rgb(0);
}

double diffuse_pdf(const Surface& s, const Vec3& out) {
  const double c = glm::dot(s.shading_normal, out);
  return c > 0 ? c / kPi : 0;
}

Rgb glossy_times_cosine(const Surface& s, const Vec3& out) {
  const Rgb rho = s.glossy();
  if (is_black(rho) || !s.above(out)) return Rgb(0);
  const double c = cos_lobe(s, out), n = s.bsdf->exponent;
  if (c <= 0) return Rgb(0);
  return rho * ((n + 2) / (2 * kPi) * pow_exact(c, n) * glm::dot(s.shading_normal, out));
}

double glossy_pdf(const Surface& s, const Vec3& out) {
  const double c = cos_lobe(s, out), n = s.bsdf->exponent;
  return c > 0 ? (n + 1) / (2 * kPi) * pow_exact(c, n) : 0;
}

Vec3 sample_diffuse(const Surface& s, const Vec2& u) {
  return Frame(s.shading_normal).to_world(sample_cosine(u));
}

Vec3 sample_glossy(const Surface& s, const Vec2& u) {
  const double z = pow_exact(1 - u.x, 1 / (s.bsdf->exponent + 1));
  const double r = std::sqrt(std::max(0.0, 1 - z * z));
  return Frame(reflect(s.in, s.shading_normal)).to_world(Vec3(cos_sin_turns(u.y) * r, z));
}

bool leave_with_power(const Surface& s, double choice, const Vec2& u, Vec3& out, Rgb& power) {
  const double p = s.diffuse_probability();
  if (choice < p) {
    // Around the geometric normal, so that the adjoint's |out.ng| cancels.
    out = Frame(s.normal).to_world(sample_cosine(u));
    power *= s.diffuse() * (s.shading_ratio(s.in) / p);
  } else {
    out = sample_glossy(s, u);
    const double pdf = glossy_pdf(s, out);
    if (!(pdf > 0) || !s.above(out)) return false;
    power *= glossy_times_cosine(s, out) *
             (s.shading_ratio(s.in) / s.shading_ratio(out) / ((1 - p) * pdf));
  }
  return s.above(out) && !is_black(power);
}

double fresnel_dielectric(double cos_in, double ior) {
  const double cos2 = 1 - (1 - cos_in * cos_in) / (ior * ior);
  if (cos2 <= 0) return 1;
  const double cos_out = std::sqrt(cos2);
  const double s = (cos_in - ior * cos_out) / (cos_in + ior * cos_out);
  const double p = (cos_out - ior * cos_in) / (cos_out + ior * cos_in);
  return (s * s + p * p) / 2;
}

Rgb fresnel_conductor(double cos_in, const Rgb& eta, const Rgb& k) {
  Rgb out(1);
  const double c2 = cos_in * cos_in, s2 = 1 - c2;
  for (int i = 0; i < 3; ++i) {
    if (eta[i] == 0 && k[i] == 0) continue;
    const double e2 = eta[i] * eta[i], k2 = k[i] * k[i];
    const double t0 = e2 - k2 - s2;
    const double a2b2 = std::sqrt(t0 * t0 + 4 * e2 * k2);
    const double a = std::sqrt(std::max(0.0, (a2b2 + t0) / 2));
    const double rs = (a2b2 + c2 - 2 * cos_in * a) / (a2b2 + c2 + 2 * cos_in * a);
    const double t3 = c2 * a2b2 + s2 * s2, t4 = 2 * cos_in * a * s2;
    out[i] = rs * (1 + (t3 - t4) / (t3 + t4)) / 2;
  }
  return out;
}

bool sample_delta(const Surface& s, double u, Carried carried, Vec3& out, Rgb& weight,
                  double& ior2) {
  const double cos_in = glm::dot(s.in, s.shading_normal);
  ior2 = 1;
  if (s.bsdf->kind == BsdfKind::kConductor) {
    out = reflect(s.in, s.shading_normal);
    weight = s.bsdf->specular * fresnel_conductor(cos_in, s.bsdf->eta, s.bsdf->k);
    if (glm::dot(s.normal, out) <= 0) return false;
  } else {
    const double ior = s.front ? s.bsdf->ior : 1 / s.bsdf->ior;
    const double f = fresnel_dielectric(cos_in, ior);
    const Rgb reflected = s.bsdf->specular * f, transmitted = s.bsdf->transmission * (1 - f);
    const double total = mean(reflected) + mean(transmitted);
    if (!(total > 0)) return false;
    const double p = mean(reflected) / total;
    if (u < p) {
      out = reflect(s.in, s.shading_normal);
      weight = reflected / p;
      if (glm::dot(s.normal, out) <= 0) return false;
    } else {
      if (!refract(s.in, s.shading_normal, ior, out)) return false;
      weight = transmitted / (1 - p);
      if (glm::dot(s.normal, out) >= 0) return false;
      if (carried == Carried::kRadiance) {
        ior2 = ior * ior;
        weight /= ior2;
      }
    }
  }
  if (carried == Carried::kPower) weight *= s.shading_ratio(s.in) / s.shading_ratio(out);
  return !is_black(weight);
}

}  // namespace photonloom
