// SPDX-License-Identifier: Apache-2.0
#include "golden/transport/intersect.hpp"

#include "golden/scene/mesh.hpp"

namespace photonloom {

Hit finish_hit(const World& world, uint32_t primitive, const Ray& ray, const Meeting& m,
               uint32_t instance) {
  Primitive copy;
  if (instance != ~0u) copy = world.placed(primitive, instance);
  const Primitive& p = instance != ~0u ? copy : world.primitives()[primitive];
  Hit hit;
  hit.primitive = primitive;
  hit.instance = instance;
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
        const auto normal = [&](size_t i) {
          const Vec3& own = mesh.normals[v[i]];
          return instance == ~0u ? own : carried_normal(world.instances()[instance].normals, own);
        };
        const Vec3 n = normal(0) * w.x + normal(1) * w.y + normal(2) * w.z;
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
    case PrimitiveKind::kCylinder: {
      const Vec3 along = p.b / glm::length(p.b);
      const Vec3 d = ray.origin + ray.direction * m.t - p.a;
      const double height = glm::dot(d, along);
      const Vec3 out = glm::normalize(d - along * height);
      hit.position = p.a + along * height + out * p.c.x;
      hit.normal = p.inward ? -out : out;
      hit.shading_normal = hit.normal;
      break;
    }
    case PrimitiveKind::kUnevenSphere:
    case PrimitiveKind::kUnevenCylinder: {
      Vec3 on = m.coordinates;  // the unit shape's point, and there its normal
      if (p.kind == PrimitiveKind::kUnevenSphere)
        on = glm::normalize(on);
      else
        on = Vec3(Vec2(on) / glm::length(Vec2(on)), on.z);
      hit.position = p.a + p.b * on.x + p.c * on.y + p.axis * on.z;
      if (p.kind == PrimitiveKind::kUnevenCylinder) on.z = 0;
      const Vec3 out = glm::normalize(glm::transpose(to_unit_shape(p)) * on);
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
