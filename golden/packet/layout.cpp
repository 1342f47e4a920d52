// SPDX-License-Identifier: Apache-2.0
#include "golden/packet/layout.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace photonloom {

const FieldPlace* PacketLayout::find(const std::string& name) const {
  for (const FieldPlace& f : fields_)
    if (f.name == name) return &f;
  return nullptr;
}

void PacketLayout::finish() {
  int below = 0;
  for (auto f = fields_.rbegin(); f != fields_.rend(); ++f) {
    if (f->bits > static_cast<int>(8 * f->member_bytes) || f->elements > f->member_elements)
      throw std::runtime_error(fmt::format(
          "packet {}, field {}: {} x {} bits do not fit the C++ struct's {} x {}", name_, f->name,
          f->elements, f->bits, f->member_elements, 8 * f->member_bytes));
    f->offset = below;
    below += f->elements * f->bits;
  }
  bits_ = below;
}

uint64_t PacketLayout::get(const void* packet, const FieldPlace& field, int element) const {
  const char* at = static_cast<const char*>(packet) + field.member_offset +
                   static_cast<size_t>(element) * field.member_bytes;
  if (field.member_bytes == 4) {
    uint32_t v;
    std::memcpy(&v, at, 4);
    return v;
  }
  uint64_t v;
  std::memcpy(&v, at, 8);
  return v;
}

void PacketLayout::set(void* packet, const FieldPlace& field, int element, uint64_t value) const {
  char* at = static_cast<char*>(packet) + field.member_offset +
             static_cast<size_t>(element) * field.member_bytes;
  if (field.member_bytes == 4) {
    const uint32_t v = static_cast<uint32_t>(value);
    std::memcpy(at, &v, 4);
  } else {
    std::memcpy(at, &value, 8);
  }
}

uint64_t PacketLayout::extract(const uint32_t* words, const FieldPlace& field, int element) const {
  const int offset = field.offset + element * field.bits;
  uint64_t value = 0;
  for (int done = 0; done < field.bits;) {
    const int bit = (offset + done) % 32;
    const int take = std::min(32 - bit, field.bits - done);
    const uint64_t piece = (words[(offset + done) / 32] >> bit) & ones(take);
    value |= piece << done;
    done += take;
  }
  return value;
}

void PacketLayout::pack(const void* packet, uint32_t* words) const {
  std::fill_n(words, this->words(), 0u);
  for (const FieldPlace& f : fields_) {
    for (int i = 0; i < f.member_elements; ++i) {
      const uint64_t value = get(packet, f, i);
      if (value > (i < f.elements ? ones(f.bits) : 0))
        throw std::runtime_error(
            f.present() && i < f.elements
                ? fmt::format("packet {}, field {}: {} does not fit its {} bits", name_, f.name,
                              value, f.bits)
                : fmt::format("packet {}, field {}: is {} in element {}, which this plan has not",
                              name_, f.name, value, i));
      if (i >= f.elements) continue;
      const int offset = f.offset + i * f.bits;
      for (int done = 0; done < f.bits;) {
        const int bit = (offset + done) % 32;
        words[(offset + done) / 32] |= static_cast<uint32_t>(value >> done) << bit;
        done += std::min(32 - bit, f.bits - done);
      }
    }
  }
}

void PacketLayout::unpack(const uint32_t* words, void* packet) const {
  for (const FieldPlace& f : fields_)
    for (int i = 0; i < f.member_elements; ++i)
      set(packet, f, i, i < f.elements ? extract(words, f, i) : 0);
}

std::string to_hex(const uint32_t* words, int bits) {
  std::string digits;
  for (int digit = (bits + 3) / 4 - 1; digit >= 0; --digit)
    digits += "0123456789abcdef"[(words[digit / 8] >> (4 * (digit % 8))) & 15];
  return "0x" + (digits.empty() ? "0" : digits);
}

}  // namespace photonloom
