// SPDX-License-Identifier: Apache-2.0
// Bounding volume hierarchy in double: built by binned SAH (Wald 2007), four children a node, boxes
// of a node tested together. Of equally near primitives the lowest number is hit, so results do not
// depend on the order of visits. Each group of instances has a hierarchy of its own, in its own
// space; the triangles in its leaves are tested where they stand in the world, as explicit copies
// would be.
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

// A primitive, or an instance.
struct Reference {
  Box box;
  Vec3 centre;
  uint32_t number;
  bool is_instance = false;
};

struct BinaryNode {
  Box box;
  int32_t left = -1, right = -1;  // inner
  uint32_t first = 0, count = 0;  // leaf
};

class Builder {
 public:
  // Of primitives; of the world with all instances.
  Builder(const World& world, World::Range range, bool with_instances) {
    references_.reserve(range.end - range.begin);
    for (uint32_t i = range.begin; i < range.end; ++i) {
      Reference r;
      primitive_bounds(world.primitives()[i], r.box.lower, r.box.upper);
      r.centre = (r.box.lower + r.box.upper) * 0.5;
      r.number = i;
      references_.push_back(r);
    }
    for (uint32_t i = 0; with_instances && i < world.instances().size(); ++i) {
      const PlacedGroup& g = world.instances()[i];
      references_.push_back({{g.lower, g.upper}, (g.lower + g.upper) * 0.5, i, true});
    }
    nodes_.reserve(2 * references_.size());
    split(0, static_cast<uint32_t>(references_.size()), 0);
    collapse(0);
    nodes_ = {};
  }
  std::vector<Node> wide;
  const std::vector<Reference>& order() const { return references_; }

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

enum class EntryKind : uint8_t { kTriangle, kRound, kInstance };

// A primitive or instance in leaf order, with what the triangle test needs beside it.
struct Entry {
  Vec3 a, b, c;
  uint32_t number;
  EntryKind kind;
};

struct Tree {
  std::vector<Node> nodes;
  std::vector<Entry> entries;
  double reach = 0;  // largest coordinate of its box
};

constexpr uint32_t kNoNumber = ~0u;

// What a search carries: the ray, moved off its surface, and the best so far.
struct Search {
  // A primitive, of an instance where it is a group's.
  struct Which {
    uint32_t primitive = kNoNumber, instance = kNoNumber;
    bool operator==(const Which&) const = default;
    bool operator<(const Which& other) const {
      return primitive != other.primitive ? primitive < other.primitive : instance < other.instance;
    }
  };
  Ray ray;
  Shear shear;
  Which from;     // that the ray leaves
  Which ignored;  // that the shadow ray ends on
  double limit = HUGE_VAL;
  Meeting best;
  Which found;
  explicit Search(const Ray& r) : ray(r), shear(r.direction) {}
};

// Where a search goes through a tree: the ray in the tree's space, at the world's speed, and the
// error of its coordinates there.
struct Passage {
  const Tree* tree;
  Vec3 origin, direction;
  double slack = 0;
  uint32_t instance = kNoNumber;
};

class DoubleBvh final : public RayCaster {
 public:
  explicit DoubleBvh(const World& world) : world_(world), groups_(world.groups().size()) {
    plant(tree_, world.world_primitives(), true);
    for (size_t g = 0; g < groups_.size(); ++g) plant(groups_[g], world.groups()[g], false);
    wide_vectors_ = __builtin_cpu_supports("avx2");
  }

  Hit closest(const Ray& ray, const Hit* from) const override {
    Search s(ray);
    start(s, from);
    run<false>(s, whole(s));
    if (s.found.primitive == kNoNumber) return Hit();
    Ray moved = ray;
    moved.origin = s.ray.origin;
    return finish_hit(world_, s.found.primitive, moved, s.best, s.found.instance);
  }

  bool occluded(const Ray& ray, double distance, const Hit* from,
                const Hit* to_hit) const override {
    Search s(ray);
    start(s, from);
    s.limit = distance;
    if (to_hit) {
      if (own_wall_before(world_, ray, from, *to_hit)) return true;
      // The segment ends as far before its surface as it starts off the other one.
      s.ignored = {to_hit->primitive, to_hit->instance};
      const Vec3 end = leave_surface(to_hit->position, to_hit->normal, -ray.direction);
      s.limit = glm::length(end - s.ray.origin);
    }
    return run<true>(s, whole(s));
  }

 private:
  void plant(Tree& tree, World::Range range, bool with_instances) const {
    Builder builder(world_, range, with_instances);
    tree.nodes = std::move(builder.wide);
    tree.entries.reserve(builder.order().size());
    for (const Reference& r : builder.order()) {
      const Vec3 reach = glm::max(glm::abs(r.box.lower), glm::abs(r.box.upper));
      tree.reach = std::max(tree.reach, max_component(reach));
      if (r.is_instance) {
        tree.entries.push_back({Vec3(0), Vec3(0), Vec3(0), r.number, EntryKind::kInstance});
        continue;
      }
      const Primitive& p = world_.primitives()[r.number];
      tree.entries.push_back(
          {p.a, p.b, p.c, r.number,
           p.kind == PrimitiveKind::kTriangle ? EntryKind::kTriangle : EntryKind::kRound});
    }
  }

