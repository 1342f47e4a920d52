// SPDX-License-Identifier: Apache-2.0
// A board and the other end of its cable. Frames, CRC and stuffing are written here once more from
// docs/host-link.md, apart from the host's library.
#pragma once
#include <algorithm>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "golden/packet/layout.hpp"
#include "golden/packet/signature.hpp"
#include "golden/plan/plan_file.hpp"
#include "golden/unit/backend.hpp"
#include "golden/unit/photon_gatherer_image.hpp"
#include "tests/catch.hpp"
#include "tests/photon_sets.hpp"
#include "verilator_tb/chip/board_model.hpp"
#include "verilator_tb/rig/stall.hpp"

namespace photonloom::test {

using Bytes = std::vector<uint8_t>;
using Words = std::vector<uint32_t>;

constexpr uint8_t kRead = 1, kWrite = 2, kPush = 3, kPull = 4, kAnswer = 0x80;
constexpr uint32_t kCfg = 1u << 28, kLines = 2u << 28, kQueries = 3u << 28;
constexpr uint32_t kSession = 4, kFlags = 12, kControl = 16;

inline void append(Bytes& to, uint32_t value) {
  for (int i = 0; i < 4; ++i) to.push_back(static_cast<uint8_t>(value >> (8 * i)));
}

inline uint32_t number(const Bytes& from, size_t at) {
  uint32_t value = 0;
  for (size_t i = 0; i < 4; ++i) value |= static_cast<uint32_t>(from.at(at + i)) << (8 * i);
  return value;
}

// The remainder of the message times x^32, bit by bit, by the polynomial of IEEE 802.3 as it is
// written there: bits enter lowest first, the result is reflected.
inline uint32_t crc32(const Bytes& bytes) {
  uint32_t remainder = 0xffffffff;
  for (const uint8_t byte : bytes)
    for (int i = 0; i < 8; ++i) {
      const bool carry = ((remainder >> 31) ^ (byte >> i & 1u)) != 0;
      remainder = remainder << 1 ^ (carry ? 0x04C11DB7u : 0);
    }
  uint32_t crc = 0;
  for (int i = 0; i < 32; ++i) crc |= (remainder >> i & 1u) << (31 - i);
  return ~crc;
}

inline Bytes stuffed(const Bytes& content) {
  Bytes wire{0xC0};
  for (const uint8_t b : content) {
    if (b == 0xC0 || b == 0xDB) wire.push_back(0xDB);
    wire.push_back(b == 0xC0 ? 0xDC : b == 0xDB ? 0xDD : b);
  }
  wire.push_back(0xC0);
  return wire;
}

inline Bytes frame(uint8_t id, uint8_t command, const Bytes& body) {
  Bytes content{id, command};
  content.insert(content.end(), body.begin(), body.end());
  const uint32_t crc = crc32(content);
  append(content, crc);
  return stuffed(content);
}

struct Answer {
  uint8_t id = 0, command = 0;
  Bytes body;
  bool bad() const { return id == 0 && command == 0xff && body.empty(); }
  Words words(size_t from = 0) const {
    Words list;
    for (size_t at = 4 * from; at < body.size(); at += 4) list.push_back(number(body, at));
    return list;
  }
};

inline Plan small_plan() {
  Plan plan;
  plan.position_bits = 10;
  plan.k = 6;
  plan.bucket = 4;
  plan.global = {.present = true, .photons = 300};
  plan.caustic = {.present = true, .photons = 90};
  plan.contexts = 3;
  plan.lanes = 2;
  plan.cache_bytes = 1024;
  plan.reorder_packets = 16;
  plan.reorder_bins = 64;
  plan.reorder_cell_bits = 2;
  plan.gatherers = 2;
  plan.replay_queries = 64;
  plan.width = plan.height = 64;
  for (MapPlan* m : {&plan.global, &plan.caustic}) m->r2_max = plan.r2_limit() / 64;
  return plan;
}

// Most leaves of such a plan take several lines.
inline Plan compressed(Plan plan) {
  plan.bucket = 16;
  plan.photon_bytes = 9;
  plan.photon_lines = PhotonLines::kCompressed;
  plan.further_percent = 1500;
  plan.cache_bytes = 4 * plan.line_bytes();
  plan.beat_bits = 4 * plan.line_bytes();
  return plan;
}

// A board and the other end of its cable.
class Bench {
 public:
  explicit Bench(const Plan& plan = small_plan(), const BoardRun& run = {.work_dir = "cosim"})
      : plan_(plan), board_(plan, run) {}

