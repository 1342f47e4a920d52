// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <flann/flann.hpp>
#include <limits>

#include "bench/contender.hpp"

namespace photonloom::bench {
namespace {

using Index = flann::KDTreeSingleIndex<flann::L2_3D<float>>;

struct Built {
  std::vector<float> coordinates;
  std::unique_ptr<Index> index;
  double seconds = 0, bytes = 0;
};

class Flann final : public Contender {
 public:
  Flann(std::shared_ptr<Built> built, int leaf, bool heap)
      : built_(std::move(built)), leaf_(leaf), heap_(heap) {}
  std::string library() const override { return "FLANN"; }
  std::string configuration() const override {
    return "leaf " + std::to_string(leaf_) + (heap_ ? ", heap" : ", sorted list");
  }
  double build_seconds() const override { return built_->seconds; }
  double bytes_per_point() const override {
    return built_->bytes / (static_cast<double>(built_->coordinates.size()) / 3);
  }
  void search(const std::vector<UVec3>& queries, size_t begin, size_t end, int64_t r2_max,
              Found& found) const override {
    flann::SearchParams parameters(flann::FLANN_CHECKS_UNLIMITED, 0, false);
    parameters.use_heap = heap_ ? flann::FLANN_True : flann::FLANN_False;
    // A point at the bound is not taken, so the bound is the next float.
    const float bound = r2_max < 0 ? std::numeric_limits<float>::max()
                                   : std::nextafter(static_cast<float>(r2_max),
                                                    std::numeric_limits<float>::infinity());
    std::vector<size_t> index(found.k);
    for (size_t i = begin; i < end; ++i) {
      const float query[3] = {static_cast<float>(queries[i][0]), static_cast<float>(queries[i][1]),
                              static_cast<float>(queries[i][2])};
      float* const d2 = &found.d2[i * found.k];
      // The library's own result sets, without its copies between matrices.
      if (r2_max < 0 && heap_) {
        flann::KNNResultSet2<float> set(found.k);
        finish(set, query, parameters, index, d2, i, r2_max, found);
      } else if (r2_max < 0) {
        flann::KNNSimpleResultSet<float> set(found.k);
        finish(set, query, parameters, index, d2, i, r2_max, found);
      } else {
        flann::KNNRadiusResultSet<float> set(bound, found.k);
        finish(set, query, parameters, index, d2, i, r2_max, found);
      }
    }
  }

 private:
  template <class Set>
  void finish(Set& set, const float* query, const flann::SearchParams& parameters,
              std::vector<size_t>& index, float* d2, size_t i, int64_t r2_max, Found& found) const {
    built_->index->findNeighbors(set, query, parameters);
    const size_t n = std::min<size_t>(set.size(), found.k);
    set.copy(index.data(), d2, n, false);
    for (size_t j = 0; j < n; ++j) found.index[i * found.k + j] = static_cast<uint32_t>(index[j]);
    found.count[i] = static_cast<uint32_t>(n);
    found.r2[i] = static_cast<double>(n == found.k ? set.worstDist() : static_cast<float>(r2_max));
  }

  std::shared_ptr<Built> built_;
  int leaf_;
  bool heap_;
};

}  // namespace

void add_flann(const std::vector<UVec3>& points, Contenders& to) {
  for (int leaf : {8, 16, 32}) {
    auto built = std::make_shared<Built>();
    for (const UVec3& p : points)
      for (uint32_t c : p) built->coordinates.push_back(static_cast<float>(c));
    const double heap_before = heap_bytes(), start = now();
    built->index =
        std::make_unique<Index>(flann::Matrix<float>(built->coordinates.data(), points.size(), 3),
                                flann::KDTreeSingleIndexParams(leaf, true));
    built->index->buildIndex();
    built->seconds = now() - start;
    built->bytes = heap_bytes() - heap_before;
    to.push_back(std::make_unique<Flann>(built, leaf, false));
    to.push_back(std::make_unique<Flann>(built, leaf, true));
  }
}

}  // namespace photonloom::bench
