// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "verilator_tb/unit/comparing.hpp"
#include "verilator_tb/unit/gatherer_unit.hpp"
#include "verilator_tb/unit/hls_units.hpp"

namespace photonloom {

namespace {

class RtlPhotonGatherer final : public GathererUnit {
 public:
  RtlPhotonGatherer(const Plan& plan, const RunOptions& options)
      : GathererUnit(plan, unit_name<PhotonGatherer>, options, options.latency),
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

class ComparingPhotonGatherer final
    : public ComparingStreams<PhotonGatherer, GatherQuery, GatherResult, GatherPhoton> {
 public:
  using ComparingStreams::ComparingStreams;

 private:
  std::string input(size_t stream, size_t i, std::span<const GatherQuery> in,
                    const std::vector<GatherResult>& results,
                    const std::vector<GatherPhoton>&) const override {
    if (stream == 0) return text(in[i]);
    // The query whose photons hold the i-th.
    for (size_t q = 0; q < in.size(); ++q) {
      if (!in[q].want_photons || in[q].flush) continue;
      if (i < results[q].count) return text(in[q]);
      i -= results[q].count;
    }
    return "none";
  }
  void follow(std::span<const GatherQuery> in, std::span<const GatherResult>,
              std::span<const GatherPhoton>) override {
    const auto from = in_cycles(), to = out_cycles(0);
    for (size_t i = 0; i < std::min({in.size(), from.size(), to.size()}); ++i)
      show(in[i], from[i], to[i]);
  }
};

}  // namespace

std::unique_ptr<Comparing<PhotonGatherer>> compare_units(const Plan& plan,
                                                         const CompareContext& context,
                                                         PhotonGatherer& golden,
                                                         PhotonGatherer& other) {
  return std::make_unique<ComparingPhotonGatherer>(plan, context, golden, other);
}

std::unique_ptr<ClockedPhotonGatherer> make_rtl_photon_gatherer(const Plan& plan,
                                                                const RunOptions& options) {
  if (options.kind == ModelKind::kHls) return make_hls_photon_gatherer(plan, options);
  return std::make_unique<RtlPhotonGatherer>(plan, options);
}

}  // namespace photonloom
