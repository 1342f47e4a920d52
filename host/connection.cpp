// SPDX-License-Identifier: Apache-2.0
#include "host/connection.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <utility>

namespace photonloom {

namespace {

constexpr uint8_t kAnswer = 0x80, kBad = 0xFF;
// So few that an id is free again long before it is needed, and no late answer is taken for a
// newer frame's.
constexpr size_t kMaxFrames = 64;
constexpr double kShortest = 0.05, kLongest = 2;  // of a time-out, seconds

}  // namespace

LinkCounts& LinkCounts::operator+=(const LinkCounts& other) {
  bytes_sent += other.bytes_sent;
  bytes_received += other.bytes_received;
  frames += other.frames;
  repeated += other.repeated;
  timeouts += other.timeouts;
  bad_answers += other.bad_answers;
  reported_bad += other.reported_bad;
  return *this;
}

Connection::Connection(std::unique_ptr<ByteLink> link, double patience)
    : link_(std::move(link)), patience_(patience) {}

void Connection::transmit(Frame& frame) {
  frame.last = ++transmissions_;
  frame.sent = link_->now();
  link_->write(frame.wire);
  counts_.bytes_sent += frame.wire.size();
}

void Connection::again(Frame& frame) {
  ++counts_.repeated;
  transmit(frame);
}

void Connection::hear() {
  heard_ = timer_ = link_->now();
  damaged_before_ = counts_.bad_answers;
}

void Connection::send(LinkCommand command, std::span<const uint8_t> body, OnAnswer on_answer) {
  const uint8_t id = next_id_++;
  Bytes content{id, static_cast<uint8_t>(command)};
  content.insert(content.end(), body.begin(), body.end());
  Bytes wire = encode_frame(content);
  while (!frames_.empty() && (frames_.size() >= kMaxFrames || in_flight_ + wire.size() > window_))
    wait();
  if (frames_.empty()) hear();
  in_flight_ += wire.size();
  ++counts_.frames;
  frames_.push_back({id, command, std::move(wire), std::move(on_answer)});
  transmit(frames_.back());
  frames_.back().first = frames_.back().last;
}

void Connection::wait() {
  const uint64_t before = answered_;
  while (answered_ == before) {
    std::array<uint8_t, 4096> buffer;
    const double left = timer_ + timeout_ - link_->now();
    const size_t n = link_->read(buffer, std::max(left, 0.0));
    counts_.bytes_received += n;
    may_repeat_ = frames_.size();
    for (size_t i = 0; i < n; ++i) {
      const auto content = decoder_.take(buffer[i]);
      if (content) take(*content);
      if (decoder_.bad() == counts_.bad_answers) continue;
      counts_.bad_answers = decoder_.bad();
      oldest_again();
    }
    if (answered_ == before) time_out();
  }
}

void Connection::drain() {
  while (!frames_.empty()) wait();
}

// A frame was damaged on its way, to the board or from it. The board answers in order, so it is
// most likely of the command that has been on the way for longest.
void Connection::oldest_again() {
  // Noise full of frame ends asks for no more than what is unanswered.
  if (may_repeat_ == 0) return;
  --may_repeat_;
  const auto oldest =
      std::min_element(frames_.begin(), frames_.end(),
                       [](const Frame& a, const Frame& b) { return a.last < b.last; });
  if (oldest != frames_.end()) again(*oldest);
}

void Connection::take(const Bytes& content) {
  if (content.size() == 2 && content[0] == 0 && content[1] == kBad) {
    ++counts_.reported_bad;
    oldest_again();
    return;
  }
  const auto at = std::find_if(frames_.begin(), frames_.end(), [&](const Frame& f) {
    return f.id == content[0] && (static_cast<uint8_t>(f.command) | kAnswer) == content[1];
  });
  if (at == frames_.end()) return;  // answered already
  const Frame frame = std::move(*at);
  frames_.erase(at);
  in_flight_ -= frame.wire.size();
  ++answered_;
  hear();
  if (frame.first == frame.last)  // else it is not known which transmission was answered
    slowest_ = std::max(heard_ - frame.sent, 0.99 * slowest_);
  // A frame that a time-out sent again says nothing of how long a round trip is: the time-out may
  // have been too short for it.
  if (!frame.timed_out && slowest_ > 0) timeout_ = std::clamp(4 * slowest_, kShortest, kLongest);
  // Frames sent before this one was sent first can no longer be answered by what is on the way.
  for (Frame& f : frames_)
    if (f.last < frame.first) again(f);
  frame.on_answer({content.data() + 2, content.size() - 2});
}

void Connection::time_out() {
  const double now = link_->now();
  if (now < timer_ + timeout_) return;
  if (now - heard_ >= patience_) {
    const uint64_t damaged = counts_.bad_answers - damaged_before_;
    throw LinkLost(fmt::format(
        "{}: no {}answer for {:.3g} seconds{}", name(), damaged ? "whole " : "", patience_,
        damaged ? fmt::format(", {} damaged one{}", damaged, damaged == 1 ? "" : "s") : ""));
  }
  for (Frame& f : frames_) {
    ++counts_.timeouts;
    f.timed_out = true;
    again(f);
  }
  timer_ = now;
  timeout_ = std::min(2 * timeout_, kLongest);
}

std::vector<uint32_t> Connection::read(uint32_t address, size_t words) {
  std::vector<uint32_t> all(words);
  for (size_t begin = 0; begin < words; begin += kMaxFrameWords) {
    const size_t n = std::min(kMaxFrameWords, words - begin);
    Bytes body;
    put_u32(body, address + static_cast<uint32_t>(begin));
    body.push_back(static_cast<uint8_t>(n));
    send(LinkCommand::kRead, body, [this, &all, begin, n](std::span<const uint8_t> answer) {
      if (answer.size() != 4 * n)
        throw std::runtime_error(
            fmt::format("{}: answers a READ of {} words with {} bytes", name(), n, answer.size()));
      for (size_t i = 0; i < n; ++i) all[begin + i] = get_u32(answer, 4 * i);
    });
  }
  drain();
  return all;
}

void Connection::send_write(uint32_t address, std::span<const uint32_t> words,
                            std::function<void(uint32_t status)> on_status) {
  Bytes body;
  put_u32(body, address);
  for (const uint32_t word : words) put_u32(body, word);
  send(LinkCommand::kWrite, body, [this, on_status](std::span<const uint8_t> answer) {
    if (answer.size() != 4)
      throw std::runtime_error(
          fmt::format("{}: answers a WRITE with {} bytes, expected 4", name(), answer.size()));
    on_status(get_u32(answer, 0));
  });
}

void Connection::write(uint32_t address, std::span<const uint32_t> words) {
  for (size_t begin = 0; begin < words.size(); begin += kMaxFrameWords) {
    const uint32_t at = address + static_cast<uint32_t>(begin);
    send_write(at, words.subspan(begin, std::min(kMaxFrameWords, words.size() - begin)),
               [this, at](uint32_t status) {
                 if (status != 0)
                   throw std::runtime_error(fmt::format(
                       "{}: refuses to write address 0x{:08x} (status {})", name(), at, status));
               });
  }
}

uint32_t Connection::write_status(uint32_t address, std::span<const uint32_t> words) {
  uint32_t result = 0;
  send_write(address, words, [&result](uint32_t status) { result = status; });
  drain();
  return result;
}

}  // namespace photonloom
