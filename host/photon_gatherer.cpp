// SPDX-License-Identifier: Apache-2.0
#include "host/photon_gatherer.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <map>
#include <random>
#include <thread>
#include <utility>

#include "golden/numeric/sha256.hpp"

namespace photonloom {

namespace {

constexpr uint32_t kWordsAtOnce = kMaxFrameWords;
constexpr int kPulls = 3;         // on the way where so many words are known to be there
constexpr int kVainAttempts = 3;  // reconnections without a single answer between them
constexpr int kCounterBits = 40;
constexpr uint32_t kResultRecord = 0, kPhotonRecord = 1;

std::string image_checksum(const PhotonGathererImage& image) {
  Bytes bytes;
  for (const CfgWrite& w : image.cfg) {
    put_u32(bytes, w.address);
    put_u32(bytes, static_cast<uint32_t>(w.data));
    put_u32(bytes, static_cast<uint32_t>(w.data >> 32));
  }
  for (const auto& lines : image.lines) {
    put_u32(bytes, static_cast<uint32_t>(lines.size()));
    bytes.insert(bytes.end(), lines.begin(), lines.end());
  }
  Sha256 sum;
  sum.add({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  return sum.hex().substr(0, 16);
}

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

// Queries on their way through the board in one session.
struct BoardPhotonGatherer::Job {
  std::span<const GatherQuery> in;
  std::vector<GatherResult>& results;
  std::vector<GatherPhoton>& photons;
  size_t done = 0;  // queries answered

  // Input: `words` are those of the queries from `done` at the start of the session's part on;
  // `sent` and `taken` count them.
  std::vector<uint32_t> words = {};
  uint32_t base = 0;  // position of words[0]
  size_t sent = 0, taken = 0, room = 0;
  int pushes = 0;
  bool may_probe = true;

  // Output.
  uint32_t asked = 0;  // position up to which words were asked for
  uint32_t end = 0;    // position up to which the board is known to have words
  int pulls = 0;
  std::map<uint32_t, std::vector<uint32_t>> arrived = {};  // by position, not yet in a row
  std::deque<uint32_t> stream = {};                        // in a row, not yet a whole record
  std::deque<GatherResult> ready_results = {};
  std::deque<GatherPhoton> ready_photons = {};
  double moved = 0;  // when the last words went in or out
};

BoardPhotonGatherer::BoardPhotonGatherer(const Plan& plan, BoardOptions options)
    : plan_(plan),
      options_(std::move(options)),
      query_(PacketLayout::of<GatherQuery>(plan)),
      result_(PacketLayout::of<GatherResult>(plan)),
      photon_(PacketLayout::of<GatherPhoton>(plan)) {
  connect(options_.wait);
}

BoardPhotonGatherer::~BoardPhotonGatherer() {
  if (journal_ && (!unfinished_ || journal_->size() == 0)) journal_->remove();
}

void BoardPhotonGatherer::connect(double patience) {
  auto board = std::make_unique<Board>(options_.open(), patience);
  board->check_plan(plan_);
  if (board->first_state().session != session_) loaded_ = false;
  seen_ = board->first_state().counters;
  board_ = std::move(board);
}

void BoardPhotonGatherer::prepare() {
  const uint32_t held = board_->first_state().session;
  std::random_device random;
  do session_ = static_cast<uint32_t>(random());
  while (session_ == 0 || session_ == held);
  board_->start_session(session_);
  input_next_ = output_next_ = 0;
  if (!loaded_) board_->load(plan_, image_);
  loaded_ = true;
}

template <class Step>
void BoardPhotonGatherer::keep_trying(Step step) {
  int vain = 0;
  for (;;) {
    const uint64_t before = answers_;
    try {
      step();
      return;
    } catch (const LinkLost& lost) {
      vain = answers_ == before ? vain + 1 : 0;
      if (vain > kVainAttempts) throw;
      reconnect(lost);
    }
  }
}

void BoardPhotonGatherer::reconnect(const LinkLost& lost) {
  ++lost_;
  if (board_) {
    ended_ += board_->connection().counts();
    board_.reset();
  }
  options_.tell(
      fmt::format("{}; waiting {:.3g} seconds for it to come back", lost.what(), options_.wait));
  const double deadline = seconds_now() + options_.wait;
  for (double left = options_.wait; left > 0; left = deadline - seconds_now()) {
    try {
      connect(std::min(left, 2.0));
      board_->connection().set_patience(options_.wait);
      if (journal_) prepare();
      options_.tell(fmt::format("{} is back", options_.device));
      return;
    } catch (const LinkLost&) {
      board_.reset();
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  }
  std::string kept;
  if (journal_ && journal_->size())
    kept = fmt::format("; {} answers are kept in {}, the same command goes on after them",
                       journal_->size(), journal_->path());
  throw LinkLost(fmt::format("{}: did not come back within {:.3g} seconds{}", options_.device,
                             options_.wait, kept));
}

void BoardPhotonGatherer::load(const PhotonMap& global, const PhotonMap& caustic) {
  image_ = photon_gatherer_image(plan_, global, caustic);
  loaded_ = false;
  if (journal_) journal_->remove();
  journal_.reset();
  journal_.emplace(plan_, image_checksum(image_), options_.work_dir, options_.resume);
  unfinished_ = true;
  if (journal_->kept())
    options_.tell(fmt::format("{}: {} answers are there already, going on after them",
                              journal_->path(), journal_->kept()));
  bool first = true;
  keep_trying([&] {
    if (std::exchange(first, false)) prepare();  // reconnect() does it otherwise
  });
}

void BoardPhotonGatherer::process(std::span<const GatherQuery> in,
                                  std::vector<GatherResult>& results,
                                  std::vector<GatherPhoton>& photons) {
  unfinished_ = true;
  Job job{.in = in, .results = results, .photons = photons};
  for (GatherResult r; job.done < in.size() && journal_->take(in[job.done], r, photons);
       ++job.done, ++resumed_)
    results.push_back(r);
  packets_in_ += in.size();
  const double began = seconds_now();
  keep_trying([&] {
    ask(job);
    expect_silence(job);
  });
  seconds_ += seconds_now() - began;
  unfinished_ = false;
}

void BoardPhotonGatherer::ask(Job& job) {
  job.words.clear();
  for (const GatherQuery& q : job.in.subspan(job.done)) {
    const size_t at = job.words.size();
    job.words.resize(at + query_.words());
    query_.pack(&q, &job.words[at]);
  }
  job.base = input_next_;
  job.sent = job.taken = 0;
  job.room = query_.words();
  job.pushes = job.pulls = 0;
  job.asked = job.end = output_next_;
  job.arrived.clear();
  job.stream.clear();
  job.ready_results.clear();
  job.ready_photons.clear();
  job.moved = seconds_now();
  // A board that is reset after its first word was taken is found out by positions that go back;
  // before, only by its session.
  push(job, query_.words());
  board_->connection().drain();
  check_session();
  double checked = job.moved;
  while (job.done < job.in.size()) {
    push(job, job.words.size());
    pull(job);
    board_->connection().wait();
    deliver(job);
    const double now = seconds_now();
    if (now - job.moved > options_.wait)
      throw std::runtime_error(
          fmt::format("{}: the board answers, but no result came for {:.3g} seconds, after {} of "
                      "{} queries",
                      options_.device, options_.wait, job.done, job.in.size()));
    if (now - std::max(checked, job.moved) > options_.wait / 4) {
      check_session();
      checked = now;
    }
  }
  board_->connection().drain();
  input_next_ = job.base + static_cast<uint32_t>(job.words.size());
}

void BoardPhotonGatherer::forgot() const {
  throw LinkLost(fmt::format("{}: forgot its session: was it reset?", options_.device));
}

void BoardPhotonGatherer::check_session() {
  if (board_->connection().read(kRegSession, 1)[0] != session_) forgot();
}

void BoardPhotonGatherer::push(Job& job, size_t until) {
  for (;;) {
    size_t n = std::min<size_t>(kWordsAtOnce, std::min(until, job.words.size()) - job.sent);
    if (n == 0) return;
    const size_t room = job.taken + job.room > job.sent ? job.taken + job.room - job.sent : 0;
    if (room > 0) {
      n = std::min(n, room);
    } else {
      // Whether there is room again is asked with a query, once for each PULL that made some.
      if (job.pushes > 0 || !job.may_probe) return;
      n = std::min(n, query_.words());
      job.may_probe = false;
    }
    Bytes body;
    put_u32(body, job.base + static_cast<uint32_t>(job.sent));
    for (size_t i = 0; i < n; ++i) put_u32(body, job.words[job.sent + i]);
    job.sent += n;
    ++job.pushes;
    board_->connection().send(
        LinkCommand::kPush, body, [this, &job](std::span<const uint8_t> answer) {
          if (answer.size() != 8)
            throw std::runtime_error(fmt::format("{}: answers a PUSH with {} bytes, expected 8",
                                                 options_.device, answer.size()));
          --job.pushes;
          const size_t next = get_u32(answer, 0) - job.base;
          if (next < job.taken || next > job.words.size()) forgot();
          if (next > job.taken) job.moved = seconds_now();
          job.taken = next;
          job.room = get_u32(answer, 4);
          // What was sent beyond a gap, or beyond the room, goes again.
          if (job.pushes == 0) job.sent = job.taken;
        });
  }
}

void BoardPhotonGatherer::pull(Job& job) {
  while (job.pulls < kPulls) {
    // Words not known to be there are asked for by a single PULL, which also says how many there
    // are.
    const uint32_t known = job.end - job.asked;
    if (known == 0 && job.pulls > 0) return;
    const uint32_t n = known ? std::min(known, kWordsAtOnce) : kWordsAtOnce;
    const uint32_t position = job.asked;
    Bytes body;
    put_u32(body, position);
    body.push_back(static_cast<uint8_t>(n));
    put_u32(body, output_next_);
    if (known) job.asked += n;
    ++job.pulls;
    board_->connection().send(
        LinkCommand::kPull, body,
        [this, &job, position, n, known](std::span<const uint8_t> answer) {
          const size_t words = answer.size() < 8 ? 0 : (answer.size() - 8) / 4;
          if (answer.size() != 8 + 4 * words || words > n)
            throw std::runtime_error(fmt::format("{}: answers a PULL of {} words with {} bytes",
                                                 options_.device, n, answer.size()));
          --job.pulls;
          const uint32_t end = get_u32(answer, 4);
          if (get_u32(answer, 0) != position || (known && words < n)) forgot();
          if (!known) job.asked = position + static_cast<uint32_t>(words);
          if (end - job.asked < 1u << 31 && end - job.end < 1u << 31) job.end = end;
          job.may_probe = true;
          if (words == 0) return;
          job.moved = seconds_now();
          std::vector<uint32_t>& to = job.arrived[position];
          for (size_t i = 0; i < words; ++i) to.push_back(get_u32(answer, 8 + 4 * i));
        });
  }
}

void BoardPhotonGatherer::deliver(Job& job) {
  for (auto at = job.arrived.begin(); (at = job.arrived.find(output_next_)) != job.arrived.end();
       job.arrived.erase(at)) {
    job.stream.insert(job.stream.end(), at->second.begin(), at->second.end());
    output_next_ += static_cast<uint32_t>(at->second.size());
  }
  while (!job.stream.empty()) {
    const uint32_t kind = job.stream.front();
    if (kind != kResultRecord && kind != kPhotonRecord)
      throw std::runtime_error(
          fmt::format("{}: a record of the output stream begins with {}, expected 0 or 1",
                      options_.device, kind));
    const PacketLayout& layout = kind == kResultRecord ? result_ : photon_;
    if (job.stream.size() < 1 + layout.words()) break;
    const std::vector<uint32_t> words(job.stream.begin() + 1,
                                      job.stream.begin() + 1 + static_cast<long>(layout.words()));
    job.stream.erase(job.stream.begin(),
                     job.stream.begin() + 1 + static_cast<long>(layout.words()));
    if (kind == kResultRecord)
      layout.unpack(words.data(), &job.ready_results.emplace_back());
    else
      layout.unpack(words.data(), &job.ready_photons.emplace_back());
  }
  while (job.done < job.in.size() && !job.ready_results.empty()) {
    const GatherQuery& query = job.in[job.done];
    const GatherResult result = job.ready_results.front();
    const size_t owed = query.want_photons && !query.flush ? result.count : 0;
    if (job.ready_photons.size() < owed) break;
    const auto photons = static_cast<long>(owed);
    const std::vector<GatherPhoton> own(job.ready_photons.begin(),
                                        job.ready_photons.begin() + photons);
    job.ready_results.pop_front();
    job.ready_photons.erase(job.ready_photons.begin(), job.ready_photons.begin() + photons);
    job.results.push_back(result);
    job.photons.insert(job.photons.end(), own.begin(), own.end());
    journal_->add(query, result, own);
    ++job.done;
    ++answers_;
  }
  journal_->flush();
}

// A packet that still comes is one too many: it goes on to whoever compares.
void BoardPhotonGatherer::expect_silence(Job& job) {
  for (;;) {
    const BoardState s = take_counters();
    if (s.session != session_) forgot();
    if (s.output_end == output_next_ && !(s.flags & kFlagQueriesInside)) break;
    if (s.output_end != output_next_) {
      pull(job);
      board_->connection().drain();
      deliver(job);
    } else if (seconds_now() - job.moved > options_.wait) {
      throw std::runtime_error(
          fmt::format("{}: all queries are answered, but the board says that some are still inside",
                      options_.device));
    }
  }
  job.results.insert(job.results.end(), job.ready_results.begin(), job.ready_results.end());
  job.photons.insert(job.photons.end(), job.ready_photons.begin(), job.ready_photons.end());
}

BoardState BoardPhotonGatherer::take_counters() {
  BoardState s = board_->state();
  for (const auto& [name, value] : s.counters)
    total_[name] += (value - seen_[name]) & ones(kCounterBits);
  seen_ = s.counters;
  return s;
}

Counters BoardPhotonGatherer::counters() const {
  Counters c = total_;
  LinkCounts link = ended_;
  if (board_) link += board_->connection().counts();
  c["packets in"] = packets_in_;
  c["packets resumed"] = resumed_;
  c["link lost"] = lost_;
  c["link milliseconds"] = static_cast<uint64_t>(1000 * seconds_);
  c["link bytes out"] = link.bytes_sent;
  c["link bytes in"] = link.bytes_received;
  c["link frames"] = link.frames;
  c["link frames again"] = link.repeated;
  c["link timeouts"] = link.timeouts;
  c["link bad answers"] = link.bad_answers;
  c["link bad frames"] = link.reported_bad;
  // As the other backends call them.
  c["cycles"] = c["busy"];
  c["stalls out"] = c["stalls results"] + c["stalls photons"];
  c["bytes read"] = c["line requests"] * static_cast<uint64_t>(plan_.line_bytes());
  return c;
}

}  // namespace photonloom
