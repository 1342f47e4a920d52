// SPDX-License-Identifier: Apache-2.0
#include <map>
#include <utility>

#include "verilator_tb/unit/comparing.hpp"
#include "verilator_tb/unit/hls_unit.hpp"
#include "verilator_tb/unit/stream_unit.hpp"

namespace photonloom {

namespace {

class RtlReorderBuffer final : public StreamUnit<ReorderBuffer> {
 public:
  RtlReorderBuffer(const Plan& plan, const RunOptions& options)
      : StreamUnit(plan, options),
        capacity_(plan.reorder_key == ReorderKey::kNone
                      ? 1
                      : static_cast<uint64_t>(plan.reorder_packets)) {}

 private:
  // A flush brings all that is held, itself too; any other one packet, once the buffer is full.
  uint64_t brings(const GatherQuery& query) override {
    ++held_;
    if (query.flush) return std::exchange(held_, 0);
    if (held_ < capacity_) return 0;
    --held_;
    return 1;
  }

  uint64_t capacity_, held_ = 0;
};

// Counts "displacement" too, the sum over "packets matched" of the distance between places in and
// out.
class ComparingReorderBuffer final
    : public ComparingStreams<ReorderBuffer, GatherQuery, GatherQuery> {
 public:
  using ComparingStreams::ComparingStreams;

 private:
  // What goes in comes out: the packet due is itself the input.
  std::string input(size_t, size_t i, std::span<const GatherQuery>,
                    const std::vector<GatherQuery>& due) const override {
    return text(due[i]);
  }
  // Where each packet that came out had gone in.
  void follow(std::span<const GatherQuery> in, std::span<const GatherQuery> out) override {
    const auto from = in_cycles(), to = out_cycles(0);
    for (size_t n = 0; n < in.size(); ++n)
      if (!in[n].flush)
        inside_[{in[n].pixel, in[n].sample, in[n].tag, in[n].map}] = {
            packets_in() + n, n < from.size() ? from[n] : 0};
    for (size_t n = 0; n < out.size(); ++n, ++packets_out_) {
      const auto at = inside_.find({out[n].pixel, out[n].sample, out[n].tag, out[n].map});
      if (out[n].flush || at == inside_.end()) continue;
      const uint64_t place = at->second.first;
      displacement_ += std::max(place, packets_out_) - std::min(place, packets_out_);
      ++matched_;
      if (n < to.size()) show(out[n], at->second.second, to[n]);
      inside_.erase(at);
    }
  }
  void add_own_counters(Counters& counters) const override {
    counters["displacement"] = displacement_;
    counters["packets matched"] = matched_;
  }

  uint64_t packets_out_ = 0, displacement_ = 0, matched_ = 0;
  // By pixel, sample, tag and map: place and cycle in.
  std::map<std::array<uint32_t, 4>, std::pair<uint64_t, uint64_t>> inside_;
};

}  // namespace

std::unique_ptr<Comparing<ReorderBuffer>> compare_units(const Plan& plan,
                                                        const CompareContext& context,
                                                        ReorderBuffer& golden,
                                                        ReorderBuffer& other) {
  return std::make_unique<ComparingReorderBuffer>(plan, context, golden, other);
}

std::unique_ptr<ClockedReorderBuffer> make_rtl_reorder_buffer(const Plan& plan,
                                                              const RunOptions& options) {
  if (options.kind == ModelKind::kHls)
    return std::make_unique<HlsStreamUnit<ReorderBuffer>>(plan, options);
  return std::make_unique<RtlReorderBuffer>(plan, options);
}

}  // namespace photonloom
