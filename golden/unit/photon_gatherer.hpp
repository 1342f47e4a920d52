// SPDX-License-Identifier: Apache-2.0
// The golden gather: exact k nearest photons in the complete kd-tree, and its brute-force twin.
// What is computed, to the bit, stands in docs/photon_gatherer.md.
#pragma once
#include <compare>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "golden/packet/packet.hpp"
#include "golden/unit/backend.hpp"
#include "golden/unit/gather_search.hpp"
#include "golden/unit/photon_map.hpp"

namespace photonloom {

// A photon found; smaller is nearer, ties by index.
struct Neighbour {
  uint64_t d2 = 0;  // position units squared, exact
  uint32_t index = 0;
  auto operator<=>(const Neighbour&) const = default;
};

// What one query's search did.
struct SearchCounts {
  uint32_t nodes = 0;       // inner nodes processed
  uint32_t leaves = 0;      // leaves processed
  uint32_t insertions = 0;  // candidates that entered the list
};

// Whether light that a photon brought from `direction` (plan.direction_bits) falls on the side of
// `normal` (plan.normal_bits): the exact product of the integer decodes is positive.
bool faces(const Plan& plan, OctCode direction, const Pair32& normal);

// Every candidate of the map, smallest (d2, index) first, at most k: the definition, by trying all
// photons. Uses neither the tree nor epsilon nor the leaf limit.
std::vector<Neighbour> brute_force_gather(const Plan& plan, const PhotonMap& map,
                                          const GatherQuery& query);

// The search of the tree, one step at a time, in the order that hardware follows. `found` becomes
// the result, smallest (d2, index) first. The lines of the leaves that it visits, in their order,
// are appended to `lines` where that is not null.
SearchCounts search_gather(const Plan& plan, const PhotonMap& map, const GatherQuery& query,
                           std::vector<Neighbour>& found, std::vector<uint32_t>* lines = nullptr);

// The result packet of a query (not of a flush) whose photons are known.
GatherResult make_gather_result(const Plan& plan, const PhotonMap& map, const GatherQuery& query,
                                std::span<const Neighbour> found, const SearchCounts& counts);

// Appends the packets that follow the result of a query with want_photons.
void append_gather_photons(const PhotonMap& map, std::span<const Neighbour> found,
                           std::vector<GatherPhoton>& photons);

// The golden unit at one level of vector instructions; all give the same packets.
// make_golden_photon_gatherer(plan) takes search::chosen_level().
std::unique_ptr<PhotonGatherer> make_golden_photon_gatherer(const Plan& plan,
                                                            const search::Level& level);

// A unit that answers by brute force; nodes, leaves and insertions of its results are 0.
std::unique_ptr<PhotonGatherer> make_brute_photon_gatherer(const Plan& plan);

}  // namespace photonloom
