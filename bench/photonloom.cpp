// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>
#include <new>

#include "bench/contender.hpp"
#include "golden/unit/gather_search.hpp"
#include "golden/unit/photon_map.hpp"

namespace photonloom::bench {
namespace {

class Golden final : public Contender {
 public:
  Golden(const std::vector<UVec3>& points, const GoldenSearch& how)
      : level_(search::chosen_level()),
        leaf_limit_(how.leaf_limit == 0 ? search::Settings{}.leaf_limit : how.leaf_limit) {
    plan_.bucket = static_cast<int>(how.bucket);
    std::vector<PackedPhoton> photons(points.size());
    for (size_t i = 0; i < points.size(); ++i) photons[i].position = points[i];
    const double start = now();
    map_ = build_photon_map(photons, plan_);
    MapPlan map_plan;
    map_plan.r2_max = plan_.r2_limit();
    fast_ = std::make_unique<search::Map>(map_, plan_, map_plan);
    seconds_ = now() - start;
  }

  std::string library() const override { return "photonloom"; }
  std::string configuration() const override { return level_.name; }
  double build_seconds() const override { return seconds_; }
  double bytes_per_point() const override {
    const search::MapView& view = fast_->view();
    // Powers and directions are not read where only the nearest photons are asked for.
    return static_cast<double>(fast_->search_bytes()) / static_cast<double>(view.count);
  }
  uint32_t number(uint32_t index) const override { return map_.source[index]; }
  void search(const std::vector<UVec3>& queries, size_t begin, size_t end, int64_t r2_max,
              Found& found) const override {
    search::MapView view = fast_->view();
    if (r2_max >= 0) view.r2_max = static_cast<uint64_t>(r2_max);
    search::Settings settings;
    settings.k = found.k;
    settings.leaf_limit = leaf_limit_;
    const search::Search search = level_.search[0][0][0];
    const uint64_t mask = (uint64_t{1} << view.index_bits) - 1;
    const auto keys = aligned_keys();
    search::QueryView some[search::kGroup];
    search::Outcome outcomes[search::kGroup];
    for (size_t i = begin; i < end; i += search::kGroup) {
      const uint32_t n = static_cast<uint32_t>(std::min<size_t>(search::kGroup, end - i));
      for (uint32_t j = 0; j < n; ++j)
        some[j] = {{queries[i + j][0], queries[i + j][1], queries[i + j][2]}, {0, 0, 0}};
      search(view, settings, some, n, keys.get(), outcomes);
      for (uint32_t j = 0; j < n; ++j) {
        const uint64_t* const key = keys.get() + j * search::kKeys;
        uint32_t* const index = &found.index[(i + j) * found.k];
        const uint32_t count = outcomes[j].count;
        for (uint32_t l = 0; l < count; ++l) index[l] = static_cast<uint32_t>(key[l] & mask);
        found.count[i + j] = count;
        found.r2[i + j] = static_cast<double>(count == found.k ? key[found.k - 1] >> view.index_bits
                                                               : view.r2_max);
      }
    }
  }

 private:
  struct Free {
    void operator()(uint64_t* keys) const { ::operator delete[](keys, std::align_val_t{64}); }
  };
  static std::unique_ptr<uint64_t[], Free> aligned_keys() {
    return std::unique_ptr<uint64_t[], Free>(static_cast<uint64_t*>(
        ::operator new[](search::kGroup* search::kKeys * sizeof(uint64_t), std::align_val_t{64})));
  }

  Plan plan_;
  const search::Level& level_;
  uint32_t leaf_limit_;
  PhotonMap map_;
  std::unique_ptr<search::Map> fast_;
  double seconds_;
};

}  // namespace

std::unique_ptr<Contender> make_photonloom(const std::vector<UVec3>& points,
                                           const GoldenSearch& how) {
  return std::make_unique<Golden>(points, how);
}

}  // namespace photonloom::bench
