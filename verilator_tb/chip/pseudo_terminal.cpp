// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/chip/pseudo_terminal.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

namespace photonloom {

namespace fs = std::filesystem;

PseudoTerminal::PseudoTerminal(const std::string& link) : link_(link) {
  const auto fail = [](const char* what) {
    throw std::runtime_error(fmt::format("pseudo-terminal: {}: {}", what, std::strerror(errno)));
  };
  device_ = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
  if (device_ < 0 || grantpt(device_) != 0 || unlockpt(device_) != 0) fail("cannot be made");
  path_ = ptsname(device_);
  // Its own opening of the terminal keeps it alive between two programs that use it, and makes it
  // pass every byte before the first of them sets it up.
  terminal_ = open(path_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios t{};
  if (terminal_ < 0 || tcgetattr(terminal_, &t) != 0) fail("cannot be opened");
  cfmakeraw(&t);
  if (tcsetattr(terminal_, TCSANOW, &t) != 0) fail("cannot be set up");
  if (link_.empty()) return;
  std::error_code error;
  if (fs::is_symlink(link_)) fs::remove(link_, error);
  fs::create_symlink(path_, link_, error);
  if (error)
    throw std::runtime_error(
        fmt::format("{}: cannot become a link to {}: {}", link_, path_, error.message()));
}

PseudoTerminal::~PseudoTerminal() {
  std::error_code ignored;
  if (!link_.empty() && fs::read_symlink(link_, ignored) == path_) fs::remove(link_, ignored);
  if (terminal_ >= 0) close(terminal_);
  if (device_ >= 0) close(device_);
}

size_t PseudoTerminal::read(std::span<uint8_t> to) {
  const ssize_t n = ::read(device_, to.data(), to.size());
  return n > 0 ? static_cast<size_t>(n) : 0;
}

size_t PseudoTerminal::write(std::span<const uint8_t> bytes) {
  const ssize_t n = ::write(device_, bytes.data(), bytes.size());
  return n > 0 ? static_cast<size_t>(n) : 0;
}

void PseudoTerminal::wait(int milliseconds) const {
  pollfd p{device_, POLLIN, 0};
  poll(&p, 1, milliseconds);
}

}  // namespace photonloom
