// SPDX-License-Identifier: Apache-2.0
// libFuzzer target for the board's end of the host link: arbitrary bytes on the wire into the real
// rtl/board/host_link.sv, UART and all, as Verilator makes C++ of it. What it does and what it
// answers is, byte by byte, what docs/host-link.md says of these bytes: Oracle below reads frames,
// computes the CRC and makes the answers on its own, with nothing of the RTL's or the host's. So no
// frame whose CRC is wrong is obeyed, good ones are obeyed in order, a bad one is answered with
// BAD, and behind one END a good frame is taken again, whatever came before.
//
// An input's first byte says what the rest is: even, the bytes of the wire; odd, the contents of
// frames, which get their CRC and ENDs here, and a fault where two bytes ahead of them say so. Few
// changes of a frame on the wire would keep it good.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "Vhost_link.h"
#include "verilated.h"

namespace {

using Wire = std::vector<uint8_t>;

constexpr uint8_t kEndByte = 0xC0, kEscapeByte = 0xDB;
constexpr unsigned kClocksPerBit = 4;
// Bytes of an input that count. Of what they become on the wire never more waits than the 2,048
// bytes that the board holds, so that none may be lost.
constexpr size_t kInput = 600;

[[noreturn]] void fail(const std::string& what) {
  std::fprintf(stderr, "board_link: %s\n", what.c_str());
  std::abort();
}

// A word read or written, a word pushed, words that may be forgotten.
struct Event {
  char kind;
  uint32_t address, word;
  bool first, last;
  bool operator==(const Event&) const = default;
};

// What lies behind the link, made up here: words by address, and the two streams.
struct Words {
  std::vector<Event> events;
  uint32_t next_in = 0xFFFFFFFC;  // positions go over 2^32
  uint32_t room = 96;
  uint32_t first = 0xFFFFFFE0, end = 80;

  static uint32_t word(uint32_t address) { return address * 0x9E3779B1u ^ address >> 7; }
  static uint32_t status(uint32_t address) {
    const uint32_t low = address & 15;
    return low == 14 ? 1 : low == 13 ? 2 : 0;
  }
  bool before(uint32_t position) const {
    return position - first > end - first && static_cast<int32_t>(position - first) < 0;
  }
  bool after(uint32_t position) const {
    return position - first > end - first && !before(position);
  }
  void read(uint32_t address, bool is_first) {
    events.push_back({'r', address, word(address), is_first, false});
  }
  void write(uint32_t address, uint32_t data, bool is_first, bool is_last) {
    events.push_back({'w', address, data, is_first, is_last});
  }
  void push(uint32_t data) {
    if (!room) return;
    events.push_back({'p', next_in++, data, false, false});
    --room;
  }
  void keep(uint32_t position) {
    events.push_back({'k', position, 0, false, false});
    first = position;
  }
};

uint32_t number(std::span<const uint8_t> bytes, size_t at) {
  return bytes[at] | uint32_t{bytes[at + 1]} << 8 | uint32_t{bytes[at + 2]} << 16 |
         uint32_t{bytes[at + 3]} << 24;
}

// CRC-32 of IEEE 802.3 from its definition, a bit at a time: the message's polynomial, its first 32
// bits complemented, modulo the generator 0x04C11DB7, the remainder complemented and reflected.
uint32_t crc_of(std::span<const uint8_t> message) {
  uint32_t remainder = 0xFFFFFFFF;
  for (const uint8_t byte : message)
    for (int i = 0; i < 8; ++i) {
      const bool top = (remainder >> 31 ^ (byte >> i & 1)) != 0;
      remainder = remainder << 1 ^ (top ? 0x04C11DB7 : 0);
    }
  uint32_t reflected = 0;
  for (int i = 0; i < 32; ++i) reflected |= (~remainder >> i & 1) << (31 - i);
  return reflected;
}

void put_number(Wire& to, uint32_t value) {
  for (int i = 0; i < 32; i += 8) to.push_back(static_cast<uint8_t>(value >> i));
}

void put_stuffed(Wire& to, std::span<const uint8_t> bytes) {
  for (const uint8_t byte : bytes) {
    if (byte == kEndByte || byte == kEscapeByte) to.push_back(kEscapeByte);
    to.push_back(byte == kEndByte ? 0xDC : byte == kEscapeByte ? 0xDD : byte);
  }
}

Wire framed(Wire content) {
  put_number(content, crc_of(content));
  Wire wire{kEndByte};
  put_stuffed(wire, content);
  wire.push_back(kEndByte);
  return wire;
}

// What the page says of bytes on the wire: answers, and what the board does with its words.
class Oracle {
 public:
  void take(uint8_t byte) {
    if (byte != kEndByte) {
      raw_.push_back(byte);
    } else if (!raw_.empty()) {
      const std::optional<Wire> frame = plain();
      raw_.clear();
      obeyed_ = frame && obey(*frame);
      if (!obeyed_) answer({0, 0xFF});
      bad_ += !obeyed_;
    }
  }
  const Wire& answers() const { return answers_; }
  const Words& words() const { return words_; }
  uint64_t bad() const { return bad_; }
  bool obeyed() const { return obeyed_; }  // the last frame

