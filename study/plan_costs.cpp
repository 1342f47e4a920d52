// SPDX-License-Identifier: Apache-2.0
#include "study/plan_costs.hpp"

#include <algorithm>
#include <cmath>

#include "golden/planner/resources.hpp"
#include "golden/unit/pack_photons.hpp"
#include "rtl/generate/hardware.hpp"

namespace photonloom {
namespace {

// A plan search changes one line or two at a time.
constexpr size_t kMapsKept = 24, kSearchesKept = 4096;

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
  const MapKey key{m.photons, plan.bucket};
  const auto known = maps_.find(key);
  if (known != maps_.end()) return known->second;
  if (maps_.size() >= kMapsKept) maps_.clear();
  const auto pass = scene_.photons(caustic_, m.photons, seed_);
  return maps_[key] = build_photon_map(pack_photons(pass->photons, plan, m, nullptr), plan);
}

const GatherSearches& PlanCosts::searches_of(const Plan& plan) {
  Plan usual = plan;
  usual.position_bits = base_.position_bits;
  usual.direction_bits = base_.direction_bits;
  usual.normal_bits = base_.normal_bits;
  MapPlan& m = caustic_ ? usual.caustic : usual.global;
  const int finer = 2 * (base_.position_bits - plan.position_bits);
  m.r2_max = std::min(finer >= 0 ? m.r2_max << finer : m.r2_max >> -finer, usual.r2_limit());
  const SearchKey key{{m.photons, plan.bucket},
                      plan.k,
                      m.r2_max,
                      std::ldexp(plan.epsilon_factor, -plan.epsilon_shift),
                      plan.leaf_limit};
  const auto known = searches_.find(key);
  if (known != searches_.end()) return known->second;
  if (searches_.size() >= kSearchesKept) searches_.clear();
  const PhotonMap none, &map = map_of(usual);
  return searches_[key] = searched(usual, caustic_ ? none : map, caustic_ ? map : none, queries_);
}

PlanCost PlanCosts::predict(const Plan& plan, bool loads) {
  PlanCost cost;
  predict_luts(plan, cost);
  if (!loads || queries_.empty()) return cost;
  const GatherCost gather = gather_cost(plan, searches_of(plan), latency_);
  cost.cycles = gather.cycles;
  cost.bytes = gather.bytes;
  return cost;
}

}  // namespace photonloom
