// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "verilator_tb/unit/gatherer_unit.hpp"

namespace photonloom {

namespace {

class RtlPhotonGatherer final : public GathererUnit {
 public:
  RtlPhotonGatherer(const Plan& plan, const RunOptions& options)
      : GathererUnit(plan, "photon_gatherer", options, options.latency),
        memory_(rig_.add_memory(plan)) {
    rig_.reset();
  }

 private:
  void load_lines(PhotonGathererImage image) override {
    image_ = std::move(image);
    configure(image_.cfg);
    rig_.cycle();
    memory_.load(image_.lines);
  }
  void add_own_counters(Counters& c) const override {
    c["line requests"] = memory_.requests();
    c["bytes read"] = memory_.bytes();
  }

  LineMemory& memory_;
  PhotonGathererImage image_;  // of which memory_ reads the lines
};

}  // namespace

std::unique_ptr<ClockedPhotonGatherer> make_rtl_photon_gatherer(const Plan& plan,
                                                                const RunOptions& options) {
  return std::make_unique<RtlPhotonGatherer>(plan, options);
}

}  // namespace photonloom
