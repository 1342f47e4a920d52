// SPDX-License-Identifier: Apache-2.0
// libFuzzer target for the host's end of the host link: arbitrary bytes to a host that waits for
// answers end in words, or in one error; behind them a good frame is taken, and frames come back as
// they were sent. The board's end is RTL: board_link.cpp.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>

#include "host/connection.hpp"

using namespace photonloom;

namespace {

// Answers with the bytes given, whatever is asked, and then with nothing; time goes on by reading.
class Noise final : public ByteLink {
 public:
  explicit Noise(std::span<const uint8_t> bytes) : bytes_(bytes) {}
  const std::string& name() const override { return name_; }
  void write(std::span<const uint8_t>) override {}
  size_t read(std::span<uint8_t> to, double seconds) override {
    const size_t n = std::min({bytes_.size(), to.size(), size_t{61}});
    std::copy_n(bytes_.begin(), n, to.begin());
    bytes_ = bytes_.subspan(n);
    time_ += n ? 0.001 : seconds;
    return n;
  }
  double now() const override { return time_; }

 private:
  std::string name_ = "noise";
  std::span<const uint8_t> bytes_;
  double time_ = 0;
};

void to_host(std::span<const uint8_t> bytes) {
  Connection connection(std::make_unique<Noise>(bytes), 0.5);
  try {
    const auto words = connection.read(0, 3);
    if (words.size() != 3) std::abort();
    connection.set_window(700);
    const uint32_t data[] = {1, 2, 3};
    connection.write(16, data);
    connection.drain();
    connection.read(64, 70);
  } catch (const std::runtime_error& error) {
    if (std::string(error.what()).empty()) std::abort();
  }
}

void good_frame_behind(std::span<const uint8_t> bytes) {
  FrameDecoder decoder;
  for (const uint8_t byte : bytes) decoder.take(byte);
  decoder.take(0xC0);
  bool taken = false;
  const Bytes content{77, 1, 0xC0, 0xDB, 0, 0, 1};
  for (const uint8_t byte : encode_frame(content))
    if (const auto frame = decoder.take(byte)) taken = *frame == content;
  if (!taken) std::abort();
}

void round_trip(std::span<const uint8_t> content) {
  if (content.size() < 2 || content.size() > kMaxFrameBytes - 4) return;
  FrameDecoder decoder;
  std::optional<Bytes> got;
  for (const uint8_t byte : encode_frame(content))
    if (auto frame = decoder.take(byte)) got = frame;
  if (!got || !std::equal(got->begin(), got->end(), content.begin(), content.end())) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  to_host({data, size});
  good_frame_behind({data, size});
  round_trip({data, size});
  return 0;
}
