// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <nanoflann.hpp>

#include "bench/contender.hpp"

namespace photonloom::bench {
namespace {

struct Cloud {
  std::vector<float> coordinates;
  size_t kdtree_get_point_count() const { return coordinates.size() / 3; }
  float kdtree_get_pt(size_t i, size_t axis) const { return coordinates[3 * i + axis]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud,
                                                 3, uint32_t>;

// A sorted list, as the library's KNNResultSet, with a first bound.
class SortedSet {
 public:
  SortedSet(uint32_t k, uint32_t* index, float* d2, float bound)
      : k_(k), bound_(bound), index_(index), d2_(d2) {}
  bool addPoint(float d2, uint32_t index) {
    uint32_t i = count_;
    for (; i > 0 && d2_[i - 1] > d2; --i)
      if (i < k_) {
        d2_[i] = d2_[i - 1];
        index_[i] = index_[i - 1];
      }
    if (i < k_) {
      d2_[i] = d2;
      index_[i] = index;
    }
    if (count_ < k_) ++count_;
    if (count_ == k_) bound_ = d2_[k_ - 1];
    return true;
  }
  float worstDist() const { return bound_; }
  bool full() const { return count_ == k_; }
  bool empty() const { return count_ == 0; }
  size_t size() const { return count_; }
  void sort() {}
  uint32_t finish() const { return count_; }
  float last() const { return bound_; }

 private:
  uint32_t k_, count_ = 0;
  float bound_;
  uint32_t* index_;
  float* d2_;
};

// A bounded heap.
class HeapSet {
 public:
  HeapSet(uint32_t k, uint32_t* index, float* d2, float bound)
      : k_(k), bound_(bound), index_(index), d2_(d2) {
    entries().clear();
  }
  bool addPoint(float d2, uint32_t index) {
    auto& heap = entries();
    if (heap.size() == k_) {
      if (d2 >= heap.front().first) return true;
      std::pop_heap(heap.begin(), heap.end());
      heap.back() = {d2, index};
    } else {
      heap.emplace_back(d2, index);
    }
    std::push_heap(heap.begin(), heap.end());
    if (heap.size() == k_) bound_ = heap.front().first;
    return true;
  }
  float worstDist() const { return bound_; }
  bool full() const { return entries().size() == k_; }
  bool empty() const { return entries().empty(); }
  size_t size() const { return entries().size(); }
  void sort() {}
  uint32_t finish() const {
    const auto& heap = entries();
    for (size_t i = 0; i < heap.size(); ++i) {
      d2_[i] = heap[i].first;
      index_[i] = heap[i].second;
    }
    return static_cast<uint32_t>(heap.size());
  }
  float last() const { return bound_; }

 private:
  static std::vector<std::pair<float, uint32_t>>& entries() {
    static std::vector<std::pair<float, uint32_t>> heap;
    return heap;
  }
  uint32_t k_;
  float bound_;
  uint32_t* index_;
  float* d2_;
};

struct Built {
  Cloud cloud;
  std::unique_ptr<Tree> tree;
  double seconds = 0, bytes = 0;
};

template <class Set>
class Nanoflann final : public Contender {
 public:
  Nanoflann(std::shared_ptr<Built> built, int leaf, const char* set)
      : built_(std::move(built)), leaf_(leaf), set_(set) {}
  std::string library() const override { return "nanoflann"; }
  std::string configuration() const override {
    return "leaf " + std::to_string(leaf_) + ", " + set_;
  }
  double build_seconds() const override { return built_->seconds; }
  double bytes_per_point() const override {
    return built_->bytes / static_cast<double>(built_->cloud.kdtree_get_point_count());
  }
  void search(const std::vector<UVec3>& queries, size_t begin, size_t end, int64_t r2_max,
              Found& found) const override {
    // A point at the bound is not taken, so the bound is the next float.
    const float infinity = std::numeric_limits<float>::infinity();
    const float bound = r2_max < 0 ? std::numeric_limits<float>::max()
                                   : std::nextafter(static_cast<float>(r2_max), infinity);
#if NANOFLANN_VERSION >= 0x150
    const nanoflann::SearchParameters parameters(0, false);
#else
    const nanoflann::SearchParams parameters(32, 0, false);
#endif
    for (size_t i = begin; i < end; ++i) {
      const float query[3] = {static_cast<float>(queries[i][0]), static_cast<float>(queries[i][1]),
                              static_cast<float>(queries[i][2])};
      Set set(found.k, &found.index[i * found.k], &found.d2[i * found.k], bound);
      built_->tree->findNeighbors(set, query, parameters);
      found.count[i] = set.finish();
      found.r2[i] =
          found.count[i] == found.k ? static_cast<double>(set.last()) : static_cast<double>(r2_max);
    }
  }

 private:
  std::shared_ptr<Built> built_;
  int leaf_;
  std::string set_;
};

}  // namespace

void add_nanoflann(const std::vector<UVec3>& points, Contenders& to) {
  for (int leaf : {8, 16, 32}) {
    auto built = std::make_shared<Built>();
    for (const UVec3& p : points)
      for (uint32_t c : p) built->cloud.coordinates.push_back(static_cast<float>(c));
    const double start = now();
    built->tree = std::make_unique<Tree>(
        3, built->cloud, nanoflann::KDTreeSingleIndexAdaptorParams(static_cast<size_t>(leaf)));
    built->seconds = now() - start;
    built->bytes = static_cast<double>(built->tree->usedMemory(*built->tree)) +
                   static_cast<double>(points.size()) * 3 * sizeof(float);
    to.push_back(std::make_unique<Nanoflann<SortedSet>>(built, leaf, "sorted list"));
    to.push_back(std::make_unique<Nanoflann<HeapSet>>(built, leaf, "heap"));
  }
}

}  // namespace photonloom::bench
