// SPDX-License-Identifier: Apache-2.0
// What gathers cost in hardware: run through the RTL, or predicted from what golden counts.
#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "golden/unit/backend.hpp"
#include "study/cache_model.hpp"

namespace photonloom {

// Means over queries. `bytes` are read at the line port.
struct GatherLoad {
  double nodes = 0, leaves = 0, insertions = 0;
  double misses = 0;  // leaf lines that the cache had to fetch
};
struct GatherCost {
  double cycles = 0, bytes = 0;
  bool from_rtl = false;
  GatherLoad load;
};

// A window on a frame's gathers: passes everything on to golden and keeps some final-gather
// queries, of a frame that has none its gathers of caustics, in the order in which they come, as
// several runs of neighbours from different places of the stream. Gathers for a sampler's tables,
// which want their photons, are never kept.
class WatchedGatherer final : public PhotonGatherer {
 public:
  WatchedGatherer(const Plan& plan, size_t queries);
  void load(const PhotonMap& global, const PhotonMap& caustic) override;
  void process(std::span<const GatherQuery> in, std::vector<GatherResult>& results,
               std::vector<GatherPhoton>& photons) override;
  Counters counters() const override { return golden_->counters(); }
  const std::vector<GatherQuery>& kept() const {
    return finals_.kept.empty() ? caustics_.kept : finals_.kept;
  }

 private:
  struct Runs {
    size_t length, stride, seen = 0;
    std::vector<GatherQuery> kept = {};
    // Of `queries` that are to be kept, where at most `most` come.
    Runs(size_t queries, size_t most);
    void see(const GatherQuery& query);
  };

  std::unique_ptr<PhotonGatherer> golden_;
  Runs finals_, caustics_;
};

// The RTL, with a line memory of this latency, from an idle unit to an idle unit; its results are
// compared with golden's, and a difference is a std::runtime_error. Builds a model where `work_dir`
// has none.
GatherCost gather_cost_rtl(const Plan& plan, const PhotonMap& global, const PhotonMap& caustic,
                           std::span<const GatherQuery> queries, int latency,
                           const std::string& work_dir);

// What queries read and do in the tree, whatever the gatherer's widths and cache; `load` without
// misses.
struct GatherSearches {
  LineVisits visits;  // with the map as the top bit of a line's number
  GatherLoad load;
};
GatherSearches searched(const Plan& plan, const PhotonMap& global, const PhotonMap& caustic,
                        std::span<const GatherQuery> queries);
// Of searches by this plan, or by one that differs in formats alone, from a model of the cache and
// the fit of study/cycle_fit.hpp.
GatherCost gather_cost(const Plan& plan, const GatherSearches& searches, int latency);
// Both.
GatherCost gather_cost_model(const Plan& plan, const PhotonMap& global, const PhotonMap& caustic,
                             std::span<const GatherQuery> queries, int latency);

// The power that joins the bounds of a gatherer without a leaf cache: with no cache between, less
// waits for less. The best whole number for gatherers on block RAM of 2 to 32 contexts and one or
// two nodes a cycle, in three scenes (tests/study/wide_gatherers_slow.cpp).
inline constexpr double kUncachedPower = 5;
// Cycles of a gather as the fit has it. docs/sweep.md has the formula. Of a gatherer with a leaf
// cache kElsewhere leaves the beats of its lines out of the bounds, for who counts them himself.
enum class LineBeats { kBound, kElsewhere };
double modelled_cycles(const Plan& plan, const GatherLoad& load, int latency,
                       LineBeats line_beats = LineBeats::kBound);
// Of the numbers of fit and cache model; results made with another are made again.
std::string cycle_fit_signature();

// Cycles of cdf_sampler for a table of `photons` photons and `rays` requests, as
// docs/cdf_sampler.md states its rates.
double sampler_cycles(const Plan& plan, double photons, double rays);

}  // namespace photonloom
