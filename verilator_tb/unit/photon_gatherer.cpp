// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "verilator_tb/unit/comparing.hpp"
#include "verilator_tb/unit/gatherer_unit.hpp"
#include "verilator_tb/unit/hls_unit.hpp"

namespace photonloom {

namespace {

class RtlPhotonGatherer final : public GathererUnit {
 public:
  RtlPhotonGatherer(const Plan& plan, const RunOptions& options)
      : GathererUnit(plan, unit_name<PhotonGatherer>, options, options.latency),
        memory_(rig_.add_memory(plan)) {
    rig_.reset();
  }

 private:
  void load_lines(PhotonGathererImage image) override {
    image_ = std::move(image);
    configure(image_.cfg);
    rig_.cycle();
    memory_.load(image_.lines);
  }
  void configure_again() override {
    configure(image_.cfg);
    rig_.cycle();
  }
  void add_own_counters(Counters& c) const override {
    c["line requests"] = memory_.requests();
    c["bytes read"] = memory_.bytes();
  }

  LineMemory& memory_;
  PhotonGathererImage image_;  // of which memory_ reads the lines
};

class HlsPhotonGatherer final : public HlsUnit<PhotonGatherer> {
 public:
  HlsPhotonGatherer(const Plan& plan, const RunOptions& options)
      : HlsUnit(plan, options),
        query_(PacketLayout::of<GatherQuery>(plan)),
        result_(PacketLayout::of<GatherResult>(plan)),
        photon_(PacketLayout::of<GatherPhoton>(plan)) {}

  void load(const PhotonMap& global, const PhotonMap& caustic) override {
    const PhotonGathererImage image = photon_gatherer_image(plan_, global, caustic);
    for (const CfgWrite& w : image.cfg) kernel_.configure(w.address, w.data);
    for (const int map : {0, 1}) kernel_.load_lines(map, image.lines[static_cast<size_t>(map)]);
  }
  void process(std::span<const GatherQuery> in, std::vector<GatherResult>& results,
               std::vector<GatherPhoton>& photons) override {
    kernel_.run(query_, in);
    const size_t first = results.size();
    kernel_.take(0, result_, results);
    kernel_.take(1, photon_, photons);
    packets_ += in.size();
    for (size_t i = first; i < results.size(); ++i) {
      nodes_ += results[i].nodes;
      leaves_ += results[i].leaves;
      insertions_ += results[i].insertions;
    }
  }
  Counters counters() const override {
    Counters c = HlsUnit::counters();
    c["nodes"] = nodes_;
    c["leaves"] = leaves_;
    c["insertions"] = insertions_;
    // The kernel has no cache; how many lines a leaf has it does not tell.
    if (!plan_.compressed()) c["bytes read"] = leaves_ * static_cast<uint64_t>(plan_.line_bytes());
    return c;
  }

 private:
  PacketLayout query_, result_, photon_;
  uint64_t nodes_ = 0, leaves_ = 0, insertions_ = 0;  // of all results
};

class ComparingPhotonGatherer final
    : public ComparingStreams<PhotonGatherer, GatherQuery, GatherResult, GatherPhoton> {
 public:
  using ComparingStreams::ComparingStreams;

 private:
  std::string input(size_t stream, size_t i, std::span<const GatherQuery> in,
                    const std::vector<GatherResult>& results,
                    const std::vector<GatherPhoton>&) const override {
    if (stream == 0) return text(in[i]);
    // The query whose photons hold the i-th.
    for (size_t q = 0; q < in.size(); ++q) {
      if (!in[q].want_photons || in[q].flush) continue;
      if (i < results[q].count) return text(in[q]);
      i -= results[q].count;
    }
    return "none";
  }
  void follow(std::span<const GatherQuery> in, std::span<const GatherResult> results,
              std::span<const GatherPhoton>) override {
    for (const GatherResult& r : results) {
      if (r.flush) continue;
      full_ += r.full;
      clamped_ += r.clamped;
    }
    const auto from = in_cycles(), to = out_cycles(0);
    for (size_t i = 0; i < std::min({in.size(), from.size(), to.size()}); ++i)
      show(in[i], from[i], to[i]);
  }
  void add_own_counters(Counters& counters) const override {
    counters["full"] = full_;
    counters["clamped"] = clamped_;
  }

  uint64_t full_ = 0, clamped_ = 0;  // flags of the results that came
};

}  // namespace

std::unique_ptr<Comparing<PhotonGatherer>> compare_units(const Plan& plan,
                                                         const CompareContext& context,
                                                         PhotonGatherer& golden,
                                                         PhotonGatherer& other) {
  return std::make_unique<ComparingPhotonGatherer>(plan, context, golden, other);
}

std::unique_ptr<ClockedPhotonGatherer> make_rtl_photon_gatherer(const Plan& plan,
                                                                const RunOptions& options) {
  if (options.kind == ModelKind::kHls) return std::make_unique<HlsPhotonGatherer>(plan, options);
  return std::make_unique<RtlPhotonGatherer>(plan, options);
}

}  // namespace photonloom
