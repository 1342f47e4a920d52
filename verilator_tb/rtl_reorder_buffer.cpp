// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/backends.hpp"
#include "verilator_tb/clocked_unit.hpp"

namespace photonloom {

namespace {

class RtlReorderBuffer final : public ClockedReorderBuffer {
 public:
  RtlReorderBuffer(const Plan& plan, const RunOptions& options)
      : capacity_(plan.reorder_key == ReorderKey::kNone
                      ? 1
                      : static_cast<uint64_t>(plan.reorder_packets)),
        latency_(options.latency),
        rig_(plan, "reorder_buffer", options),
        in_(rig_, plan, "in"),
        out_(rig_, plan, "out") {
    rig_.reset();
  }

  void process(std::span<const GatherQuery> in, std::vector<GatherQuery>& out) override {
    out_cycles_.clear();
    uint64_t owed = 0;
    for (const GatherQuery& q : in) {
      in_.push(q);
      ++held_;
      if (q.flush) {
        owed += held_;
        held_ = 0;
      } else if (held_ >= capacity_) {
        ++owed;
        --held_;
      }
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
  void finish() override { expect_silence(rig_, "reorder_buffer", out_.stream(), latency_); }

 private:
  uint64_t capacity_, held_ = 0;
  int latency_;
  Rig rig_;
  PacketSource<GatherQuery> in_;
  PacketTaker<GatherQuery> out_;
  std::vector<uint64_t> in_cycles_, out_cycles_;
};

}  // namespace

std::unique_ptr<ClockedReorderBuffer> make_rtl_reorder_buffer(const Plan& plan,
                                                              const RunOptions& options) {
  return std::make_unique<RtlReorderBuffer>(plan, options);
}

}  // namespace photonloom
