// SPDX-License-Identifier: Apache-2.0
// The reorder buffer as an HLS kernel: queries in, the same queries out, bin by bin
// (docs/reorder_buffer.md). A bin is a linked list through the pool. Mirrors
// golden/unit/reorder_buffer.cpp.
//
// One pipelined loop. A turn takes a query and lets another leave, or lets one leave before a
// flush, or looks at kLook bins for the fullest one. The initiation interval is 4 by the dependency
// length_: whether the current bin is empty decides the bin (read 1, choose 1), whose length is
// changed (read 1, write 1) before the next turn reads it. The list's own, head_ -> next_ -> head_,
// takes 3.
#pragma once
#include "hls_kernels/reorder_buffer/timing.hpp"
#include "hls_kernels/vocabulary.hpp"

namespace photonloom_hls {

template <class T>
class ReorderBuffer {
  template <int W>
  using uint = typename T::template uint<W>;
  using Query = GatherQuery<T>;
  using QueryStream = typename T::template stream<Query>;

  static constexpr bool kPassThrough = kReorderKey == 0;
  static constexpr bool kFullest = kReorderDrain == 1;
  static constexpr int kBinBits = clog2(kReorderBins);
  static constexpr int kWord =
      kReorderBins < 64 ? kReorderBins : 64;  // bins in a word of the bitmap
  static constexpr int kWords = kReorderBins / kWord;
  static constexpr int kLook =
      kReorderBins < ReorderTiming::kBinsALook ? kReorderBins : ReorderTiming::kBinsALook;
  static constexpr int kLooks = kReorderBins / kLook;
  using Bin = uint<at_least(1, kBinBits)>;
  using Slot = uint<at_least(1, clog2(kReorderPackets))>;
  using Length = uint<clog2(kReorderPackets + 1)>;
  using Word = uint<kWord>;
  using Summary = uint<kWords>;

 public:
  static constexpr unsigned kInterval = kPassThrough ? 1 : ReorderTiming::kLengthLatency;

  struct StreamPlaces {};  // it has no stream within

  // As after reset.
  ReorderBuffer() { clear(); }

  // Takes `packets` packets and gives all that they let leave.
  void run(QueryStream& in, QueryStream& out, const uint<32>& packets) {
    uint<32> taken = 0;
    const uint<64> most = uint<64>(2 * packets + kReorderPackets + 1) * (kLooks + 2);
    for (uint<64> turn = 0; turn < most; ++turn) {
      HLS_PIPELINE(kInterval);
      if (taken == packets && !busy()) break;
      if (kPassThrough) {
        out.write(in.read());
        taken += 1;
      } else if (looking_) {
        look();
      } else {
        if (!busy()) {
          const Query query = in.read();
          taken += 1;
          if (query.flush == 1) {
            flush_ = query;
            draining_ = true;
          } else {
            insert(query);
            owed_ = held_ == kReorderPackets;
          }
        }
        if (busy()) leave(out);
      }
    }
  }

 private:
  bool busy() const { return owed_ || draining_; }

  // A packet that is due leaves, or the fullest bin has to be found first.
  void leave(QueryStream& out) {
    if (held_ == 0) {
      out.write(flush_);
      draining_ = false;
      current_ = 0;
      fixed_ = 0;
      wrapped_ = false;
      return;
    }
    if (kFullest && fixed_ == 0) {
      looking_ = true;
      looked_ = 0;
      best_ = 0;
      return;
    }
    if (!kFullest && length_[index(current_)] == 0) current_ = next_bin();
    if (kFullest) fixed_ -= 1;
    const Slot slot = head_[index(current_)];
    out.write(pool_[index(slot)]);
    head_[index(current_)] = next_[index(slot)];
    const Length left = length_[index(current_)] - 1;
    length_[index(current_)] = left;
    if (left == 0) mark(current_, false);
    held_ -= 1;
    spare_ = slot;
    wrapped_ = true;
    owed_ = false;
  }

  // Slots are handed out one after the other; from the first packet that left on each takes the
  // place of the one that left before, until a flush has emptied the pool.
  void insert(const Query& query) {
    Slot slot = held_;
    if (wrapped_) slot = spare_;
    const Bin bin = bin_of(query);
    pool_[index(slot)] = query;
    const Length length = length_[index(bin)];
    if (length == 0) {
      head_[index(bin)] = slot;
      mark(bin, true);
    } else {
      next_[index(tail_[index(bin)])] = slot;
    }
    tail_[index(bin)] = slot;
    length_[index(bin)] = length + 1;
    held_ += 1;
  }

