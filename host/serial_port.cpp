// SPDX-License-Identifier: Apache-2.0
// The kernel's own termios2, because the C library's termios knows no rate but the historic ones.
#include <asm/termbits.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <linux/serial.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>

#include "host/byte_link.hpp"

namespace photonloom {

namespace {

class SerialPort final : public ByteLink {
 public:
  SerialPort(const DeviceName& device, double write_seconds)
      : name_(device.path), write_seconds_(write_seconds) {
    descriptor_ = open(name_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (descriptor_ < 0) fail("cannot be opened");
    try {
      configure(device.baud);
    } catch (...) {
      close(descriptor_);
      throw;
    }
  }
  ~SerialPort() override { close(descriptor_); }

  const std::string& name() const override { return name_; }

  void write(std::span<const uint8_t> bytes) override {
    while (!bytes.empty()) {
      const ssize_t n = ::write(descriptor_, bytes.data(), bytes.size());
      if (n > 0) {
        bytes = bytes.subspan(static_cast<size_t>(n));
      } else if (n < 0 && errno == EAGAIN) {
        if (!wait(POLLOUT, static_cast<int>(write_seconds_ * 1000) + 1))
          throw LinkLost(fmt::format("{}: takes no bytes for {:g} seconds", name_, write_seconds_));
      } else if (n < 0 && errno != EINTR) {
        fail("is gone");
      }
    }
  }

  size_t read(std::span<uint8_t> to, double seconds) override {
    if (!wait(POLLIN, static_cast<int>(seconds * 1000) + 1)) return 0;
    const ssize_t n = ::read(descriptor_, to.data(), to.size());
    if (n > 0) return static_cast<size_t>(n);
    if (n < 0 && (errno == EAGAIN || errno == EINTR)) return 0;
    // Readable without bytes: the other end was closed.
    if (n == 0) throw LinkLost(fmt::format("{}: is gone: the other end was closed", name_));
    fail("is gone");
  }

  double now() const override {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  }

 private:
  [[noreturn]] void fail(const char* what) const {
    throw LinkLost(fmt::format("{}: {}: {}", name_, what, std::strerror(errno)));
  }

  void configure(uint32_t baud) {
    termios2 t{};
    if (ioctl(descriptor_, TCGETS2, &t) != 0)
      throw LinkLost(fmt::format("{}: is no serial port or pseudo-terminal", name_));
    if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0)
      throw LinkLost(fmt::format("{}: is in use by another program", name_));
    t.c_iflag = 0;
    t.c_oflag = 0;
    t.c_lflag = 0;
    t.c_cflag = CS8 | CREAD | CLOCAL | BOTHER;
    t.c_ispeed = t.c_ospeed = baud;
    t.c_cc[VMIN] = 1;
    t.c_cc[VTIME] = 0;
    if (ioctl(descriptor_, TCSETS2, &t) != 0)
      throw LinkLost(
          fmt::format("{}: cannot be set to {} baud: {}", name_, baud, std::strerror(errno)));
    termios2 is{};
    // A rate the port cannot make comes back as another one; more than 2 % off no byte is right.
    if (ioctl(descriptor_, TCGETS2, &is) == 0 &&
        (is.c_ospeed > baud + baud / 50 || is.c_ospeed < baud - baud / 50))
      throw LinkLost(fmt::format("{}: makes {} baud where {} was asked", name_, is.c_ospeed, baud));
    ioctl(descriptor_, TCFLSH, TCIOFLUSH);  // what an earlier program left
    // USB adapters hold short answers back for 16 ms unless told otherwise; where the driver cannot
    // be told, answers only come later.
    serial_struct serial{};
    if (ioctl(descriptor_, TIOCGSERIAL, &serial) == 0) {
      serial.flags |= ASYNC_LOW_LATENCY;
      ioctl(descriptor_, TIOCSSERIAL, &serial);
    }
  }

  bool wait(short events, int milliseconds) const {
    pollfd p{descriptor_, events, 0};
    const int n = poll(&p, 1, milliseconds);
    if (n < 0 && errno != EINTR) fail("cannot be waited for");
    return n > 0;
  }

  std::string name_;
  double write_seconds_;
  int descriptor_ = -1;
};

}  // namespace

DeviceName parse_device(const std::string& text) {
  DeviceName device{text, kDefaultBaud};
  const size_t at = text.rfind('@');
  if (at != std::string::npos) {
    device.path = text.substr(0, at);
    const char *from = text.data() + at + 1, *to = text.data() + text.size();
    const auto read = std::from_chars(from, to, device.baud);
    if (read.ec != std::errc() || read.ptr != to || device.baud < 300)
      throw std::runtime_error(
          fmt::format("'{}': after @ expected a rate in baud, 300 or more", text));
  }
  if (device.path.empty())
    throw std::runtime_error(fmt::format(
        "'{}': expected a device, such as /dev/ttyUSB0 or /dev/ttyUSB0@{}", text, kDefaultBaud));
  return device;
}

std::unique_ptr<ByteLink> open_serial(const DeviceName& device, double write_seconds) {
  return std::make_unique<SerialPort>(device, write_seconds);
}

}  // namespace photonloom
