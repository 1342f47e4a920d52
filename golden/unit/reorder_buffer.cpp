// SPDX-License-Identifier: Apache-2.0
#include "golden/unit/reorder_buffer.hpp"

#include <algorithm>
#include <vector>

#include "golden/numeric/bits.hpp"
#include "golden/numeric/hilbert.hpp"
#include "golden/plan/plan_file.hpp"

namespace photonloom {

uint32_t reorder_bin(const Plan& plan, const UVec3& position) {
  const int cell_bits = plan.reorder_cell_bits, shift = plan.position_bits - cell_bits;
  const int bin_bits = clog2(static_cast<uint64_t>(plan.reorder_bins));
  const UVec3 cell{position[0] >> shift, position[1] >> shift, position[2] >> shift};
  if (plan.reorder_key == ReorderKey::kHash) {
    const uint32_t code = (((cell[2] << cell_bits) | cell[1]) << cell_bits) | cell[0];
    return static_cast<uint32_t>(uint64_t{code * 2654435769u} >> (32 - bin_bits));
  }
  return static_cast<uint32_t>(hilbert_index(cell, cell_bits) >> (3 * cell_bits - bin_bits));
}

namespace {

constexpr uint32_t kNone = ~0u;

class PassThrough final : public ReorderBuffer {
 public:
  void process(std::span<const GatherQuery> in, std::vector<GatherQuery>& out) override {
    out.insert(out.end(), in.begin(), in.end());
    packets_ += in.size();
  }
  Counters counters() const override { return {{"packets", packets_}}; }

 private:
  uint64_t packets_ = 0;
};

// A pool of packets linked into a FIFO per bin.
class GoldenReorderBuffer final : public ReorderBuffer {
 public:
  explicit GoldenReorderBuffer(const Plan& plan)
      : plan_(plan),
        capacity_(static_cast<uint32_t>(plan.reorder_packets)),
        pool_(capacity_),
        next_(capacity_),
        bins_(static_cast<size_t>(plan.reorder_bins)),
        length_(bins_.size()),
        occupied_((bins_.size() + 63) / 64) {
    for (uint32_t slot = 0; slot < capacity_; ++slot) next_[slot] = slot + 1;
  }

  void process(std::span<const GatherQuery> in, std::vector<GatherQuery>& out) override {
    out.reserve(out.size() + in.size());
    for (const GatherQuery& query : in) {
      ++packets_;
      if (query.flush) {
        ++flushes_;
        while (held_ > 0) release(out);
        out.push_back(query);
        current_ = 0;
        fixed_ = 0;
        continue;
      }
      accept(query);
      if (held_ == capacity_) release(out);
    }
  }

  Counters counters() const override {
    return {{"packets", packets_}, {"flushes", flushes_}, {"choices", choices_}};
  }

 private:
  struct Bin {
    uint32_t head, tail;
  };

  void accept(const GatherQuery& query) {
    const uint32_t slot = free_;
    free_ = next_[slot];
    pool_[slot] = query;
    next_[slot] = kNone;
    const uint32_t b = reorder_bin(plan_, query.position);
    Bin& bin = bins_[b];
    if (length_[b]++ == 0) {
      bin.head = slot;
      occupied_[b / 64] |= uint64_t{1} << (b % 64);
    } else {
      next_[bin.tail] = slot;
    }
    bin.tail = slot;
    ++held_;
  }

  // Takes the oldest packet of the bin that the drain rule names. held_ > 0.
  void release(std::vector<GatherQuery>& out) {
    if (plan_.reorder_drain == ReorderDrain::kSweep) {
      if (length_[current_] == 0) {
        current_ = next_occupied(current_);
        ++choices_;
      }
    } else if (fixed_ == 0) {
      current_ =
          static_cast<uint32_t>(std::max_element(length_.begin(), length_.end()) - length_.begin());
      fixed_ = length_[current_];
      ++choices_;
    }
    if (fixed_ > 0) --fixed_;
    Bin& bin = bins_[current_];
    const uint32_t slot = bin.head;
    out.push_back(pool_[slot]);
    bin.head = next_[slot];
    if (--length_[current_] == 0) occupied_[current_ / 64] &= ~(uint64_t{1} << (current_ % 64));
    next_[slot] = free_;
    free_ = slot;
    --held_;
  }

  // The first occupied bin after b in cyclic order; there is one.
  uint32_t next_occupied(uint32_t b) const {
    size_t word = b / 64;
    uint64_t bits = b % 64 == 63 ? 0 : occupied_[word] >> (b % 64 + 1) << (b % 64 + 1);
    while (bits == 0) {
      word = word + 1 == occupied_.size() ? 0 : word + 1;
      bits = occupied_[word];
    }
    return static_cast<uint32_t>(word * 64) + static_cast<uint32_t>(std::countr_zero(bits));
  }

  const Plan plan_;
  const uint32_t capacity_;
  std::vector<GatherQuery> pool_;
  std::vector<uint32_t> next_;  // in the bin, or in the list of free slots
  std::vector<Bin> bins_;
  std::vector<uint32_t> length_;
  std::vector<uint64_t> occupied_;
  uint32_t free_ = 0, held_ = 0;
  uint32_t current_ = 0;  // the bin being drained
  uint32_t fixed_ = 0;    // fullest: packets still to leave before the next choice
  uint64_t packets_ = 0, flushes_ = 0, choices_ = 0;
};

}  // namespace

std::unique_ptr<ReorderBuffer> make_golden_reorder_buffer(const Plan& plan) {
  check_plan(plan);
  return make_golden_reorder_pool(plan);
}

std::unique_ptr<ReorderBuffer> make_golden_reorder_pool(const Plan& plan) {
  if (plan.reorder_key == ReorderKey::kNone) return std::make_unique<PassThrough>();
  return std::make_unique<GoldenReorderBuffer>(plan);
}

}  // namespace photonloom
