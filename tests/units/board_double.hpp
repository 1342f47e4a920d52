// SPDX-License-Identifier: Apache-2.0
// The board's side of docs/host-link.md as plainly as possible, around a golden gatherer, and a
// link to it in time of its own that changes bytes: a double for tests of the host.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "golden/numeric/random.hpp"
#include "golden/packet/layout.hpp"
#include "golden/plan/plan_file.hpp"
#include "golden/unit/photon_gatherer.hpp"
#include "host/board.hpp"

namespace photonloom::test {

// Takes and gives bytes on the wire.
class BoardDouble {
 public:
  explicit BoardDouble(const Plan& plan) : plan_(plan), hash(plan_hash(plan)) { reset(); }

  const Plan plan_;
  // What a test may change.
  uint64_t hash;
  uint32_t magic = kLinkMagic, version = kLinkVersion;
  size_t rx_bytes = 700, output_room = 200;  // bytes, words
  size_t input_room = 20;                    // words
  bool stuck = false;                        // takes queries and answers none
  bool one_photon_too_many = false;
  bool mute = false;
  uint32_t clock_khz = 0;
  std::optional<uint32_t> flags;        // what it says, instead of what is so
  uint64_t replay_cycles = 0;           // that it says a replay took
  uint64_t full = 0, clamped = 0;       // results of the last replay's last pass, without the flush
  uint64_t asked = 0, loads = 0;        // queries that came in; configuration words written
  std::array<uint64_t, 12> counters{};  // as registers show them: modulo 2^40
  std::array<uint64_t, 12> each_adds{};  // what each query adds to them beyond its own counts
  uint64_t busy_adds = 0;  // what each frame that reads adds to the first, which runs meanwhile

  // What the maps must be for results to be right, as a load over the link writes them.
  void set_maps(const PhotonMap& global, const PhotonMap& caustic) {
    gatherer_ = make_golden_photon_gatherer(plan_);
    gatherer_->load(global, caustic);
    image_ = photon_gatherer_image(plan_, global, caustic);
  }

  // Power off and on.
  void reset() {
    decoder_ = {};
    session_ = 0;
    clear_streams();
    configuration_.clear();
    lines_.clear();
    replay_control_ = 0;
    replay_set_ = {1, 1, 0};
    replay_words_.assign(1 << 16, 0);
  }

  Bytes take(uint8_t byte) {
    if (mute) return {};
    const uint64_t bad = decoder_.bad();
    const auto content = decoder_.take(byte);
    if (decoder_.bad() != bad) return encode_frame(Bytes{0, 0xFF});
    if (!content) return {};
    const Bytes answer = execute(*content);
    return encode_frame(answer.empty() ? Bytes{0, 0xFF} : answer);
  }

  // Words of photon lines that came over the link, by address.
  const std::map<uint64_t, uint32_t>& lines() const { return lines_; }

  // Whether all of the maps came over the link.
  bool loaded() const {
    for (const CfgWrite& w : image_.cfg) {
      const auto at = configuration_.find(w.address);
      if (at == configuration_.end() || at->second != w.data) return false;
    }
    for (size_t map = 0; map < 2; ++map) {
      const uint64_t base =
          map ? plan_.memory_lines(plan_.global) * static_cast<uint64_t>(plan_.line_bytes()) : 0;
      for (size_t i = 0; i < image_.lines[map].size(); ++i) {
        const auto at = lines_.find((base + i) / 4);
        if (at == lines_.end() ||
            static_cast<uint8_t>(at->second >> (8 * (i % 4))) != image_.lines[map][i])
          return false;
      }
    }
    return true;
  }

 private:
  void clear_streams() {
    input_.clear();
    output_.clear();
    waiting_.clear();
    input_next_ = output_first_ = 0;
  }
  uint32_t output_end() const { return output_first_ + static_cast<uint32_t>(output_.size()); }

