// SPDX-License-Identifier: Apache-2.0
#include "golden/transport/bsdf.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "golden/transport/microfacet.hpp"
#include "golden/transport/principled.hpp"
#include "golden/transport/sampling.hpp"

namespace photonloom {
namespace {

double cos_lobe(const Surface& s, const Vec3& out) {
  return glm::dot(reflect(s.in, s.shading_normal), out);
}

bool is_phong(const Surface& s) { return s.bsdf->kind == BsdfKind::kPhong; }
bool is_principled(const Surface& s) { return s.bsdf->kind == BsdfKind::kPrincipled; }

// The rough surface in its own frame: `in` above.
struct Rough {
  Vec3 x, y, z, in;
  MicrofacetSurface facets;

  explicit Rough(const Surface& s) : z(s.shading_normal) {
    facets.kind = is_principled(s) ? Microfacets::kGgx : s.bsdf->microfacets;
    facets.alpha_u = s.alpha_u;
    facets.alpha_v = s.alpha_v;
    const Vec3 along = s.tangent - z * glm::dot(s.tangent, z);
    const double length = glm::length(along);
    const Frame any(z);
    x = length > 0 ? along / length : any.s;
    y = length > 0 ? glm::cross(z, x) : any.t;
    in = to_local(s.in);
  }
  Vec3 to_local(const Vec3& v) const {
    return Vec3(glm::dot(v, x), glm::dot(v, y), glm::dot(v, z));
  }
  Vec3 to_world(const Vec3& v) const { return x * v.x + y * v.y + z * v.z; }
};

PrincipledLobe principled_lobe(const Surface& s, const Rough& r) {
  return {s.bsdf->principled, s.base,  s.roughness, s.metallic,
          s.bsdf->ior,        s.front, r.facets,    r.in};
}

// Probability of reflection when rough glass is met at this cosine to the facet.
double reflect_probability(const Surface& s, double fresnel) {
  const double r = mean(s.glossy_lobe) * fresnel, t = mean(s.transmission) * (1 - fresnel);
  return r + t > 0 ? r / (r + t) : 0;
}

// The facet that sends `in` to `out`, towards the front; zero where there is none.
Vec3 half_vector(const Rough& r, const Vec3& out, double ior) {
  const Vec3 sum = out.z > 0 ? r.in + out : r.in + out * ior;
  const double length = glm::length(sum);
  if (!(length > 0)) return Vec3(0);
  return sum / (sum.z < 0 ? -length : length);
}

Rgb facet_fresnel(const Surface& s, double cos_in) {
  if (s.bsdf->kind == BsdfKind::kRoughConductor)
    return fresnel_conductor(cos_in, s.bsdf->eta, s.bsdf->k);
  return Rgb(fresnel_dielectric(cos_in, s.relative_ior()));
}

Rgb rough_times_cosine(const Surface& s, const Vec3& out_world, Carried carried) {
  if (!s.reaches(out_world)) return Rgb(0);
  const Rough r(s);
  const Vec3 out = r.to_local(out_world);
  const double ior = s.transmits() ? s.relative_ior() : 1;
  const Vec3 m = half_vector(r, out, ior);
  const double cos_in = glm::dot(r.in, m);
  // Each side of the facet sees its own side of the surface.
  if (!(cos_in > 0) || !(glm::dot(out, m) * out.z > 0)) return Rgb(0);
  const double facets = r.facets.density(m) * r.facets.shadowing(r.in, out, m);
  if (out.z > 0) return s.glossy_lobe * facet_fresnel(s, cos_in) * (facets / (4 * r.in.z));
  const double passed = 1 - fresnel_dielectric(cos_in, ior);
  double value = passed * facets * cos_in * refraction_jacobian(r.in, out, m, ior) / r.in.z;
  if (carried == Carried::kRadiance) value /= ior * ior;
  return s.transmission * value;
}

double rough_pdf(const Surface& s, const Vec3& out_world) {
  const Rough r(s);
  const Vec3 out = r.to_local(out_world);
  if (out.z == 0 || (out.z < 0 && !s.transmits())) return 0;
  const double ior = s.transmits() ? s.relative_ior() : 1;
  const Vec3 m = half_vector(r, out, ior);
  const double cos_in = glm::dot(r.in, m);
  if (!(cos_in > 0) || !(glm::dot(out, m) * out.z > 0)) return 0;
  const double normals = r.facets.pdf(r.in, m);
  double reflects = 1;
  if (s.transmits()) reflects = reflect_probability(s, fresnel_dielectric(cos_in, ior));
  if (out.z > 0) return reflects * normals / (4 * cos_in);
  return (1 - reflects) * normals * refraction_jacobian(r.in, out, m, ior);
}

// Zero, which has no density, where light meets a facet from behind or is sent to the wrong side.
Vec3 sample_rough(const Surface& s, const Vec2& u) {
  const Rough r(s);
  const Vec3 m = r.facets.sample(r.in, u);
  const double cos_in = glm::dot(r.in, m);
  if (!(cos_in > 0)) return Vec3(0);
  if (s.transmits()) {
    // Reflection or refraction by a number of its own, a hash of the two.
    const double choice =
        to_unit(mix64(std::bit_cast<uint64_t>(u.x) ^
                      mix64(std::bit_cast<uint64_t>(u.y) + 0x9e3779b97f4a7c15ull)));
    const double ior = s.relative_ior();
    if (!(choice < reflect_probability(s, fresnel_dielectric(cos_in, ior)))) {
      Vec3 out;
      return refract(r.in, m, ior, out) && out.z < 0 ? r.to_world(out) : Vec3(0);
    }
  }
  const Vec3 out = reflect(r.in, m);
  return out.z > 0 ? r.to_world(out) : Vec3(0);
}

// Directions below a coat of index `ior` and above it, both towards the outside; zero where light
// from below does not get out.
Vec3 below_coat(const Vec3& d, const Vec3& normal, double ior) {
  const double c = glm::dot(d, normal);
  return normal * std::sqrt(std::max(0.0, 1 - (1 - c * c) / (ior * ior))) + (d - normal * c) / ior;
}
Vec3 above_coat(const Vec3& d, const Vec3& normal, double ior) {
  const double c = glm::dot(d, normal), sin2 = (1 - c * c) * ior * ior;
  if (!(c > 0) || sin2 >= 1) return Vec3(0);
  return normal * std::sqrt(1 - sin2) + (d - normal * c) * ior;
}

// The glossy lobe under a coat, as it is met there: only shading normals count.
Surface bare_lobe(const Surface& s) {
  Surface below = s;
  below.under_coat = false;
  below.in = below_coat(s.in, s.shading_normal, s.coat->ior);
  below.normal = s.shading_normal;
  return below;
}

// Solid angle below the coat over the one above it.
double narrowed(const Surface& s, const Vec3& out, const Vec3& out_below) {
  return glm::dot(s.shading_normal, out) /
         (s.coat->ior * s.coat->ior * glm::dot(s.shading_normal, out_below));
}

// A diffuse lobe, `rho`, under the surface's coat.
Rgb cosine_lobe(const Surface& s, const Rgb& rho, const Vec3& out) {
  if (!s.above(out)) return Rgb(0);
  const double cosine = glm::dot(s.shading_normal, out);
  const Rgb bare = rho * (cosine / kPi);
  return s.coat ? bare * s.coat->passes(cosine) : bare;
}

// Of the light that glossy lobes send on, the share that the followed diffuse one samples.
double followed_share(const Surface& s) {
  return is_black(s.followed_lobe) ? 0 : mean(s.followed_lobe) / s.glossy_share;
}

}  // namespace

double Surface::diffuse_probability() const {
  const double d = mean(diffuse()), g = glossy_share;
  return d > 0 ? d / (d + g) : 0;
}

double Coat::enters(double cosine) const {
  if (!(cosine > 0)) return 0;
  if (kind == CoatKind::kBurley) return 1 - 0.5 * schlick_weight(cosine);
  if (table.empty()) return 1 - fresnel_dielectric(cosine, ior);
  const double at = std::min(cosine, 1.0) * static_cast<double>(table.size() - 1);
  const size_t i = std::min(static_cast<size_t>(at), table.size() - 2);
  const double part = at - static_cast<double>(i);
  return table[i] * (1 - part) + table[i + 1] * part;
}

namespace {

// Share of light of this cosine that a coat of index `ior` (other side over this one) reflects,
// over an even grid of numbers of the sampler.
double coat_reflects(const Bsdf& plastic, double cosine, double ior) {
  constexpr int kGrid = 64;
  MicrofacetSurface facets;
  facets.kind = plastic.microfacets;
  facets.alpha_u = facets.alpha_v = plastic.alpha_u;
  const double c = std::max(cosine, 1e-4);
  const Vec3 in(std::sqrt(std::max(0.0, 1 - c * c)), 0, c);
  double sum = 0;
  for (int i = 0; i < kGrid; ++i)
    for (int j = 0; j < kGrid; ++j) {
      const Vec3 m = facets.sample(in, Vec2((i + 0.5) / kGrid, (j + 0.5) / kGrid));
      const double to_facet = glm::dot(in, m);
      const Vec3 out = reflect(in, m);
      const double pdf = facets.pdf(in, m);
      if (!(to_facet > 0) || !(out.z > 0) || !(pdf > 0)) continue;
      sum += fresnel_dielectric(to_facet, ior) * facets.density(m) * facets.shadowing(in, out, m) *
             to_facet / (in.z * pdf);
    }
  return std::min(1.0, sum / (kGrid * kGrid));
}

// A coat over the lobes of a part: it is met by choice, in proportion to what it and what lies
// below send on. Light that it reflects back down is lost (Weidlich and Wilkie 2007).
void put_coat(const World& world, const Bsdf& b, double choice, Surface& s) {
  s.coat = world.coat(b);
  const double cos_in = glm::dot(s.in, s.shading_normal);
  const Rgb passes = s.coat->passes(cos_in);
  const Rgb mirrored = b.coat_specular * (1 - s.coat->enters(cos_in));
  if (s.delta) {
    s.reflection = mirrored + s.reflection * passes * passes;
    return;
  }
  const double base = mean(s.diffuse_lobe * passes) + s.glossy_share * mean(passes);
  const double p = mean(mirrored) > 0 ? mean(mirrored) / (mean(mirrored) + base) : 0;
  s.delta = choice < p;
  if (s.delta) {
    s.reflection = mirrored / p;
    s.diffuse_lobe = s.glossy_lobe = Rgb(0);
    s.coat = nullptr;
    return;
  }
  s.diffuse_lobe *= passes / (s.coat->ior * s.coat->ior * (1 - p));
  s.glossy_lobe *= passes / (1 - p);
  s.glossy_share *= mean(passes) / (1 - p);
  s.under_coat = true;
}

// Textures and lobes of one part, which is no mixture.
void fill(const World& world, const Hit& hit, const Bsdf& b, double choice, Surface& s) {
  const auto look_up = [&](const Rgb& factor, Slot slot) {
    const int t = b.textured(slot);
    return t < 0 ? factor : factor * world.texture(t, hit);
  };
  s.bsdf = &b;
  s.delta = b.is_delta();
  const double cos_in = glm::dot(s.in, s.shading_normal);
  const auto roughness = [&](double alpha, Slot slot) {
    const int t = b.textured(slot);
    return std::max(1e-4, t < 0 ? alpha : alpha * luminance(world.texture(t, hit)));
  };
  const bool rough = b.kind == BsdfKind::kRoughConductor || b.kind == BsdfKind::kRoughDielectric ||
                     b.kind == BsdfKind::kRoughPlastic;
  if (rough) {
    s.alpha_u = roughness(b.alpha_u, Slot::kAlphaU);
    s.alpha_v = roughness(b.alpha_v, Slot::kAlphaV);
    if (s.alpha_u != s.alpha_v) s.tangent = world.tangent(hit);
  }
  switch (b.kind) {
    case BsdfKind::kDiffuse:
      s.diffuse_lobe = look_up(b.diffuse, Slot::kDiffuse);
      break;
    case BsdfKind::kPhong:
      s.diffuse_lobe = look_up(b.diffuse, Slot::kDiffuse);
      s.glossy_lobe = look_up(b.specular, Slot::kSpecular);
      s.glossy_share = mean(s.glossy_lobe);
      break;
    case BsdfKind::kConductor:
      s.reflection =
          look_up(b.specular, Slot::kSpecular) *
          fresnel_conductor(b.is_coated() ? glm::dot(below_coat(s.in, s.shading_normal, b.coat_ior),
                                                     s.shading_normal)
                                          : cos_in,
                            b.eta, b.k);
      break;
    case BsdfKind::kDielectric:
    case BsdfKind::kThinDielectric:
      s.reflection = look_up(b.specular, Slot::kSpecular);
      s.transmission = look_up(b.transmission, Slot::kTransmission);
      break;
    case BsdfKind::kRoughConductor:
      s.glossy_lobe = look_up(b.specular, Slot::kSpecular);
      s.glossy_share = mean(s.glossy_lobe);
      break;
    case BsdfKind::kRoughDielectric:
      s.glossy_lobe = look_up(b.specular, Slot::kSpecular);
      s.transmission = look_up(b.transmission, Slot::kTransmission);
      s.glossy_share = mean(s.glossy_lobe + s.transmission);
      break;
    case BsdfKind::kPlastic:
    case BsdfKind::kRoughPlastic: {
      const Rgb d = look_up(b.diffuse, Slot::kDiffuse), g = look_up(b.specular, Slot::kSpecular);
      s.coat = world.coat(b);
      const double enters = s.coat->enters(cos_in);
      const Rgb kept = b.nonlinear ? 1.0 - d * s.coat->inner : Rgb(1 - s.coat->inner);
      s.diffuse_lobe = d / kept * (enters / (b.ior * b.ior));
      const double glossy = mean(g) * (1 - enters), diffuse = mean(d) * enters;
      if (b.kind == BsdfKind::kRoughPlastic) {
        s.glossy_lobe = g;
        s.glossy_share = diffuse > 0 ? mean(s.diffuse_lobe) * glossy / diffuse : glossy;
        break;
      }
      const double p = glossy + diffuse > 0 ? glossy / (glossy + diffuse) : 0;
      s.delta = choice < p;
      if (s.delta) {
        s.reflection = g * ((1 - enters) / p);
        s.diffuse_lobe = Rgb(0);
      } else {
        s.diffuse_lobe /= 1 - p;
      }
      break;
    }
    case BsdfKind::kPrincipled: {
      const Principled& p = b.principled;
      const auto varied = [&](double value, Slot slot) {
        const int t = b.textured(slot);
        return t < 0 ? value : std::clamp(value * luminance(world.texture(t, hit)), 0.0, 1.0);
      };
      s.base = look_up(b.diffuse, Slot::kDiffuse);
      s.roughness = varied(p.roughness, Slot::kAlphaU);
      s.metallic = varied(p.metallic, Slot::kShare);
      const double aspect = std::sqrt(1 - 0.9 * p.anisotropic), alpha = s.roughness * s.roughness;
      s.alpha_u = std::max(0.001, alpha / aspect);
      s.alpha_v = std::max(0.001, alpha * aspect);
      if (s.alpha_u != s.alpha_v) s.tangent = world.tangent(hit);
      s.coat = world.coat(b);
      const double base = (1 - s.metallic) * (1 - p.spec_trans);
      if (s.front)
        s.diffuse_lobe = s.base * (base * (1 - p.flatness) * s.coat->enters(cos_in));
      else if (p.spec_trans == 0)
        break;
      s.glossy_lobe = Rgb(1);  // its value is its own: principled.hpp
      s.glossy_share = mean(s.base) * (s.metallic + base * (0.25 * s.roughness + p.flatness)) +
                       (1 - s.metallic) * (0.1 + p.spec_trans) + 0.05 * p.clearcoat + 0.1 * p.sheen;
      break;
    }
    case BsdfKind::kMixture:
      break;
  }
  if (b.is_coated()) put_coat(world, b, choice, s);
  if (b.follow_diffuse) {
    s.glossy_share += mean(s.diffuse_lobe);
    std::swap(s.diffuse_lobe, s.followed_lobe);
  }
}

// The first diffuse part, for photons, which land whatever part is chosen.
void find_store(const World& world, const Hit& hit, const Bsdf& b, Surface& s) {
  if (s.stores || world.opacity(b, hit) == 0) return;
  if (b.kind == BsdfKind::kMixture) {
    for (size_t i = 0; i < b.parts.size(); ++i)
      if (b.parts[i] >= 0 && world.share(b, i, hit) > 0)
        find_store(world, hit, world.scene().bsdfs[static_cast<size_t>(b.parts[i])], s);
    return;
  }
  const int t = b.textured(Slot::kDiffuse);
  if (!b.has_diffuse() || is_black(b.diffuse) || (t >= 0 && is_black(world.texture(t, hit))))
    return;
  if (b.kind == BsdfKind::kPrincipled && !s.front) return;
  s.stores = true;
  if (const Coat* coat = world.coat(b)) s.entering = coat->passes(glm::dot(s.in, s.shading_normal));
}

// One part of a mixture by its share of what does not pass straight on; null: the black rest. The
// choice is stretched to [0, 1) for what comes after.
const Bsdf* choose_part(const World& world, const Hit& hit, const Bsdf& mixture, double& choice) {
  const double total = world.opacity(mixture, hit);
  double before = 0;
  for (size_t i = 0; i < mixture.parts.size(); ++i) {
    const int part = mixture.parts[i];
    const Bsdf* b = part < 0 ? nullptr : &world.scene().bsdfs[static_cast<size_t>(part)];
    const double share = world.share(mixture, i, hit) * (b ? world.opacity(*b, hit) : 1) / total;
    if (choice < before + share) {
      choice = std::clamp((choice - before) / share, 0.0, 0x1.fffffffffffffp-1);
      return b;
    }
    before += share;
  }
  return nullptr;
}

}  // namespace

Rgb Coat::passes(double cosine) const {
  Rgb share(enters(cosine));
  if (is_black(absorption) || !(cosine > 0)) return share;
  const double below = std::sqrt(1 - (1 - cosine * cosine) / (ior * ior));
  constexpr double kLog2E = 1.44269504088896340736;
  for (int i = 0; i < 3; ++i) share[i] *= exp2_exact(-absorption[i] / below * kLog2E);
  return share;
}

Coat make_coat(const Bsdf& plastic) {
  constexpr int kSteps = 64, kFine = 1024;
  Coat coat;
  coat.kind = plastic.kind == BsdfKind::kPrincipled ? CoatKind::kBurley : CoatKind::kFresnel;
  if (coat.kind == CoatKind::kBurley) return coat;
  if (plastic.is_coated()) {
    coat.ior = plastic.coat_ior;
    coat.absorption = plastic.coat_absorption;
    return coat;
  }
  coat.ior = plastic.ior;
  const bool rough = plastic.kind != BsdfKind::kPlastic;
  const int steps = rough ? kSteps : kFine;
  // Of diffuse light, by midpoints of the square of the cosine, in which it is even.
  const auto reflected = [&](double ior) {
    double mean = 0;
    for (int i = 0; i < steps; ++i) {
      const double cosine = std::sqrt((i + 0.5) / steps);
      mean +=
          (rough ? coat_reflects(plastic, cosine, ior) : fresnel_dielectric(cosine, ior)) / steps;
    }
    return mean;
  };
  if (rough)
    for (int i = 0; i < kSteps; ++i)
      coat.table.push_back(
          std::max(0.0, 1 - coat_reflects(plastic, i / (kSteps - 1.0), plastic.ior)));
  // What gets out from below lies within the critical angle: too few of the midpoints, or none,
  // where the index is high. By reciprocity as much passes either way, in the ratio of solid
  // angles.
  constexpr double kHighIndex = 4, kLeast = 0x1p-20;
  coat.inner = plastic.ior <= kHighIndex
                   ? reflected(1 / plastic.ior)
                   : 1 - std::max(1 - reflected(plastic.ior), kLeast) / (plastic.ior * plastic.ior);
  return coat;
}

namespace {

// The shading normal that a BSDF's normal or bump map makes of a hit's, on the surface's own side.
Vec3 turned_normal(const World& world, const Hit& hit, const Bsdf& b) {
  const Vec3& n = hit.shading_normal;
  Vec3 du, dv, turned;
  if (!world.derivatives(hit, du, dv)) return n;
  if (b.normal_map >= 0) {
    const Vec3 local = 2.0 * world.texture(b.normal_map, hit) - 1.0;
    const Vec3 across = du - n * glm::dot(n, du);
    if (!(glm::dot(across, across) > 0)) return n;
    const Vec3 s = glm::normalize(across);
    turned = s * local.x + glm::cross(n, s) * local.y + n * local.z;
  } else {
    const Texture& height = world.scene().textures[static_cast<size_t>(b.bump_map)];
    const Vec2 uv = world.uv(hit);
    const auto slope = [&](const Vec2& step) {
      return (luminance(texture_value(height, uv + step)) -
              luminance(texture_value(height, uv - step))) /
             (2 * (step.x + step.y));
    };
    constexpr double kStep = 0x1p-17;  // far below a texel, far above rounding
    du += n * (slope(Vec2(kStep, 0)) - glm::dot(n, du));
    dv += n * (slope(Vec2(0, kStep)) - glm::dot(n, dv));
    turned = glm::cross(du, dv);
    if (glm::dot(turned, hit.normal) < 0) turned = -turned;
  }
  const double length = glm::length(turned);
  return length > 0 ? turned / length : n;
}

}  // namespace

namespace {

// Sides and normals, and the BSDF of the side; null: black.
const Bsdf* turn(const World& world, const Hit& hit, const Vec3& ray_direction, Surface& s) {
  s.front = glm::dot(hit.normal, ray_direction) < 0;
  s.in = -ray_direction;
  s.normal = s.front ? hit.normal : -hit.normal;
  s.shading_normal = s.front ? hit.shading_normal : -hit.shading_normal;
  const Bsdf* b = world.bsdf(hit.shape, s.front);
  if (b && (b->normal_map >= 0 || b->bump_map >= 0)) {
    const Vec3 turned = turned_normal(world, hit, *b);
    s.shading_normal = s.front ? turned : -turned;
  }
  return b && glm::dot(s.shading_normal, s.in) > 0 ? b : nullptr;
}

// The glossy lobe itself, without a followed diffuse one.
Rgb own_times_cosine(const Surface& s, const Vec3& out, Carried carried) {
  const Rgb& rho = s.glossy_lobe;
  if (is_black(rho) && is_black(s.transmission)) return Rgb(0);
  if (s.under_coat) {
    if (!s.above(out)) return Rgb(0);
    const Vec3 below = below_coat(out, s.shading_normal, s.coat->ior);
    return own_times_cosine(bare_lobe(s), below, carried) * narrowed(s, out, below) *
           s.coat->passes(glm::dot(s.shading_normal, out));
  }
  if (is_principled(s)) {
    const Rough r(s);
    return s.reaches(out) ? principled_times_cosine(principled_lobe(s, r), r.to_local(out),
                                                    carried == Carried::kRadiance)
                          : Rgb(0);
  }
  if (!is_phong(s)) return rough_times_cosine(s, out, carried);
  if (!s.above(out)) return Rgb(0);
  const double c = cos_lobe(s, out), n = s.bsdf->exponent;
  if (c <= 0) return Rgb(0);
  return rho * ((n + 2) / (2 * kPi) * pow_exact(c, n) * glm::dot(s.shading_normal, out));
}

double own_pdf(const Surface& s, const Vec3& out) {
  if (s.under_coat) {
    if (!(glm::dot(out, s.shading_normal) > 0)) return 0;
    const Vec3 below = below_coat(out, s.shading_normal, s.coat->ior);
    return own_pdf(bare_lobe(s), below) * narrowed(s, out, below);
  }
  if (is_principled(s)) {
    const Rough r(s);
    return principled_pdf(principled_lobe(s, r), r.to_local(out));
  }
  if (!is_phong(s)) return rough_pdf(s, out);
  const double c = cos_lobe(s, out), n = s.bsdf->exponent;
  return c > 0 ? (n + 1) / (2 * kPi) * pow_exact(c, n) : 0;
}

Vec3 sample_own(const Surface& s, const Vec2& u) {
  if (s.under_coat) return above_coat(sample_own(bare_lobe(s), u), s.shading_normal, s.coat->ior);
  if (is_principled(s)) {
    const Rough r(s);
    return r.to_world(sample_principled(principled_lobe(s, r), u));
  }
  if (!is_phong(s)) return sample_rough(s, u);
  const double z = pow_exact(1 - u.x, 1 / (s.bsdf->exponent + 1));
  const double r = std::sqrt(std::max(0.0, 1 - z * z));
  return Frame(reflect(s.in, s.shading_normal)).to_world(Vec3(cos_sin_turns(u.y) * r, z));
}

}  // namespace

Surface make_part(const World& world, const Hit& hit, const Vec3& ray_direction, const Bsdf& part,
                  bool delta) {
  Surface s;
  if (turn(world, hit, ray_direction, s)) fill(world, hit, part, delta ? 0 : 1, s);
  return s;
}

Surface make_surface(const World& world, const Hit& hit, const Vec3& ray_direction, double choice) {
  Surface s;
  const Bsdf* b = turn(world, hit, ray_direction, s);
  if (!b) return s;
  find_store(world, hit, *b, s);
  while (b && b->kind == BsdfKind::kMixture) b = choose_part(world, hit, *b, choice);
  if (b) fill(world, hit, *b, choice, s);
  return s;
}

Rgb diffuse_times_cosine(const Surface& s, const Vec3& out) {
  return cosine_lobe(s, s.diffuse(), out);
}

double diffuse_pdf(const Surface& s, const Vec3& out) {
  const double c = glm::dot(s.shading_normal, out);
  return c > 0 ? c / kPi : 0;
}

Vec3 sample_diffuse(const Surface& s, const Vec2& u) {
  return Frame(s.shading_normal).to_world(sample_cosine(u));
}

Rgb glossy_times_cosine(const Surface& s, const Vec3& out, Carried carried) {
  const Rgb own = own_times_cosine(s, out, carried);
  return is_black(s.followed_lobe) ? own : own + cosine_lobe(s, s.followed_lobe, out);
}

double glossy_pdf(const Surface& s, const Vec3& out) {
  const double followed = followed_share(s);
  if (followed == 0) return own_pdf(s, out);
  return followed * diffuse_pdf(s, out) + (followed < 1 ? (1 - followed) * own_pdf(s, out) : 0);
}

Vec3 sample_glossy(const Surface& s, const Vec2& u) {
  const double followed = followed_share(s);
  if (followed == 0) return sample_own(s, u);
  constexpr double kBelowOne = 1 - 0x1p-53;
  if (u.x < followed) return sample_diffuse(s, Vec2(std::min(u.x / followed, kBelowOne), u.y));
  return sample_own(s, Vec2(std::min((u.x - followed) / (1 - followed), kBelowOne), u.y));
}

bool leave_with_power(const Surface& s, double choice, const Vec2& u, Vec3& out, Rgb& power) {
  const double p = s.diffuse_probability();
  if (choice < p) {
    // Around the geometric normal, so that the adjoint's |out.ng| cancels.
    out = Frame(s.normal).to_world(sample_cosine(u));
    power *= s.diffuse() * (s.shading_ratio(s.in) / p);
    if (s.coat) power *= s.coat->passes(glm::dot(s.shading_normal, out));
  } else {
    out = sample_glossy(s, u);
    const double pdf = glossy_pdf(s, out);
    if (!(pdf > 0) || !s.reaches(out)) return false;
    power *= glossy_times_cosine(s, out, Carried::kPower) *
             (s.shading_ratio(s.in) / s.shading_ratio(out) / ((1 - p) * pdf));
  }
  return s.reaches(out) && !is_black(power);
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
  if (s.bsdf->kind != BsdfKind::kDielectric && s.bsdf->kind != BsdfKind::kThinDielectric) {
    out = reflect(s.in, s.shading_normal);
    weight = s.reflection;
    if (glm::dot(s.normal, out) <= 0) return false;
  } else {
    const bool thin = s.bsdf->kind == BsdfKind::kThinDielectric;
    const double ior = s.front || thin ? s.bsdf->ior : 1 / s.bsdf->ior;
    double f = fresnel_dielectric(cos_in, ior);
    if (thin) f = 2 * f / (1 + f);  // all reflections between the two faces
    const Rgb reflected = s.reflection * f, transmitted = s.transmission * (1 - f);
    const double total = mean(reflected) + mean(transmitted);
    if (!(total > 0)) return false;
    const double p = mean(reflected) / total;
    if (u < p) {
      out = reflect(s.in, s.shading_normal);
      weight = reflected / p;
      if (glm::dot(s.normal, out) <= 0) return false;
    } else {
      if (thin) {
        out = -s.in;
      } else if (!refract(s.in, s.shading_normal, ior, out)) {
        return false;
      }
      weight = transmitted / (1 - p);
      if (glm::dot(s.normal, out) >= 0) return false;
      if (carried == Carried::kRadiance) {
        ior2 = thin ? 1 : ior * ior;
        weight /= ior2;
      }
    }
  }
  if (carried == Carried::kPower) weight *= s.shading_ratio(s.in) / s.shading_ratio(out);
  return !is_black(weight);
}

}  // namespace photonloom
