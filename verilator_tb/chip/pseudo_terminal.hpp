// SPDX-License-Identifier: Apache-2.0
// The device side of a pseudo-terminal: what a program opens by its path as it opens a serial port.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace photonloom {

class PseudoTerminal {
 public:
  // `link`, if not empty, becomes a symbolic link to the terminal; what was there is replaced only
  // if it was such a link too. The link goes with the object. Throws std::runtime_error.
  explicit PseudoTerminal(const std::string& link);
  ~PseudoTerminal();
  PseudoTerminal(const PseudoTerminal&) = delete;
  PseudoTerminal& operator=(const PseudoTerminal&) = delete;

  const std::string& path() const { return path_; }
  // Neither waits; the number of bytes.
  size_t read(std::span<uint8_t> to);
  size_t write(std::span<const uint8_t> bytes);
  // Until there is something to read, or so long.
  void wait(int milliseconds) const;

 private:
  int device_ = -1, terminal_ = -1;
  std::string path_, link_;
};

}  // namespace photonloom
