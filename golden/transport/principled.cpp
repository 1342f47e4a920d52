// SPDX-License-Identifier: Apache-2.0
#include "golden/transport/principled.hpp"

#include <bit>
#include <cmath>

#include "golden/numeric/elementary.hpp"
#include "golden/numeric/random.hpp"
#include "golden/transport/bsdf.hpp"
#include "golden/transport/sampling.hpp"

namespace photonloom {
namespace {

Rgb tinted(const Rgb& base) {
  const double l = luminance(base);
  return l > 0 ? base / l : Rgb(1);
}

// Schlick's Fresnel term from outside; into a thinner medium by the refracted angle.
Rgb schlick(const Rgb& r0, double cosine, double eta) {
  double c = cosine;
  if (!(eta > 1)) c = std::sqrt(std::max(0.0, 1 - (1 - cosine * cosine) / (eta * eta)));
  const double w = schlick_weight(c);
  return r0 * (1 - w) + w;
}

// Burley's GTR1 distribution of the clear coat's facets, of width 0.1 down to 0.001.
struct ClearCoat {
  double alpha2;
  explicit ClearCoat(double gloss) {
    const double alpha = 0.1 + (0.001 - 0.1) * gloss;
    alpha2 = alpha * alpha;
  }
  double density(const Vec3& m) const {
    constexpr double kLn2 = 0.69314718055994530942;
    return (alpha2 - 1) / (kPi * log2_exact(alpha2) * kLn2 * (1 + (alpha2 - 1) * m.z * m.z));
  }
  double pdf(const Vec3& m) const { return m.z > 0 ? density(m) * m.z : 0; }
  Vec3 sample(const Vec2& u) const {
    const double z2 = (1 - pow_exact(alpha2, 1 - u.x)) / (1 - alpha2);
    return Vec3(cos_sin_turns(u.y) * std::sqrt(std::max(0.0, 1 - z2)),
                std::sqrt(std::max(0.0, z2)));
  }
};

double relative_index(const PrincipledLobe& l) { return l.front ? l.eta : 1 / l.eta; }
double base_share(const PrincipledLobe& l) {
  return (1 - l.metallic) * (1 - l.parameters.spec_trans);
}
double glass_share(const PrincipledLobe& l) { return (1 - l.metallic) * l.parameters.spec_trans; }

// Of facets: probability of reflection when one is met with this Fresnel term.
double reflects(const PrincipledLobe& l, double fresnel) {
  return l.front ? 1 - glass_share(l) * (1 - fresnel) : fresnel;
}

// How often the clear coat and an even spread are sampled, where facets are once.
double coat_rate(const PrincipledLobe& l) { return l.front ? 0.25 * l.parameters.clearcoat : 0; }
double even_rate(const PrincipledLobe& l) {
  const Principled& p = l.parameters;
  return l.front && base_share(l) > 0
             ? base_share(l) * (0.5 * l.roughness + p.flatness) + 0.5 * p.sheen
             : 0;
}

// The facet between two directions; false: none that both see from their sides.
bool facet_between(const PrincipledLobe& l, const Vec3& out, Vec3& m) {
  const Vec3 sum = out.z > 0 ? l.in + out : l.in + out * relative_index(l);
  const double length = glm::length(sum);
  if (!(length > 0)) return false;
  m = sum / (sum.z < 0 ? -length : length);
  return glm::dot(l.in, m) > 0 && glm::dot(out, m) * out.z > 0;
}

Rgb specular(const PrincipledLobe& l, double fresnel, double cosine) {
  if (!l.front) return Rgb(glass_share(l) * fresnel);
  const double tint = l.parameters.spec_tint, plain = 1 - l.metallic;
  Rgb f(plain * (1 - tint) * fresnel);
  if (l.metallic > 0) f += schlick(l.base, cosine, l.eta) * l.metallic;
  if (tint > 0) {
    const double r = (l.eta - 1) / (l.eta + 1);
    f += schlick(tinted(l.base) * (r * r), cosine, l.eta) * (plain * tint);
  }
  return f;
}

// Retro-reflection, fake subsurface light and sheen, times pi; `difference` is the cosine between
// either direction and the one half way.
Rgb spread(const PrincipledLobe& l, const Vec3& out, double difference) {
  const Principled& p = l.parameters;
  const double o = schlick_weight(out.z), i = schlick_weight(l.in.z);
  const double r = 2 * l.roughness * difference * difference;
  const double retro = r * (o + i + o * i * (r - 1));
  double light = (1 - p.flatness) * retro;
  if (p.flatness > 0) {
    const auto flattened = [&](double w) { return 1 + (r / 2 - 1) * w; };
    light += p.flatness * 1.25 * (flattened(o) * flattened(i) * (1 / (out.z + l.in.z) - 0.5) + 0.5);
  }
  Rgb sum = l.base * (base_share(l) * light);
  if (p.sheen > 0)
    sum += (Rgb(1 - p.sheen_tint) + tinted(l.base) * p.sheen_tint) *
           (kPi * p.sheen * (1 - l.metallic) * schlick_weight(difference));
  return sum;
}

}  // namespace

Rgb principled_times_cosine(const PrincipledLobe& l, const Vec3& out, bool radiance) {
  const double ior = relative_index(l);
  Vec3 m;
  if (!facet_between(l, out, m)) return Rgb(0);
  const double cosine = glm::dot(l.in, m), fresnel = fresnel_dielectric(cosine, ior);
  const double facets = l.facets.density(m) * l.facets.shadowing(l.in, out, m);
  if (out.z < 0) {
    if (!(l.parameters.spec_trans > 0)) return Rgb(0);
    double value = glass_share(l) * (1 - fresnel) * facets * cosine *
                   refraction_jacobian(l.in, out, m, ior) / l.in.z;
    if (radiance) value /= ior * ior;
    return glm::sqrt(l.base) * value;
  }
  Rgb sum = specular(l, fresnel, cosine) * (facets / (4 * l.in.z));
  if (!l.front) return sum;
  if (l.parameters.clearcoat > 0) {
    const MicrofacetSurface shadows{Microfacets::kGgx, 0.25, 0.25};
    sum += schlick(Rgb(0.04), cosine, l.eta) *
           (0.25 * l.parameters.clearcoat * ClearCoat(l.parameters.clearcoat_gloss).density(m) *
            shadows.shadowing(l.in, out, m) * out.z);
  }
  if (base_share(l) > 0) sum += spread(l, out, cosine) * (out.z / kPi);
  return sum;
}

double principled_pdf(const PrincipledLobe& l, const Vec3& out) {
  if (out.z == 0) return 0;
  const double even = even_rate(l), coat = coat_rate(l);
  double pdf = out.z > 0 ? even * out.z / kPi : 0;
  Vec3 m;
  if (facet_between(l, out, m)) {
    const double ior = relative_index(l), cosine = glm::dot(l.in, m);
    const double reflected = reflects(l, fresnel_dielectric(cosine, ior));
    const double normals = l.facets.pdf(l.in, m);
    if (out.z < 0) {
      pdf += (1 - reflected) * normals * refraction_jacobian(l.in, out, m, ior);
    } else {
      pdf += reflected * normals / (4 * cosine);
      if (coat > 0) pdf += coat * ClearCoat(l.parameters.clearcoat_gloss).pdf(m) / (4 * cosine);
    }
  }
  return pdf / (1 + coat + even);
}

Vec3 sample_principled(const PrincipledLobe& l, const Vec2& u) {
  // A number of its own, a hash of the two.
  const double choice =
      to_unit(mix64(std::bit_cast<uint64_t>(u.x) ^
                    mix64(std::bit_cast<uint64_t>(u.y) + 0x9e3779b97f4a7c15ull))) *
      (1 + coat_rate(l) + even_rate(l));
  if (choice >= 1 + coat_rate(l)) return sample_cosine(u);
  const bool coat = choice >= 1;
  const Vec3 m =
      coat ? ClearCoat(l.parameters.clearcoat_gloss).sample(u) : l.facets.sample(l.in, u);
  const double cosine = glm::dot(l.in, m);
  if (!(cosine > 0)) return Vec3(0);
  const double ior = relative_index(l);
  if (!coat && !(choice < reflects(l, fresnel_dielectric(cosine, ior)))) {
    Vec3 out;
    return refract(l.in, m, ior, out) && out.z < 0 ? out : Vec3(0);
  }
  const Vec3 out = reflect(l.in, m);
  return out.z > 0 ? out : Vec3(0);
}

}  // namespace photonloom
