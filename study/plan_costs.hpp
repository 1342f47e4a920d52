// SPDX-License-Identifier: Apache-2.0
// What plans cost that were not rendered: the queries of one frame through each plan's map. Formats
// of positions and directions hardly change what a search visits, so all searches are made in those
// of one plan.
#pragma once
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "study/gather_cost.hpp"
#include "study/study_scene.hpp"

namespace photonloom {

// Of a plan: what the planner may minimise, and what stands beside it.
struct PlanCost {
  double cycles = 0;        // a final gather
  double bytes = 0;         // at the line port, a final gather
  double gatherer_lut = 0;  // LUT-equivalents of the gatherer
  double lut = 0;           // of all units
};

// The gatherer's LUT-equivalents and those of all units with a prediction.
void predict_luts(const Plan& plan, PlanCost& cost);

class PlanCosts {
 public:
  // `queries` are of a frame by `plan`, whose formats searches are made in; photons of `seed`.
  PlanCosts(StudyScene& scene, const Plan& plan, std::vector<GatherQuery> queries, uint64_t seed,
            int latency);

  // `loads`: cycles and bytes too, else resources alone.
  PlanCost predict(const Plan& plan, bool loads);

 private:
  using MapKey = std::tuple<uint64_t, int>;                               // photons, bucket
  using SearchKey = std::tuple<MapKey, int, uint64_t, double, uint32_t>;  // k, r2, E / 2^s, leaves
  const PhotonMap& map_of(const Plan& plan);
  const GatherSearches& searches_of(const Plan& plan);

  StudyScene& scene_;
  Plan base_;
  std::vector<GatherQuery> queries_;
  uint64_t seed_;
  int latency_;
  bool caustic_;  // the queries go to the caustic map
  std::map<MapKey, PhotonMap> maps_;
  std::map<SearchKey, GatherSearches> searches_;
};

}  // namespace photonloom
