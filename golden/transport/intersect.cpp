// SPDX-License-Identifier: Apache-2.0
#include "golden/transport/intersect.hpp"

namespace photonloom {

Hit finish_hit(const World& world, uint32_t primitive, const Ray& ray, const Meeting& m) {
  const Primitive& p = world.primitives()[primitive];
  Hit hit;
  hit.primitive = primitive;
  hit.shape = p.shape;
  hit.distance = m.t;
  hit.normal = p.normal;
  hit.shading_normal = p.normal;
  switch (p.kind) {
    case PrimitiveKind::kTriangle: {
      const Vec3& w = m.coordinates;
      hit.position = p.a * w.x + p.b * w.y + p.c * w.z;
      hit.coordinates = Vec2(w.y, w.z);
      const Mesh& mesh = world.scene().shapes[p.shape].mesh;
      if (!mesh.normals.empty()) {
        const auto& v = mesh.triangles[p.index];
        const Vec3 n =
            mesh.normals[v[0]] * w.x + mesh.normals[v[1]] * w.y + mesh.normals[v[2]] * w.z;
        // A shading normal on the other side of the triangle says nothing about it.
        if (glm::dot(n, p.normal) > 0) hit.shading_normal = n / glm::length(n);
      }
      break;
    }
    case PrimitiveKind::kSphere: {
      const Vec3 out = glm::normalize(ray.origin + ray.direction * m.t - p.a);
      hit.position = p.a + out * p.b.x;
      hit.normal = p.inward ? -out : out;
      hit.shading_normal = hit.normal;
      break;
    }
    case PrimitiveKind::kDisk:
      hit.position = p.a + p.b * m.coordinates.x + p.c * m.coordinates.y;
      hit.coordinates = Vec2(m.coordinates.x, m.coordinates.y);
      break;
  }
  return hit;
}

}  // namespace photonloom