  Passage whole(const Search& s) const { return {&tree_, s.ray.origin, s.ray.direction}; }
  // Through an instance: its boxes are met with room for all rounding of the way there.
  Passage through(const Search& s, uint32_t instance) const {
    const PlacedGroup& g = world_.instances()[instance];
    Passage p;
    p.tree = &groups_[g.group];
    p.instance = instance;
    p.origin = Vec3(g.to_group * glm::dvec4(s.ray.origin, 1));
    p.direction = glm::dmat3(g.to_group) * s.ray.direction;
    double size = p.tree->reach;
    for (int row = 0; row < 3; ++row) {
      double sum = std::fabs(g.to_group[3][row]);
      for (int column = 0; column < 3; ++column)
        sum += std::fabs(g.to_group[column][row] * s.ray.origin[column]);
      size = std::max(size, sum);
    }
    p.slack = size * 0x1p-46;
    return p;
  }

  static void start(Search& s, const Hit* from) {
    if (!from) return;
    s.from = {from->primitive, from->instance};
    s.ray.origin = leave_surface(from->position, from->normal, s.ray.direction);
  }

  template <bool any>
  bool run(Search& s, const Passage& passage) const {
    return wide_vectors_ ? walk_avx2<any>(s, passage) : walk_sse2<any>(s, passage);
  }
  template <bool any>
  __attribute__((target("avx2"))) bool walk_avx2(Search& s, const Passage& passage) const {
    return walk<any>(s, passage);
  }
  template <bool any>
  bool walk_sse2(Search& s, const Passage& passage) const {
    return walk<any>(s, passage);
  }
  template <bool any>
  __attribute__((always_inline)) inline bool walk(Search& s, const Passage& passage) const;
  // True when the search is over.
  template <bool any>
  __attribute__((always_inline)) inline bool visit_leaf(Search& s, const Passage& passage,
                                                        int32_t first, int32_t count) const;
  template <bool any>
  __attribute__((noinline)) bool visit_instance(Search& s, uint32_t instance) const {
    return run<any>(s, through(s, instance)) && any;
  }

  const World& world_;
  Tree tree_;
  std::vector<Tree> groups_;
  bool wide_vectors_ = false;
};

template <bool any>
inline bool DoubleBvh::visit_leaf(Search& s, const Passage& passage, int32_t first,
                                  int32_t count) const {
  for (int32_t i = first; i < first + count; ++i) {
    const Entry& e = passage.tree->entries[static_cast<size_t>(i)];
    if (e.kind == EntryKind::kInstance) {
      if (visit_instance<any>(s, e.number)) return true;
      continue;
    }
    const Search::Which which{e.number, passage.instance};
    if (which == s.ignored) continue;
    const bool leaving = which == s.from;
    Meeting m;
    bool met = false;
    if (e.kind == EntryKind::kRound) {
      met = meet_round(world_.primitives()[e.number], s.ray.origin, s.ray.direction, leaving, m);
    } else if (passage.instance == kNoNumber) {
      met = !leaving && meet_triangle(e.a, e.b, e.c, s.ray.origin, s.shear, m);
    } else if (!leaving) {
      const Mat4& to_world = world_.instances()[passage.instance].to_world;
      const auto carried = [&](const Vec3& v) { return Vec3(to_world * glm::dvec4(v, 1)); };
      met = meet_triangle(carried(e.a), carried(e.b), carried(e.c), s.ray.origin, s.shear, m);
    }
    if (!met || m.t > s.limit) continue;
    if (any) return true;
    if (m.t == s.limit && s.found < which) continue;
    s.limit = m.t;
    s.best = m;
    s.found = which;
  }
  return false;
}

template <bool any>
inline bool DoubleBvh::walk(Search& s, const Passage& passage) const {
  typedef double Four __attribute__((vector_size(32)));
  typedef int64_t Mask __attribute__((vector_size(32)));
  const Node* nodes = passage.tree->nodes.data();
  Four near_origin[3], far_origin[3], inverse[3];
  int near[3], far[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double d = passage.direction[axis], o = passage.origin[axis];
    // A finite stand-in for the infinite slope of a parallel ray: 0 * slope stays 0.
    const double inv = d == 0 ? 0x1p1000 : 1.0 / d;
    // Boxes grow by the slack.
    const double n = inv < 0 ? o - passage.slack : o + passage.slack;
    const double f = inv < 0 ? o + passage.slack : o - passage.slack;
    near_origin[axis] = Four{n, n, n, n};
    far_origin[axis] = Four{f, f, f, f};
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
    const Node& n = nodes[static_cast<size_t>(node)];
    const Four x0 =
        (*reinterpret_cast<const Four*>(n.bound[near[0]]) - near_origin[0]) * inverse[0];
    const Four y0 =
        (*reinterpret_cast<const Four*>(n.bound[near[1]]) - near_origin[1]) * inverse[1];
    const Four z0 =
        (*reinterpret_cast<const Four*>(n.bound[near[2]]) - near_origin[2]) * inverse[2];
    const Four x1 = (*reinterpret_cast<const Four*>(n.bound[far[0]]) - far_origin[0]) * inverse[0];
    const Four y1 = (*reinterpret_cast<const Four*>(n.bound[far[1]]) - far_origin[1]) * inverse[1];
    const Four z1 = (*reinterpret_cast<const Four*>(n.bound[far[2]]) - far_origin[2]) * inverse[2];
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
      if (top == 0) return any ? false : s.found.primitive != kNoNumber;
      const Pending p = stack[--top];
      if (p.t > s.limit) continue;
      if (p.count < 0) {
        node = p.first;
        break;
      }
      if (visit_leaf<any>(s, passage, p.first, p.count)) return true;
    }
  }
}

}  // namespace

std::unique_ptr<RayCaster> make_double_bvh(const World& world) {
  return std::make_unique<DoubleBvh>(world);
}

}  // namespace photonloom