  // The fullest of kLook bins more.
  void look() {
    HLS_PARTITION(length_, 1)
    for (int i = 0; i < kLook; ++i) {
      HLS_UNROLL
      const unsigned bin = index(looked_) * kLook + static_cast<unsigned>(i);
      if (length_[bin] > best_) {
        best_ = length_[bin];
        current_ = bin;
      }
    }
    looked_ += 1;
    if (looked_ == kLooks) {
      looking_ = false;
      fixed_ = best_;
    }
  }

  // The first bin after the current one, in cyclic order, that holds a packet; there is one.
  Bin next_bin() const {
    const unsigned word = index(current_) / kWord, above = index(current_) % kWord + 1;
    const Word here = occupied_[word] >> above << above;
    if (here != 0) return word * kWord + index(lowest_bit<T, kWord>(here));
    const Summary later = summary_ >> (word + 1) << (word + 1);
    unsigned next = 0;
    if (later != 0)
      next = index(lowest_bit<T, kWords>(later));
    else
      next = index(lowest_bit<T, kWords>(summary_));
    return next * kWord + index(lowest_bit<T, kWord>(occupied_[next]));
  }

  void mark(const Bin& bin, bool holds) {
    const unsigned word = index(bin) / kWord;
    const Word bit = Word(1) << (index(bin) % kWord);
    const Summary summary_bit = Summary(1) << word;
    Word changed = occupied_[word] | bit;
    if (!holds) changed = changed ^ bit;
    occupied_[word] = changed;
    Summary summary = summary_ | summary_bit;
    if (changed == 0) summary = summary ^ summary_bit;
    summary_ = summary;
  }

  // The key of a query's cell, its top bits.
  static Bin bin_of(const Query& query) {
    if (kBinBits == 0) return 0;
    uint<kReorderCellBits> cell[3];
    for (int axis = 0; axis < 3; ++axis) {
      HLS_UNROLL
      cell[axis] = T::template slice<kReorderCellBits>(query.position[axis],
                                                       kPositionBits - kReorderCellBits);
    }
    if (kReorderKey == 2) {
      uint<32> code = cell[2];
      code = code << kReorderCellBits | cell[1];
      code = code << kReorderCellBits | cell[0];
      const uint<32> factor = 2654435769u;
      const uint<32> product = code * factor;
      return product >> (32 - kBinBits);
    }
    return hilbert(cell) >> (3 * kReorderCellBits - kBinBits);
  }

  // The Hilbert index of a cell (golden/numeric/hilbert.hpp), level by level.
  static uint<3 * kReorderCellBits> hilbert(uint<kReorderCellBits> (&x)[3]) {
    using Cell = uint<kReorderCellBits>;
    for (int level = kReorderCellBits - 1; level > 0; --level) {
      HLS_UNROLL
      const Cell below = (1 << level) - 1;
      for (int axis = 0; axis < 3; ++axis) {
        HLS_UNROLL
        const Cell differ = (x[0] ^ x[axis]) & below;
        if (x[axis][level]) {
          x[0] = x[0] ^ below;
        } else {
          x[0] = x[0] ^ differ;
          x[axis] = x[axis] ^ differ;
        }
      }
    }
    x[1] = x[1] ^ x[0];
    x[2] = x[2] ^ x[1];
    Cell turned = 0;
    for (int level = kReorderCellBits - 1; level > 0; --level) {
      HLS_UNROLL
      const Cell below = (1 << level) - 1;
      if (x[2][level]) turned = turned ^ below;
    }
    uint<3 * kReorderCellBits> key = 0;
    for (int level = kReorderCellBits - 1; level >= 0; --level) {
      HLS_UNROLL
      for (int axis = 0; axis < 3; ++axis) {
        HLS_UNROLL
        const uint<1> bit = x[axis][level] ^ turned[level];
        key = key << 1 | bit;
      }
    }
    return key;
  }

  void clear() {
    for (int bin = 0; bin < kReorderBins; ++bin) length_[bin] = 0;
    for (int word = 0; word < kWords; ++word) occupied_[word] = 0;
    summary_ = 0;
    current_ = 0;
    held_ = 0;
    fixed_ = 0;
  }

  static constexpr int kSlots = kPassThrough ? 1 : kReorderPackets;
  Query pool_[kSlots];
  Slot next_[kSlots];  // behind it in its bin
  Slot head_[kReorderBins], tail_[kReorderBins];
  Length length_[kReorderBins];
  Word occupied_[kWords];  // bins that hold a packet
  Summary summary_;        // words that are not 0
  Bin current_;            // the bin that packets leave
  Length held_;
  Length fixed_;  // fullest: how many leave before the next choice
  Slot spare_;    // of the packet that left last
  bool wrapped_ = false;
  bool owed_ = false;      // the pool is full
  bool draining_ = false;  // before flush_
  Query flush_;
  bool looking_ = false;
  uint<clog2(kLooks + 1) + 1> looked_;
  Length best_;
};

}  // namespace photonloom_hls
