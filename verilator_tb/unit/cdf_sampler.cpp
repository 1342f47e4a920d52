// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/unit/stream_unit.hpp"

namespace photonloom {

namespace {

class RtlCdfSampler final : public StreamUnit<ClockedCdfSampler, SamplerInput, Sample> {
 public:
  RtlCdfSampler(const Plan& plan, const RunOptions& options)
      : StreamUnit(plan, "cdf_sampler", options) {}

 private:
  // A request brings its sample; before the first header there is no table to take it from.
  uint64_t brings(const SamplerInput& packet) override {
    open_ |= packet.kind == 0;
    return open_ && packet.kind == 2;
  }

  bool open_ = false;
};

}  // namespace

std::unique_ptr<ClockedCdfSampler> make_rtl_cdf_sampler(const Plan& plan,
                                                        const RunOptions& options) {
  return std::make_unique<RtlCdfSampler>(plan, options);
}

}  // namespace photonloom
