// SPDX-License-Identifier: Apache-2.0
// Photon map and path tracer integrate the same light on textured, rough, coated and open surfaces
// and under environments, layer by layer.
#include <memory>

#include "tests/catch.hpp"
#include "tests/oracles/photon_mapper.hpp"

using namespace photonloom;
using namespace photonloom::oracle;

namespace {

int add_texture(Scene& s, const Rgb& a, const Rgb& b, double tiles) {
  Texture t;
  t.kind = TextureKind::kCheckerboard;
  t.color[0] = a;
  t.color[1] = b;
  t.to_uv = {{{tiles, 0, 0}, {0, tiles, 0}}};
  s.textures.push_back(t);
  return static_cast<int>(s.textures.size()) - 1;
}

void set_texture(Bsdf& b, Slot slot, int texture) {
  b.texture[static_cast<size_t>(slot)] = texture;
}

Bsdf glossy(BsdfKind kind, Microfacets facets, double alpha, const Rgb& diffuse, double ior) {
  Bsdf b;
  b.kind = kind;
  b.microfacets = facets;
  b.alpha_u = b.alpha_v = alpha;
  b.specular = Rgb(0.9);
  b.diffuse = diffuse;
  b.ior = ior;
  return b;
}

// With coordinates over the whole square.
Shape& add_textured_quad(Scene& s, int bsdf, const Vec3& corner, const Vec3& u, const Vec3& v) {
  Shape& q = add_quad(s, bsdf, corner, u, v);
  q.mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  return q;
}

Light sky(const Rgb& radiance) {
  Light l;
  l.kind = LightKind::kEnvironment;
  l.intensity = radiance;
  return l;
}

// Diffuse lobes under two coats, which are followed, and under none.
int add_coated_mixture(Scene& s) {
  Bsdf mixture;
  mixture.kind = BsdfKind::kMixture;
  for (const double ior : {1.5, 1.9}) {
    Bsdf plastic = glossy(BsdfKind::kRoughPlastic, Microfacets::kGgx, 0.3, Rgb(0.7), ior);
    plastic.follow_diffuse = true;
    mixture.parts.push_back(add_bsdf(s, plastic));
    mixture.shares.push_back(0.35);
  }
  mixture.parts.push_back(add_diffuse(s, Rgb(0.6)));
  mixture.shares.push_back(0.3);
  return add_bsdf(s, mixture);
}

}  // namespace

// A dense coat and a wide lamp: the path tracer finds caustics by chance, and those of a common
// plastic, which throws back 4 %, under a small lamp are too noisy to judge.
TEST_CASE("layers agree: plastics, smooth and rough, on a textured floor, caustic within 5 %") {
  Scene s = room(false);
  add_quad(s, -1, Vec3(0.1, 0.998, 0.1), Vec3(0.8, 0, 0), Vec3(0, 0, 0.8)).radiance = Rgb(2.5);
  Bsdf floor;
  floor.diffuse = Rgb(1);
  set_texture(floor, Slot::kDiffuse, add_texture(s, Rgb(0.8, 0.5, 0.2), Rgb(0.1, 0.3, 0.6), 3));
  add_textured_quad(s, add_bsdf(s, floor), Vec3(0, 0.002, 0), Vec3(0, 0, 1), Vec3(1, 0, 0));
  add_sphere(s, add_bsdf(s, glossy(BsdfKind::kPlastic, Microfacets::kGgx, 0.1, Rgb(0.7), 2.4)),
             Vec3(0.3, 0.21, 0.65), 0.2);
  add_sphere(s, add_bsdf(s, glossy(BsdfKind::kRoughPlastic, Microfacets::kGgx, 0.3, Rgb(0.6), 1.5)),
             Vec3(0.7, 0.21, 0.35), 0.2);
  check_layers("plastics", s, 2048, 11, 0.05);
}

