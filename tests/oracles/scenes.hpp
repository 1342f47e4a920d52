// SPDX-License-Identifier: Apache-2.0
// Scenes built by hand, for closed forms.
#pragma once
#include <array>
#include <utility>
#include <vector>

#include "golden/transport/path.hpp"
#include "golden/transport/world.hpp"

namespace photonloom::oracle {

inline int add_bsdf(Scene& s, const Bsdf& b) {
  s.bsdfs.push_back(b);
  return static_cast<int>(s.bsdfs.size()) - 1;
}
inline int add_diffuse(Scene& s, const Rgb& rho, bool two_sided = false) {
  Bsdf b;
  b.diffuse = rho;
  b.two_sided = two_sided;
  return add_bsdf(s, b);
}
inline int add_phong(Scene& s, const Rgb& diffuse, const Rgb& specular, double n) {
  Bsdf b;
  b.kind = BsdfKind::kPhong;
  b.diffuse = diffuse;
  b.specular = specular;
  b.exponent = n;
  return add_bsdf(s, b);
}
inline int add_mirror(Scene& s, const Rgb& specular = Rgb(1), bool two_sided = false) {
  Bsdf b;
  b.kind = BsdfKind::kConductor;
  b.specular = specular;
  b.two_sided = two_sided;
  return add_bsdf(s, b);
}
inline int add_glass(Scene& s, double ior) {
  Bsdf b;
  b.kind = BsdfKind::kDielectric;
  b.specular = Rgb(1);
  b.ior = ior;
  return add_bsdf(s, b);
}

// A quadrilateral with the normal cross(u, v): corner, corner + u, corner + u + v, corner + v.
inline Shape& add_quad(Scene& s, int bsdf, const Vec3& corner, const Vec3& u, const Vec3& v) {
  Shape q;
  q.kind = ShapeKind::kRectangle;
  q.bsdf = bsdf;
  q.mesh.positions = {corner, corner + u, corner + u + v, corner + v};
  q.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  s.shapes.push_back(q);
  return s.shapes.back();
}

// The box [lower, upper] with normals inward, six quadrilaterals in one mesh.
inline Shape& add_room(Scene& s, int bsdf, const Vec3& lo, const Vec3& hi) {
  Shape room;
  room.kind = ShapeKind::kCube;
  room.bsdf = bsdf;
  const Vec3 x(hi.x - lo.x, 0, 0), y(0, hi.y - lo.y, 0), z(0, 0, hi.z - lo.z);
  const auto face = [&](const Vec3& corner, const Vec3& u, const Vec3& v) {
    const uint32_t n = static_cast<uint32_t>(room.mesh.positions.size());
    for (const Vec3& p : {corner, corner + u, corner + u + v, corner + v})
      room.mesh.positions.push_back(p);
    room.mesh.triangles.push_back({n, n + 1, n + 2});
    room.mesh.triangles.push_back({n, n + 2, n + 3});
  };
  face(lo, x, y);
  face(lo, y, z);
  face(lo, z, x);
  face(hi, -y, -x);
  face(hi, -z, -y);
  face(hi, -x, -z);
  s.shapes.push_back(room);
  return s.shapes.back();
}

inline Shape& add_sphere(Scene& s, int bsdf, const Vec3& centre, double r, bool inward = false) {
  Shape sphere;
  sphere.kind = ShapeKind::kSphere;
  sphere.bsdf = bsdf;
  sphere.flip_normals = inward;
  sphere.to_world = Mat4(r);
  sphere.to_world[3] = glm::dvec4(centre, 1);
  s.shapes.push_back(sphere);
  return s.shapes.back();
}

// A camera at `eye` that looks at `target`.
inline void set_camera(Scene& s, const Vec3& eye, const Vec3& target, const Vec3& up, double fov,
                       int width, int height) {
  const Vec3 z = glm::normalize(target - eye), x = glm::normalize(glm::cross(up, z)),
             y = glm::cross(z, x);
  s.camera.to_world =
      Mat4(glm::dvec4(x, 0), glm::dvec4(y, 0), glm::dvec4(z, 0), glm::dvec4(eye, 1));
  s.camera.fov = fov;
  s.film = {width, height};
}

inline double channel_mean(const Image& image, const std::string& name) {
  double sum = 0;
  for (float p : image.find(name)->pixels) sum += static_cast<double>(p);
  return sum / static_cast<double>(image.find(name)->pixels.size());
}

// By path tracing.
inline Image path_image(const Scene& scene, int spp, uint64_t seed) {
  const World world(scene);
  const auto caster = make_embree(world);
  PathOptions options;
  options.spp = spp;
  options.seed = seed;
  return render_path(world, *caster, options);
}

}  // namespace photonloom::oracle
