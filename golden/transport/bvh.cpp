// SPDX-License-Identifier: Apache-2.0
// Bounding volume hierarchy in double: built by binned SAH (Wald 2007), four children a node, boxes
// of a node tested together. Of equally near primitives the lowest number is hit, so results do not
// depend on the order of visits.
#include <algorithm>
#include <cmath>
#include <vector>

#include "golden/transport/intersect.hpp"

namespace photonloom {
namespace {

constexpr int kBins = 16;
constexpr size_t kLeafSize = 4;

struct Box {
  Vec3 lower{HUGE_VAL}, upper{-HUGE_VAL};
  void add(const Box& b) {
    lower = glm::min(lower, b.lower);
    upper = glm::max(upper, b.upper);
  }
  void add(const Vec3& p) {
    lower = glm::min(lower, p);
    upper = glm::max(upper, p);
  }
  double half_area() const {
    const Vec3 d = upper - lower;
    return d.x * d.y + d.y * d.z + d.z * d.x;
  }
};

// A child: empty (count 0, first 0), a leaf (count > 0: entries first .. first + count - 1), or the
// node `first` (count < 0).
struct alignas(32) Node {
  double bound[6][4];  // lower x, y, z, upper x, y, z
  int32_t first[4];
  int32_t count[4];
};

struct Reference {
  Box box;
  Vec3 centre;
  uint32_t primitive;
};

struct BinaryNode {
  Box box;
  int32_t left = -1, right = -1;  // inner
  uint32_t first = 0, count = 0;  // leaf
};

class Builder {
 public:
  explicit Builder(const World& world) {
    for (uint32_t i = 0; i < world.primitives().size(); ++i) {
      Reference r;
      primitive_bounds(world.primitives()[i], r.box.lower, r.box.upper);
      r.centre = (r.box.lower + r.box.upper) * 0.5;
      r.primitive = i;
      references_.push_back(r);
    }
    nodes_.reserve(2 * references_.size());
    split(0, static_cast<uint32_t>(references_.size()), 0);
    collapse(0);
    for (const Reference& r : references_) order.push_back(r.primitive);
  }
  std::vector<Node> wide;
  std::vector<uint32_t> order;

 private:
  int32_t split(uint32_t first, uint32_t count, int depth);
  uint32_t partition(uint32_t first, uint32_t count, const Box& centres, double area);
  int32_t collapse(int32_t root);

  std::vector<Reference> references_;
  std::vector<BinaryNode> nodes_;
};

int32_t Builder::split(uint32_t first, uint32_t count, int depth) {
  const int32_t self = static_cast<int32_t>(nodes_.size());
  nodes_.emplace_back();
  Box box, centres;
  for (uint32_t i = first; i < first + count; ++i) {
    box.add(references_[i].box);
    centres.add(references_[i].centre);
  }
  nodes_[static_cast<size_t>(self)].box = box;
  uint32_t left = 0;
  if (count > 1) left = partition(first, count, centres, box.half_area());
  // Deep chains come from coincident or nested boxes: halve them.
  if (left != 0 && depth > 40) left = count / 2;
  if (left == 0 && count > 2 * kLeafSize) left = count / 2;
  if (left == 0) {
    nodes_[static_cast<size_t>(self)].first = first;
    nodes_[static_cast<size_t>(self)].count = count;
    return self;
  }
  const int32_t l = split(first, left, depth + 1);
  const int32_t r = split(first + left, count - left, depth + 1);
  nodes_[static_cast<size_t>(self)].left = l;
  nodes_[static_cast<size_t>(self)].right = r;
  return self;
}

// Orders the references by the best split and returns how many go left; 0: a leaf is better.
uint32_t Builder::partition(uint32_t first, uint32_t count, const Box& centres, double area) {
  double best = count <= kLeafSize ? static_cast<double>(count) * area : HUGE_VAL;
  int best_axis = -1, best_bin = 0;
  const Vec3 size = centres.upper - centres.lower;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(size[axis] > 0)) continue;
    const double scale = kBins / size[axis];
    Box boxes[kBins];
    uint32_t counts[kBins] = {};
    for (uint32_t i = first; i < first + count; ++i) {
      const int b = std::min(
          kBins - 1, static_cast<int>((references_[i].centre[axis] - centres.lower[axis]) * scale));
      boxes[b].add(references_[i].box);
      ++counts[b];
    }
    double right_cost[kBins];
    Box right;
    uint32_t n = 0;
    for (int b = kBins - 1; b > 0; --b) {
      if (counts[b]) right.add(boxes[b]);
      n += counts[b];
      right_cost[b] = n ? right.half_area() * n : 0;
    }
    Box left;
    n = 0;
    for (int b = 1; b < kBins; ++b) {
      if (counts[b - 1]) left.add(boxes[b - 1]);
      n += counts[b - 1];
      if (n == 0 || n == count) continue;
      const double cost = 0.5 * area + left.half_area() * n + right_cost[b];
      if (cost < best) {
        best = cost;
        best_axis = axis;
        best_bin = b;
      }
    }
  }
  if (best_axis < 0) return 0;
  const double scale = kBins / size[best_axis], low = centres.lower[best_axis];
  const auto begin = references_.begin() + first;
  const auto middle = std::stable_partition(begin, begin + count, [&](const Reference& r) {
    return std::min(kBins - 1, static_cast<int>((r.centre[best_axis] - low) * scale)) < best_bin;
  });
  return static_cast<uint32_t>(middle - begin);
}

