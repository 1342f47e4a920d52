// SPDX-License-Identifier: Apache-2.0
#include "golden/unit/photon_gatherer_image.hpp"
#include "verilator_tb/backends.hpp"
#include "verilator_tb/clocked_unit.hpp"

namespace photonloom {

namespace {

class RtlPhotonGatherer final : public ClockedPhotonGatherer {
 public:
  RtlPhotonGatherer(const Plan& plan, const RunOptions& options)
      : plan_(plan),
        latency_(options.latency),
        rig_(plan, "photon_gatherer", options),
        in_(rig_, plan, "in"),
        results_(rig_, plan, "result"),
        photons_(rig_, plan, "photon"),
        memory_(rig_.add_memory(plan)) {
    rig_.reset();
  }

  void load(const PhotonMap& global, const PhotonMap& caustic) override {
    image_ = photon_gatherer_image(plan_, global, caustic);
    for (const CfgWrite& w : image_.cfg) {
      rig_.set("cfg_valid_i", 1);
      rig_.set("cfg_addr_i", w.address);
      rig_.set("cfg_data_i", w.data);
      rig_.cycle();
    }
    rig_.set("cfg_valid_i", 0);
    rig_.cycle();
    memory_.load(image_.lines);
    load_cycles_ = rig_.cycles();
  }

  void process(std::span<const GatherQuery> in, std::vector<GatherResult>& results,
               std::vector<GatherPhoton>& photons) override {
    result_cycles_.clear();
    photon_cycles_.clear();
    for (const GatherQuery& q : in) in_.push(q);
    size_t got = 0;
    int64_t photons_owed = 0;  // negative while photons are ahead of their result
    rig_.run_until([&] {
      while (results_.waiting()) {
        const GatherResult r = results_.pop(result_cycles_);
        if (got < in.size() && in[got].want_photons && !in[got].flush) photons_owed += r.count;
        ++got;
        results.push_back(r);
      }
      while (photons_.waiting()) {
        photons.push_back(photons_.pop(photon_cycles_));
        --photons_owed;
      }
      return got >= in.size() && photons_owed <= 0;
    });
    in_cycles_ = in_.stream().take_cycles();
  }

  Counters counters() const override {
    Counters c{{"packets in", in_.stream().accepted()},
               {"cycles", rig_.cycles() - load_cycles_},
               {"stalls in", in_.stream().stalled()},
               {"stalls out", results_.stream().stalled() + photons_.stream().stalled()},
               {"line requests", memory_.requests()},
               {"bytes read", memory_.bytes()}};
    add_port_counters(rig_, c);
    return c;
  }
  uint64_t cycles() const override { return rig_.cycles(); }
  std::span<const uint64_t> in_cycles() const override { return in_cycles_; }
  std::span<const uint64_t> out_cycles(int stream) const override {
    return stream == 0 ? result_cycles_ : photon_cycles_;
  }
  void finish() override {
    expect_silence(rig_, "photon_gatherer", results_.stream(), latency_);
    expect_silence(rig_, "photon_gatherer", photons_.stream(), latency_);
  }

 private:
  Plan plan_;
  int latency_;
  uint64_t load_cycles_ = 0;
  Rig rig_;
  PacketSource<GatherQuery> in_;
  PacketTaker<GatherResult> results_;
  PacketTaker<GatherPhoton> photons_;
  LineMemory& memory_;
  PhotonGathererImage image_;
  std::vector<uint64_t> in_cycles_, result_cycles_, photon_cycles_;
};

}  // namespace

std::unique_ptr<ClockedPhotonGatherer> make_rtl_photon_gatherer(const Plan& plan,
                                                                const RunOptions& options) {
  return std::make_unique<RtlPhotonGatherer>(plan, options);
}

}  // namespace photonloom
