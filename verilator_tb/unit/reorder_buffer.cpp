// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "verilator_tb/unit/stream_unit.hpp"

namespace photonloom {

namespace {

class RtlReorderBuffer final : public StreamUnit<ClockedReorderBuffer, GatherQuery, GatherQuery> {
 public:
  RtlReorderBuffer(const Plan& plan, const RunOptions& options)
      : StreamUnit(plan, "reorder_buffer", options),
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

}  // namespace

std::unique_ptr<ClockedReorderBuffer> make_rtl_reorder_buffer(const Plan& plan,
                                                              const RunOptions& options) {
  return std::make_unique<RtlReorderBuffer>(plan, options);
}

}  // namespace photonloom
