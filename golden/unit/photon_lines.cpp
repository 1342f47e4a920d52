// SPDX-License-Identifier: Apache-2.0
#include "golden/unit/photon_lines.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <optional>
#include <stdexcept>

#include "golden/plan/plan_file.hpp"

namespace photonloom {
namespace {

constexpr uint32_t kUnused = 3;  // low exponent bits of an unused record, whose mantissas are 0

// Fields one after the other from a bit on, little endian.
class FieldWriter {
 public:
  FieldWriter(std::span<uint8_t> bytes, size_t at) : bytes_(bytes), at_(at) {}
  void put(uint64_t value, int bits) {
    for (int i = 0; i < bits; ++i, ++at_)
      if (i < 64 && (value >> i & 1))
        bytes_[at_ / 8] = static_cast<uint8_t>(bytes_[at_ / 8] | 1u << (at_ % 8));
  }

 private:
  std::span<uint8_t> bytes_;
  size_t at_;
};

class FieldReader {
 public:
  FieldReader(std::span<const uint8_t> bytes, size_t at) : bytes_(bytes), at_(at) {}
  uint32_t get(int bits) {
    uint32_t value = 0;
    for (int i = 0; i < bits; ++i, ++at_)
      if (i < 32) value |= static_cast<uint32_t>(bytes_[at_ / 8] >> (at_ % 8) & 1) << i;
    return value;
  }

