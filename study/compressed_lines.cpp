// SPDX-License-Identifier: Apache-2.0
#include "study/compressed_lines.hpp"

#include <algorithm>
#include <bit>
#include <map>

namespace photonloom {
namespace {

// What a line's photons are relative to, and the bits that they need of each offset.
struct Box {
  UVec3 corner;
  uint32_t exponent;
  LineLayout needed;
};

Box box_of(std::span<const PackedPhoton> line) {
  UVec3 low = line[0].position, high = low;
  uint32_t least = line[0].power.exponent, most = least;
  for (const PackedPhoton& p : line) {
    for (size_t c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], p.position[c]);
      high[c] = std::max(high[c], p.position[c]);
    }
    least = std::min(least, p.power.exponent);
    most = std::max(most, p.power.exponent);
  }
  Box box{low, least, {}};
  for (size_t c = 0; c < 3; ++c) {
    box.corner[c] = low[c] >> kCornerStep << kCornerStep;
    box.needed.position[c] = static_cast<uint8_t>(std::bit_width(high[c] - box.corner[c]));
  }
  box.needed.exponent = static_cast<uint8_t>(std::bit_width(most - least));
  return box;
}

bool fits(const LineLayout& needed, const LineLayout& layout) {
  return needed.position[0] <= layout.position[0] && needed.position[1] <= layout.position[1] &&
         needed.position[2] <= layout.position[2] && needed.exponent <= layout.exponent;
}

int corner_bits(const Plan& plan) { return std::max(0, plan.position_bits - kCornerStep); }

// Fields one after the other, little endian.
class Writer {
 public:
  explicit Writer(size_t bytes) : bytes_(bytes, 0) {}
  void put(uint64_t value, int bits) {
    for (int i = 0; i < bits; ++i, ++at_)
      if (value >> i & 1) bytes_[at_ / 8] = static_cast<uint8_t>(bytes_[at_ / 8] | 1u << (at_ % 8));
  }
  std::vector<uint8_t> take() { return std::move(bytes_); }

 private:
  std::vector<uint8_t> bytes_;
  size_t at_ = 0;
};

class Reader {
 public:
  explicit Reader(std::span<const uint8_t> bytes) : bytes_(bytes) {}
  uint32_t get(int bits) {
    uint32_t value = 0;
    for (int i = 0; i < bits; ++i, ++at_)
      value |= static_cast<uint32_t>(bytes_[at_ / 8] >> (at_ % 8) & 1) << i;
    return value;
  }

 private:
  std::span<const uint8_t> bytes_;
  size_t at_ = 0;
};

}  // namespace

int offset_bits(const Plan& plan, int line_bytes) {
  const int header = kLayoutBits + 3 * corner_bits(plan) + plan.exponent_bits;
  const int fixed = 2 * plan.direction_bits + plan.channels * plan.mantissa_bits;
  return (8 * line_bytes - header) / plan.bucket - fixed;
}

LineFormat choose_line_format(const Plan& plan, const PhotonMap& map, int line_bytes) {
  std::map<LineLayout, uint64_t> wanted;  // lines by what they need
  for (uint32_t line = 0; line < map.lines; ++line)
    ++wanted[box_of(std::span(map.slots).subspan(size_t{line} * static_cast<size_t>(plan.bucket),
                                                 static_cast<size_t>(plan.bucket)))
                 .needed];
  LineFormat format{line_bytes, {}};
  const int room = offset_bits(plan, line_bytes);
  while (format.layouts.size() < kLineLayouts) {
    LineLayout best;
    uint64_t most = 0;
    for (int e = 0; e <= std::min(plan.exponent_bits, room); ++e)
      for (int x = 0; x <= std::min(plan.position_bits, room - e); ++x)
        for (int y = 0; y <= std::min(plan.position_bits, room - e - x); ++y) {
          const LineLayout layout{
              {static_cast<uint8_t>(x), static_cast<uint8_t>(y),
               static_cast<uint8_t>(std::min(plan.position_bits, room - e - x - y))},
              static_cast<uint8_t>(e)};
          uint64_t lines = 0;
          for (const auto& [needed, count] : wanted)
            if (fits(needed, layout)) lines += count;
          if (lines > most) {
            most = lines;
            best = layout;
          }
        }
    if (most == 0) break;
    format.layouts.push_back(best);
    std::erase_if(wanted, [&](const auto& w) { return fits(w.first, best); });
  }
  return format;
}

std::optional<size_t> fitting_layout(const LineFormat& format, std::span<const PackedPhoton> line) {
  const LineLayout needed = box_of(line).needed;
  for (size_t i = 0; i < format.layouts.size(); ++i)
    if (fits(needed, format.layouts[i])) return i;
  return std::nullopt;
}

std::vector<uint8_t> encode_line(const Plan& plan, const LineFormat& format,
                                 std::span<const PackedPhoton> line) {
  const std::optional<size_t> chosen = fitting_layout(format, line);
  const auto size = static_cast<size_t>(format.line_bytes);
  Writer out(chosen ? size : 2 * size);
  const Box box = chosen ? box_of(line) : Box{{0, 0, 0}, 0, {}};
  LineLayout layout{
      {static_cast<uint8_t>(plan.position_bits), static_cast<uint8_t>(plan.position_bits),
       static_cast<uint8_t>(plan.position_bits)},
      static_cast<uint8_t>(plan.exponent_bits)};
  out.put(chosen.value_or(kLineLayouts), kLayoutBits);
  if (chosen) {
    layout = format.layouts[*chosen];
    for (const uint32_t x : box.corner) out.put(x >> kCornerStep, corner_bits(plan));
    out.put(box.exponent, plan.exponent_bits);
  }
  for (const PackedPhoton& p : line) {
    for (size_t c = 0; c < 3; ++c) out.put(p.position[c] - box.corner[c], layout.position[c]);
    out.put(p.power.exponent - box.exponent, layout.exponent);
    out.put(p.direction.u, plan.direction_bits);
    out.put(p.direction.v, plan.direction_bits);
    for (int c = 0; c < plan.channels; ++c)
      out.put(p.power.mantissa[static_cast<size_t>(c)], plan.mantissa_bits);
  }
  return out.take();
}

std::vector<PackedPhoton> decode_line(const Plan& plan, const LineFormat& format,
                                      std::span<const uint8_t> bytes) {
  Reader in(bytes);
  const size_t chosen = in.get(kLayoutBits);
  Box box{{0, 0, 0}, 0, {}};
  LineLayout layout{
      {static_cast<uint8_t>(plan.position_bits), static_cast<uint8_t>(plan.position_bits),
       static_cast<uint8_t>(plan.position_bits)},
      static_cast<uint8_t>(plan.exponent_bits)};
  if (chosen < kLineLayouts) {
    layout = format.layouts[chosen];
    for (uint32_t& x : box.corner) x = in.get(corner_bits(plan)) << kCornerStep;
    box.exponent = in.get(plan.exponent_bits);
  }
  std::vector<PackedPhoton> line(static_cast<size_t>(plan.bucket));
  for (PackedPhoton& p : line) {
    for (size_t c = 0; c < 3; ++c) p.position[c] = box.corner[c] + in.get(layout.position[c]);
    p.power.exponent = box.exponent + in.get(layout.exponent);
    p.direction.u = in.get(plan.direction_bits);
    p.direction.v = in.get(plan.direction_bits);
    for (int c = 0; c < plan.channels; ++c)
      p.power.mantissa[static_cast<size_t>(c)] = in.get(plan.mantissa_bits);
  }
  return line;
}

}  // namespace photonloom
