// SPDX-License-Identifier: Apache-2.0
#include "host/board.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <thread>
#include <utility>

#include "golden/packet/layout.hpp"
#include "golden/plan/plan_file.hpp"

namespace photonloom {

namespace {

constexpr const char* kCounterNames[] = {
    "busy",      "queries",        "nodes",          "leaves",    "insertions",   "line requests",
    "stalls in", "stalls results", "stalls photons", "reordered", "lines served", "memory busy",
};

constexpr size_t kRegisters = kRegCounters + 2 * std::size(kCounterNames);
static_assert(kRegisters <= kMaxFrameWords, "one READ takes all registers at one time");

// Whether a count of two words may have carried between them, for the second is read later than the
// first (docs/host-link.md). One that is as it was `before` stands still.
bool may_have_carried(std::span<const uint32_t> now, std::span<const uint32_t> before) {
  const auto may = [&](size_t i) {
    return now[i] >= 0xFF000000u && (before.empty() || now[i] != before[i]);
  };
  bool any = may(kRegReplayCycles) || may(kRegReplayResults);
  for (size_t i = kRegCounters; i < kRegisters; i += 2) any |= may(i);
  return any;
}

}  // namespace

std::span<const char* const> link_counter_names() { return kCounterNames; }

Board::Board(std::unique_ptr<ByteLink> link, double patience)
    : connection_(std::move(link), patience), patience_(patience) {
  std::vector<uint32_t> r;
  try {
    r = connection_.read(kRegMagic, 2);
  } catch (const LinkLost& lost) {
    const uint64_t bytes = connection_.counts().bytes_received;
    throw LinkLost(
        fmt::format("{}; {}", lost.what(),
                    bytes ? fmt::format("{} bytes came, but no frame: is the rate right?", bytes)
                          : "nothing came at all: is there a Photonloom board at its other end?"));
  }
  if (r[0] != kLinkMagic)
    throw WrongBoard(
        fmt::format("{}: register 0 holds 0x{:08x}, expected 0x{:08x}: this is no Photonloom board",
                    name(), r[0], kLinkMagic));
  if (r[1] != kLinkVersion)
    throw WrongBoard(fmt::format("{}: speaks version {} of the host link, this program version {}",
                                 name(), r[1], kLinkVersion));
  first_ = state();
  connection_.set_window(first_.rx_bytes);
}

BoardState Board::state() {
  std::vector<uint32_t> r = connection_.read(0, kRegisters);
  for (std::vector<uint32_t> before; may_have_carried(r, before);)
    before = std::exchange(r, connection_.read(0, kRegisters));
  const auto both = [&r](size_t i) { return r[i] | uint64_t{r[i + 1]} << 32; };
  BoardState s;
  s.version = r[kRegVersion];
  s.plan_hash = both(kRegPlanHash);
  s.session = r[kRegSession];
  s.gatherers = r[kRegGatherers];
  s.rx_bytes = r[kRegRxBytes];
  s.input_room = r[kRegInputRoom];
  s.input_position = r[kRegInputPosition];
  s.output_first = r[kRegOutputFirst];
  s.output_end = r[kRegOutputEnd];
  s.clock_khz = r[kRegClockKhz];
  s.flags = r[kRegFlags];
  s.frames_bad = r[kRegFramesBad];
  s.bytes_lost = r[kRegBytesLost];
  s.self_test = r[kRegSelfTest];
  s.faults = r[kRegFaults];
  s.replay_cycles = both(kRegReplayCycles);
  s.replay_signature = both(kRegReplaySignature);
  s.replay_results = both(kRegReplayResults);
  for (size_t i = 0; i < std::size(kCounterNames); ++i)
    s.counters[kCounterNames[i]] = both(kRegCounters + 2 * i);
  return s;
}

void Board::check_plan(const Plan& plan) const {
  const uint64_t wanted = plan_hash(plan);
  if (first_.plan_hash == wanted) return;
  throw WrongBoard(fmt::format(
      "{}: holds the bitstream of plan {:016x}, but this is plan {:016x}; build the bitstream of "
      "this plan (photonloom generate --board, make fpga) and flash it, or use the board's plan "
      "with --plan",
      name(), first_.plan_hash, wanted));
}

template <class Done>
void Board::wait_flags(Done done, double seconds, const char* what) {
  using Clock = std::chrono::steady_clock;
  const auto deadline = Clock::now() + std::chrono::duration<double>(seconds);
  while (!done(connection_.read(kRegFlags, 1)[0])) {
    if (Clock::now() > deadline)
      throw LinkLost(fmt::format("{}: {} for {:.3g} seconds", name(), what, seconds));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

void Board::start_session(uint32_t session) {
  connection_.write(kRegSession, {&session, 1});
  connection_.drain();
  wait_flags([](uint32_t flags) { return !(flags & (kFlagQueriesInside | kFlagReplayBusy)); },
             patience_, "does not finish the queries of an earlier run");
  const BoardState s = state();
  if (s.session != session || s.input_position != 0 || s.output_end != 0)
    throw LinkLost(fmt::format("{}: forgot its session: was it reset?", name()));
}

void Board::load(const Plan& plan, const PhotonGathererImage& image) {
  wait_flags([](uint32_t flags) { return flags & kFlagMemoryReady; }, patience_,
             "its photon memory is not ready");
  for (const size_t map : {size_t{0}, size_t{1}}) {
    const std::vector<uint8_t>& bytes = image.lines[map];
    std::vector<uint32_t> words((bytes.size() + 3) / 4);
    for (size_t i = 0; i < bytes.size(); ++i) words[i / 4] |= uint32_t{bytes[i]} << (8 * (i % 4));
    const uint64_t base =
        map == 0 ? 0
                 : plan.memory_lines(plan.global) * static_cast<uint64_t>(plan.line_bytes()) / 4;
    connection_.write(link_address(LinkSpace::kPhotonLines, base), words);
  }
  connection_.drain();
  // Then the configuration: caches forget what they hold when it is written. Runs of neighbouring
  // addresses travel together.
  for (size_t i = 0; i < image.cfg.size();) {
    std::vector<uint32_t> words;
    const uint32_t first = image.cfg[i].address;
    while (i < image.cfg.size() && image.cfg[i].address == first + words.size() / 2) {
      words.push_back(static_cast<uint32_t>(image.cfg[i].data));
      words.push_back(static_cast<uint32_t>(image.cfg[i].data >> 32));
      ++i;
    }
    connection_.write(link_address(LinkSpace::kConfiguration, 2ull * first), words);
  }
  connection_.drain();
}

Board::Replay Board::replay(const Plan& plan, std::span<const GatherQuery> queries, uint32_t passes,
                            uint32_t mode) {
  if (queries.empty() || queries.size() > static_cast<size_t>(plan.replay_queries))
    throw std::runtime_error(fmt::format(
        "{} queries to replay, the plan's replayer holds 1 to {} (board.replay_queries)",
        queries.size(), plan.replay_queries));
  const PacketLayout layout = PacketLayout::of<GatherQuery>(plan);
  const size_t stride = std::bit_ceil(layout.words());
  std::vector<uint32_t> words(queries.size() * stride, 0);
  for (size_t i = 0; i < queries.size(); ++i) layout.pack(&queries[i], &words[i * stride]);
  connection_.write(link_address(LinkSpace::kReplayQueries, 0), words);
  const uint32_t set[] = {static_cast<uint32_t>(queries.size()), passes, mode};
  connection_.write(kRegReplayQueries, set);
  connection_.drain();

  uint32_t number = connection_.read(kRegReplayControl, 1)[0] + 1;
  if (number == 0) number = 1;
  // Status 2, not now, is also what a second copy of the frame that started it gets.
  if (connection_.write_status(kRegReplayControl, {&number, 1}) != 0 &&
      connection_.read(kRegReplayControl, 1)[0] != number)
    throw std::runtime_error(fmt::format("{}: refuses to start a replay", name()));
  const uint64_t expected = queries.size() * uint64_t{passes};
  uint64_t seen = 0;
  auto moved = std::chrono::steady_clock::now();
  for (;;) {
    const BoardState s = state();
    if (!(s.flags & kFlagReplayBusy))
      return {s.replay_cycles, s.replay_signature, s.replay_results};
    const auto now = std::chrono::steady_clock::now();
    if (s.replay_results != seen) {
      seen = s.replay_results;
      moved = now;
    } else if (std::chrono::duration<double>(now - moved).count() > patience_) {
      throw LinkLost(
          fmt::format("{}: replay is stuck at {} of {} results", name(), seen, expected));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

}  // namespace photonloom
