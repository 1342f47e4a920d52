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
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "golden/packet/packet.hpp"
#include "golden/plan/units.hpp"
#include "golden/unit/photon_map.hpp"

namespace photonloom {

// What a unit counted, by name; words of the domain ("packets in", "leaves", "cycles", "cache
// hits").
using Counters = std::map<std::string, uint64_t>;

// A unit of one stream in and streams out of these packets. process() appends to each output what
// the packets determine.
template <class In_, class... Out>
class PacketUnit {
 public:
  using In = In_;
  using FirstOut = std::tuple_element_t<0, std::tuple<Out...>>;
  // Calls f(std::type_identity<P>{}) for the packet of each output.
  template <class F>
  static void for_each_output(F&& f) {
    (f(std::type_identity<Out>{}), ...);
  }

  virtual ~PacketUnit() = default;
  virtual void process(std::span<const In> in, std::vector<Out>&... out) = 0;
  virtual Counters counters() const = 0;
};

// The units' interfaces, one for each line of golden/plan/units.hpp. kOutputs names the output
// streams as the module's ports do, kRecorded the files of `render --record`, the input's first.
class PhotonGatherer : public PacketUnit<GatherQuery, GatherResult, GatherPhoton> {
 public:
  static constexpr const char* kOutputs[] = {"result", "photon"};
  static constexpr const char* kRecorded[] = {"gather_query", "gather_result", "gather_photon"};
  // Both maps must outlive the unit; an absent one is an empty map. process() gives a result for
  // every query, in order; for a query with want_photons its `count` photons are appended to the
  // photons.
  virtual void load(const PhotonMap& global, const PhotonMap& caustic) = 0;
};

class ReorderBuffer : public PacketUnit<GatherQuery, GatherQuery> {
 public:
  static constexpr const char* kOutputs[] = {"out"};
  static constexpr const char* kRecorded[] = {"reorder_in", "reorder_out"};
};

class CdfSampler : public PacketUnit<SamplerInput, Sample> {
 public:
  static constexpr const char* kOutputs[] = {"out"};
  static constexpr const char* kRecorded[] = {"sampler_input", "sample"};
};

class IrradianceCache : public PacketUnit<CacheLookup, CacheResult> {
 public:
  static constexpr const char* kOutputs[] = {"out"};
  static constexpr const char* kRecorded[] = {"cache_lookup", "cache_result"};
};

// Golden units, make_golden_NAME of each; and by type. `threads` as in TBB's arena of the caller.
#define PHOTONLOOM_MAKE_GOLDEN(Interface, name, ...)                                            \
  std::unique_ptr<Interface> make_golden_##name(const Plan& plan);                              \
  inline std::unique_ptr<Interface> make_golden(std::type_identity<Interface>, const Plan& p) { \
    return make_golden_##name(p);                                                               \
  }
PHOTONLOOM_UNITS(PHOTONLOOM_MAKE_GOLDEN)
#undef PHOTONLOOM_MAKE_GOLDEN

// What stands in front of units of its own kind and sees their packets (a comparison, a recorder):
// hands all but packets and counters on to each of them. They must outlive it.
template <class Unit>
class InFront : public Unit {
 public:
  explicit InFront(std::vector<Unit*>) {}
};
template <>
class InFront<PhotonGatherer> : public PhotonGatherer {
 public:
  explicit InFront(std::vector<PhotonGatherer*> units) : units_(std::move(units)) {}
  void load(const PhotonMap& global, const PhotonMap& caustic) final {
    for (PhotonGatherer* unit : units_) unit->load(global, caustic);
  }

 private:
  std::vector<PhotonGatherer*> units_;
};

}  // namespace photonloom
