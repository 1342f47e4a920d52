// SPDX-License-Identifier: Apache-2.0
// What the RTL backends share: a rig, typed packets in and out, counters.
#pragma once
#include <fmt/core.h>

#include <string>
#include <vector>

#include "golden/packet/layout.hpp"
#include "golden/packet/trace.hpp"
#include "golden/unit/backend.hpp"
#include "verilator_tb/rig/rig.hpp"

namespace photonloom {

// A source of packets of one type.
template <class P>
class PacketSource {
 public:
  PacketSource(Rig& rig, const Plan& plan, const std::string& name)
      : layout_(PacketLayout::of<P>(plan)),
        source_(rig.add_source(name, layout_.bits())),
        words_(layout_.words()) {}
  void push(const P& packet) {
    layout_.pack(&packet, words_.data());
    source_.push(words_.data());
  }
  Source& stream() { return source_; }
  const Source& stream() const { return source_; }

 private:
  PacketLayout layout_;
  Source& source_;
  std::vector<uint32_t> words_;
};

template <class P>
class PacketTaker {
 public:
  PacketTaker(Rig& rig, const Plan& plan, const std::string& name)
      : layout_(PacketLayout::of<P>(plan)), taker_(rig.add_taker(name, layout_.bits())) {}
  bool waiting() const { return taker_.waiting() > 0; }
  P pop(std::vector<uint64_t>& cycles) {
    P packet{};
    layout_.unpack(taker_.front(), &packet);
    cycles.push_back(taker_.front_cycle());
    taker_.pop();
    return packet;
  }
  const Taker& stream() const { return taker_; }
  // The next one in JSON.
  std::string front_text() const {
    P packet{};
    layout_.unpack(taker_.front(), &packet);
    return packet_to_json(layout_, &packet);
  }

 private:
  PacketLayout layout_;
  Taker& taker_;
};

// Counters of a unit's ports count_NAME_o, as NAME with blanks.
inline void add_port_counters(const Rig& rig, Counters& counters) {
  for (const std::string& port : rig.counter_ports()) {
    std::string name = port.substr(6, port.size() - 8);
    for (char& c : name)
      if (c == '_') c = ' ';
    counters[name] = rig.get(port);
  }
}

// Clocks on for a while; a packet that comes out now was never owed.
template <class P>
void expect_silence(Rig& rig, const std::string& unit, PacketTaker<P>& out, int latency) {
  for (int i = 0; i < 200 + 4 * latency; ++i) rig.cycle();
  if (!out.waiting()) return;
  const Taker& taker = out.stream();
  const uint64_t number = taker.taken() - taker.waiting(), cycle = taker.front_cycle();
  throw RigError(unit,
                 fmt::format(", stream {}: packet {} in cycle {} is one too many: every packet "
                             "owed had come out; it is {}",
                             taker.name(), number, cycle, out.front_text()),
                 cycle);
}

}  // namespace photonloom