// The binary node's grandchildren, the largest opened first, become one node of four.
int32_t Builder::collapse(int32_t root) {
  int32_t children[4] = {root};
  int n = 1;
  while (n < 4) {
    int pick = -1;
    double area = -1;
    for (int i = 0; i < n; ++i) {
      const BinaryNode& c = nodes_[static_cast<size_t>(children[i])];
      if (c.left >= 0 && c.box.half_area() > area) {
        pick = i;
        area = c.box.half_area();
      }
    }
    if (pick < 0) break;
    const BinaryNode& c = nodes_[static_cast<size_t>(children[pick])];
    children[n++] = c.right;
    children[pick] = c.left;
  }
  const size_t self = wide.size();
  wide.emplace_back();
  for (int i = 0; i < 4; ++i) {
    Box box;  // empty: never met
    int32_t first = 0, count = 0;
    if (i < n) {
      const BinaryNode c = nodes_[static_cast<size_t>(children[i])];
      box = c.box;
      count = c.left >= 0 ? -1 : static_cast<int32_t>(c.count);
      first = c.left >= 0 ? collapse(children[i]) : static_cast<int32_t>(c.first);
    }
    for (int axis = 0; axis < 3; ++axis) {
      wide[self].bound[axis][i] = box.lower[axis];
      wide[self].bound[3 + axis][i] = box.upper[axis];
    }
    wide[self].first[i] = first;
    wide[self].count[i] = count;
  }
  return static_cast<int32_t>(self);
}

// A primitive in leaf order, with what the triangle test needs beside it.
struct Entry {
  Vec3 a, b, c;
  uint32_t primitive;
  PrimitiveKind kind;
};

// What a search carries: the ray, moved off its surface, and the best so far.
struct Search {
  Ray ray;
  Shear shear;
  uint32_t from = ~0u;     // primitive the ray leaves
  uint32_t ignored = ~0u;  // primitive the shadow ray ends on
  double limit = HUGE_VAL;
  Meeting best;
  uint32_t primitive = ~0u;
  explicit Search(const Ray& r) : ray(r), shear(r.direction) {}
};

class DoubleBvh final : public RayCaster {
 public:
  explicit DoubleBvh(const World& world) : world_(world) {
    Builder builder(world);
    nodes_ = std::move(builder.wide);
    for (uint32_t i : builder.order) {
      const Primitive& p = world.primitives()[i];
      entries_.push_back({p.a, p.b, p.c, i, p.kind});
    }
    wide_vectors_ = __builtin_cpu_supports("avx2");
  }

  Hit closest(const Ray& ray, const Hit* from) const override {
    Search s(ray);
    start(s, from);
    run<false>(s);
    if (s.primitive == ~0u) return Hit();
    Ray moved = ray;
    moved.origin = s.ray.origin;
    return finish_hit(world_, s.primitive, moved, s.best);
  }

  bool occluded(const Ray& ray, double distance, const Hit* from,
                const Hit* to_hit) const override {
    Search s(ray);
    start(s, from);
    s.limit = distance;
    if (to_hit) {
      // The segment ends as far before its surface as it starts off the other one.
      s.ignored = to_hit->primitive;
      const Vec3 end = leave_surface(to_hit->position, to_hit->normal, -ray.direction);
      s.limit = glm::length(end - s.ray.origin);
    }
    return run<true>(s);
  }

 private:
  static void start(Search& s, const Hit* from) {
    if (!from) return;
    s.from = from->primitive;
    s.ray.origin = leave_surface(from->position, from->normal, s.ray.direction);
  }

  template <bool any>
  bool run(Search& s) const {
    return wide_vectors_ ? walk_avx2<any>(s) : walk_sse2<any>(s);
  }
  template <bool any>
  __attribute__((target("avx2"))) bool walk_avx2(Search& s) const {
    return walk<any>(s);
  }
  template <bool any>
  bool walk_sse2(Search& s) const {
    return walk<any>(s);
  }
  template <bool any>
  __attribute__((always_inline)) inline bool walk(Search& s) const;
  // True when the search is over.
  template <bool any>
  __attribute__((always_inline)) inline bool visit_leaf(Search& s, int32_t first,
                                                        int32_t count) const;

