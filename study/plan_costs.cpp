// SPDX-License-Identifier: Apache-2.0
#include "study/plan_costs.hpp"

#include <algorithm>

#include "golden/planner/resources.hpp"
#include "golden/unit/pack_photons.hpp"
#include "rtl/generate/hardware.hpp"

namespace photonloom {
namespace {

// Maps kept; a search changes one line at a time.
constexpr size_t kMapsKept = 24;

// The cell of fewer bits that holds a cell or a coordinate of more; of more bits its lower corner.
uint32_t requantised(uint32_t code, int from, int to) {
  return from >= to ? code >> (from - to) : code << (to - from);
}

}  // namespace

void predict_luts(const Plan& plan, PlanCost& cost) {
  cost.lut = cost.gatherer_lut = 0;
  for (const std::string& unit : units_present(plan)) {
    if (!is_predicted(unit)) continue;
    const double lut = estimate_resources(plan, unit).lut;
    cost.lut += lut;
    if (unit == unit_name<PhotonGatherer>) cost.gatherer_lut = lut;
  }
}

PlanCosts::PlanCosts(StudyScene& scene, const Plan& plan, std::vector<GatherQuery> queries,
                     uint64_t seed, int latency)
    : scene_(scene),
      base_(plan),
      queries_(std::move(queries)),
      seed_(seed),
      latency_(latency),
      caustic_(!plan.global.present) {}

const PhotonMap& PlanCosts::map_of(const Plan& plan) {
  const MapPlan& m = plan.map(caustic_);
  const MapKey key{m.photons, plan.position_bits, plan.direction_bits, plan.bucket};
  const auto known = maps_.find(key);
  if (known != maps_.end()) return known->second;
  if (maps_.size() >= kMapsKept) maps_.clear();
  const auto pass = scene_.photons(caustic_, m.photons, seed_);
  return maps_[key] = build_photon_map(pack_photons(pass->photons, plan, m, nullptr), plan);
}

PlanCost PlanCosts::predict(const Plan& plan, bool loads) {
  PlanCost cost;
  predict_luts(plan, cost);
  if (!loads || queries_.empty()) return cost;
  std::vector<GatherQuery> queries = queries_;
  for (GatherQuery& q : queries) {
    for (uint32_t& x : q.position) x = requantised(x, base_.position_bits, plan.position_bits);
    for (uint32_t& x : q.normal) x = requantised(x, base_.normal_bits, plan.normal_bits);
  }
  const PhotonMap none, &map = map_of(plan);
  const GatherCost gather =
      gather_cost_model(plan, caustic_ ? none : map, caustic_ ? map : none, queries, latency_);
  cost.cycles = gather.cycles;
  cost.bytes = gather.bytes;
  return cost;
}

}  // namespace photonloom
