// SPDX-License-Identifier: Apache-2.0
// Bytes to and from a board, and the clock by which a host waits for them.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>

namespace photonloom {

// The device went away, or nobody answers at its other end. what() is a sentence naming the device.
struct LinkLost : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class ByteLink {
 public:
  virtual ~ByteLink() = default;
  virtual const std::string& name() const = 0;
  // Sends all bytes, in order. Throws LinkLost.
  virtual void write(std::span<const uint8_t> bytes) = 0;
  // Waits at most `seconds` for a byte; the number of bytes put into `to`, 0 where none came.
  // Throws LinkLost.
  virtual size_t read(std::span<uint8_t> to, double seconds) = 0;
  // Seconds of a clock that never goes back.
  virtual double now() const = 0;
};

// Where a board is: a path and a rate, "PATH" or "PATH@BAUD".
struct DeviceName {
  std::string path;
  uint32_t baud = 0;  // as given, or kDefaultBaud
};
constexpr uint32_t kDefaultBaud =
    2'000'000;  // of the boards that `generate --board` knows, at their default clock

// Throws std::runtime_error saying what was expected.
DeviceName parse_device(const std::string& text);

// A serial port or the terminal side of a pseudo-terminal: raw, 8 data bits, no parity, 1 stop bit,
// no flow control, locked against a second program. Throws LinkLost where it cannot be opened, and
// where it takes no bytes for `write_seconds`.
std::unique_ptr<ByteLink> open_serial(const DeviceName& device, double write_seconds = 5);

}  // namespace photonloom
