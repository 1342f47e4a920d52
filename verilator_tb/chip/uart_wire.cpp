// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/chip/uart_wire.hpp"

#include <algorithm>

namespace photonloom {

void UartWire::hold_low(double bits) {
  low_until_ = static_cast<double>(clock_) + bits * bit_;
  start_ = low_until_ + 2 * bit_;
}

bool UartWire::drive() {
  const double now = static_cast<double>(clock_);
  if (busy_ && now >= start_ + 10 * bit_) {
    busy_ = false;
    start_ += 10 * bit_;
  }
  if (!busy_) {
    if (rest_ > 0) {
      start_ = std::max(start_, now) + rest_;
      rest_ = 0;
    }
    // A byte right behind another one begins where that one's stop bit ends, between two clocks.
    if (!out_.empty() && now >= start_) {
      if (now >= start_ + 1) start_ = now;
      frame_ = 0x200u | static_cast<uint32_t>(out_.front()) << 1;
      out_.pop_front();
      busy_ = true;
    }
  }
  if (!busy_) return now >= low_until_;
  const int bit = std::min(9, static_cast<int>((now - start_) / bit_));
  return (frame_ >> bit & 1) != 0;
}

void UartWire::sample(bool level) {
  const double now = static_cast<double>(clock_++);
  if (bit_number_ < 0) {
    if (last_level_ && !level) {
      bit_number_ = 0;
      next_ = now + 0.5 * bit_ - 0.5;  // the edge lies between the last clock and this one
    }
  } else if (now >= next_) {
    next_ += bit_;
    if (bit_number_ == 0) {
      bit_number_ = level ? -1 : 1;
    } else if (bit_number_ <= 8) {
      shift_ = shift_ >> 1 | static_cast<uint32_t>(level) << 7;
      ++bit_number_;
    } else {
      if (level)
        in_.push_back(static_cast<uint8_t>(shift_));
      else
        ++framing_errors_;
      bit_number_ = -1;
    }
  }
  last_level_ = level;
}

}  // namespace photonloom
