// SPDX-License-Identifier: Apache-2.0
// Surfaces as a ray meets them: lobes, their values and their sampling.
//
// Sides are decided by the geometric normal, cosines are taken to the shading normal. Light that
// the two normals see on different sides meets black. With shading normals a BSDF is not symmetric;
// photons get the adjoint (Veach 1997, section 5.3): for light arriving from `in` and leaving to
// `out`, the factor |in.ns| |out.ng| / (|in.ng| |out.ns|), so that photon map and path tracer
// converge to the same image.
#pragma once
#include "golden/transport/world.hpp"

namespace photonloom {

enum class Carried { kRadiance, kPower };  // camera paths, photons

// A BSDF at one point: textures looked up, and of several parts one chosen. What is sent on, over
// the probability of the choice, is in the lobes.
struct Surface {
  const Bsdf* bsdf = nullptr;   // the part that was chosen; null: black
  Vec3 in;                      // unit, back along the ray
  Vec3 normal, shading_normal;  // turned to the side of `in`
  bool front = true;
  bool delta = false;          // a mirror or glass
  bool stores = false;         // photons: some part, chosen or not, has a diffuse lobe
  Rgb entering{1};             // photons: the share that enters that part's coat
  const Coat* coat = nullptr;  // of the diffuse lobe; what leaves to `in` is in the lobe already
  bool under_coat = false;     // the glossy lobe lies below that coat
  Rgb diffuse_lobe{0}, glossy_lobe{0}, reflection{0}, transmission{0};
  Rgb followed_lobe{0};     // diffuse, and sampled with the glossy lobe (Bsdf::follow_diffuse)
  double glossy_share = 0;  // of both, beside the diffuse lobe's mean, when one is chosen
  double alpha_u = 0, alpha_v = 0;
  Rgb base{0};                         // of a principled BSDF
  double roughness = 0, metallic = 0;  // likewise
  Vec3 tangent{0};                     // not normalised; 0: any

  bool is_delta() const { return delta; }
  const Rgb& diffuse() const { return diffuse_lobe; }
  // A glossy lobe that reaches both sides, as rough glass has.
  bool transmits() const { return bsdf && !bsdf->is_delta() && bsdf->transmits(); }
  bool black() const {
    return !delta && is_black(diffuse_lobe) && is_black(glossy_lobe) && is_black(transmission) &&
           is_black(followed_lobe);
  }
  // Index of the other side over that of the side of `in`.
  double relative_ior() const { return front ? bsdf->ior : 1 / bsdf->ior; }
  // Probability of the diffuse lobe when one of diffuse and glossy is chosen.
  double diffuse_probability() const;
  // Both normals see `direction` on this side.
  bool above(const Vec3& direction) const {
    return glm::dot(normal, direction) > 0 && glm::dot(shading_normal, direction) > 0;
  }
  // A lobe may send light to `direction`: both normals see it on the same side.
  bool reaches(const Vec3& direction) const {
    return above(direction) || (transmits() && glm::dot(normal, direction) < 0 &&
                                glm::dot(shading_normal, direction) < 0);
  }
  // |d.ns| / |d.ng|: what turns power per area of the true surface into power per area of the
  // shaded one.
  double shading_ratio(const Vec3& direction) const {
    return glm::dot(shading_normal, direction) / glm::dot(normal, direction);
  }
};

// Black where the shading normal sees the ray from behind. `choice` in [0, 1) chooses among parts
// (mixtures, a plastic's coat and base); it counts where World::has_choices().
Surface make_surface(const World& world, const Hit& hit, const Vec3& ray_direction,
                     double choice = 0);

// The same with the choice made: `part` is no mixture, and `delta` says whether a plastic's or
// other coat is met (ignored where there is none).
Surface make_part(const World& world, const Hit& hit, const Vec3& ray_direction, const Bsdf& part,
                  bool delta);

// Of a plastic or a coated BSDF.
Coat make_coat(const Bsdf& b);

// BSDF times |cosine|, and density of the lobe's sampling. Radiance that a glossy lobe of glass
// takes to the denser side has the factor 1/ior^2, as sample_delta. Glossy: a followed diffuse lobe
// with it.
Rgb diffuse_times_cosine(const Surface& s, const Vec3& out);
double diffuse_pdf(const Surface& s, const Vec3& out);
Rgb glossy_times_cosine(const Surface& s, const Vec3& out, Carried carried = Carried::kRadiance);
double glossy_pdf(const Surface& s, const Vec3& out);

// Zero, of density 0, where a rough lobe sends nothing for this u.
Vec3 sample_diffuse(const Surface& s, const Vec2& u);
Vec3 sample_glossy(const Surface& s, const Vec2& u);

// Unpolarised Fresnel reflectance. `cos_in` > 0 on the incident side; `ior` transmitted over
// incident index. Conductor: per channel, eta + i k over a dielectric of index 1; eta = k = 0: 1.
double fresnel_dielectric(double cos_in, double ior);
Rgb fresnel_conductor(double cos_in, const Rgb& eta, const Rgb& k);

// Reflection or refraction at a delta surface, chosen by u in proportion to what each carries.
// False: absorbed. `weight` is throughput, with 1/ior^2 on radiance that enters the denser side;
// `ior2` is that factor's inverse (1 for power), for those who want it out again.
bool sample_delta(const Surface& s, double u, Carried carried, Vec3& out, Rgb& weight,
                  double& ior2);

// A photon that leaves a surface which is not delta: chooses a lobe by `choice` and a direction by
// u; false: absorbed. Multiplies the power by what the lobe sends over the density of its choice.
bool leave_with_power(const Surface& s, double choice, const Vec2& u, Vec3& out, Rgb& power);

}  // namespace photonloom
