// SPDX-License-Identifier: Apache-2.0
// What the comparisons of all units share: all but which input decided a packet and what of the
// streams is worth a line in the timeline.
#pragma once
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <deque>
#include <iterator>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "golden/packet/trace.hpp"
#include "verilator_tb/rig/clocked.hpp"
#include "verilator_tb/rig/timeline.hpp"
#include "verilator_tb/unit/compare_units.hpp"

namespace photonloom {

// Of a unit of packets In to packets Out...; `Unit` derives from PacketUnit of these.
template <class Unit, class In, class... Out>
class ComparingStreams : public Comparing<Unit> {
 public:
  ComparingStreams(const Plan& plan, const CompareContext& context, Unit& golden, Unit& other)
      : Comparing<Unit>({&golden, &other}),
        plan_(plan),
        golden_(golden),
        other_(other),
        clocked_(dynamic_cast<const Clocked*>(&other)),
        timeline_(context.timeline) {
    static_assert(std::size(Unit::kOutputs) == sizeof...(Out));
    (comparers_.emplace_back(PacketLayout::of<Out>(plan), Unit::kOutputs[comparers_.size()],
                             context),
     ...);
  }

  void process(std::span<const In> in, std::vector<Out>&... out) final {
    std::tuple<std::vector<Out>...> due;
    const std::array<size_t, sizeof...(Out)> before{out.size()...};
    std::apply(
        [&](auto&... golden) {
          golden_.process(in, golden...);
          other_.process(in, out...);
          size_t n = 0;
          std::optional<Divergence> first;  // of all streams
          const auto compare = [&]<class P>(const std::vector<P>& expected,
                                            const std::vector<P>& all) {
            const size_t stream = n++;
            try {
              comparers_[stream].template compare<P>(
                  expected, std::span(all).subspan(before[stream]),
                  out_cycles(static_cast<int>(stream)),
                  [&](size_t i) { return input(stream, i, in, golden...); });
            } catch (const Divergence& divergence) {
              if (!first || divergence.cycle < first->cycle) first = divergence;
            }
          };
          (compare(golden, out), ...);
          if (first) throw Divergence(*first);
          n = 0;
          const auto tail = [&]<class P>(const std::vector<P>& all) {
            return std::span<const P>(all).subspan(before[n++]);
          };
          const std::tuple came{tail(out)...};  // in braces: from left to right
          std::apply([&](auto... span) { follow(in, span...); }, came);
        },
        due);
    packets_in_ += in.size();
  }
  Counters counters() const final {
    Counters counters = other_.counters();
    add_own_counters(counters);
    return counters;
  }
  uint64_t packets_in() const final { return packets_in_; }
  uint64_t compared() const final {
    uint64_t sum = 0;
    for (const StreamComparer& c : comparers_) sum += c.compared();
    return sum;
  }
  uint64_t differences() const final {
    uint64_t sum = 0;
    for (const StreamComparer& c : comparers_) sum += c.differences();
    return sum;
  }
  std::string first_report() const final {
    return std::min_element(comparers_.begin(), comparers_.end(),
                            [](const StreamComparer& a, const StreamComparer& b) {
                              return std::pair(a.first_report().empty(), a.first_cycle()) <
                                     std::pair(b.first_report().empty(), b.first_cycle());
                            })
        ->first_report();
  }

 protected:
  // The input that decided packet i of this call's output `stream`, of which golden gave `due`.
  virtual std::string input(size_t stream, size_t i, std::span<const In> in,
                            const std::vector<Out>&... due) const = 0;
  // Packets of this call, as the other backend gave them: for the timeline and own counters.
  virtual void follow(std::span<const In> in, std::span<const Out>... out) = 0;
  virtual void add_own_counters(Counters&) const {}

  template <class P>
  std::string text(const P& packet) const {
    return packet_to_json(PacketLayout::of<P>(plan_), &packet);
  }
  // A packet in the timeline, if there is one.
  template <class P>
  void show(const P& packet, uint64_t from, uint64_t to) {
    if (!timeline_) return;
    std::string name = fmt::format("pixel {} sample {}", packet.pixel, packet.sample);
    if constexpr (requires { packet.tag; }) name += fmt::format(" tag {}", packet.tag);
    timeline_->add(unit_name<Unit>, name, from, to);
  }
  // Of the last process(); empty where the other backend has no clock.
  std::span<const uint64_t> in_cycles() const {
    return clocked_ ? clocked_->in_cycles() : std::span<const uint64_t>{};
  }
  std::span<const uint64_t> out_cycles(int stream) const {
    return clocked_ ? clocked_->out_cycles(stream) : std::span<const uint64_t>{};
  }

 private:
  Plan plan_;
  Unit& golden_;
  Unit& other_;
  const Clocked* clocked_;  // the other one, if it has a clock
  Timeline* timeline_;
  uint64_t packets_in_ = 0;
  std::deque<StreamComparer> comparers_;  // one an output
};

}  // namespace photonloom