  Bytes execute(const Bytes& f) {
    const std::span<const uint8_t> body{f.data() + 2, f.size() - 2};
    Bytes answer{f[0], static_cast<uint8_t>(f[1] | 0x80)};
    const auto n_of = [&](size_t at) -> size_t { return body[at]; };
    switch (f[1]) {
      case 1:
        if (body.size() != 5 || n_of(4) < 1 || n_of(4) > 64) return {};
        for (size_t i = 0; i < n_of(4); ++i)
          put_u32(answer, read(get_u32(body, 0) + static_cast<uint32_t>(i)));
        counters[0] += busy_adds;
        return answer;
      case 2: {
        if (body.size() < 8 || body.size() % 4) return {};
        uint32_t status = 0;
        for (size_t i = 1; i < body.size() / 4; ++i)
          status = std::max(
              status, write(get_u32(body, 0) + static_cast<uint32_t>(i - 1), get_u32(body, 4 * i)));
        put_u32(answer, status);
        return answer;
      }
      case 3: {
        if (body.size() < 8 || body.size() % 4) return {};
        const uint32_t position = get_u32(body, 0);
        for (size_t i = 1; i < body.size() / 4; ++i)
          if (position + static_cast<uint32_t>(i - 1) == input_next_ &&
              input_.size() < input_room) {
            input_.push_back(get_u32(body, 4 * i));
            ++input_next_;
          }
        work();
        put_u32(answer, input_next_);
        put_u32(answer, static_cast<uint32_t>(input_room - input_.size()));
        return answer;
      }
      case 4: {
        if (body.size() != 9 || n_of(4) < 1 || n_of(4) > 64) return {};
        const uint32_t position = get_u32(body, 0), keep = get_u32(body, 5);
        if (keep - output_first_ <= output_.size()) {
          output_.erase(output_.begin(), output_.begin() + (keep - output_first_));
          output_first_ = keep;
        }
        work();
        const uint32_t at = position - output_first_;
        const bool there = at <= output_.size();
        put_u32(answer, there ? position : at < 0x80000000u ? output_end() : output_first_);
        put_u32(answer, output_end());
        for (size_t i = at; there && i < std::min(output_.size(), at + n_of(4)); ++i)
          put_u32(answer, output_[i]);
        return answer;
      }
    }
    return {};
  }

  uint32_t read(uint32_t address) const {
    const auto half = [address](uint64_t value) {
      return static_cast<uint32_t>(address & 1 ? value >> 32 : value);
    };
    switch (address) {
      case kRegMagic:
        return magic;
      case kRegVersion:
        return version;
      case kRegPlanHash:
      case kRegPlanHash + 1:
        return half(hash);
      case kRegSession:
        return session_;
      case kRegGatherers:
        return 1;
      case kRegRxBytes:
        return static_cast<uint32_t>(rx_bytes);
      case kRegInputPosition:
        return input_next_;
      case kRegOutputFirst:
        return output_first_;
      case kRegOutputEnd:
        return output_end();
      case kRegClockKhz:
        return clock_khz;
      case kRegReplayCycles:
      case kRegReplayCycles + 1:
        return half(replay_cycles);
      case kRegFlags:
        if (flags) return *flags;
        return kFlagMemoryReady | (waiting_.empty() && input_.empty() ? 0 : kFlagQueriesInside);
      case kRegReplayControl:
        return replay_control_;
      case kRegReplayResults:
        return static_cast<uint32_t>(replay_results_);
      case kRegReplaySignature:
      case kRegReplaySignature + 1:
        return half(replay_signature_);
      default:
        break;
    }
    if (address >= kRegCounters && address < kRegCounters + 2 * counters.size())
      return half(counters[(address - kRegCounters) / 2] +
                  (address == kRegCounters + 1 && busy_adds ? 2 : 0));
    return 0;
  }

