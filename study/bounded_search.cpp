// SPDX-License-Identifier: Apache-2.0
#include "study/bounded_search.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "golden/numeric/shared_exponent.hpp"
#include "golden/unit/photon_gatherer.hpp"

namespace photonloom {
namespace {

constexpr size_t kFewestKnown = 4;

// Squared distance to the nearest subtree that the search of docs/architecture.md leaves out
// although photons in it may be among the k nearest; all ones where there is none. `bound` is the
// search's last.
class LeftOut {
 public:
  LeftOut(const PhotonMap& map, const GatherQuery& query, std::span<const uint32_t> visited,
          uint64_t bound)
      : map_(map), query_(query), bound_(bound), visited_(visited.begin(), visited.end()) {
    std::sort(visited_.begin(), visited_.end());
    if (map.lines > 0) walk(1, {0, 0, 0});
  }
  uint64_t nearest() const { return nearest_; }

 private:
  void walk(uint32_t node, UVec3 offset) {
    uint64_t d2 = 0;
    for (const uint32_t o : offset) d2 += uint64_t{o} * o;
    if (d2 > bound_ || d2 >= nearest_) return;
    if (node >= map_.lines) {
      if (!std::binary_search(visited_.begin(), visited_.end(), node - map_.lines)) nearest_ = d2;
      return;
    }
    const MapNode& n = map_.nodes[node];
    const int64_t away = int64_t{query_.position[n.axis]} - int64_t{n.split};
    const uint32_t right = away >= 0 ? 1 : 0;
    walk(2 * node + right, offset);
    offset[n.axis] = static_cast<uint32_t>(away < 0 ? -away : away);
    walk(2 * node + 1 - right, offset);
  }

  const PhotonMap& map_;
  const GatherQuery& query_;
  uint64_t bound_, nearest_ = ~uint64_t{0};
  std::vector<uint32_t> visited_;
};

double flux_of(const Plan& plan, const PhotonMap& map, std::span<const Neighbour> found) {
  double flux = 0;
  for (const Neighbour& n : found)
    for (int c = 0; c < plan.channels; ++c)
      flux += static_cast<double>(power_value(map.slots[n.index].power, c));
  return flux;
}

double over_r2(const Plan& plan, double flux, uint64_t r2) {
  return flux / static_cast<double>(std::max(r2, plan.r2_floor));
}

// docs/frame.md's estimate but for constants.
double estimate(const Plan& plan, const PhotonMap& map, std::span<const Neighbour> found,
                uint64_t r2_max) {
  const bool full = found.size() == static_cast<size_t>(plan.k);
  const double c = full ? (plan.k - 1.0) / plan.k : 1.0;
  return over_r2(plan, c * flux_of(plan, map, found), full ? found.back().d2 : r2_max);
}

}  // namespace

BoundedSearch bounded_search(const Plan& plan, const PhotonMap& global, const PhotonMap& caustic,
                             std::span<const GatherQuery> queries) {
  BoundedSearch b;
  if (plan.leaf_limit == 0 && plan.epsilon_factor == uint32_t{1} << plan.epsilon_shift) return b;
  Plan exact = plan;
  exact.leaf_limit = 0;
  exact.epsilon_factor = 1;
  exact.epsilon_shift = 0;
  std::vector<Neighbour> all, found;
  std::vector<uint32_t> leaves;
  std::vector<double> e, f, known;  // estimates: exact, ordinary, within what was searched whole
  size_t wanted = 0, kept = 0;
  for (const GatherQuery& query : queries) {
    const PhotonMap& map = query.map ? caustic : global;
    const uint64_t r2_max = plan.map(query.map != 0).r2_max;
    leaves.clear();
    search_gather(exact, map, query, all);
    search_gather(plan, map, query, found, &leaves);
    wanted += all.size();
    std::vector<Neighbour> both;
    std::set_intersection(all.begin(), all.end(), found.begin(), found.end(),
                          std::back_inserter(both));
    kept += both.size();
    e.push_back(estimate(exact, map, all, r2_max));
    f.push_back(estimate(plan, map, found, r2_max));
    const uint64_t bound = found.size() == static_cast<size_t>(plan.k) ? found.back().d2 : r2_max;
    const uint64_t whole = LeftOut(map, query, leaves, bound).nearest();
    const auto end = std::partition_point(found.begin(), found.end(),
                                          [&](const Neighbour& n) { return n.d2 < whole; });
    const std::span<const Neighbour> within(found.begin(), end);
    known.push_back(whole > bound || within.size() < kFewestKnown
                        ? f.back()
                        : over_r2(plan, flux_of(plan, map, within), whole));
  }
  const auto sum = [](const std::vector<double>& v) {
    double s = 0;
    for (const double x : v) s += x;
    return s;
  };
  const double total = sum(e), ordinary = sum(f);
  if (wanted == 0 || !(total > 0)) return b;
  const auto spread = [&](const std::vector<double>& v, double factor) {
    double s = 0, square = 0;
    for (size_t i = 0; i < v.size(); ++i) {
      s += (factor * v[i] - e[i]) * (factor * v[i] - e[i]);
      square += e[i] * e[i];
    }
    return std::sqrt(s / square);
  };
  b.recall = static_cast<double>(kept) / static_cast<double>(wanted);
  b.light = ordinary / total - 1;
  b.spread = spread(f, 1);
  b.spread_scaled = ordinary > 0 ? spread(f, total / ordinary) : b.spread;
  b.light_known = sum(known) / total - 1;
  b.spread_known = spread(known, 1);
  return b;
}

}  // namespace photonloom
