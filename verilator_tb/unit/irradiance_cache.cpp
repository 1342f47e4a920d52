// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/unit/comparing.hpp"
#include "verilator_tb/unit/hls_unit.hpp"
#include "verilator_tb/unit/stream_unit.hpp"

namespace photonloom {

namespace {

class RtlIrradianceCache final : public StreamUnit<IrradianceCache> {
 public:
  RtlIrradianceCache(const Plan& plan, const RunOptions& options) : StreamUnit(plan, options) {}

 private:
  uint64_t brings(const CacheLookup&) override { return 1; }
};

class ComparingIrradianceCache final
    : public ComparingStreams<IrradianceCache, CacheLookup, CacheResult> {
 public:
  using ComparingStreams::ComparingStreams;

 private:
  std::string input(size_t, size_t i, std::span<const CacheLookup> in,
                    const std::vector<CacheResult>&) const override {
    return i < in.size() ? text(in[i]) : "none";
  }
  void follow(std::span<const CacheLookup>, std::span<const CacheResult> out) override {
    const auto from = in_cycles(), to = out_cycles(0);
    for (size_t i = 0; i < std::min({out.size(), from.size(), to.size()}); ++i)
      show(out[i], from[i], to[i]);
    for (const CacheResult& r : out) full_ += r.full;
  }
  void add_own_counters(Counters& counters) const override { counters["answers full"] = full_; }

  uint64_t full_ = 0;  // flags of the answers that came
};

}  // namespace

std::unique_ptr<Comparing<IrradianceCache>> compare_units(const Plan& plan,
                                                          const CompareContext& context,
                                                          IrradianceCache& golden,
                                                          IrradianceCache& other) {
  return std::make_unique<ComparingIrradianceCache>(plan, context, golden, other);
}

std::unique_ptr<ClockedIrradianceCache> make_rtl_irradiance_cache(const Plan& plan,
                                                                  const RunOptions& options) {
  if (options.kind == ModelKind::kHls)
    return std::make_unique<HlsStreamUnit<IrradianceCache>>(plan, options);
  return std::make_unique<RtlIrradianceCache>(plan, options);
}

}  // namespace photonloom
