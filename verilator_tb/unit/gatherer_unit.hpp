// SPDX-License-Identifier: Apache-2.0
// What gathers under a clock, one photon_gatherer or a board's engine of several: all but where the
// photon lines are, and in which order results are due.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "golden/unit/photon_gatherer_image.hpp"
#include "verilator_tb/unit/backends.hpp"
#include "verilator_tb/unit/clocked_unit.hpp"

namespace photonloom {

constexpr uint32_t kLeafCacheWord = 0x800004;  // docs/photon_gatherer.md

class GathererUnit : public ClockedPhotonGatherer {
 public:
  // After `silence` cycles and a margin, no packet can be on its way. The constructor of what
  // derives from this connects the rest of the ports and resets.
  GathererUnit(const Plan& plan, const std::string& unit, const RunOptions& options, int silence)
      : plan_(plan),
        rig_(plan, unit, options),
        unit_(unit),
        silence_(silence),
        leaf_cache_(options.leaf_cache),
        in_(rig_, plan, "in"),
        results_(rig_, plan, "result"),
        photons_(rig_, plan, "photon") {}

  void load(const PhotonMap& global, const PhotonMap& caustic) final {
    PhotonGathererImage image = photon_gatherer_image(plan_, global, caustic);
    if (leaf_cache_) image.cfg.push_back({kLeafCacheWord, *leaf_cache_});
    load_lines(std::move(image));
    load_cycles_ = rig_.cycles();
  }

  void process(std::span<const GatherQuery> in, std::vector<GatherResult>& results,
               std::vector<GatherPhoton>& photons) final {
    result_cycles_.clear();
    photon_cycles_.clear();
    if (rig_.restart([&] {
          for (const GatherQuery& q : in) in_.push(q);
        }))
      configure_again();
    const std::vector<GatherQuery> due = take_due(in);
    for (const GatherQuery& q : in) in_.push(q);
    size_t got = 0;
    int64_t photons_owed = 0;  // negative while photons are ahead of their result
    rig_.run_until([&] {
      while (results_.waiting()) {
        const GatherResult r = results_.pop(result_cycles_);
        if (got < due.size() && due[got].want_photons && !due[got].flush) photons_owed += r.count;
        ++got;
        results.push_back(r);
      }
      while (photons_.waiting()) {
        photons.push_back(photons_.pop(photon_cycles_));
        --photons_owed;
      }
      return in_.stream().empty() && got >= due.size() && photons_owed <= 0;
    });
    in_cycles_ = in_.stream().take_cycles();
  }

  Counters counters() const final {
    Counters c{{"packets in", in_.stream().accepted()},
               {"cycles", rig_.cycles() - load_cycles_},
               {"stalls in", in_.stream().stalled()},
               {"stalls results", results_.stream().stalled()},
               {"stalls photons", photons_.stream().stalled()},
               {"stalls out", results_.stream().stalled() + photons_.stream().stalled()}};
    add_own_counters(c);
    add_port_counters(rig_, c);
    return c;
  }
  uint64_t cycles() const final { return rig_.cycles(); }
  std::vector<QueueFill> queue_fills() const final { return rig_.queue_fills(); }
  std::span<const uint64_t> in_cycles() const final { return in_cycles_; }
  std::span<const uint64_t> out_cycles(int stream) const final {
    return stream == 0 ? result_cycles_ : photon_cycles_;
  }
  void finish() override {
    expect_silence(rig_, unit_, results_, silence_);
    expect_silence(rig_, unit_, photons_, silence_);
  }

 protected:
  // Puts lines and configuration where the unit finds them.
  virtual void load_lines(PhotonGathererImage image) = 0;
  // After a reset: what that has lost. Of a line memory outside the lines are still there.
  virtual void configure_again() = 0;
  // The queries whose results come, in their order, once those of `in` have gone in.
  virtual std::vector<GatherQuery> take_due(std::span<const GatherQuery> in) {
    return {in.begin(), in.end()};
  }
  virtual void add_own_counters(Counters&) const {}

  void configure(const std::vector<CfgWrite>& writes) {
    for (const CfgWrite& w : writes) {
      rig_.set("cfg_valid_i", 1);
      rig_.set("cfg_addr_i", w.address);
      rig_.set("cfg_data_i", w.data);
      rig_.cycle();
    }
    rig_.set("cfg_valid_i", 0);
  }

  Plan plan_;
  Rig rig_;

 private:
  std::string unit_;
  int silence_;
  std::optional<uint64_t> leaf_cache_;  // of each gatherer
  PacketSource<GatherQuery> in_;
  PacketTaker<GatherResult> results_;
  PacketTaker<GatherPhoton> photons_;
  uint64_t load_cycles_ = 0;
  std::vector<uint64_t> in_cycles_, result_cycles_, photon_cycles_;
};

}  // namespace photonloom
