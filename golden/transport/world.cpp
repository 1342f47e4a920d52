// SPDX-License-Identifier: Apache-2.0
#include "golden/transport/world.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include <tbb/parallel_for.h>

#include "golden/numeric/elementary.hpp"
#include "golden/numeric/random.hpp"
#include "golden/transport/bsdf.hpp"
#include "golden/transport/emitters.hpp"

namespace photonloom {
namespace {

std::string file_of(const Scene& scene) {
  return scene.files.empty() ? scene.name : scene.files.front();
}

Vec3 column(const Mat4& m, int i) { return Vec3(m[i]); }

Primitive disk_primitive(const Shape& s) {
  Primitive p;
  p.kind = PrimitiveKind::kDisk;
  p.a = column(s.to_world, 3);
  p.b = column(s.to_world, 0);
  p.c = column(s.to_world, 1);
  const Vec3 n = glm::cross(p.b, p.c);
  p.area = kPi * glm::length(n);
  // The normal +z is carried by the inverse transpose: cross(x, y) times the determinant's sign.
  const bool mirrored = glm::dot(n, column(s.to_world, 2)) < 0;
  p.normal = glm::normalize(n) * (mirrored != s.flip_normals ? -1.0 : 1.0);
  return p;
}

Primitive sphere_primitive(const Shape& s) {
  Primitive p;
  p.kind = PrimitiveKind::kSphere;
  p.a = column(s.to_world, 3);
  p.b = Vec3(glm::length(column(s.to_world, 0)), 0, 0);
  p.area = 4 * kPi * p.b.x * p.b.x;
  p.inward = s.flip_normals;
  return p;
}

Primitive cylinder_primitive(const Shape& s) {
  Primitive p;
  p.kind = PrimitiveKind::kCylinder;
  p.a = column(s.to_world, 3);
  p.b = column(s.to_world, 2);
  p.c = Vec3(glm::length(column(s.to_world, 0)), 0, 0);
  p.area = 2 * kPi * p.c.x * glm::length(p.b);
  p.inward = s.flip_normals;
  return p;
}

// Area of the image of the unit sphere, or of the cylinder of radius and height 1: over an even
// grid of the unit shape's points, the length that their area's vector has in the world.
double uneven_area(const Primitive& p) {
  constexpr int kTurns = 256, kHeights = 128;
  const glm::dmat3 cofactors(glm::cross(p.c, p.axis), glm::cross(p.axis, p.b),
                             glm::cross(p.b, p.c));
  const bool tube = p.kind == PrimitiveKind::kUnevenCylinder;
  const int heights = tube ? 1 : kHeights;
  double sum = 0;
  for (int i = 0; i < heights; ++i) {
    const double z = tube ? 0 : (2 * i + 1.0) / kHeights - 1;
    for (int j = 0; j < kTurns; ++j)
      sum += glm::length(cofactors *
                         Vec3(cos_sin_turns((j + 0.5) / kTurns) * std::sqrt(1 - z * z), z));
  }
  return sum / (heights * kTurns) * (tube ? 2 * kPi : 4 * kPi);
}

Primitive uneven_primitive(const Shape& s) {
  Primitive p;
  p.kind =
      s.kind == ShapeKind::kSphere ? PrimitiveKind::kUnevenSphere : PrimitiveKind::kUnevenCylinder;
  p.a = column(s.to_world, 3);
  p.b = column(s.to_world, 0);
  p.c = column(s.to_world, 1);
  p.axis = column(s.to_world, 2);
  p.area = uneven_area(p);
  p.inward = s.flip_normals;
  return p;
}

// The same for corners in any order.
uint64_t hash_of_corners(const Primitive& p) {
  uint64_t sum = 0;
  for (const Vec3& v : {p.a, p.b, p.c}) {
    const auto bits = [](double x) { return std::bit_cast<uint64_t>(x + 0.0); };  // no -0
    sum += hash_bits(bits(v.x), bits(v.y), bits(v.z), 0);
  }
  return sum;
}

bool has_corners_of(const Primitive& p, const Primitive& q) {
  const std::array<Vec3, 3> a{p.a, p.b, p.c}, b{q.a, q.b, q.c};
  return std::is_permutation(a.begin(), a.end(), b.begin());
}

// Half the extent of a disk, or of an uneven cylinder's end, along each axis.
Vec3 disk_reach(const Primitive& p) { return glm::sqrt(p.b * p.b + p.c * p.c); }

}  // namespace

void primitive_bounds(const Primitive& p, Vec3& lower, Vec3& upper) {
  switch (p.kind) {
    case PrimitiveKind::kTriangle:
      lower = glm::min(p.a, glm::min(p.b, p.c));
      upper = glm::max(p.a, glm::max(p.b, p.c));
      return;
    case PrimitiveKind::kSphere:
      lower = p.a - Vec3(p.b.x);
      upper = p.a + Vec3(p.b.x);
      return;
    case PrimitiveKind::kCylinder: {
      const Vec3 along = glm::normalize(p.b);
      const Vec3 reach = glm::sqrt(glm::max(Vec3(0), 1.0 - along * along)) * p.c.x;
      lower = glm::min(p.a, p.a + p.b) - reach;
      upper = glm::max(p.a, p.a + p.b) + reach;
      return;
    }
    case PrimitiveKind::kDisk:
      lower = p.a - disk_reach(p);
      upper = p.a + disk_reach(p);
      return;
    case PrimitiveKind::kUnevenSphere: {
      const Vec3 reach = glm::sqrt(p.b * p.b + p.c * p.c + p.axis * p.axis);
      lower = p.a - reach;
      upper = p.a + reach;
      return;
    }
    case PrimitiveKind::kUnevenCylinder:
      lower = glm::min(p.a, p.a + p.axis) - disk_reach(p);
      upper = glm::max(p.a, p.a + p.axis) + disk_reach(p);
      return;
  }
}

World::World(Scene scene) : scene_(std::move(scene)) {
  add_coats();
  add_primitives();
  add_emitters();
}

void World::add_coats() {
  const std::vector<bool> used = used_bsdfs(scene_);
  for (size_t i = 0; i < scene_.bsdfs.size(); ++i) {
    if (!used[i]) continue;
    const Bsdf& b = scene_.bsdfs[i];
    const bool plastic = b.kind == BsdfKind::kPlastic || b.kind == BsdfKind::kRoughPlastic;
    if (b.kind == BsdfKind::kMixture || b.kind == BsdfKind::kPlastic || b.is_coated())
      has_choices_ = true;
    if (!plastic && !b.is_coated() && b.kind != BsdfKind::kPrincipled) continue;
    coats_.resize(scene_.bsdfs.size());
    coats_[i] = make_coat(b);
  }
}

// The primitives of one shape.
void World::add_shape(uint32_t s) {
  const Shape& shape = scene_.shapes[s];
  const size_t first = primitives_.size();
  if (shape.uneven) {
    primitives_.push_back(uneven_primitive(shape));
  } else if (shape.kind == ShapeKind::kSphere) {
    primitives_.push_back(sphere_primitive(shape));
  } else if (shape.kind == ShapeKind::kDisk) {
    primitives_.push_back(disk_primitive(shape));
  } else if (shape.kind == ShapeKind::kCylinder) {
    primitives_.push_back(cylinder_primitive(shape));
  } else {
    for (uint32_t t = 0; t < shape.mesh.triangles.size(); ++t) {
      const auto& v = shape.mesh.triangles[t];
      Primitive p;
      p.index = t;
      p.a = shape.mesh.positions[v[0]];
      p.b = shape.mesh.positions[v[1]];
      p.c = shape.mesh.positions[v[2]];
      const Vec3 n = glm::cross(p.b - p.a, p.c - p.a);
      const double length = glm::length(n);
      if (!(length > 0)) continue;  // no area: nothing can meet it
      p.normal = n / length;
      p.area = length / 2;
      primitives_.push_back(p);
    }
  }
  for (size_t i = first; i < primitives_.size(); ++i) primitives_[i].shape = s;
}

void World::add_primitives() {
  int groups = 0;
  for (uint32_t s = 0; s < scene_.shapes.size(); ++s) {
    const Shape& shape = scene_.shapes[s];
    groups = std::max(groups, shape.group + 1);
    const Bsdf* front = shape.bsdf < 0 ? nullptr : &scene_.bsdfs[static_cast<size_t>(shape.bsdf)];
    const bool both = front && (front->two_sided || front->transmits());
    side_bsdf_.push_back(shape.bsdf);
    side_bsdf_.push_back(shape.back_bsdf >= 0 ? shape.back_bsdf : both ? shape.bsdf : -1);
    if (shape.group < 0) add_shape(s);
    for (bool side : {true, false}) {
      const Bsdf* b = bsdf(s, side);
      has_delta_ = has_delta_ || has_delta_part(scene_, b);
      has_glossy_ = has_glossy_ || has_glossy_part(scene_, b);
      const bool is_open = has_open_part(scene_, b);
      side_open_.push_back(is_open);
      has_openings_ = has_openings_ || is_open;
    }
  }
  for (int g = 0; g < groups; ++g) {
    const uint32_t begin = size();
    for (uint32_t s = 0; s < scene_.shapes.size(); ++s)
      if (scene_.shapes[s].group == g) add_shape(s);
    groups_.push_back({begin, size()});
  }
  if (primitives_.empty())
    throw SceneError(file_of(scene_) + ": the scene has no shapes with area");
  add_instances();
  measure();
  warn_of_twins();
}

bool World::differ(const Primitive& p, const Primitive& q) const {
  if (scene_.shapes[p.shape].radiance || scene_.shapes[q.shape].radiance) return true;
  const bool turned = glm::dot(p.normal, q.normal) < 0;
  for (const bool side : {true, false})
    if (bsdf(p.shape, side) != bsdf(q.shape, side != turned)) return true;
  return false;
}

void World::warn_of_twins() {
  std::vector<std::pair<uint64_t, uint32_t>> by_hash;
  for (uint32_t i = 0; i < size(); ++i)
    if (primitives_[i].kind == PrimitiveKind::kTriangle)
      by_hash.emplace_back(hash_of_corners(primitives_[i]), i);
  std::sort(by_hash.begin(), by_hash.end());
  size_t twins = 0;
  const Primitive *first = nullptr, *its_twin = nullptr;
  for (size_t i = 1; i < by_hash.size(); ++i) {
    if (by_hash[i].first != by_hash[i - 1].first) continue;
    const Primitive &p = primitives_[by_hash[i - 1].second], &q = primitives_[by_hash[i].second];
    // Shapes of a group and others are in different spaces.
    if (scene_.shapes[p.shape].group != scene_.shapes[q.shape].group || !has_corners_of(p, q) ||
        !differ(p, q))
      continue;
    if (++twins == 1) first = &p, its_twin = &q;
  }
  if (twins == 0) return;
  const auto name = [&](const Primitive& p) {
    const std::string& id = scene_.shapes[p.shape].id;
    return fmt::format("triangle {} of shape {}{}", p.index, p.shape,
                       id.empty() ? "" : " (" + id + ")");
  };
  scene_.warnings.push_back(fmt::format(
      "{}: {} triangles have the corners of another that has another BSDF or a lamp, the first {} "
      "and {}: which of the two a ray meets is not defined, and images of different renderers may "
      "differ; expected one of each",
      file_of(scene_), twins, name(*first), name(*its_twin)));
}

namespace {

Vec3 carried(const Mat4& m, const Vec3& p) { return Vec3(m * glm::dvec4(p, 1)); }

// The vertices of a group's triangles, each once, in blocks with a box each: for bounds of the
// group wherever it stands, without a look at every vertex.
class GroupVertices {
 public:
  GroupVertices(const Scene& scene, uint32_t group);

