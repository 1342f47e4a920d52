// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/unit/compare_units.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <map>

#include "golden/packet/trace.hpp"
#include "verilator_tb/rig/timeline.hpp"

namespace photonloom {
namespace {

template <class P>
std::string text_of(const Plan& plan, const P& packet) {
  return packet_to_json(PacketLayout::of<P>(plan), &packet);
}

// What a packet is called in the timeline.
template <class P>
std::string label(const P& p) {
  return fmt::format("pixel {} sample {} tag {}", p.pixel, p.sample, p.tag);
}

class ComparingPhotonGatherer final : public Comparing<PhotonGatherer> {
 public:
  ComparingPhotonGatherer(const Plan& plan, const CompareContext& context, PhotonGatherer& golden,
                          PhotonGatherer& other)
      : plan_(plan),
        golden_(golden),
        other_(other),
        clocked_(dynamic_cast<const Clocked*>(&other)),
        timeline_(context.timeline),
        results_(PacketLayout::of<GatherResult>(plan), "result", context),
        photons_(PacketLayout::of<GatherPhoton>(plan), "photon", context) {}

  void load(const PhotonMap& global, const PhotonMap& caustic) override {
    golden_.load(global, caustic);
    other_.load(global, caustic);
  }
  void process(std::span<const GatherQuery> in, std::vector<GatherResult>& results,
               std::vector<GatherPhoton>& photons) override {
    std::vector<GatherResult> golden_results;
    std::vector<GatherPhoton> golden_photons;
    golden_.process(in, golden_results, golden_photons);
    packets_in_ += in.size();
    const size_t result0 = results.size(), photon0 = photons.size();
    other_.process(in, results, photons);
    results_.compare<GatherResult>(golden_results, std::span(results).subspan(result0),
                                   out_cycles(0), [&](size_t i) { return text_of(plan_, in[i]); });
    photons_.compare<GatherPhoton>(golden_photons, std::span(photons).subspan(photon0),
                                   out_cycles(1), [&](size_t i) {
                                     // The query whose photons hold the i-th.
                                     for (size_t q = 0; q < in.size(); ++q) {
                                       if (!in[q].want_photons || in[q].flush) continue;
                                       if (i < golden_results[q].count)
                                         return text_of(plan_, in[q]);
                                       i -= golden_results[q].count;
                                     }
                                     return std::string("none");
                                   });
    if (!timeline_ || !clocked_) return;
    const auto from = clocked_->in_cycles(), to = out_cycles(0);
    for (size_t i = 0; i < std::min({in.size(), from.size(), to.size()}); ++i)
      timeline_->add("photon_gatherer", label(in[i]), from[i], to[i]);
  }
  Counters counters() const override { return other_.counters(); }
  uint64_t packets_in() const override { return packets_in_; }
  uint64_t compared() const override { return results_.compared() + photons_.compared(); }
  uint64_t differences() const override { return results_.differences() + photons_.differences(); }
  std::string first_report() const override {
    return results_.first_report().empty() ? photons_.first_report() : results_.first_report();
  }

 private:
  std::span<const uint64_t> out_cycles(int stream) const {
    return clocked_ ? clocked_->out_cycles(stream) : std::span<const uint64_t>{};
  }
  Plan plan_;
  PhotonGatherer& golden_;
  PhotonGatherer& other_;
  const Clocked* clocked_;  // the other one, if it has a clock
  Timeline* timeline_;
  uint64_t packets_in_ = 0;
  StreamComparer results_, photons_;
};

// Units of one stream in and one out.
template <class Unit, class Clocked, class In, class Out>
class ComparingStreams final : public Comparing<Unit> {
 public:
  ComparingStreams(const Plan& plan, const CompareContext& context, Unit& golden, Clocked& other)
      : plan_(plan),
        unit_(context.unit),
        golden_(golden),
        other_(other),
        timeline_(context.timeline),
        out_(PacketLayout::of<Out>(plan), "out", context) {}

