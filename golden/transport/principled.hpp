// SPDX-License-Identifier: Apache-2.0
// Mitsuba 3's principled BSDF (Burley 2012, 2015) but for its diffuse lobe: specular reflection and
// transmission by GGX facets, clear coat, retro-reflection, fake subsurface light and sheen. The
// diffuse lobe, Burley's product of two factors, is the surface's (bsdf.hpp), so that photons are
// gathered there. Formulas: docs/materials.md.
#pragma once
#include <algorithm>

#include "golden/numeric/vec.hpp"
#include "golden/scene/scene.hpp"
#include "golden/transport/microfacet.hpp"

namespace photonloom {

// In a frame whose z axis is the normal on the side of `in`.
struct PrincipledLobe {
  const Principled& parameters;
  Rgb base;
  double roughness, metallic;
  double eta;  // inside over outside
  bool front;
  MicrofacetSurface facets;
  Vec3 in;
};

// (1 - cosine)^5.
inline double schlick_weight(double cosine) {
  const double m = std::clamp(1 - cosine, 0.0, 1.0);
  return m * m * (m * m) * m;
}

// As glossy_times_cosine, glossy_pdf and sample_glossy of bsdf.hpp.
Rgb principled_times_cosine(const PrincipledLobe& lobe, const Vec3& out, bool radiance);
double principled_pdf(const PrincipledLobe& lobe, const Vec3& out);
Vec3 sample_principled(const PrincipledLobe& lobe, const Vec2& u);

}  // namespace photonloom