 private:
  // The bytes between two ENDs without stuffing, where they are a frame with the right CRC.
  std::optional<Wire> plain() const {
    Wire frame;
    for (size_t i = 0; i < raw_.size(); ++i) {
      uint8_t byte = raw_[i];
      if (byte == kEscapeByte) {
        if (++i == raw_.size() || (raw_[i] != 0xDC && raw_[i] != 0xDD)) return std::nullopt;
        byte = raw_[i] == 0xDC ? kEndByte : kEscapeByte;
      }
      frame.push_back(byte);
    }
    if (frame.size() < 6 || frame.size() > 272) return std::nullopt;
    const uint32_t crc = number(frame, frame.size() - 4);
    frame.resize(frame.size() - 4);
    if (crc != crc_of(frame)) return std::nullopt;
    return frame;
  }

  void answer(const Wire& content) {
    const Wire wire = framed(content);
    answers_.insert(answers_.end(), wire.begin(), wire.end());
  }

  bool obey(const Wire& frame) {
    const uint8_t command = frame[1];
    const std::span<const uint8_t> body = std::span(frame).subspan(2);
    Wire content{frame[0], static_cast<uint8_t>(command | 0x80)};
    if (command == 1) {
      if (body.size() != 5 || body[4] < 1 || body[4] > 64) return false;
      for (uint32_t i = 0; i < body[4]; ++i) {
        words_.read(number(body, 0) + i, i == 0);
        put_number(content, Words::word(number(body, 0) + i));
      }
    } else if (command == 2 || command == 3) {
      if (body.size() < 8 || body.size() > 260 || body.size() % 4) return false;
      uint32_t status = 0;
      const uint32_t count = static_cast<uint32_t>(body.size()) / 4 - 1;
      for (uint32_t i = 0; i < count; ++i) {
        const uint32_t address = number(body, 0) + i, word = number(body, 4 * i + 4);
        if (command == 3) {
          if (address == words_.next_in) words_.push(word);
          continue;
        }
        words_.write(address, word, i == 0, i + 1 == count);
        if (const uint32_t now = Words::status(address); now && status != 1) status = now;
      }
      put_number(content, command == 3 ? words_.next_in : status);
      if (command == 3) put_number(content, words_.room);
    } else if (command == 4) {
      if (body.size() != 9 || body[4] < 1 || body[4] > 64) return false;
      uint32_t position = number(body, 0), count = body[4];
      const uint32_t keep = number(body, 5);
      if (!words_.before(keep) && !words_.after(keep)) words_.keep(keep);
      if (words_.before(position) || words_.after(position)) {
        position = words_.before(position) ? words_.first : words_.end;
        count = 0;
      }
      put_number(content, position);
      put_number(content, words_.end);
      for (uint32_t i = 0; i < std::min(count, words_.end - position); ++i)
        put_number(content, Words::word(position + i));
    } else {
      return false;
    }
    answer(content);
    return true;
  }

  Wire raw_, answers_;
  Words words_;
  uint64_t bad_ = 0;
  bool obeyed_ = false;
};

// The RTL, clocked, with the other ends of its two wires and its words.
class Board {
 public:
  Board() : rtl_(&context_) {
    context_.fatalOnError(false);
    rtl_.uart_rx_i = 1;
    rtl_.rst_i = 1;
    for (int i = 0; i < 3; ++i) cycle();
    rtl_.rst_i = 0;
    sent_.clear();
    words_ = Words();
    bad_ = 0;
    receiving_ = 0;
    // The receiver's line has to be seen idle before the first start bit.
    for (int i = 0; i < 4; ++i) cycle();
  }

