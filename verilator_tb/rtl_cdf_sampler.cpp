// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/backends.hpp"
#include "verilator_tb/clocked_unit.hpp"

namespace photonloom {

namespace {

class RtlCdfSampler final : public ClockedCdfSampler {
 public:
  RtlCdfSampler(const Plan& plan, const RunOptions& options)
      : latency_(options.latency),
        rig_(plan, "cdf_sampler", options),
        in_(rig_, plan, "in"),
        out_(rig_, plan, "out") {
    rig_.reset();
  }

  void process(std::span<const SamplerInput> in, std::vector<Sample>& out) override {
    out_cycles_.clear();
    uint64_t owed = 0;
    for (const SamplerInput& packet : in) {
      in_.push(packet);
      open_ |= packet.kind == 0;
      owed += open_ && packet.kind == 2;  // before the first header nothing is owed
    }
    const uint64_t until = out_.stream().taken() + owed;
    rig_.run_until([&] { return in_.stream().empty() && out_.stream().taken() >= until; });
    while (out_.waiting()) out.push_back(out_.pop(out_cycles_));
    in_cycles_ = in_.stream().take_cycles();
  }

  Counters counters() const override {
    Counters c{{"packets in", in_.stream().accepted()},
               {"cycles", rig_.cycles()},
               {"stalls in", in_.stream().stalled()},
               {"stalls out", out_.stream().stalled()}};
    add_port_counters(rig_, c);
    return c;
  }
  uint64_t cycles() const override { return rig_.cycles(); }
  std::span<const uint64_t> in_cycles() const override { return in_cycles_; }
  std::span<const uint64_t> out_cycles(int) const override { return out_cycles_; }
  void finish() override { expect_silence(rig_, "cdf_sampler", out_.stream(), latency_); }

 private:
  int latency_;
  bool open_ = false;
  Rig rig_;
  PacketSource<SamplerInput> in_;
  PacketTaker<Sample> out_;
  std::vector<uint64_t> in_cycles_, out_cycles_;
};

}  // namespace

std::unique_ptr<ClockedCdfSampler> make_rtl_cdf_sampler(const Plan& plan,
                                                        const RunOptions& options) {
  return std::make_unique<RtlCdfSampler>(plan, options);
}

}  // namespace photonloom
