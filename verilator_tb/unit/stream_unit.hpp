// SPDX-License-Identifier: Apache-2.0
// A unit of one stream in and one out, under a clock: all but how many packets each packet brings
// out.
#pragma once
#include <span>
#include <vector>

#include "verilator_tb/unit/backends.hpp"
#include "verilator_tb/unit/clocked_unit.hpp"

namespace photonloom {

// Of interface `Unit`, with one output.
template <class Unit>
class StreamUnit : public ClockedUnit<Unit> {
 public:
  using In = typename Unit::In;
  using Out = typename Unit::FirstOut;

  StreamUnit(const Plan& plan, const RunOptions& options)
      : latency_(options.latency),
        rig_(plan, unit_name<Unit>, options),
        in_(rig_, plan, "in"),
        out_(rig_, plan, "out") {
    rig_.reset();
  }

  void process(std::span<const In> in, std::vector<Out>& out) final {
    out_cycles_.clear();
    rig_.restart([&] {
      for (const In& packet : in) in_.push(packet);
    });
    uint64_t until = out_.stream().taken();
    for (const In& packet : in) {
      in_.push(packet);
      until += brings(packet);
    }
    rig_.run_until([&] { return in_.stream().empty() && out_.stream().taken() >= until; });
    while (out_.waiting()) out.push_back(out_.pop(out_cycles_));
    in_cycles_ = in_.stream().take_cycles();
  }

  Counters counters() const final {
    Counters c{{"packets in", in_.stream().accepted()},
               {"cycles", rig_.cycles()},
               {"stalls in", in_.stream().stalled()},
               {"stalls out", out_.stream().stalled()}};
    add_port_counters(rig_, c);
    return c;
  }
  uint64_t cycles() const final { return rig_.cycles(); }
  std::span<const uint64_t> in_cycles() const final { return in_cycles_; }
  std::span<const uint64_t> out_cycles(int) const final { return out_cycles_; }
  void finish() final { expect_silence(rig_, unit_name<Unit>, out_, latency_); }

 protected:
  // How many packets come out because this one goes in after those before it.
  virtual uint64_t brings(const In& packet) = 0;

 private:
  int latency_;
  Rig rig_;
  PacketSource<In> in_;
  PacketTaker<Out> out_;
  std::vector<uint64_t> in_cycles_, out_cycles_;
};

}  // namespace photonloom