 private:
  std::span<const uint8_t> bytes_;
  size_t at_;
};

size_t slot_at(const Plan& plan, size_t slot) {
  return 8 * slot * static_cast<size_t>(plan.photon_bytes);
}

// The axes whose offsets are the first and the second of a record, beside the line's own.
size_t first_axis(uint32_t axis) { return axis == 0 ? 1 : 0; }
size_t second_axis(uint32_t axis) { return axis >= 2 ? 1 : 2; }
size_t own_axis(uint32_t axis) { return std::min<uint32_t>(axis, 2); }

// What the records of a line are relative to, and how their offsets lie.
struct Header {
  uint32_t split = 0, axis = 0, more = 0, exponent = 0;
  UVec3 corner;  // position units
};

std::vector<uint8_t> plain_line(const Plan& plan, std::span<const PackedPhoton> slots) {
  std::vector<uint8_t> bytes(static_cast<size_t>(plan.line_bytes()), 0);
  for (size_t s = 0; s < slots.size(); ++s) {
    FieldWriter out(bytes, slot_at(plan, s));
    for (const uint32_t x : slots[s].position) out.put(x, plan.position_bits);
    out.put(slots[s].direction.u, plan.direction_bits);
    out.put(slots[s].direction.v, plan.direction_bits);
    for (int c = 0; c < plan.channels; ++c)
      out.put(slots[s].power.mantissa[static_cast<size_t>(c)], plan.mantissa_bits);
    out.put(slots[s].power.exponent, plan.exponent_bits);
  }
  return bytes;
}

std::vector<PackedPhoton> read_plain_line(const Plan& plan, std::span<const uint8_t> bytes) {
  std::vector<PackedPhoton> slots(static_cast<size_t>(plan.bucket));
  for (size_t s = 0; s < slots.size(); ++s) {
    FieldReader in(bytes, slot_at(plan, s));
    for (uint32_t& x : slots[s].position) x = in.get(plan.position_bits);
    slots[s].direction.u = in.get(plan.direction_bits);
    slots[s].direction.v = in.get(plan.direction_bits);
    for (int c = 0; c < plan.channels; ++c)
      slots[s].power.mantissa[static_cast<size_t>(c)] = in.get(plan.mantissa_bits);
    slots[s].power.exponent = in.get(plan.exponent_bits);
  }
  return slots;
}

// ---- compressed lines ----

bool is_dark(const PackedPhoton& photon) {
  return photon.power.mantissa == std::array<uint32_t, 3>{};
}

// The header of a line with these photons, where a layout holds them: the first, by split, then by
// axis.
std::optional<Header> fitting_header(const Plan& plan, std::span<const PackedPhoton> slots,
                                     std::span<const size_t> members) {
  const int step = plan.position_bits - plan.corner_bits();
  Header header;
  UVec3 high = slots[members[0]].position;
  header.corner = high;
  header.exponent = slots[members[0]].power.exponent;
  uint32_t most = header.exponent;
  for (const size_t s : members) {
    for (size_t c = 0; c < 3; ++c) {
      header.corner[c] = std::min(header.corner[c], slots[s].position[c]);
      high[c] = std::max(high[c], slots[s].position[c]);
    }
    header.exponent = std::min(header.exponent, slots[s].power.exponent);
    most = std::max(most, slots[s].power.exponent);
  }
  for (uint32_t& x : header.corner) x = x >> step << step;
  for (const size_t s : members)
    if (is_dark(slots[s]) && (slots[s].power.exponent - header.exponent) % 4 == kUnused)
      return std::nullopt;
  std::array<int, 3> needed{};
  for (size_t c = 0; c < 3; ++c)
    needed[c] = static_cast<int>(std::bit_width(high[c] - header.corner[c]));
  for (header.split = 0; header.split < kSplits; ++header.split) {
    for (header.axis = 0; header.axis < kAxes; ++header.axis) {
      const OffsetBits bits = offset_bits_of(plan, header.split, header.axis);
      if (most - header.exponent <= ones(bits.exponent) &&
          needed[own_axis(header.axis)] <= bits.own &&
          needed[first_axis(header.axis)] <= bits.first &&
          needed[second_axis(header.axis)] <= bits.second)
        return header;
    }
  }
  return std::nullopt;
}

uint32_t bit(uint32_t value, int number) { return number < 32 ? value >> number & 1 : 0; }

// The fields of a record whose bits its split deals out.
struct Fields {
  uint32_t own = 0, first = 0, second = 0, exponent = 0;
};

// What a shared bit is: bit `number` of a field.
struct SharedBit {
  uint32_t Fields::*field;
  int number;
};
std::array<SharedBit, 4> shared_bits(const Plan& plan, uint32_t split, uint32_t axis) {
  const int a = plan.axis_offset_bits(), b = plan.other_offset_bits();
  const auto own = [&](int n) { return SharedBit{&Fields::own, a + n}; };
  const auto first = [&](int n) { return SharedBit{&Fields::first, b + n}; };
  const auto second = [&](int n) { return SharedBit{&Fields::second, b + n}; };
  const auto exponent = [](int n) { return SharedBit{&Fields::exponent, n}; };
  if (axis == 3)
    return {own(0), own(1), own(2), split == 1 ? first(0) : split == 2 ? second(0) : own(3)};
  switch (split) {
    case 0:
      return {own(0), own(1), own(2), exponent(2)};
    case 1:
      return {own(0), first(0), second(0), exponent(2)};
    case 2:
      return {exponent(3), first(0), second(0), exponent(2)};
    default:
      return {first(1), first(0), second(0), second(1)};
  }
}

void put_record(const Plan& plan, const Header& header, const PackedPhoton& photon,
                FieldWriter out) {
  const auto offset = [&](size_t c) { return photon.position[c] - header.corner[c]; };
  const Fields f{offset(own_axis(header.axis)), offset(first_axis(header.axis)),
                 offset(second_axis(header.axis)), photon.power.exponent - header.exponent};
  out.put(f.first, plan.other_offset_bits());
  out.put(f.second, plan.other_offset_bits());
  out.put(f.own, plan.axis_offset_bits());
  for (const SharedBit& s : shared_bits(plan, header.split, header.axis))
    out.put(bit(f.*s.field, s.number), 1);
  out.put(photon.direction.u, plan.direction_bits);
  out.put(photon.direction.v, plan.direction_bits);
  out.put(f.exponent, 2);
  for (int c = 0; c < plan.channels; ++c)
    out.put(photon.power.mantissa[static_cast<size_t>(c)], plan.mantissa_bits);
}

// An unused record; its low bits, of which all but the exponent's and the mantissas are free, hold
// `address`.
void put_unused(const Plan& plan, uint64_t address, FieldWriter out) {
  out.put(address, plan.offset_bits() - 2 + 2 * plan.direction_bits);
  out.put(kUnused, 2);
}

// The header's bits are dealt to the slots in turn, `slot_header_bits` each, above their records.
void put_header(const Plan& plan, const Header& header, std::span<uint8_t> bytes) {
  std::vector<uint8_t> fields(static_cast<size_t>(plan.bucket * plan.slot_header_bits()) / 8 + 1);
  FieldWriter out(fields, 0);
  out.put(header.split, 2);
  out.put(header.axis, 2);
  out.put(header.more, 1);
  out.put(header.exponent, plan.exponent_bits);
  const int step = plan.position_bits - plan.corner_bits();
  for (const uint32_t x : header.corner) out.put(x >> step, plan.corner_bits());
  FieldReader in(fields, 0);
  for (size_t s = 0; s < static_cast<size_t>(plan.bucket); ++s)
    FieldWriter(bytes, slot_at(plan, s) + static_cast<size_t>(plan.record_bits()))
        .put(in.get(plan.slot_header_bits()), plan.slot_header_bits());
}

Header get_header(const Plan& plan, std::span<const uint8_t> bytes) {
  std::vector<uint8_t> fields(static_cast<size_t>(plan.bucket * plan.slot_header_bits()) / 8 + 1);
  FieldWriter out(fields, 0);
  for (size_t s = 0; s < static_cast<size_t>(plan.bucket); ++s)
    out.put(FieldReader(bytes, slot_at(plan, s) + static_cast<size_t>(plan.record_bits()))
                .get(plan.slot_header_bits()),
            plan.slot_header_bits());
  FieldReader in(fields, 0);
  Header header;
  header.split = in.get(2);
  header.axis = in.get(2);
  header.more = in.get(1);
  header.exponent = in.get(plan.exponent_bits);
  for (uint32_t& x : header.corner)
    x = in.get(plan.corner_bits()) << (plan.position_bits - plan.corner_bits());
  return header;
}

// A line's photon, unless its record is unused.
std::optional<PackedPhoton> get_record(const Plan& plan, const Header& header, FieldReader in) {
  Fields f;
  f.first = in.get(plan.other_offset_bits());
  f.second = in.get(plan.other_offset_bits());
  f.own = in.get(plan.axis_offset_bits());
  const uint32_t shared = in.get(4);
  PackedPhoton photon;
  photon.direction.u = in.get(plan.direction_bits);
  photon.direction.v = in.get(plan.direction_bits);
  f.exponent = in.get(2);
  for (int c = 0; c < plan.channels; ++c)
    photon.power.mantissa[static_cast<size_t>(c)] = in.get(plan.mantissa_bits);
  if (f.exponent == kUnused && is_dark(photon)) return std::nullopt;
  const std::array<SharedBit, 4> bits = shared_bits(plan, header.split, header.axis);
  for (size_t i = 0; i < bits.size(); ++i)
    if (bits[i].number < 32) f.*bits[i].field |= bit(shared, static_cast<int>(i)) << bits[i].number;
  photon.position[own_axis(header.axis)] = f.own;
  photon.position[first_axis(header.axis)] = f.first;
  photon.position[second_axis(header.axis)] = f.second;
  for (size_t c = 0; c < 3; ++c) photon.position[c] += header.corner[c];
  photon.power.exponent = header.exponent + f.exponent;
  return photon;
}

// Puts a line of `members` into `bytes`; `next` is the address of the leaf's next line.
void put_line(const Plan& plan, Header header, std::span<const PackedPhoton> slots,
              std::span<const size_t> members, std::optional<uint64_t> next,
              std::span<uint8_t> bytes) {
  header.more = next ? 1 : 0;
  put_header(plan, header, bytes);
  for (size_t s = 0; s < slots.size(); ++s) {
    const FieldWriter record(bytes, slot_at(plan, s));
    if (std::find(members.begin(), members.end(), s) != members.end())
      put_record(plan, header, slots[s], record);
    else
      put_unused(plan, s + 1 == slots.size() ? next.value_or(0) : 0, record);
  }
}

std::vector<uint8_t> compressed_lines(const Plan& plan, const PhotonMap& map, bool is_caustic) {
  const auto bucket = static_cast<size_t>(plan.bucket),
             size = static_cast<size_t>(plan.line_bytes());
  std::vector<uint8_t> bytes(map.lines * size, 0);
  for (uint32_t leaf = 0; leaf < map.lines; ++leaf) {
    const std::span<const PackedPhoton> slots = std::span(map.slots).subspan(leaf * bucket, bucket);
    std::vector<size_t> left;
    for (size_t s = 0; s < bucket; ++s)
      if (map.valid(leaf * bucket + s)) left.push_back(s);
    size_t line = leaf;
    std::optional<Header> all;
    while (!(all = fitting_header(plan, slots, left))) {
      // The first slots, as many as fit together, so that slots are read in their order. The last
      // one is never among them: its record names the next line.
      std::optional<Header> header;
      size_t n = 0;
      while (const auto with = fitting_header(plan, slots, std::span(left).first(n + 1))) {
        header = with;
        ++n;
      }
      const size_t next = bytes.size() / size;
      const uint64_t address = next | uint64_t{is_caustic} << plan.line_address_bits();
      bytes.resize(bytes.size() + size, 0);
      put_line(plan, *header, slots, std::span(left).first(n), address,
               std::span(bytes).subspan(line * size, size));
      line = next;
      left.erase(left.begin(), left.begin() + static_cast<std::ptrdiff_t>(n));
    }
    put_line(plan, *all, slots, left, std::nullopt, std::span(bytes).subspan(line * size, size));
  }
  return bytes;
}

}  // namespace

OffsetBits offset_bits_of(const Plan& plan, uint32_t split, uint32_t axis) {
  OffsetBits bits{plan.axis_offset_bits(), plan.other_offset_bits(), plan.other_offset_bits(), 2};
  for (const SharedBit& s : shared_bits(plan, split, axis))
    ++(s.field == &Fields::own      ? bits.own
       : s.field == &Fields::first  ? bits.first
       : s.field == &Fields::second ? bits.second
                                    : bits.exponent);
  return bits;
}

std::vector<uint8_t> photon_lines(const Plan& plan, const PhotonMap& map, bool is_caustic) {
  const uint64_t leaves = plan.lines(plan.map(is_caustic));
  const char* name = is_caustic ? "caustic" : "global";
  if (map.lines > leaves)
    throw std::runtime_error(
        fmt::format("{} map: has {} lines, the plan has room for {}; expected {}.photons of at "
                    "least {}",
                    name, map.lines, leaves, name, map.count));
  if (plan.compressed()) {
    std::vector<uint8_t> bytes = compressed_lines(plan, map, is_caustic);
    const uint64_t lines = bytes.size() / static_cast<size_t>(plan.line_bytes());
    if (lines > plan.memory_lines(plan.map(is_caustic)))
      throw PlanError(
          fmt::format("{} map: its {} leaves take {} lines, the plan has room for {}; expected "
                      "photon.further_percent of at least {}",
                      name, map.lines, lines, plan.memory_lines(plan.map(is_caustic)),
                      (100 * (lines - leaves) + leaves - 1) / leaves));
    return bytes;
  }
  std::vector<uint8_t> bytes;
  const auto bucket = static_cast<size_t>(plan.bucket);
  for (uint32_t leaf = 0; leaf < map.lines; ++leaf) {
    const std::vector<uint8_t> line =
        plain_line(plan, std::span(map.slots).subspan(leaf * bucket, bucket));
    bytes.insert(bytes.end(), line.begin(), line.end());
  }
  return bytes;
}

StoredLeaf read_leaf(const Plan& plan, std::span<const uint8_t> lines, uint32_t leaf) {
  const auto size = static_cast<size_t>(plan.line_bytes());
  if (!plan.compressed()) return {read_plain_line(plan, lines.subspan(leaf * size, size)), {leaf}};
  StoredLeaf stored;
  stored.slots.assign(static_cast<size_t>(plan.bucket),
                      {{}, invalid_power(plan.exponent_bits), {}});
  for (uint32_t line = leaf;;) {
    const std::span<const uint8_t> bytes = lines.subspan(line * size, size);
    stored.lines.push_back(line);
    const Header header = get_header(plan, bytes);
    for (size_t s = 0; s < stored.slots.size(); ++s)
      if (const auto photon = get_record(plan, header, FieldReader(bytes, slot_at(plan, s))))
        stored.slots[s] = *photon;
    if (!header.more) return stored;
    line = FieldReader(bytes, slot_at(plan, stored.slots.size() - 1)).get(plan.line_address_bits());
  }
}

FurtherLines further_lines(const Plan& plan, const PhotonMap& map, bool is_caustic) {
  FurtherLines further;
  if (!plan.compressed()) return further;
  const std::vector<uint8_t> bytes = photon_lines(plan, map, is_caustic);
  for (uint32_t leaf = 0; leaf < map.lines; ++leaf) {
    const std::vector<uint32_t> lines = read_leaf(plan, bytes, leaf).lines;
    if (lines.size() > 1) further[leaf].assign(lines.begin() + 1, lines.end());
  }
  return further;
}

std::vector<uint32_t> lines_of(const FurtherLines& further, std::span<const uint32_t> leaves) {
  std::vector<uint32_t> lines;
  for (const uint32_t leaf : leaves) {
    lines.push_back(leaf);
    if (const auto at = further.find(leaf); at != further.end())
      lines.insert(lines.end(), at->second.begin(), at->second.end());
  }
  return lines;
}

}  // namespace photonloom