TEST_CASE("layers agree: a mixture whose diffuse lobes lie under two coats and none, within 5 %") {
  Scene s = room(true);
  const int mixed = add_coated_mixture(s);
  add_sphere(s, mixed, Vec3(0.3, 0.2, 0.65), 0.2);
  add_quad(s, mixed, Vec3(0, 0.002, 0), Vec3(0, 0, 1), Vec3(1, 0, 0));
  check_layers("mixture", s, 2048, 14, 0.05);
}

TEST_CASE("layers agree: rough metal, rough glass and thin glass, caustic within 5 %") {
  Scene s = room(true);
  add_sphere(s,
             add_bsdf(s, glossy(BsdfKind::kRoughConductor, Microfacets::kBeckmann, 0.3, Rgb(0), 1)),
             Vec3(0.3, 0.2, 0.65), 0.2);
  Bsdf glass = glossy(BsdfKind::kRoughDielectric, Microfacets::kGgx, 0.3, Rgb(0), 1.5);
  add_sphere(s, add_bsdf(s, glass), Vec3(0.7, 0.2, 0.35), 0.2);
  glass.kind = BsdfKind::kThinDielectric;
  Shape& pane =
      add_quad(s, add_bsdf(s, glass), Vec3(0.1, 0.5, 0.2), Vec3(0.5, 0, 0.1), Vec3(0, 0.1, 0.5));
  pane.back_bsdf = pane.bsdf;
  check_layers("rough", s, 2048, 12, 0.05);
}

// What photons lack and light paths add: on the camera's first hit (metal floor), on a mixture of
// two coats, and on final gather rays that come to either. The camera looks past ball and mirror,
// in which it would see caustics that no path of the path tracer finds (docs/transport.md).
TEST_CASE("layers agree: a point lamp through glass onto rough lobes, caustic within 5 %") {
  Scene s = room(false);
  Light lamp;
  lamp.kind = LightKind::kPoint;
  lamp.position = Vec3(0.45, 0.95, 0.5);
  lamp.intensity = Rgb(1);
  s.lights.push_back(lamp);
  const int metal =
      add_bsdf(s, glossy(BsdfKind::kRoughConductor, Microfacets::kBeckmann, 0.4, Rgb(0), 1));
  add_quad(s, metal, Vec3(0, 0.002, 0), Vec3(0, 0, 1), Vec3(1, 0, 0));
  const int mixed = add_coated_mixture(s);
  add_quad(s, mixed, Vec3(0.002, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1));
  add_sphere(s, add_glass(s, 1.5), Vec3(0.45, 0.7, 0.5), 0.15);
  add_sphere(s, add_mirror(s, Rgb(0.9)), Vec3(0.8, 0.7, 0.35), 0.12);
  set_camera(s, Vec3(0.8, 0.5, -1), Vec3(0.15, 0.1, 0.5), Vec3(0, 1, 0), 26, kSize, kSize);
  check_layers("lamp", s, 4096, 15, 0.05, 4);
}

TEST_CASE("layers agree: an environment, a mask and a mixture, caustic within 5 %") {
  Scene s = room(false);
  s.lights.push_back(sky(Rgb(1, 0.8, 0.5)));
  Bsdf leaf;
  leaf.diffuse = Rgb(0.5);
  leaf.two_sided = true;
  set_texture(leaf, Slot::kOpacity, add_texture(s, Rgb(1), Rgb(0.2), 4));
  Shape& sheet = add_textured_quad(s, add_bsdf(s, leaf), Vec3(0.1, 0.6, 0.1), Vec3(0, 0, 0.8),
                                   Vec3(0.8, 0.1, 0));
  sheet.back_bsdf = sheet.bsdf;
  Bsdf mixture;
  mixture.kind = BsdfKind::kMixture;
  mixture.parts = {add_diffuse(s, Rgb(0.8)), add_mirror(s, Rgb(0.9))};
  mixture.shares = {0.6, 0.4};
  add_sphere(s, add_bsdf(s, mixture), Vec3(0.5, 0.22, 0.4), 0.2);
  check_layers("sky", s, 2048, 13, 0.05);
}
