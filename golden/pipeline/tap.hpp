// SPDX-License-Identifier: Apache-2.0
// A unit whose packets somebody else sees too: recorder and watch stand in front of it.
#pragma once
#include <array>
#include <iterator>
#include <memory>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "golden/unit/backend.hpp"

namespace photonloom {

// Hands everything on to `unit`, and each stream's packets, in order, to what sees it: Seer<P> has
// see(std::span<const P>).
template <template <class> class Seer, class Unit, class In, class... Out>
class Tapped final : public InFront<Unit> {
 public:
  using Seers = std::tuple<std::shared_ptr<Seer<In>>, std::shared_ptr<Seer<Out>>...>;
  Tapped(std::unique_ptr<Unit> unit, Seers seers)
      : InFront<Unit>({unit.get()}), unit_(std::move(unit)), seers_(std::move(seers)) {}

  void process(std::span<const In> in, std::vector<Out>&... out) override {
    const std::array<size_t, sizeof...(Out)> before{out.size()...};
    unit_->process(in, out...);
    std::apply(
        [&](auto& of_in, auto&... of_out) {
          of_in->see(in);
          size_t stream = 0;
          (of_out->see(std::span<const Out>(out).subspan(before[stream++])), ...);
        },
        seers_);
  }
  Counters counters() const override { return unit_->counters(); }

 private:
  std::unique_ptr<Unit> unit_;
  Seers seers_;
};

// `begin(std::type_identity<P>{}, stream)` gives the std::shared_ptr<Seer<P>> of a stream, by its
// name in Unit::kRecorded, the input's first.
template <template <class> class Seer, class Unit, class Begin, class In, class... Out>
std::unique_ptr<Unit> tapped(std::unique_ptr<Unit> unit, const PacketUnit<In, Out...>*,
                             Begin begin) {
  static_assert(std::size(Unit::kRecorded) == 1 + sizeof...(Out));
  size_t n = 0;
  const auto seer = [&](auto packet) { return begin(packet, Unit::kRecorded[n++]); };
  // In braces: from left to right.
  typename Tapped<Seer, Unit, In, Out...>::Seers seers{seer(std::type_identity<In>{}),
                                                       seer(std::type_identity<Out>{})...};
  return std::make_unique<Tapped<Seer, Unit, In, Out...>>(std::move(unit), std::move(seers));
}

}  // namespace photonloom
