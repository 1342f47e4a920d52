// SPDX-License-Identifier: Apache-2.0
#include <bit>

#include "golden/numeric/random.hpp"
#include "golden/scene/scene.hpp"

namespace photonloom {
namespace {

// A chain of mixed words: order counts.
class Hasher {
 public:
  void add(uint64_t word) { state_ = mix64(state_ * 0x9e3779b97f4a7c15ull + word + 1); }
  void add(int value) { add(static_cast<uint64_t>(static_cast<int64_t>(value))); }
  void add(double value) { add(std::bit_cast<uint64_t>(value == 0 ? 0.0 : value)); }  // -0 is 0
  void add(const Vec3& v) {
    for (int i = 0; i < 3; ++i) add(v[i]);
  }
  void add(const Mat4& m) {
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) add(m[i][j]);
  }
  template <class Enum>
  requires std::is_enum_v<Enum>
  void add(Enum e) { add(static_cast<int>(e)); }
  uint64_t value() const { return state_; }

 private:
  uint64_t state_ = 0x70686f746f6e6c6full;
};

}  // namespace

uint64_t scene_hash(const Scene& scene) {
  Hasher h;
  h.add(scene.camera.to_world);
  h.add(scene.camera.fov);
  h.add(scene.camera.fov_axis);
  h.add(scene.camera.near_clip);
  h.add(scene.camera.far_clip);
  h.add(scene.film.width);
  h.add(scene.film.height);
  // What the cameras and films of most scenes do not have adds nothing to the hash.
  const Camera& camera = scene.camera;
  if (camera.kind != CameraKind::kPerspective) {
    h.add(camera.kind);
    h.add(camera.aperture_radius);
    h.add(camera.focus_distance);
  }
  if (camera.offset_x != 0 || camera.offset_y != 0)
    h.add(Vec3(camera.offset_x, camera.offset_y, 0));
  const Film& film = scene.film;
  if (film.is_window())
    for (const double x : {film.whole_width, film.whole_height, film.left, film.top}) h.add(x);
  if (!film.filter.is_plain_box()) {
    h.add(film.filter.kind);
    for (const double x : {film.filter.radius, film.filter.stddev, film.filter.b, film.filter.c})
      h.add(x);
  }
  h.add(scene.max_depth);
  h.add(scene.rr_depth);
  // What scenes without textures, roughness and environments do not have adds nothing to the hash.
  const auto add_bitmap = [&](const Bitmap& b) {
    h.add(b.width);
    h.add(b.height);
    for (const float t : b.texels) h.add(static_cast<double>(t));
  };
  const bool has_textures = !scene.textures.empty();
  const auto add_texture = [&](int index) {
    if (index < 0) return;
    const Texture& t = scene.textures[static_cast<size_t>(index)];
    h.add(t.kind);
    if (t.bitmap) add_bitmap(*t.bitmap);
    h.add(static_cast<int>(t.nearest));
    h.add(t.wrap_u);
    h.add(t.wrap_v);
    for (const auto& row : t.to_uv)
      for (const double x : row) h.add(x);
    for (const Rgb& c : {t.color[0], t.color[1], t.scale}) h.add(c);
  };
  const auto add_bsdf = [&](const auto& again, int index) -> void {
    if (index < 0) {
      h.add(-1);
      return;
    }
    const Bsdf& b = scene.bsdfs[static_cast<size_t>(index)];
    h.add(b.kind);
    for (const Rgb& c : {b.diffuse, b.specular, b.transmission, b.eta, b.k}) h.add(c);
    h.add(b.exponent);
    h.add(b.ior);
    if (b.kind > BsdfKind::kDielectric) {
      h.add(b.microfacets);
      h.add(b.alpha_u);
      h.add(b.alpha_v);
      h.add(static_cast<int>(b.nonlinear));
      for (const double share : b.shares) h.add(share);
      for (const int part : b.parts) again(again, part);
    }
    if (b.opacity != 1) h.add(b.opacity);
    if (b.follow_diffuse) h.add(static_cast<int>(b.follow_diffuse));
    if (b.kind == BsdfKind::kPrincipled) {
      const Principled& p = b.principled;
      for (const double x : {p.roughness, p.anisotropic, p.metallic, p.spec_trans, p.spec_tint,
                             p.sheen, p.sheen_tint, p.flatness, p.clearcoat, p.clearcoat_gloss})
        h.add(x);
    }
    if (b.is_coated()) {
      h.add(b.coat_ior);
      h.add(b.coat_specular);
      h.add(b.coat_absorption);
    }
    for (const auto& [which, map] : {std::pair(1, b.normal_map), std::pair(2, b.bump_map)}) {
      if (map < 0) continue;
      h.add(which);
      add_texture(map);
    }
    for (size_t slot = 0; slot < b.texture.size(); ++slot) {
      if (b.texture[slot] < 0) continue;
      h.add(static_cast<uint64_t>(slot));
      add_texture(b.texture[slot]);
    }
  };
  h.add(static_cast<uint64_t>(scene.shapes.size()));
  for (const Shape& s : scene.shapes) {
    const bool is_mesh = s.kind != ShapeKind::kSphere && s.kind != ShapeKind::kDisk &&
                         s.kind != ShapeKind::kCylinder;
    h.add(is_mesh ? ShapeKind::kMesh : s.kind);
    if (s.group >= 0) h.add(s.group);
    h.add(s.to_world);
    if (!is_mesh) h.add(static_cast<int>(s.flip_normals));  // in a mesh it is applied
    h.add(static_cast<uint64_t>(s.mesh.positions.size()));
    for (const Vec3& p : s.mesh.positions) h.add(p);
    h.add(static_cast<uint64_t>(s.mesh.normals.size()));
    for (const Vec3& n : s.mesh.normals) h.add(n);
    h.add(static_cast<uint64_t>(s.mesh.triangles.size()));
    for (const auto& t : s.mesh.triangles)
      for (const uint32_t v : t) h.add(static_cast<uint64_t>(v));
    if (has_textures) {
      for (const Vec2& uv : s.mesh.uvs) h.add(Vec3(uv, 0));
      for (const Rgb& c : s.mesh.colors) h.add(c);
    }
    add_bsdf(add_bsdf, s.bsdf);
    add_bsdf(add_bsdf, s.back_bsdf);
    h.add(static_cast<int>(s.radiance.has_value()));
    if (s.radiance) h.add(*s.radiance);
    add_texture(s.radiance_texture);
  }
  for (const Instance& i : scene.instances) {
    h.add(i.group);
    h.add(i.to_world);
  }
  h.add(static_cast<uint64_t>(scene.lights.size()));
  for (const Light& l : scene.lights) {
    h.add(l.kind);
    h.add(l.position);
    h.add(l.direction);
    h.add(l.intensity);
    h.add(l.cutoff_angle);
    h.add(l.beam_angle);
    if (l.map) {
      add_bitmap(*l.map);
      h.add(l.to_world);
    }
  }
  return h.value();
}

}  // namespace photonloom