  // Calls see(vertex in the world) for all vertices but those of blocks that settled(middle, half)
  // accepts: their vertices lie within `half` of `middle` along each axis.
  template <class Settled, class See>
  void visit(const Mat4& to_world, Settled&& settled, See&& see) const {
    const glm::dmat3 m(to_world);
    for (size_t b = 0; b < boxes_.size(); ++b) {
      const auto& [lower, upper] = boxes_[b];
      const Vec3 middle = carried(to_world, (lower + upper) * 0.5), edge = (upper - lower) * 0.5;
      const Vec3 half = glm::abs(m[0]) * edge.x + glm::abs(m[1]) * edge.y + glm::abs(m[2]) * edge.z;
      // Far above the rounding of the way there.
      const Vec3 rounding = (glm::abs(middle) + half + glm::abs(Vec3(to_world[3]))) * 0x1p-40;
      if (settled(middle, half + rounding)) continue;
      const size_t end = std::min(vertices_.size(), (b + 1) * kBlock);
      for (size_t i = b * kBlock; i < end; ++i) see(carried(to_world, vertices_[i]));
    }
  }

 private:
  static constexpr size_t kBlock = 256;
  std::vector<Vec3> vertices_;
  std::vector<std::pair<Vec3, Vec3>> boxes_;
};

GroupVertices::GroupVertices(const Scene& scene, uint32_t group) {
  for (const Shape& s : scene.shapes) {
    if (s.group != static_cast<int>(group)) continue;
    std::vector<char> used(s.mesh.positions.size(), 0);
    for (const auto& t : s.mesh.triangles)
      for (const uint32_t v : t) used[v] = 1;
    for (size_t i = 0; i < used.size(); ++i)
      if (used[i]) vertices_.push_back(s.mesh.positions[i]);
  }
  for (size_t first = 0; first < vertices_.size(); first += kBlock) {
    std::pair<Vec3, Vec3> box(vertices_[first], vertices_[first]);
    for (size_t i = first; i < std::min(vertices_.size(), first + kBlock); ++i) {
      box.first = glm::min(box.first, vertices_[i]);
      box.second = glm::max(box.second, vertices_[i]);
    }
    boxes_.push_back(box);
  }
}

}  // namespace

Primitive World::placed(uint32_t primitive, uint32_t instance) const {
  Primitive p = primitives_[primitive];
  if (instance == ~0u) return p;
  const PlacedGroup& g = instances_[instance];
  for (Vec3* v : {&p.a, &p.b, &p.c}) *v = carried(g.to_world, *v);
  const Vec3 n = glm::cross(p.b - p.a, p.c - p.a);
  const double length = glm::length(n);
  p.normal = n / (g.mirrored ? -length : length);
  p.area = length / 2;
  return p;
}

void World::add_instances() {
  for (const Instance& i : scene_.instances) {
    PlacedGroup g;
    g.group = static_cast<uint32_t>(i.group);
    g.to_world = i.to_world;
    g.to_group = glm::inverse(i.to_world);
    g.normals = glm::transpose(glm::inverse(glm::dmat3(i.to_world)));
    g.mirrored = glm::determinant(glm::dmat3(i.to_world)) < 0;
    instances_.push_back(g);
  }
  for (uint32_t group = 0; group < groups_.size(); ++group) {
    const GroupVertices vertices(scene_, group);
    tbb::parallel_for(size_t{0}, instances_.size(), [&](size_t i) {
      PlacedGroup& g = instances_[i];
      if (g.group != group) return;
      g.lower = Vec3(HUGE_VAL);
      g.upper = Vec3(-HUGE_VAL);
      vertices.visit(
          g.to_world,
          [&](const Vec3& middle, const Vec3& half) {
            return glm::all(glm::greaterThan(middle - half, g.lower)) &&
                   glm::all(glm::lessThan(middle + half, g.upper));
          },
          [&](const Vec3& p) {
            g.lower = glm::min(g.lower, p);
            g.upper = glm::max(g.upper, p);
          });
    });
  }
}

// Areas and bounds of everything in the world.
void World::measure() {
  std::vector<int> diffuse_sides;  // of shapes
  for (uint32_t shape = 0; shape < scene_.shapes.size(); ++shape)
    diffuse_sides.push_back(static_cast<int>(has_diffuse_part(scene_, bsdf(shape, true))) +
                            static_cast<int>(has_diffuse_part(scene_, bsdf(shape, false))));
  const Range world = world_primitives();
  lower_ = Vec3(HUGE_VAL);
  upper_ = Vec3(-HUGE_VAL);
  for (uint32_t i = world.begin; i < world.end; ++i) {
    const Primitive& p = primitives_[i];
    surface_area_ += p.area;
    for (int side = diffuse_sides[p.shape]; side > 0; --side) diffuse_area_ += p.area;
    Vec3 lo, hi;
    primitive_bounds(p, lo, hi);
    lower_ = glm::min(lower_, lo);
    upper_ = glm::max(upper_, hi);
  }
  // Area, and that which can hold photons, of a group whose area vectors go by these cofactors.
  const auto areas = [&](uint32_t group, const glm::dmat3& cofactors) {
    Vec2 sum(0);
    for (uint32_t i = groups_[group].begin; i < groups_[group].end; ++i) {
      const Primitive& p = primitives_[i];
      const double area = glm::length(cofactors * p.normal) * p.area;
      sum += Vec2(area, diffuse_sides[p.shape] * area);
    }
    return sum;
  };
  std::vector<Vec2> own_areas;
  for (uint32_t group = 0; group < groups_.size(); ++group)
    own_areas.push_back(areas(group, glm::dmat3(1)));
  for (const PlacedGroup& g : instances_) {
    lower_ = glm::min(lower_, g.lower);
    upper_ = glm::max(upper_, g.upper);
    const glm::dmat3 cofactors = g.normals * glm::determinant(glm::dmat3(g.to_world));
    // Even scales make all triangles larger alike.
    const double scale2 = glm::length(cofactors[0]);
    bool even = true;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        even = even && std::fabs(glm::dot(cofactors[i], cofactors[j]) -
                                 (i == j ? scale2 * scale2 : 0)) <= 1e-12 * scale2 * scale2;
    const Vec2 sum = even ? own_areas[g.group] * scale2 : areas(g.group, cofactors);
    surface_area_ += sum.x;
    diffuse_area_ += sum.y;
  }
  // Squares and products of lengths, some in single precision, stay far from its limits.
  constexpr double kSmallest = 1e-12, kLargest = 1e12;
  const double across = max_component(upper_ - lower_);
  if (!(across >= kSmallest && across <= kLargest))
    throw SceneError(fmt::format("{}: the scene is {:g} units across, expected {:g} to {:g}",
                                 file_of(scene_), across, kSmallest, kLargest));
  // Coordinates hold the place within the scene beside its place in the world.
  constexpr double kFarthest = 1e9;
  const double from_origin = max_component(glm::max(glm::abs(lower_), glm::abs(upper_)));
  if (from_origin > kFarthest * across)
    throw SceneError(fmt::format(
        "{}: the scene is {:g} units across and lies {:g} from the origin, expected at most {:g} "
        "times its size: a number does not hold both",
        file_of(scene_), across, from_origin, kFarthest));
  const Vec3 camera(scene_.camera.to_world[3]);
  const double from_scene = max_component(glm::abs(camera - (lower_ + upper_) * 0.5));
  if (!(from_scene <= kFarthest * across))
    throw SceneError(fmt::format(
        "{}: the sensor is {:g} units from a scene of {:g} units across, expected at most {:g} "
        "times as far",
        file_of(scene_), from_scene, across, kFarthest));
  centre_ = (lower_ + upper_) * 0.5;
  for (uint32_t i = world.begin; i < world.end; ++i) {
    const Primitive& p = primitives_[i];
    if (p.kind == PrimitiveKind::kTriangle) {
      for (const Vec3& v : {p.a, p.b, p.c}) radius_ = std::max(radius_, glm::length(v - centre_));
    } else if (p.kind == PrimitiveKind::kCylinder) {
      for (const Vec3& v : {p.a, p.a + p.b})
        radius_ = std::max(radius_, glm::length(v - centre_) + p.c.x);
    } else if (p.kind == PrimitiveKind::kUnevenCylinder || p.kind == PrimitiveKind::kUnevenSphere) {
      Vec3 lo, hi;
      primitive_bounds(p, lo, hi);
      radius_ =
          std::max(radius_, glm::length(glm::max(glm::abs(lo - centre_), glm::abs(hi - centre_))));
    } else {
      const double reach = p.kind == PrimitiveKind::kSphere
                               ? p.b.x
                               : std::max(glm::length(p.b), glm::length(p.c)) * std::sqrt(2.0);
      radius_ = std::max(radius_, glm::length(p.a - centre_) + reach);
    }
  }
  // The sphere of the instances' boxes; only those that reach further are looked at whole.
  const auto furthest_corner = [&](const PlacedGroup& g) {
    return glm::length(glm::max(glm::abs(g.lower - centre_), glm::abs(g.upper - centre_)));
  };
  for (uint32_t group = 0; group < groups_.size(); ++group) {
    const GroupVertices vertices(scene_, group);
    for (const PlacedGroup& g : instances_) {
      if (g.group != group || furthest_corner(g) <= radius_) continue;
      vertices.visit(
          g.to_world,
          [&](const Vec3& middle, const Vec3& half) {
            return glm::length(glm::abs(middle - centre_) + half) < radius_;
          },
          [&](const Vec3& p) { radius_ = std::max(radius_, glm::length(p - centre_)); });
    }
  }
  radius_ = std::min(radius_, glm::length(upper_ - lower_) * 0.5);
  cube_extent_ = max_component(upper_ - lower_) * (1 + 0x1p-16);
  cube_origin_ = centre_ - Vec3(cube_extent_ * 0.5);
}

void World::add_emitters() {
  for (size_t i = 0; i < world_primitives().end; ++i) {
    Primitive& p = primitives_[i];
    const std::optional<Rgb>& radiance = scene_.shapes[p.shape].radiance;
    if (!radiance || is_black(*radiance)) continue;
    if (scene_.shapes[p.shape].uneven)
      throw SceneError(
          fmt::format("{}: a sphere or cylinder of uneven scales emits, expected equal "
                      "scales or a mesh",
                      file_of(scene_)));
    p.emitter = static_cast<int32_t>(emitters_.size());
    Emitter e;
    e.primitive = static_cast<int32_t>(i);
    e.radiance = *radiance;
    e.power = *radiance * (kPi * p.area);
    e.texture = scene_.shapes[p.shape].radiance_texture;
    if (e.texture >= 0) e.power *= texture_mean(scene_.textures[static_cast<size_t>(e.texture)]);
    emitters_.push_back(e);
  }
  for (size_t i = 0; i < scene_.lights.size(); ++i) {
    Emitter e;
    e.light = static_cast<int32_t>(i);
    if (scene_.lights[i].kind == LightKind::kEnvironment) {
      environment_ = std::make_shared<const Environment>(scene_.lights[i]);
      environment_emitter_ = static_cast<uint32_t>(emitters_.size());
      e.power = environment_->integral() * (kPi * radius_ * radius_);
      if (is_black(e.power)) environment_.reset();
    } else {
      e.power = light_power(scene_.lights[i], radius_);
    }
    if (!is_black(e.power)) emitters_.push_back(e);
  }
  if (emitters_.empty()) throw SceneError(file_of(scene_) + ": the scene has no light");
  for (const Emitter& e : emitters_) emitted_power_ += e.power;
  // Products with areas, and squares, are numbers.
  constexpr double kMostPower = 1e120;
  if (!(max_component(emitted_power_) <= kMostPower))
    throw SceneError(
        fmt::format("{}: the lamps emit {:g} W, expected dimmer lamps, of at most {:g} W",
                    file_of(scene_), max_component(emitted_power_), kMostPower));
  const double total = mean(emitted_power_);
  double sum = 0;
  for (Emitter& e : emitters_) {
    e.pmf = mean(e.power) / total;
    sum += e.pmf;
    emitter_cdf_.push_back(sum);
  }
}

double World::opacity(const Bsdf& b, const Hit& hit) const {
  double share_of_parts = 1;
  if (b.kind == BsdfKind::kMixture) {
    // What is in no part is black, and there.
    double rest = 1;
    share_of_parts = 0;
    for (size_t i = 0; i < b.parts.size(); ++i) {
      const double s = share(b, i, hit);
      rest -= s;
      share_of_parts +=
          s * (b.parts[i] < 0 ? 1 : opacity(scene_.bsdfs[static_cast<size_t>(b.parts[i])], hit));
    }
    share_of_parts += std::max(0.0, rest);
  }
  const int t = b.textured(Slot::kOpacity);
  const double own = t < 0 ? b.opacity : b.opacity * luminance(texture_at(t, hit));
  return std::clamp(own * share_of_parts, 0.0, 1.0);
}

double World::share(const Bsdf& mixture, size_t part, const Hit& hit) const {
  const int t = mixture.textured(Slot::kShare);
  if (t < 0) return mixture.shares[part];
  const double second = std::clamp(luminance(texture_at(t, hit)), 0.0, 1.0);
  return part == 0 ? 1 - second : second;
}

Rgb World::albedo(const Bsdf& b, const Hit& hit) const {
  if (b.kind != BsdfKind::kMixture)
    return b.diffuse * texture(b.textured(Slot::kDiffuse), hit) +
           b.specular * texture(b.textured(Slot::kSpecular), hit);
  Rgb sum(0);
  for (size_t i = 0; i < b.parts.size(); ++i)
    if (b.parts[i] >= 0)
      sum += albedo(scene_.bsdfs[static_cast<size_t>(b.parts[i])], hit) * share(b, i, hit);
  return sum;
}

namespace {

// Angle of (x, y) from 0 to 1 for a whole turn.
double turn_of(double x, double y) {
  const double turn = angle_of(x, std::fabs(y)) / (2 * kPi);
  return y < 0 ? 1 - turn : turn;
}

// The point of the unit sphere whose image a point on a sphere is.
Vec3 on_unit_sphere(const Shape& s, const Vec3& position) {
  const Vec3 d = position - column(s.to_world, 3);
  if (s.uneven) return glm::normalize(glm::inverse(glm::dmat3(s.to_world)) * d);
  const Vec3 local(glm::dot(d, column(s.to_world, 0)), glm::dot(d, column(s.to_world, 1)),
                   glm::dot(d, column(s.to_world, 2)));
  return local / glm::length(local);
}

// The point of the cylinder of radius and height 1 whose image a point on a cylinder is.
Vec3 in_cylinder(const Shape& s, const Vec3& position) {
  const Vec3 d = position - column(s.to_world, 3);
  if (s.uneven) return glm::inverse(glm::dmat3(s.to_world)) * d;
  Vec3 local(0);
  for (int i = 0; i < 3; ++i) {
    const Vec3 axis = column(s.to_world, i);
    local[i] = glm::dot(d, axis) / glm::dot(axis, axis);
  }
  return local;
}

struct Corners {
  Vec2 uv[3];
};
Corners corners_of(const Mesh& mesh, uint32_t triangle) {
  if (!mesh.corner_uvs.empty()) {
    const auto& c = mesh.corner_uvs[triangle];
    return {{c[0], c[1], c[2]}};
  }
  if (mesh.uvs.empty()) return {{Vec2(0), Vec2(0), Vec2(0)}};
  const auto& v = mesh.triangles[triangle];
  return {{mesh.uvs[v[0]], mesh.uvs[v[1]], mesh.uvs[v[2]]}};
}

}  // namespace

Vec2 World::uv(const Hit& hit) const {
  const Primitive& p = primitives_[hit.primitive];
  const Shape& s = scene_.shapes[p.shape];
  switch (p.kind) {
    case PrimitiveKind::kTriangle: {
      const Corners c = corners_of(s.mesh, p.index);
      const Vec2& w = hit.coordinates;
      return c.uv[0] * (1 - w.x - w.y) + c.uv[1] * w.x + c.uv[2] * w.y;
    }
    case PrimitiveKind::kSphere:
    case PrimitiveKind::kUnevenSphere: {
      const Vec3 d = on_unit_sphere(s, hit.position);
      return Vec2(turn_of(d.x, d.y), angle_of(d.z, std::sqrt(d.x * d.x + d.y * d.y)) / kPi);
    }
    case PrimitiveKind::kCylinder:
    case PrimitiveKind::kUnevenCylinder: {
      const Vec3 d = in_cylinder(s, hit.position);
      return Vec2(turn_of(d.x, d.y), d.z);
    }
    default:
      return Vec2(glm::length(hit.coordinates), turn_of(hit.coordinates.x, hit.coordinates.y));
  }
}

Vec3 World::tangent(const Hit& hit) const {
  const Primitive& p = primitives_[hit.primitive];
  const Shape& s = scene_.shapes[p.shape];
  Vec3 du, dv;
  switch (p.kind) {
    case PrimitiveKind::kTriangle:
      return derivatives(hit, du, dv) ? du : Vec3(0);
    case PrimitiveKind::kSphere:
    case PrimitiveKind::kUnevenSphere: {
      const Vec3 d = on_unit_sphere(s, hit.position);
      return column(s.to_world, 1) * d.x - column(s.to_world, 0) * d.y;
    }
    case PrimitiveKind::kCylinder:
    case PrimitiveKind::kUnevenCylinder: {
      const Vec3 d = in_cylinder(s, hit.position);
      return column(s.to_world, 1) * d.x - column(s.to_world, 0) * d.y;
    }
    default:
      return p.b * hit.coordinates.x + p.c * hit.coordinates.y;
  }
}

bool World::derivatives(const Hit& hit, Vec3& du, Vec3& dv) const {
  const Primitive& p = primitives_[hit.primitive];
  const Shape& s = scene_.shapes[p.shape];
  switch (p.kind) {
    case PrimitiveKind::kTriangle: {
      const Primitive placed_p = placed(hit.primitive, hit.instance);
      const Corners c = corners_of(s.mesh, p.index);
      const Vec2 b = c.uv[1] - c.uv[0], d = c.uv[2] - c.uv[0];
      const double det = b.x * d.y - b.y * d.x;
      if (det == 0) return false;
      const Vec3 ab = placed_p.b - placed_p.a, ac = placed_p.c - placed_p.a;
      du = (ab * d.y - ac * b.y) / det;
      dv = (ac * b.x - ab * d.x) / det;
      return true;
    }
    case PrimitiveKind::kSphere:
    case PrimitiveKind::kUnevenSphere: {
      const Vec3 d = on_unit_sphere(s, hit.position);
      const double across = std::sqrt(d.x * d.x + d.y * d.y);
      const Vec3 x = column(s.to_world, 0), y = column(s.to_world, 1), z = column(s.to_world, 2);
      du = (y * d.x - x * d.y) * (2 * kPi);
      dv = across > 0 ? ((x * d.x + y * d.y) * (d.z / across) - z * across) * kPi : Vec3(0);
      return across > 0;
    }
    case PrimitiveKind::kCylinder:
    case PrimitiveKind::kUnevenCylinder: {
      const Vec3 d = in_cylinder(s, hit.position);
      du = (column(s.to_world, 1) * d.x - column(s.to_world, 0) * d.y) * (2 * kPi);
      dv = column(s.to_world, 2);
      return true;
    }
    default: {
      const Vec2& at = hit.coordinates;
      const double r = glm::length(at);
      if (!(r > 0)) return false;
      du = (p.b * at.x + p.c * at.y) / r;
      dv = (p.c * at.x - p.b * at.y) * (2 * kPi);
      return true;
    }
  }
}

Rgb World::texture_at(int index, const Hit& hit) const {
  const Texture& t = scene_.textures[static_cast<size_t>(index)];
  if (t.kind != TextureKind::kVertexColor) return texture_value(t, uv(hit));
  const Primitive& p = primitives_[hit.primitive];
  const Mesh& mesh = scene_.shapes[p.shape].mesh;
  if (p.kind != PrimitiveKind::kTriangle || mesh.colors.empty()) return Rgb(0);
  const auto& v = mesh.triangles[p.index];
  const Vec2& w = hit.coordinates;
  return (mesh.colors[v[0]] * (1 - w.x - w.y) + mesh.colors[v[1]] * w.x + mesh.colors[v[2]] * w.y) *
         t.scale;
}

uint32_t World::choose_emitter(double u) const {
  const auto at =
      std::upper_bound(emitter_cdf_.begin(), emitter_cdf_.end(), u * emitter_cdf_.back());
  return static_cast<uint32_t>(
      std::min<size_t>(static_cast<size_t>(at - emitter_cdf_.begin()), emitters_.size() - 1));
}

}  // namespace photonloom
