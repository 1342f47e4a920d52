// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/unit/comparing.hpp"
#include "verilator_tb/unit/hls_unit.hpp"
#include "verilator_tb/unit/stream_unit.hpp"

namespace photonloom {

namespace {

class RtlCdfSampler final : public StreamUnit<CdfSampler> {
 public:
  RtlCdfSampler(const Plan& plan, const RunOptions& options) : StreamUnit(plan, options) {}

 private:
  // A request brings its sample; before the first header there is no table to take it from.
  uint64_t brings(const SamplerInput& packet) override {
    open_ |= packet.kind == 0;
    return open_ && packet.kind == 2;
  }

  bool open_ = false;
};

class ComparingCdfSampler final : public ComparingStreams<CdfSampler, SamplerInput, Sample> {
 public:
  using ComparingStreams::ComparingStreams;

 private:
  std::string input(size_t, size_t i, std::span<const SamplerInput> in,
                    const std::vector<Sample>&) const override {
    for (const SamplerInput& packet : in)
      if (packet.kind == 2 && i-- == 0) return text(packet);
    return "none";
  }
  void follow(std::span<const SamplerInput> in, std::span<const Sample> out) override {
    const auto from = in_cycles(), to = out_cycles(0);
    size_t i = 0;
    for (size_t n = 0; n < in.size(); ++n) {
      if (in[n].kind != 2) continue;
      if (n < from.size() && i < std::min(out.size(), to.size())) show(out[i], from[n], to[i]);
      ++i;
    }
  }
};

}  // namespace

std::unique_ptr<Comparing<CdfSampler>> compare_units(const Plan& plan,
                                                     const CompareContext& context,
                                                     CdfSampler& golden, CdfSampler& other) {
  return std::make_unique<ComparingCdfSampler>(plan, context, golden, other);
}

std::unique_ptr<ClockedCdfSampler> make_rtl_cdf_sampler(const Plan& plan,
                                                        const RunOptions& options) {
  if (options.kind == ModelKind::kHls)
    return std::make_unique<HlsStreamUnit<CdfSampler>>(plan, options);
  return std::make_unique<RtlCdfSampler>(plan, options);
}

}  // namespace photonloom
