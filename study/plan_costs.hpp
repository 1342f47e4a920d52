// SPDX-License-Identifier: Apache-2.0
// What plans cost that were not rendered: the queries of one frame, in each plan's formats, through
// a map of its own.
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
  // `queries` are of a frame by `plan`, photons of `seed`.
  PlanCosts(StudyScene& scene, const Plan& plan, std::vector<GatherQuery> queries, uint64_t seed,
            int latency);

  // `loads`: cycles and bytes too, else resources alone.
  PlanCost predict(const Plan& plan, bool loads);

 private:
  // What decides a search: powers do not.
  using MapKey = std::tuple<uint64_t, int, int, int>;
  const PhotonMap& map_of(const Plan& plan);

  StudyScene& scene_;
  Plan base_;
  std::vector<GatherQuery> queries_;
  uint64_t seed_;
  int latency_;
  bool caustic_;  // the queries go to the caustic map
  std::map<MapKey, PhotonMap> maps_;
};

}  // namespace photonloom
