// SPDX-License-Identifier: Apache-2.0
// Frames of the host link (docs/host-link.md): byte stuffing and CRC-32.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace photonloom {

using Bytes = std::vector<uint8_t>;

constexpr size_t kMaxFrameBytes = 272;  // before stuffing
constexpr size_t kMaxFrameWords = 64;   // of data in one frame

// CRC-32 of IEEE 802.3.
uint32_t link_crc(std::span<const uint8_t> bytes);

// The bytes on the wire of a frame with this content (id, command, body), both ENDs included.
Bytes encode_frame(std::span<const uint8_t> content);

// Takes bytes from the wire; gives the content of good frames.
class FrameDecoder {
 public:
  // The content (id, command, body) of the frame that this byte ends, if it is good.
  std::optional<Bytes> take(uint8_t byte);
  uint64_t bad() const { return bad_; }  // frames dropped so far

 private:
  Bytes frame_;
  bool escaped_ = false, broken_ = false;
  uint64_t bad_ = 0;
};

// Little endian numbers in a frame.
void put_u32(Bytes& to, uint32_t value);
uint32_t get_u32(std::span<const uint8_t> from, size_t at);

}  // namespace photonloom
