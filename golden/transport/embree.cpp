// SPDX-License-Identifier: Apache-2.0
// Embree finds a primitive in single precision; in double the hit is then worked out on that
// primitive, and what rounding invented (neighbours of the surface a ray leaves) is rejected. Where
// the two disagree, which is at edges, our own BVH decides.
#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "golden/transport/intersect.hpp"

namespace photonloom {
namespace {

#if RTC_VERSION_MAJOR >= 4
using Context = RTCRayQueryContext;
void init_context(Context* c) { rtcInitRayQueryContext(c); }
void intersect(RTCScene scene, Context* context, RTCRayHit* ray) {
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.context = context;
  arguments.flags = RTC_RAY_QUERY_FLAG_INCOHERENT;
  rtcIntersect1(scene, ray, &arguments);
}
void occlude(RTCScene scene, Context* context, RTCRay* ray) {
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.context = context;
  arguments.flags = RTC_RAY_QUERY_FLAG_INCOHERENT;
  rtcOccluded1(scene, ray, &arguments);
}
#else
using Context = RTCIntersectContext;
void init_context(Context* c) { rtcInitIntersectContext(c); }
void intersect(RTCScene scene, Context* context, RTCRayHit* ray) {
  rtcIntersect1(scene, context, ray);
}
void occlude(RTCScene scene, Context* context, RTCRay* ray) { rtcOccluded1(scene, context, ray); }
#endif

// What callbacks know of the ray; the context comes first so that its address is the query's.
struct Query {
  Context context;
  const World* world;
  const std::vector<uint32_t>* numbers[2];  // primitive numbers of Embree's geometries
  Ray ray;                                  // moved off its surface
  Shear shear;
  uint32_t from = ~0u, ignored = ~0u;
  double limit = HUGE_VAL;

