// SPDX-License-Identifier: Apache-2.0
// The far end of a UART's two wires, clock by clock: 8 data bits, no parity, 1 stop bit. Its own
// bit may have another length than the board's, as two oscillators do.
#pragma once
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

namespace photonloom {

class UartWire {
 public:
  // `clocks_per_bit`: of this end, in clocks of the board, any number from 2 up.
  explicit UartWire(double clocks_per_bit) : bit_(clocks_per_bit) {}

  // Bytes to the board, one behind the other without a gap.
  void send(std::span<const uint8_t> bytes) { out_.insert(out_.end(), bytes.begin(), bytes.end()); }
  // The line rests for so many bits before the next byte. Only while nothing waits to be sent.
  void rest(double bits) { rest_ += bits * bit_; }
  // The line is 0 for so long, then rests for two bits. Only while nothing waits to be sent.
  void hold_low(double bits);
  bool sending() const { return !out_.empty() || busy_; }
  size_t waiting() const { return out_.size(); }

  // Once a clock: the level that drives the board's input now, then the level of its output.
  bool drive();
  void sample(bool level);

  // Bytes from the board, oldest first; the caller takes them out.
  std::deque<uint8_t>& received() { return in_; }
  uint64_t framing_errors() const { return framing_errors_; }

 private:
  double bit_;
  uint64_t clock_ = 0;

  std::deque<uint8_t> out_;
  bool busy_ = false;
  double start_ = 0;  // of the byte being sent, or when the line is free
  double rest_ = 0;
  double low_until_ = 0;
  uint32_t frame_ = 0;  // its ten bits, the start bit lowest

  std::deque<uint8_t> in_;
  int bit_number_ = -1;  // of the byte being received
  double next_ = 0;      // when its next bit is sampled
  bool last_level_ = true;
  uint32_t shift_ = 0;
  uint64_t framing_errors_ = 0;
};

}  // namespace photonloom