  const World& world_;
  std::vector<Node> nodes_;
  std::vector<Entry> entries_;
  bool wide_vectors_ = false;
};

template <bool any>
inline bool DoubleBvh::visit_leaf(Search& s, int32_t first, int32_t count) const {
  for (int32_t i = first; i < first + count; ++i) {
    const Entry& e = entries_[static_cast<size_t>(i)];
    if (e.primitive == s.ignored) continue;
    const bool leaving = e.primitive == s.from;
    Meeting m;
    bool met = false;
    if (e.kind == PrimitiveKind::kTriangle) {
      met = !leaving && meet_triangle(e.a, e.b, e.c, s.ray.origin, s.shear, m);
    } else {
      const Primitive& p = world_.primitives()[e.primitive];
      met = e.kind == PrimitiveKind::kSphere
                ? meet_sphere(p, s.ray.origin, s.ray.direction, leaving, m)
                : !leaving && meet_disk(p, s.ray.origin, s.ray.direction, m);
    }
    if (!met || m.t > s.limit) continue;
    if (any) return true;
    if (m.t == s.limit && e.primitive > s.primitive) continue;
    s.limit = m.t;
    s.best = m;
    s.primitive = e.primitive;
  }
  return false;
}

template <bool any>
inline bool DoubleBvh::walk(Search& s) const {
  typedef double Four __attribute__((vector_size(32)));
  typedef int64_t Mask __attribute__((vector_size(32)));
  Four origin[3], inverse[3];
  int near[3], far[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double d = s.ray.direction[axis], o = s.ray.origin[axis];
    // A finite stand-in for the infinite slope of a parallel ray: 0 * slope stays 0.
    const double inv = d == 0 ? 0x1p1000 : 1.0 / d;
    origin[axis] = Four{o, o, o, o};
    inverse[axis] = Four{inv, inv, inv, inv};
    near[axis] = inv < 0 ? 3 + axis : axis;
    far[axis] = inv < 0 ? axis : 3 + axis;
  }
  // Three roundings on either side of a slab's distance.
  constexpr double kSlack = 1 + 0x1p-50;
  const Four slack = {kSlack, kSlack, kSlack, kSlack};
  const Four zero = {0, 0, 0, 0};

  struct Pending {
    double t;
    int32_t first, count;
  };
  Pending stack[256];
  int top = 0;
  int32_t node = 0;
  for (;;) {
    const Node& n = nodes_[static_cast<size_t>(node)];
    const Four x0 = (*reinterpret_cast<const Four*>(n.bound[near[0]]) - origin[0]) * inverse[0];
    const Four y0 = (*reinterpret_cast<const Four*>(n.bound[near[1]]) - origin[1]) * inverse[1];
    const Four z0 = (*reinterpret_cast<const Four*>(n.bound[near[2]]) - origin[2]) * inverse[2];
    const Four x1 = (*reinterpret_cast<const Four*>(n.bound[far[0]]) - origin[0]) * inverse[0];
    const Four y1 = (*reinterpret_cast<const Four*>(n.bound[far[1]]) - origin[1]) * inverse[1];
    const Four z1 = (*reinterpret_cast<const Four*>(n.bound[far[2]]) - origin[2]) * inverse[2];
    Four t0 = x0 > y0 ? x0 : y0;
    t0 = t0 > z0 ? t0 : z0;
    t0 = t0 > zero ? t0 : zero;
    Four t1 = x1 < y1 ? x1 : y1;
    t1 = (t1 < z1 ? t1 : z1) * slack;
    const Four limit = {s.limit, s.limit, s.limit, s.limit};
    t1 = t1 < limit ? t1 : limit;
    const Mask hit = t0 <= t1;
    // Children onto the stack, the nearest on top.
    const int base = top;
    for (int i = 0; i < 4; ++i) {
      if (!hit[i] || n.count[i] == 0) continue;
      int at = top++;
      while (at > base && stack[at - 1].t < t0[i]) {
        stack[at] = stack[at - 1];
        --at;
      }
      stack[at] = {t0[i], n.first[i], n.count[i]};
    }
    for (;;) {
      if (top == 0) return any ? false : s.primitive != ~0u;
      const Pending p = stack[--top];
      if (p.t > s.limit) continue;
      if (p.count < 0) {
        node = p.first;
        break;
      }
      if (visit_leaf<any>(s, p.first, p.count)) return true;
    }
  }
}

}  // namespace

std::unique_ptr<RayCaster> make_double_bvh(const World& world) {
  return std::make_unique<DoubleBvh>(world);
}

}  // namespace photonloom
