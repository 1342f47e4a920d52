// SPDX-License-Identifier: Apache-2.0
#include "host/frame.hpp"

#include <zlib.h>

namespace photonloom {

namespace {

constexpr uint8_t kEnd = 0xC0, kEscape = 0xDB, kEscapedEnd = 0xDC, kEscapedEscape = 0xDD;
constexpr size_t kCrcBytes = 4, kMinFrameBytes = 6;

}  // namespace

uint32_t link_crc(std::span<const uint8_t> bytes) {
  return static_cast<uint32_t>(crc32(0, bytes.data(), static_cast<uInt>(bytes.size())));
}

Bytes encode_frame(std::span<const uint8_t> content) {
  Bytes frame(content.begin(), content.end());
  put_u32(frame, link_crc(content));
  Bytes wire{kEnd};
  for (const uint8_t byte : frame) {
    if (byte == kEnd || byte == kEscape) {
      wire.push_back(kEscape);
      wire.push_back(byte == kEnd ? kEscapedEnd : kEscapedEscape);
    } else {
      wire.push_back(byte);
    }
  }
  wire.push_back(kEnd);
  return wire;
}

std::optional<Bytes> FrameDecoder::take(uint8_t byte) {
  if (byte != kEnd) {
    if (escaped_) {
      escaped_ = false;
      if (byte != kEscapedEnd && byte != kEscapedEscape) broken_ = true;
      frame_.push_back(byte == kEscapedEnd ? kEnd : kEscape);
    } else if (byte == kEscape) {
      escaped_ = true;
    } else {
      frame_.push_back(byte);
    }
    if (frame_.size() > kMaxFrameBytes) {
      broken_ = true;
      frame_.resize(kMaxFrameBytes);
    }
    return std::nullopt;
  }
  Bytes frame;
  frame.swap(frame_);
  const bool broken = broken_ || escaped_;
  broken_ = escaped_ = false;
  if (frame.empty() && !broken) return std::nullopt;  // two ENDs
  if (!broken && frame.size() >= kMinFrameBytes) {
    const size_t content = frame.size() - kCrcBytes;
    if (get_u32(frame, content) == link_crc({frame.data(), content})) {
      frame.resize(content);
      return frame;
    }
  }
  ++bad_;
  return std::nullopt;
}

void put_u32(Bytes& to, uint32_t value) {
  for (int i = 0; i < 4; ++i) to.push_back(static_cast<uint8_t>(value >> (8 * i)));
}

uint32_t get_u32(std::span<const uint8_t> from, size_t at) {
  uint32_t value = 0;
  for (size_t i = 0; i < 4; ++i) value |= uint32_t{from[at + i]} << (8 * i);
  return value;
}

}  // namespace photonloom
