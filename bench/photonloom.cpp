// SPDX-License-Identifier: Apache-2.0
#include "bench/contender.hpp"
#include "golden/unit/gather_search.hpp"
#include "golden/unit/photon_map.hpp"

namespace photonloom::bench {
namespace {

class Golden final : public Contender {
 public:
  explicit Golden(const std::vector<UVec3>& points) : level_(search::chosen_level()) {
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
    const double slots = static_cast<double>(view.lines) * view.bucket;
    // Powers and directions are not read where only the nearest photons are asked for; the numbers
    // that the photons had in the input are.
    return (static_cast<double>(fast_->search_bytes()) + slots * sizeof(uint32_t)) /
           static_cast<double>(view.count);
  }
  void search(const std::vector<UVec3>& queries, size_t begin, size_t end, int64_t r2_max,
              Found& found) const override {
    search::MapView view = fast_->view();
    if (r2_max >= 0) view.r2_max = static_cast<uint64_t>(r2_max);
    search::Settings settings;
    settings.k = found.k;
    const search::Search search = level_.search[0][0][0];
    const uint64_t mask = (uint64_t{1} << view.index_bits) - 1;
    alignas(64) uint64_t keys[search::kKeys];
    for (size_t i = begin; i < end; ++i) {
      const search::QueryView query{{queries[i][0], queries[i][1], queries[i][2]}, {0, 0, 0}};
      const search::Outcome outcome = search(view, settings, query, keys);
      uint32_t* const index = &found.index[i * found.k];
      for (uint32_t j = 0; j < outcome.count; ++j) index[j] = map_.source[keys[j] & mask];
      found.count[i] = outcome.count;
      found.r2[i] = static_cast<double>(
          outcome.count == found.k ? keys[found.k - 1] >> view.index_bits : view.r2_max);
    }
  }

 private:
  Plan plan_;
  const search::Level& level_;
  PhotonMap map_;
  std::unique_ptr<search::Map> fast_;
  double seconds_;
};

}  // namespace

void add_photonloom(const std::vector<UVec3>& points, Contenders& to) {
  to.push_back(std::make_unique<Golden>(points));
}

}  // namespace photonloom::bench
