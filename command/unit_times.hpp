// SPDX-License-Identifier: Apache-2.0
// How long each unit of a frame takes.
#pragma once
#include <chrono>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "command/console.hpp"
#include "golden/pipeline/frame.hpp"

namespace photonloom {

// Seconds in a unit's calls: of the clock on the wall, and of all threads' CPU.
struct UnitTime {
  double wall = 0, cpu = 0;
};
using UnitTimes = std::map<std::string, UnitTime>;

// Hands everything on to `unit` and adds to `time` what its calls take.
template <class Unit, class In, class... Out>
class Timed final : public InFront<Unit> {
 public:
  Timed(std::unique_ptr<Unit> unit, UnitTime& time)
      : InFront<Unit>({unit.get()}), unit_(std::move(unit)), time_(time) {}

  void process(std::span<const In> in, std::vector<Out>&... out) override {
    const auto start = std::chrono::steady_clock::now();
    const double cpu = cpu_seconds();
    unit_->process(in, out...);
    time_.cpu += cpu_seconds() - cpu;
    time_.wall += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  Counters counters() const override { return unit_->counters(); }

 private:
  std::unique_ptr<Unit> unit_;
  UnitTime& time_;
};

template <class Unit, class In, class... Out>
std::unique_ptr<Unit> timed(std::unique_ptr<Unit> unit, const PacketUnit<In, Out...>*,
                            UnitTime& time) {
  return std::make_unique<Timed<Unit, In, Out...>>(std::move(unit), time);
}

// The same units, each call of them timed. `times` must outlive them.
inline FrameUnits timed_units(FrameUnits units, UnitTimes& times) {
  for_each_unit([&](auto unit) {
    using Unit = typename decltype(unit)::type;
    auto& inner = units.of(unit);
    const Unit* kind = inner.get();
    if (kind) inner = timed<Unit>(std::move(inner), kind, times[unit_name<Unit>]);
  });
  return units;
}

}  // namespace photonloom