  void send(uint8_t byte) {
    const unsigned bits = 1u << 9 | unsigned{byte} << 1;
    for (unsigned bit = 0; bit < 10; ++bit) {
      rtl_.uart_rx_i = bits >> bit & 1;
      for (unsigned i = 0; i < kClocksPerBit; ++i) cycle();
    }
  }
  void cycle() {
    rtl_.clk_i = 0;
    const uint32_t address = rtl_.address_o;
    rtl_.read_word_i = rtl_.pull_word_i = Words::word(address);
    rtl_.write_ready_i = ++cycles_ % 5 == 0;
    rtl_.write_status_i = static_cast<uint8_t>(Words::status(address));
    rtl_.push_position_i = words_.next_in;
    rtl_.push_room_i = static_cast<uint16_t>(words_.room);
    rtl_.pull_before_i = words_.before(address);
    rtl_.pull_after_i = words_.after(address);
    rtl_.pull_first_i = words_.first;
    rtl_.pull_end_i = words_.end;
    rtl_.eval();
    if (!rtl_.rst_i) {
      if (rtl_.read_valid_o) words_.read(address, rtl_.first_o);
      if (rtl_.write_valid_o && rtl_.write_ready_i)
        words_.write(address, rtl_.write_word_o, rtl_.first_o, rtl_.write_last_o);
      if (rtl_.push_valid_o) words_.push(rtl_.push_word_o);
      if (rtl_.keep_valid_o) words_.keep(address);
      if (rtl_.byte_lost_o) fail("lost a byte, of fewer than it holds");
      bad_ += rtl_.frame_bad_o;
      receive(rtl_.uart_tx_o);
    }
    rtl_.clk_i = 1;
    rtl_.eval();
    if (context_.gotFinish() || context_.gotError()) fail("an assertion of the RTL failed");
  }
  const Wire& sent() const { return sent_; }
  const Words& words() const { return words_; }
  uint64_t bad() const { return bad_; }

 private:
  // Samples the bits of a byte in their middle.
  void receive(bool line) {
    if (receiving_ == 0 && line) return;
    ++receiving_;
    if (receiving_ % kClocksPerBit != 2) return;
    const unsigned bit = receiving_ / kClocksPerBit;
    if (bit == 0)
      byte_ = 0;
    else if (bit < 9)
      byte_ |= static_cast<unsigned>(line) << (bit - 1);
    else {
      if (!line) fail("sent a byte without a stop bit");
      sent_.push_back(static_cast<uint8_t>(byte_));
      receiving_ = 0;
    }
  }

  VerilatedContext context_;
  Vhost_link rtl_;
  Words words_;
  Wire sent_;
  unsigned receiving_ = 0, byte_ = 0;
  uint64_t cycles_ = 0, bad_ = 0;
};

// Frames of the contents that an input holds, each behind its length and what is wrong with it.
Wire frames_of(std::span<const uint8_t> from) {
  Wire wire;
  while (from.size() >= 2) {
    const uint8_t fault = from[1];
    const size_t length = std::min<size_t>(from[0] | (fault & 1) << 8, from.size() - 2);
    Wire frame = framed({from.begin() + 2, from.begin() + 2 + static_cast<long>(length)});
    from = from.subspan(2 + length);
    const size_t place = fault >> 4;  // among the last bytes, where the CRC is
    uint8_t& byte = frame[frame.size() - 1 - std::min(place, frame.size() - 1)];
    switch (fault >> 1 & 7) {
      case 1:
        byte ^= 1;
        break;
      case 2:
        byte ^= 0x80;
        break;
      case 3:
        frame.pop_back();
        break;
      case 4:
        frame.erase(frame.begin());
        break;
      case 5:
        byte = kEscapeByte;
        break;
      case 6:
        byte = kEndByte;
        break;
      default:
        break;
    }
    wire.insert(wire.end(), frame.begin(), frame.end());
  }
  return wire;
}

std::string hex(const Wire& bytes) {
  std::string text;
  char two[4];
  for (const uint8_t byte : bytes) {
    std::snprintf(two, sizeof two, " %02x", byte);
    text += two;
  }
  return text;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  const std::span<const uint8_t> rest(data + 1, std::min(size, kInput) - 1);
  Wire wire = data[0] & 1 ? frames_of(rest) : Wire(rest.begin(), rest.end());
  // One END, and the board is there again.
  wire.push_back(kEndByte);
  const Wire good = framed({0x2A, 1, 3, 0, 0, 0, 1});
  wire.insert(wire.end(), good.begin() + 1, good.end());

  Oracle oracle;
  for (const uint8_t byte : wire) oracle.take(byte);
  if (!oracle.obeyed()) fail("the oracle does not take a good frame behind an END");

  Board board;
  for (const uint8_t byte : wire) board.send(byte);
  // The longest silence is that of a full WRITE: its bytes through the receiver, and its words.
  // When the last frame is answered, nothing is left that another answer could be to.
  constexpr unsigned kSilence = 8000, kBehind = 400;
  size_t seen = board.sent().size();
  for (unsigned left = kSilence; left > 0 && seen <= oracle.answers().size(); --left) {
    board.cycle();
    if (board.sent().size() != seen) {
      seen = board.sent().size();
      left = seen == oracle.answers().size() ? kBehind : kSilence;
    }
  }
  if (board.sent() != oracle.answers())
    fail("to" + hex(wire) + "\n  expected" + hex(oracle.answers()) + "\n  answered" +
         hex(board.sent()));
  if (board.words().events != oracle.words().events)
    fail("to" + hex(wire) + ": answers rightly, and does something else with its words");
  if (board.bad() != oracle.bad()) fail("counts another number of bad frames");
  return 0;
}