  BoardModel& board() { return board_; }
  const Plan& plan() const { return plan_; }

  void send(const Bytes& wire) { board_.wire().send(wire); }
  void run(uint64_t cycles) {
    for (uint64_t i = 0; i < cycles; ++i) board_.cycle();
    take();
  }
  // Until everything is sent and the board has been silent for a while.
  std::vector<Answer> settle(uint64_t quiet = 8000) {
    size_t seen = board_.wire().received().size();
    for (uint64_t left = quiet; left > 0; --left) {
      board_.cycle();
      const size_t now = board_.wire().received().size();
      if (board_.wire().sending() || now != seen) left = quiet;
      seen = now;
    }
    take();
    return std::exchange(answers_, {});
  }
  // The next answer.
  Answer next(uint64_t patience = 200000) {
    for (uint64_t i = 0; answers_.empty(); ++i) {
      if (i == patience) throw std::runtime_error("the board does not answer");
      board_.cycle();
      if (!board_.wire().received().empty() && board_.wire().received().back() == 0xC0) take();
    }
    const Answer answer = answers_.front();
    answers_.erase(answers_.begin());
    return answer;
  }
  Answer ask(uint8_t command, const Bytes& body, uint64_t patience = 200000) {
    const uint8_t id = ++id_;
    send(frame(id, command, body));
    const Answer answer = next(patience);
    CHECK(answer.id == id);
    CHECK(answer.command == (command | kAnswer));
    return answer;
  }
  Words read(uint32_t address, uint8_t n) {
    Bytes body;
    append(body, address);
    body.push_back(n);
    return ask(kRead, body).words();
  }
  uint32_t reg(uint32_t address) { return read(address, 1).at(0); }
  uint32_t write(uint32_t address, const Words& words, uint64_t patience = 200000) {
    uint32_t status = 0;
    for (size_t at = 0; at < words.size(); at += 64) {
      Bytes body;
      append(body, address + static_cast<uint32_t>(at));
      for (size_t i = at; i < std::min(words.size(), at + 64); ++i) append(body, words[i]);
      const Answer answer = ask(kWrite, body, patience);
      REQUIRE(answer.body.size() == 4);
      status |= number(answer.body, 0);
    }
    return status;
  }
  struct Pushed {
    uint32_t next, room;
  };
  Pushed push(uint32_t position, const Words& words) {
    Bytes body;
    append(body, position);
    for (const uint32_t w : words) append(body, w);
    const Answer answer = ask(kPush, body);
    REQUIRE(answer.body.size() == 8);
    return {number(answer.body, 0), number(answer.body, 4)};
  }
  struct Pulled {
    uint32_t position, end;
    Words words;
  };
  Pulled pull(uint32_t position, uint8_t n, uint32_t keep) {
    Bytes body;
    append(body, position);
    body.push_back(n);
    append(body, keep);
    const Answer answer = ask(kPull, body);
    REQUIRE(answer.body.size() >= 8);
    return {number(answer.body, 0), number(answer.body, 4), answer.words(2)};
  }

  // Loads maps; golden has them too.
  void load(uint64_t seed) {
    global_ = build_photon_map(make_photons(plan_, PointSet::kSurfaces, plan_.global.photons, seed),
                               plan_);
    caustic_ = build_photon_map(
        make_photons(plan_, PointSet::kClustered, plan_.caustic.photons, seed + 1), plan_);
    const PhotonGathererImage image = photon_gatherer_image(plan_, global_, caustic_);
    std::map<uint32_t, uint64_t> cfg;
    for (const CfgWrite& w : image.cfg) cfg[w.address] = w.data;
    for (auto at = cfg.begin(); at != cfg.end();) {
      const uint32_t first = at->first;
      Words words;
      for (uint32_t a = first; at != cfg.end() && at->first == a; ++a, ++at) {
        words.push_back(static_cast<uint32_t>(at->second));
        words.push_back(static_cast<uint32_t>(at->second >> 32));
      }
      REQUIRE(write(kCfg + 2 * first, words) == 0);
    }
    Bytes bytes = image.lines[0];
    bytes.resize(plan_.memory_lines(plan_.global) * static_cast<size_t>(plan_.line_bytes()));
    bytes.insert(bytes.end(), image.lines[1].begin(), image.lines[1].end());
    bytes.resize((bytes.size() + 3) / 4 * 4);
    Words words;
    for (size_t i = 0; i < bytes.size(); i += 4) words.push_back(number(bytes, i));
    REQUIRE(write(kLines, words) == 0);
    golden_ = make_golden_photon_gatherer(plan_);
    golden_->load(global_, caustic_);
  }
  PhotonGatherer& golden() { return *golden_; }
  // The board's reset button; what of its answers was under way is gone.
  void reset_board() {
    board_.set("rst_i", 1);
    for (int i = 0; i < 8; ++i) board_.cycle();
    board_.set("rst_i", 0);
    board_.wire().received().clear();
    raw_.clear();
    answers_.clear();
  }

