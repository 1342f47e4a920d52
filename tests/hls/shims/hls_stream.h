// SPDX-License-Identifier: Apache-2.0
// Stands for the vendor's hls_stream.h in tests: unbounded in C simulation; a read of an empty
// stream warns and gives a value that nobody wrote.
#pragma once
#include <cstdio>
#include <deque>
#include <string>

namespace hls {

template <class E>
class stream {
 public:
  stream() = default;
  explicit stream(const char* name) : name_(name) {}
  stream(const stream&) = delete;
  stream& operator=(const stream&) = delete;

  bool empty() const { return packets_.empty(); }
  void write(const E& packet) { packets_.push_back(packet); }
  E read() {
    if (packets_.empty()) {
      std::fprintf(stderr, "WARNING: Hls::stream '%s' is read while empty\n", name_.c_str());
      return E();
    }
    const E packet = packets_.front();
    packets_.pop_front();
    return packet;
  }

 private:
  std::string name_ = "stream";
  std::deque<E> packets_;
};

}  // namespace hls