  uint32_t write(uint32_t address, uint32_t value) {
    const uint32_t word = address & 0x0FFFFFFF;
    switch (address >> 28) {
      case 0:
        if (address == kRegSession) {
          if (value != session_) clear_streams();
          session_ = value;
          return 0;
        }
        if (address >= kRegReplayQueries && address <= kRegReplayMode) {
          replay_set_[address - kRegReplayQueries] = value;
          return 0;
        }
        if (address == kRegReplayControl) {
          if (value != replay_control_ && value) replay();
          replay_control_ = value;
          return 0;
        }
        return 1;
      case 1:
        if (word % 2 == 0) {
          low_ = value;
        } else {
          configuration_[word / 2] = low_ | uint64_t{value} << 32;
          ++loads;
        }
        return 0;
      case 2:
        lines_[word] = value;
        return 0;
      case 3:
        replay_words_.at(word) = value;
        return 0;
    }
    return 1;
  }

  // Answers the queries that are complete, as far as the output memory has room. Photons come
  // before their result here and there.
  void work() {
    const PacketLayout query = PacketLayout::of<GatherQuery>(plan_);
    for (;;) {
      while (!waiting_.empty() && output_.size() < output_room) {
        output_.push_back(waiting_.front());
        waiting_.pop_front();
      }
      if (!waiting_.empty() || stuck || input_.size() < query.words()) return;
      GatherQuery q{};
      query.unpack(input_.data(), &q);
      input_.erase(input_.begin(), input_.begin() + static_cast<long>(query.words()));
      ++asked;
      std::vector<GatherResult> results;
      std::vector<GatherPhoton> photons;
      gatherer_->process({&q, 1}, results, photons);
      const std::array<uint64_t, 12> own{0, !q.flush, results[0].nodes, results[0].leaves,
                                         results[0].insertions};
      for (size_t i = 0; i < counters.size(); ++i)
        counters[i] = (counters[i] + own[i] + each_adds[i]) % (uint64_t{1} << 40);
      if (one_photon_too_many && !photons.empty()) photons.push_back(photons.back());
      if (!loaded()) results[0].flux = {};  // it has no map
      const auto record = [&](uint32_t kind, const PacketLayout& layout, const void* packet) {
        std::vector<uint32_t> words(layout.words());
        layout.pack(packet, words.data());
        waiting_.push_back(kind);
        waiting_.insert(waiting_.end(), words.begin(), words.end());
      };
      const bool result_first = asked % 3 == 0;
      if (result_first) record(0, PacketLayout::of<GatherResult>(plan_), results.data());
      for (const GatherPhoton& p : photons) record(1, PacketLayout::of<GatherPhoton>(plan_), &p);
      if (!result_first) record(0, PacketLayout::of<GatherResult>(plan_), results.data());
    }
  }

  void replay() {
    const PacketLayout query = PacketLayout::of<GatherQuery>(plan_);
    const size_t stride = std::bit_ceil(query.words());
    std::vector<GatherQuery> queries(replay_set_[0]);
    for (size_t i = 0; i < queries.size(); ++i) {
      query.unpack(&replay_words_.at(i * stride), &queries[i]);
      queries[i].want_photons = 0;
    }
    if (replay_set_[2] & kReplayReordered) {
      std::vector<GatherQuery> ordered;
      make_golden_reorder_buffer(plan_)->process(queries, ordered);
      queries = ordered;
    }
    replay_results_ = queries.size() * uint64_t{replay_set_[1]};
    replay_signature_ = 0;
    for (uint32_t pass = 0; pass < replay_set_[1]; ++pass) {
      std::vector<GatherResult> results;
      std::vector<GatherPhoton> photons;
      gatherer_->process(queries, results, photons);
      const PacketLayout layout = PacketLayout::of<GatherResult>(plan_);
      full = clamped = 0;
      for (const GatherResult& r : results) {
        if (!r.flush) full += r.full, clamped += r.clamped;
        std::vector<uint32_t> words(layout.words() + 1, 0);
        layout.pack(&r, words.data());
        for (size_t i = 0; i < layout.words(); i += 2)
          replay_signature_ = (replay_signature_ >> 1) ^
                              (replay_signature_ & 1 ? 0xC96C5795D7870F42ull : 0) ^
                              (words[i] | uint64_t{words[i + 1]} << 32);
      }
    }
  }