 private:
  // Frames among the bytes that came; one that is bad fails the test.
  void take() {
    std::deque<uint8_t>& in = board_.wire().received();
    for (; !in.empty(); in.pop_front()) {
      if (in.front() != 0xC0) {
        raw_.push_back(in.front());
        continue;
      }
      if (raw_.empty()) continue;
      Bytes content;
      for (size_t i = 0; i < raw_.size(); ++i) {
        if (raw_[i] != 0xDB) {
          content.push_back(raw_[i]);
          continue;
        }
        REQUIRE(i + 1 < raw_.size());
        REQUIRE((raw_[i + 1] == 0xDC || raw_[i + 1] == 0xDD));
        content.push_back(raw_[++i] == 0xDC ? 0xC0 : 0xDB);
      }
      raw_.clear();
      REQUIRE(content.size() >= 6);
      REQUIRE(content.size() <= 272);
      const uint32_t crc = number(content, content.size() - 4);
      content.resize(content.size() - 4);
      REQUIRE(crc == crc32(content));
      answers_.push_back({content[0], content[1], Bytes(content.begin() + 2, content.end())});
    }
  }

  Plan plan_;
  BoardModel board_;
  PhotonMap global_, caustic_;
  std::unique_ptr<PhotonGatherer> golden_;
  Bytes raw_;
  std::vector<Answer> answers_;
  uint8_t id_ = 0;
};

inline std::vector<GatherQuery> queries(const Plan& plan, size_t n, uint64_t seed, bool photons) {
  std::vector<GatherQuery> list;
  for (size_t i = 0; i < n; ++i) {
    GatherQuery q = make_query(plan, PointSet::kSurfaces, seed, i);
    q.map = i % 5 == 0;
    q.flush = i % 13 == 7;
    q.want_photons = photons && i % 2 == 0;
    list.push_back(q);
  }
  return list;
}

template <class P>
Words packed(const Plan& plan, const P& packet) {
  const PacketLayout layout = PacketLayout::of<P>(plan);
  Words words(layout.words());
  layout.pack(&packet, words.data());
  return words;
}

inline Words packed(const Plan& plan, const std::vector<GatherQuery>& list) {
  Words words;
  for (const GatherQuery& q : list)
    for (const uint32_t w : packed(plan, q)) words.push_back(w);
  return words;
}

// The two streams in the records; a record that is not whole fails.
struct Streams {
  std::vector<Words> results, photons;
};
inline Streams records(const Plan& plan, const Words& words) {
  Streams s;
  const size_t size[] = {PacketLayout::of<GatherResult>(plan).words(),
                         PacketLayout::of<GatherPhoton>(plan).words()};
  for (size_t at = 0; at < words.size();) {
    const uint32_t kind = words[at++];
    REQUIRE(kind <= 1);
    REQUIRE(at + size[kind] <= words.size());
    const auto from = words.begin() + static_cast<ptrdiff_t>(at);
    (kind ? s.photons : s.results)
        .push_back(Words(from, from + static_cast<ptrdiff_t>(size[kind])));
    at += size[kind];
  }
  return s;
}

inline Streams golden_records(Bench& bench, const std::vector<GatherQuery>& list) {
  std::vector<GatherResult> results;
  std::vector<GatherPhoton> photons;
  bench.golden().process(list, results, photons);
  Streams s;
  for (const GatherResult& r : results) s.results.push_back(packed(bench.plan(), r));
  for (const GatherPhoton& p : photons) s.photons.push_back(packed(bench.plan(), p));
  return s;
}

// One damage to the bytes of a frame on their way.
inline Bytes damaged(Bytes wire, RoleRandom& random) {
  const size_t at = random.below(wire.size());
  const auto place = wire.begin() + static_cast<ptrdiff_t>(at);
  switch (random.below(5)) {
    case 0:
      wire[at] = static_cast<uint8_t>(wire[at] ^ (1 + random.below(255)));
      break;
    case 1:
      wire.erase(place);
      break;
    case 2:
      wire.insert(place, wire[at]);
      break;
    case 3:
      wire.insert(place, static_cast<uint8_t>(random.bits()));
      break;
    default:
      wire.erase(place, wire.begin() + static_cast<ptrdiff_t>(
                                           std::min(wire.size(), at + 1 + random.below(20))));
  }
  return wire;
}

// Loads maps, sends queries and fetches their records; every second frame goes out as `harm` makes
// it. What is not answered is sent again. Fails where an answer is not what the streams allow, or a
// record is not golden's. Returns how many frames the board refused.
using Harm = Bytes (*)(Bytes wire, RoleRandom& random);
inline uint64_t soak_on(Bench& bench, uint64_t seed, size_t count, Harm harm) {
  INFO("seed " << seed);
  const Plan& plan = bench.plan();
  RoleRandom random(seed, "soak");
  bench.load(seed);
  const std::vector<GatherQuery> list = queries(plan, count, seed, true);
  const Words in = packed(plan, list);
  const Streams golden = golden_records(bench, list);
  size_t whole = golden.results.size() * (1 + golden.results[0].size());
  if (!golden.photons.empty()) whole += golden.photons.size() * (1 + golden.photons[0].size());

  uint8_t id = 0;
  uint64_t refused = 0;
  const auto ask = [&](uint8_t command, const Bytes& body) {
    ++id;
    const Bytes wire = frame(id, command, body);
    for (int attempt = 0;; ++attempt) {
      REQUIRE(attempt < 100);
      bench.send(random.below(2) ? harm(wire, random) : wire);
      Answer good;
      for (const Answer& a : bench.settle(3000)) {
        if (a.bad()) {
          ++refused;
          continue;
        }
        REQUIRE(a.id == id);
        REQUIRE(a.command == (command | kAnswer));
        good = a;
      }
      if (good.command) return good;
    }
  };
  Words out;
  uint32_t next = 0;
  {
    Bytes body;
    append(body, kSession);
    append(body, 1 + static_cast<uint32_t>(seed));
    REQUIRE(number(ask(kWrite, body).body, 0) == 0);
  }
  while (out.size() < whole) {
    if (next < in.size()) {
      Bytes body;
      append(body, next);
      const size_t n = std::min<size_t>(1 + random.below(64), in.size() - next);
      for (size_t i = 0; i < n; ++i) append(body, in[next + i]);
      const Answer answer = ask(kPush, body);
      REQUIRE(answer.body.size() == 8);
      const uint32_t now = number(answer.body, 0);
      REQUIRE(now >= next);
      REQUIRE(now <= next + n);
      next = now;
    }
    const auto position = static_cast<uint32_t>(out.size());
    Bytes body;
    append(body, position);
    body.push_back(static_cast<uint8_t>(1 + random.below(64)));
    append(body, position);
    const Answer answer = ask(kPull, body);
    REQUIRE(number(answer.body, 0) == position);
    const Words words = answer.words(2);
    out.insert(out.end(), words.begin(), words.end());
    REQUIRE(out.size() <= number(answer.body, 4));
  }
  bench.send({0xC0});  // ends what the last damage may have left open
  refused += bench.settle(3000).size();
  const Streams got = records(plan, out);
  CHECK(got.results == golden.results);
  CHECK(got.photons == golden.photons);
  CHECK(bench.reg(13) == (refused & 0xffff));
  return refused;
}

// The same of a board of its own with damage of all kinds.
inline void soak(const BoardRun& run, const Plan& plan, uint64_t seed, size_t count) {
  Bench bench(plan, run);
  CHECK(soak_on(bench, seed, count, damaged) > 0);
}

}  // namespace photonloom::test
