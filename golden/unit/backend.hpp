// SPDX-License-Identifier: Apache-2.0
// The one interface behind which a unit is golden, RTL, a netlist or a board. A unit is a
// deterministic function from its input packets to its output packets: process() takes packets in
// order and appends every packet that they (with all before them) determine, in order. How the
// calls cut the stream never changes what comes out.
#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "golden/packet/packet.hpp"
#include "golden/unit/photon_map.hpp"

namespace photonloom {

// What a unit counted, by name; words of the domain ("packets in", "leaves", "cycles", "cache
// hits").
using Counters = std::map<std::string, uint64_t>;

class PhotonGatherer {
 public:
  virtual ~PhotonGatherer() = default;
  // Both maps must outlive the unit; an absent one is an empty map.
  virtual void load(const PhotonMap& global, const PhotonMap& caustic) = 0;
  // A result for every query, in order; for a query with want_photons its `count` photons are
  // appended to `photons`.
  virtual void process(std::span<const GatherQuery> in, std::vector<GatherResult>& results,
                       std::vector<GatherPhoton>& photons) = 0;
  virtual Counters counters() const = 0;
};

class ReorderBuffer {
 public:
  virtual ~ReorderBuffer() = default;
  virtual void process(std::span<const GatherQuery> in, std::vector<GatherQuery>& out) = 0;
  virtual Counters counters() const = 0;
};

class CdfSampler {
 public:
  virtual ~CdfSampler() = default;
  virtual void process(std::span<const SamplerInput> in, std::vector<Sample>& out) = 0;
  virtual Counters counters() const = 0;
};

// Golden units. `threads` as in TBB's arena of the caller.
std::unique_ptr<PhotonGatherer> make_golden_photon_gatherer(const Plan& plan);
std::unique_ptr<ReorderBuffer> make_golden_reorder_buffer(const Plan& plan);
std::unique_ptr<CdfSampler> make_golden_cdf_sampler(const Plan& plan);

}  // namespace photonloom
