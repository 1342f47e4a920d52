// SPDX-License-Identifier: Apache-2.0
// Commands to a board over a link that may lose, change or repeat bytes: several frames on the way,
// each sent again until it is answered. A command may be executed twice (docs/host-link.md).
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host/byte_link.hpp"
#include "host/frame.hpp"

namespace photonloom {

enum class LinkCommand : uint8_t { kRead = 1, kWrite = 2, kPush = 3, kPull = 4 };

// What travelled, in frames and bytes on the wire.
struct LinkCounts {
  uint64_t bytes_sent = 0, bytes_received = 0;
  uint64_t frames = 0;        // commands
  uint64_t repeated = 0;      // frames sent again
  uint64_t timeouts = 0;      // of them, for want of any answer
  uint64_t bad_answers = 0;   // frames received that were dropped
  uint64_t reported_bad = 0;  // BAD frames from the board
  LinkCounts& operator+=(const LinkCounts& other);
};

class Connection {
 public:
  using OnAnswer = std::function<void(std::span<const uint8_t> body)>;

  // `patience`: seconds without an answer after which the link counts as lost. The window is one
  // frame until set_window().
  Connection(std::unique_ptr<ByteLink> link, double patience);

  const std::string& name() const { return link_->name(); }
  // Bytes of unanswered frames that the board can hold.
  void set_window(size_t bytes) { window_ = bytes; }
  void set_patience(double seconds) { patience_ = seconds; }

  // Sends a command, first waiting until the board has room for it. `on_answer` is called by a
  // later wait() (or the waiting in here) with the body of the answer. All throw LinkLost.
  void send(LinkCommand command, std::span<const uint8_t> body, OnAnswer on_answer);
  // Takes what arrives until at least one frame is answered. Something must be unanswered.
  void wait();
  // Until everything is answered.
  void drain();
  size_t unanswered() const { return frames_.size(); }

  // A command with its answer. Addresses and words as in docs/host-link.md; any number of words.
  std::vector<uint32_t> read(uint32_t address, size_t words);
  // Several frames on the way; complete after drain(). What the board refuses is an error.
  void write(uint32_t address, std::span<const uint32_t> words);
  // One frame of words, waited for; its status.
  uint32_t write_status(uint32_t address, std::span<const uint32_t> words);

  const LinkCounts& counts() const { return counts_; }

 private:
  struct Frame {
    uint8_t id;
    LinkCommand command;
    Bytes wire;
    OnAnswer on_answer;
    uint64_t first = 0, last = 0;  // number of its first and its latest transmission
    double sent = 0;               // when, of the latest
    bool timed_out = false;        // sent again for want of any answer
  };
  void transmit(Frame& frame);
  void again(Frame& frame);
  void oldest_again();
  void hear();
  void take(const Bytes& content);
  void time_out();
  void send_write(uint32_t address, std::span<const uint32_t> words,
                  std::function<void(uint32_t status)> on_status);

  std::unique_ptr<ByteLink> link_;
  double patience_;
  size_t window_ = kMaxFrameBytes;
  std::deque<Frame> frames_;  // unanswered, in the order of send()
  size_t in_flight_ = 0;      // their bytes
  size_t may_repeat_ = 0;     // frames, for damage among the bytes that were read last
  uint64_t transmissions_ = 0, answered_ = 0;
  uint8_t next_id_ = 1;
  double heard_ = 0;  // when the last answer came, or the first of the waiting frames went
  uint64_t damaged_before_ = 0;  // answers, when heard_ was
  double timer_ = 0;             // from when the time-out counts
  double timeout_ = 1;           // seconds
  double slowest_ = 0;           // round trip seen, decaying
  FrameDecoder decoder_;
  LinkCounts counts_;
};

}  // namespace photonloom