  Query(const World& w, const std::vector<uint32_t>& triangles, const std::vector<uint32_t>& others,
        const Ray& r, const Hit* leaving)
      : world(&w), numbers{&triangles, &others}, ray(r), shear(r.direction) {
    init_context(&context);
    if (!leaving) return;
    from = leaving->primitive;
    ray.origin = leave_surface(leaving->position, leaving->normal, r.direction);
  }
  uint32_t primitive(unsigned geometry, unsigned number) const {
    return (*numbers[geometry])[number];
  }
  bool meet(uint32_t number, Meeting& m) const {
    const Primitive& p = world->primitives()[number];
    const bool leaving = number == from;
    if (number == ignored) return false;
    const bool met = p.kind == PrimitiveKind::kTriangle
                         ? !leaving && meet_triangle(p.a, p.b, p.c, ray.origin, shear, m)
                         : meet_round(p, ray.origin, ray.direction, leaving, m);
    return met && m.t <= limit;
  }
};

const Query& query_of(const Context* context) { return *reinterpret_cast<const Query*>(context); }

// Closest hit: the triangle's plane must lie before the ray.
void filter_closest(const RTCFilterFunctionNArguments* a) {
  const Query& q = query_of(a->context);
  const RTCHit* hit = reinterpret_cast<const RTCHit*>(a->hit);
  const uint32_t number = q.primitive(0, hit->primID);
  const Primitive& p = q.world->primitives()[number];
  Crossing c;
  if (number == q.from || !cross_plane(p.a, p.b, p.c, q.ray.origin, q.shear, c) || !(c.t > 0))
    a->valid[0] = 0;
}

void filter_occluded(const RTCFilterFunctionNArguments* a) {
  const Query& q = query_of(a->context);
  Meeting m;
  if (!q.meet(q.primitive(0, reinterpret_cast<const RTCHit*>(a->hit)->primID), m)) a->valid[0] = 0;
}

void bounds_of(const RTCBoundsFunctionArguments* a);
void intersect_other(const RTCIntersectFunctionNArguments* a) {
  if (!a->valid[0]) return;
  const Query& q = query_of(a->context);
  RTCRayHit* ray = reinterpret_cast<RTCRayHit*>(a->rayhit);
  Meeting m;
  if (!q.meet(q.primitive(1, a->primID), m) || m.t > static_cast<double>(ray->ray.tfar)) return;
  ray->ray.tfar = static_cast<float>(m.t);
  ray->hit.primID = a->primID;
  ray->hit.geomID = a->geomID;
}
void occlude_other(const RTCOccludedFunctionNArguments* a) {
  if (!a->valid[0]) return;
  const Query& q = query_of(a->context);
  Meeting m;
  if (q.meet(q.primitive(1, a->primID), m)) reinterpret_cast<RTCRay*>(a->ray)->tfar = -INFINITY;
}

class EmbreeCaster final : public RayCaster {
 public:
  explicit EmbreeCaster(const World& world) : world_(world), exact_(make_double_bvh(world)) {
    device_ = rtcNewDevice(nullptr);
    if (!device_) throw std::runtime_error("Embree cannot start on this machine");
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    for (uint32_t i = 0; i < world.primitives().size(); ++i)
      (world.primitives()[i].kind == PrimitiveKind::kTriangle ? triangles_ : others_).push_back(i);
    add_triangles();
    add_others();
    rtcCommitScene(scene_);
    const RTCError error = rtcGetDeviceError(device_);
    if (error != RTC_ERROR_NONE)
      throw std::runtime_error("Embree cannot take this scene: error " + std::to_string(error));
  }
  ~EmbreeCaster() override {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  EmbreeCaster(const EmbreeCaster&) = delete;
  EmbreeCaster& operator=(const EmbreeCaster&) = delete;

  Hit closest(const Ray& ray, const Hit* from) const override {
    Query q(world_, triangles_, others_, ray, from);
    if (!is_single(q.ray)) return exact_->closest(ray, from);
    RTCRayHit r;
    r.ray = single(q);
    r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    intersect(scene_, &q.context, &r);
    if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return Hit();
    const uint32_t number = q.primitive(r.hit.geomID, r.hit.primID);
    Meeting m;
    if (!q.meet(number, m)) return exact_->closest(ray, from);
    return finish_hit(world_, number, q.ray, m);
  }

  bool occluded(const Ray& ray, double distance, const Hit* from,
                const Hit* to_hit) const override {
    Query q(world_, triangles_, others_, ray, from);
    q.limit = distance;
    if (to_hit) {
      if (own_wall_before(world_, ray, from, *to_hit)) return true;
      q.ignored = to_hit->primitive;
      q.limit = glm::length(leave_surface(to_hit->position, to_hit->normal, -ray.direction) -
                            q.ray.origin);
    }
    if (!is_single(q.ray)) return exact_->occluded(ray, distance, from, to_hit);
    RTCRay r = single(q);
    r.tfar = static_cast<float>(q.limit) * (1 + 0x1p-20f);
    occlude(scene_, &q.context, &r);
    return r.tfar < 0;
  }

  void bounds(uint32_t other, RTCBounds* b) const {
    Vec3 lo, hi;
    primitive_bounds(world_.primitives()[others_[other]], lo, hi);
    lo -= world_.centre();
    hi -= world_.centre();
    const double slack = world_.cube_extent() * 0x1p-20;
    b->lower_x = static_cast<float>(lo.x - slack);
    b->lower_y = static_cast<float>(lo.y - slack);
    b->lower_z = static_cast<float>(lo.z - slack);
    b->upper_x = static_cast<float>(hi.x + slack);
    b->upper_y = static_cast<float>(hi.y + slack);
    b->upper_z = static_cast<float>(hi.z + slack);
  }

 private:
  void add_triangles() {
    RTCGeometry g = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    float* v = static_cast<float*>(rtcSetNewGeometryBuffer(
        g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 3 * triangles_.size()));
    unsigned* index = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), triangles_.size()));
    for (size_t i = 0; i < triangles_.size(); ++i) {
      const Primitive& p = world_.primitives()[triangles_[i]];
      size_t corner = 3 * i;
      for (const Vec3& x : {p.a, p.b, p.c}) {
        // Around the scene's centre, so that single precision is spent on the scene.
        const Vec3 local = x - world_.centre();
        for (int axis = 0; axis < 3; ++axis)
          v[3 * corner + static_cast<size_t>(axis)] = static_cast<float>(local[axis]);
        index[corner] = static_cast<unsigned>(corner);
        ++corner;
      }
    }
    rtcSetGeometryIntersectFilterFunction(g, filter_closest);
    rtcSetGeometryOccludedFilterFunction(g, filter_occluded);
    attach(g, 0);
  }
  void add_others() {
    RTCGeometry g = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(g, static_cast<unsigned>(others_.size()));
    rtcSetGeometryUserData(g, this);
    rtcSetGeometryBoundsFunction(g, bounds_of, nullptr);
    rtcSetGeometryIntersectFunction(g, intersect_other);
    rtcSetGeometryOccludedFunction(g, occlude_other);
    attach(g, 1);
  }
  void attach(RTCGeometry g, unsigned number) {
    rtcCommitGeometry(g);
    rtcAttachGeometryByID(scene_, g, number);
    rtcReleaseGeometry(g);
  }
  // Whether Embree takes the ray: it stops the program at numbers above 1.8e18, and at none.
  bool is_single(const Ray& ray) const {
    constexpr double kLargest = 1e18;
    bool good = true;
    for (int i = 0; i < 3; ++i)
      good = good && std::fabs(ray.origin[i] - world_.centre()[i]) <= kLargest &&
             std::isfinite(ray.direction[i]);
    return good;
  }
  RTCRay single(const Query& q) const {
    const Vec3 o = q.ray.origin - world_.centre();
    RTCRay r;
    r.org_x = static_cast<float>(o.x);
    r.org_y = static_cast<float>(o.y);
    r.org_z = static_cast<float>(o.z);
    r.dir_x = static_cast<float>(q.ray.direction.x);
    r.dir_y = static_cast<float>(q.ray.direction.y);
    r.dir_z = static_cast<float>(q.ray.direction.z);
    r.tnear = 0;
    r.tfar = INFINITY;
    r.time = 0;
    r.mask = ~0u;
    r.id = 0;
    r.flags = 0;
    return r;
  }

  const World& world_;
  std::unique_ptr<RayCaster> exact_;
  std::vector<uint32_t> triangles_, others_;
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
};

void bounds_of(const RTCBoundsFunctionArguments* a) {
  static_cast<const EmbreeCaster*>(a->geometryUserPtr)->bounds(a->primID, a->bounds_o);
}

// Whether something is so small beside the scene that single precision around the scene's centre
// may move its corners by more than 2^-8 of it.
bool has_small_things(const World& world) {
  constexpr double kSmall = 0x1p-18;
  const auto is_small = [&](const Primitive& p) {
    Vec3 low, high;
    primitive_bounds(p, low, high);
    const double across = max_component(high - low);
    return across > 0 && across < kSmall * world.cube_extent();
  };
  return std::any_of(world.primitives().begin(), world.primitives().end(), is_small);
}

}  // namespace

std::unique_ptr<RayCaster> make_embree(const World& world) {
  // Our own hierarchy has the instances' hits to the last bit, and small things in a wide scene.
  if (!world.instances().empty() || has_small_things(world)) return make_double_bvh(world);
  return std::make_unique<EmbreeCaster>(world);
}

}  // namespace photonloom