  std::unique_ptr<PhotonGatherer> gatherer_;
  PhotonGathererImage image_;
  FrameDecoder decoder_;
  uint32_t session_ = 0, low_ = 0;
  std::vector<uint32_t> input_, output_;
  std::deque<uint32_t> waiting_;
  uint32_t input_next_ = 0, output_first_ = 0;
  std::map<uint64_t, uint64_t> configuration_;
  std::map<uint64_t, uint32_t> lines_;
  uint32_t replay_control_ = 0;
  std::array<uint32_t, 3> replay_set_{};
  std::vector<uint32_t> replay_words_;
  uint64_t replay_results_ = 0, replay_signature_ = 0;
};

// How often a byte is harmed, one in so many; 0: never.
struct Faults {
  uint64_t corrupt = 0, drop = 0, duplicate = 0;
};

// A wire whose bytes take time, and harm; `bytes_until_lost` bytes to the board later it breaks.
class FaultyLink final : public ByteLink {
 public:
  FaultyLink(BoardDouble& board, const Faults& faults, uint64_t seed,
             uint64_t bytes_until_lost = ~0ull)
      : board_(board), faults_(faults), seed_(seed), left_(bytes_until_lost) {}

  double byte_seconds = 1e-5;
  uint64_t reset_board_at = ~0ull;  // bytes to the board until somebody presses its button
  // What happened on it, kept by whoever made it.
  struct Log {
    uint64_t harmed = 0;  // bytes
    double seconds = 0;   // of the wire's own time
  };
  Log* log = nullptr;

  const std::string& name() const override { return name_; }
  double now() const override { return now_; }

  void write(std::span<const uint8_t> bytes) override {
    const auto harmed = [this](uint8_t byte) { return harm(byte); };
    for (const uint8_t byte : bytes) {
      if (left_-- == 0) throw LinkLost(name_ + ": is gone");
      if (bytes_++ == reset_board_at) board_.reset();
      // A board that has not yet room for what comes loses it.
      to_board_ = std::max(to_board_, now_) + byte_seconds;
      if (log) log->seconds = std::max(log->seconds, to_board_);
      for (const uint8_t b : harmed(byte))
        for (const uint8_t answer : board_.take(b))
          for (const uint8_t a : harmed(answer)) {
            to_host_ = std::max(to_host_, to_board_) + byte_seconds;
            arriving_.push_back({to_host_, a});
          }
    }
  }

  size_t read(std::span<uint8_t> to, double seconds) override {
    const double until = now_ + seconds;
    if (arriving_.empty() || arriving_.front().at > until) {
      now_ = until;
      return 0;
    }
    now_ = std::max(now_, arriving_.front().at);
    size_t n = 0;
    for (; n < to.size() && !arriving_.empty() && arriving_.front().at <= now_; ++n) {
      to[n] = arriving_.front().byte;
      arriving_.pop_front();
    }
    return n;
  }

 private:
  struct Arriving {
    double at;
    uint8_t byte;
  };
  Bytes harm(uint8_t byte) {
    const auto hit = [this](uint64_t one_in) {
      const bool hits = one_in && hash_bits(seed_, ++number_, 0, 0) % one_in == 0;
      if (hits && log) ++log->harmed;
      return hits;
    };
    if (hit(faults_.drop)) return {};
    if (hit(faults_.duplicate)) return {byte, byte};
    if (hit(faults_.corrupt))
      return {static_cast<uint8_t>(byte ^ (1 + hash_bits(seed_, ++number_, 1, 0) % 255))};
    return {byte};
  }

  std::string name_ = "double";
  BoardDouble& board_;
  Faults faults_;
  uint64_t seed_, number_ = 0, left_, bytes_ = 0;
  double now_ = 0, to_board_ = 0, to_host_ = 0;
  std::deque<Arriving> arriving_;
};

}  // namespace photonloom::test