  void process(std::span<const In> in, std::vector<Out>& out) override {
    std::vector<Out> golden_out;
    golden_.process(in, golden_out);
    const size_t out0 = out.size();
    other_.process(in, out);
    out_.template compare<Out>(golden_out, std::span(out).subspan(out0), other_.out_cycles(0),
                               [&](size_t i) { return input(in, golden_out, i); });
    follow(in, std::span(out).subspan(out0));
    packets_in_ += in.size();
  }
  Counters counters() const override {
    Counters c = other_.counters();
    if constexpr (std::is_same_v<In, GatherQuery>) {
      c["displacement"] = displacement_;
      c["packets matched"] = matched_;
    }
    return c;
  }
  uint64_t packets_in() const override { return packets_in_; }
  uint64_t compared() const override { return out_.compared(); }
  uint64_t differences() const override { return out_.differences(); }
  std::string first_report() const override { return out_.first_report(); }

 private:
  std::string input(std::span<const In> in, const std::vector<Out>& golden_out, size_t i) const {
    if constexpr (std::is_same_v<In, SamplerInput>) {
      for (const In& packet : in)
        if (packet.kind == 2 && i-- == 0) return text_of(plan_, packet);
      return "none";
    } else {
      // What goes in comes out: the packet due is itself the input.
      return text_of(plan_, golden_out[i]);
    }
  }
  // Where each packet that came out had gone in.
  void follow(std::span<const In> in, std::span<const Out> out) {
    const auto from = other_.in_cycles(), to = other_.out_cycles(0);
    if constexpr (std::is_same_v<In, SamplerInput>) {
      size_t i = 0;
      for (size_t n = 0; n < in.size(); ++n) {
        if (in[n].kind != 2) continue;
        if (timeline_ && n < from.size() && i < std::min(out.size(), to.size()))
          timeline_->add(unit_, label(out[i]), from[n], to[i]);
        ++i;
      }
    } else {
      for (size_t n = 0; n < in.size(); ++n)
        if (!in[n].flush)
          inside_[{in[n].pixel, in[n].sample, in[n].tag, in[n].map}] = {
              packets_in_ + n, n < from.size() ? from[n] : 0};
      for (size_t n = 0; n < out.size(); ++n, ++packets_out_) {
        const auto at = inside_.find({out[n].pixel, out[n].sample, out[n].tag, out[n].map});
        if (out[n].flush || at == inside_.end()) continue;
        const uint64_t place = at->second.first;
        displacement_ += std::max(place, packets_out_) - std::min(place, packets_out_);
        ++matched_;
        if (timeline_ && n < to.size())
          timeline_->add(unit_, label(out[n]), at->second.second, to[n]);
        inside_.erase(at);
      }
    }
  }
  Plan plan_;
  std::string unit_;
  Unit& golden_;
  Clocked& other_;
  Timeline* timeline_;
  uint64_t packets_in_ = 0, packets_out_ = 0, displacement_ = 0, matched_ = 0;
  // By pixel, sample, tag and map: place and cycle in.
  std::map<std::array<uint32_t, 4>, std::pair<uint64_t, uint64_t>> inside_;
  StreamComparer out_;
};

}  // namespace

std::unique_ptr<Comparing<PhotonGatherer>> compare_units(const Plan& plan,
                                                         const CompareContext& context,
                                                         PhotonGatherer& golden,
                                                         PhotonGatherer& other) {
  return std::make_unique<ComparingPhotonGatherer>(plan, context, golden, other);
}

std::unique_ptr<Comparing<ReorderBuffer>> compare_units(const Plan& plan,
                                                        const CompareContext& context,
                                                        ReorderBuffer& golden,
                                                        ClockedReorderBuffer& other) {
  return std::make_unique<
      ComparingStreams<ReorderBuffer, ClockedReorderBuffer, GatherQuery, GatherQuery>>(
      plan, context, golden, other);
}

std::unique_ptr<Comparing<CdfSampler>> compare_units(const Plan& plan,
                                                     const CompareContext& context,
                                                     CdfSampler& golden, ClockedCdfSampler& other) {
  return std::make_unique<ComparingStreams<CdfSampler, ClockedCdfSampler, SamplerInput, Sample>>(
      plan, context, golden, other);
}

}  // namespace photonloom
