// SPDX-License-Identifier: Apache-2.0
#include "golden/unit/reference_gather.hpp"

#include <oneapi/tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "golden/numeric/elementary.hpp"

namespace photonloom {
namespace {

constexpr size_t kParallelItems = 8192;  // ranges below this are built by one task

double length2(const Vec3& v) { return v.x * v.x + v.y * v.y + v.z * v.z; }

size_t middle_of(size_t begin, size_t end) { return begin + (end - begin) / 2; }

}  // namespace

// One search. The list is a heap with the k-th on top. Rounding is monotone, so the d^2 of a
// subtree, computed like a photon's from offsets that are at most the photon's, never exceeds it.
class ReferenceGather::Finder {
 public:
  Finder(const ReferenceGather& gather, const Vec3& position, const Vec3& normal, int k,
         double r2_max, std::vector<ReferenceNeighbour>& found)
      : gather_(gather),
        position_(position),
        normal_(normal),
        k_(static_cast<size_t>(k)),
        bound_(r2_max),
        found_(found) {}

  void visit(size_t begin, size_t end, const Vec3& offset) {
    if (end - begin <= gather_.leaf_) {
      for (size_t i = begin; i < end; ++i) consider(gather_.items_[i]);
      return;
    }
    const size_t middle = middle_of(begin, end);
    const Item& at = gather_.items_[middle];
    const int axis = static_cast<int>(at.axis);
    const double away = position_[axis] - at.position[axis];
    if (away >= 0) {
      visit(middle + 1, end, offset);
    } else {
      visit(begin, middle, offset);
    }
    Vec3 far = offset;
    far[axis] = std::fabs(away);
    if (!(length2(far) <= bound_)) return;
    consider(at);
    if (away >= 0) {
      visit(begin, middle, far);
    } else {
      visit(middle + 1, end, far);
    }
  }

 private:
  void consider(const Item& item) {
    const ReferenceNeighbour candidate{length2(item.position - position_), item.index};
    if (!(candidate.d2 <= bound_)) return;
    if (found_.size() == k_ && !(candidate < found_.front())) return;
    const Vec3& direction = gather_.photons_[item.index].direction;
    if (!(direction.x * normal_.x + direction.y * normal_.y + direction.z * normal_.z > 0)) return;
    if (found_.size() == k_) {
      std::pop_heap(found_.begin(), found_.end());
      found_.back() = candidate;
    } else {
      found_.push_back(candidate);
    }
    std::push_heap(found_.begin(), found_.end());
    if (found_.size() == k_) bound_ = found_.front().d2;
  }

  const ReferenceGather& gather_;
  Vec3 position_, normal_;
  size_t k_;
  double bound_;
  std::vector<ReferenceNeighbour>& found_;
};

ReferenceGather::ReferenceGather(std::vector<Photon> photons, ReferenceTree tree)
    : photons_(std::move(photons)), leaf_(tree == ReferenceTree::kNodes ? 1 : 8) {
  items_.resize(photons_.size());
  for (size_t i = 0; i < items_.size(); ++i)
    items_[i] = {photons_[i].position, static_cast<uint32_t>(i), 0};
  build(0, items_.size());
}

void ReferenceGather::build(size_t begin, size_t end) {
  if (end - begin <= leaf_) return;
  const auto first = items_.begin() + static_cast<std::ptrdiff_t>(begin);
  const auto last = items_.begin() + static_cast<std::ptrdiff_t>(end);
  Vec3 low = first->position, high = low;
  for (auto i = first; i != last; ++i) {
    low = glm::min(low, i->position);
    high = glm::max(high, i->position);
  }
  const Vec3 size = high - low;
  const uint32_t axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
  const size_t middle = middle_of(begin, end);
  const auto at = items_.begin() + static_cast<std::ptrdiff_t>(middle);
  std::nth_element(first, at, last, [axis](const Item& a, const Item& b) {
    const int c = static_cast<int>(axis);
    return std::tie(a.position[c], a.index) < std::tie(b.position[c], b.index);
  });
  at->axis = axis;
  const auto left = [&] { build(begin, middle); };
  const auto right = [&] { build(middle + 1, end); };
  if (end - begin >= kParallelItems) {
    tbb::parallel_invoke(left, right);
  } else {
    left();
    right();
  }
}

void ReferenceGather::find(const Vec3& position, const Vec3& normal, int k, double r2_max,
                           std::vector<ReferenceNeighbour>& found) const {
  found.clear();
  Finder(*this, position, normal, k, r2_max, found).visit(0, items_.size(), Vec3(0));
  std::sort_heap(found.begin(), found.end());
}

Rgb ReferenceGather::flux(std::span<const ReferenceNeighbour> found) const {
  Rgb sum(0);
  for (const ReferenceNeighbour& n : found) sum += photons_[n.index].power;
  return sum;
}

Rgb ReferenceGather::irradiance(std::span<const ReferenceNeighbour> found, int k, double r2_max,
                                double r2_floor, Kernel kernel) const {
  const double r2 = radius2(found, k, r2_max);
  if (std::isinf(r2)) return Rgb(0);
  const double divisor = r2 > r2_floor ? r2 : r2_floor;
  Rgb sum(0);
  if (kernel == Kernel::kFlat) {
    const bool full = found.size() == static_cast<size_t>(k);
    sum = flux(found) * (full ? static_cast<double>(k - 1) / static_cast<double>(k) : 1.0);
  } else {
    for (const ReferenceNeighbour& n : found)
      sum += photons_[n.index].power * (2.0 * (1.0 - n.d2 / divisor));
  }
  return sum / (kPi * divisor);
}

std::vector<Photon> in_map_order(std::span<const Photon> photons, const PhotonMap& map) {
  std::vector<Photon> ordered(map.count);
  for (uint64_t i = 0; i < map.count; ++i) ordered[i] = photons[map.source[i]];
  return ordered;
}

}  // namespace photonloom
