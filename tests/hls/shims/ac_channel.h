// SPDX-License-Identifier: Apache-2.0
// Stands for ac_channel.h in tests: unbounded in C simulation; a read of an empty channel ends the
// program.
#pragma once
#include <cstdio>
#include <cstdlib>
#include <deque>

template <class E>
class ac_channel {
 public:
  ac_channel() = default;
  ac_channel(const ac_channel&) = delete;
  ac_channel& operator=(const ac_channel&) = delete;

  bool available(unsigned n) const { return packets_.size() >= n; }
  void write(const E& packet) { packets_.push_back(packet); }
  E read() {
    if (packets_.empty()) {
      std::fprintf(stderr, "Read from empty channel\n");
      std::abort();
    }
    const E packet = packets_.front();
    packets_.pop_front();
    return packet;
  }

 private:
  std::deque<E> packets_;
};
