// SPDX-License-Identifier: Apache-2.0
// How a packet lies in a bit vector, and its packing: a SystemVerilog packed struct, the first
// field in the most significant bits, the elements of an array field flat with element 0 in the low
// bits. Fields of no elements or no bits are absent.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "golden/packet/packet.hpp"

namespace photonloom {

// Where one field is, in the vector and in the C++ struct.
struct FieldPlace {
  std::string name;
  std::string unit;
  std::string meaning;
  int elements = 0;          // in hardware; 0 where absent
  int bits = 0;              // of one element
  int offset = 0;            // of element 0 in the vector
  bool array = false;        // an array in C++ and in JSON, whatever its number of elements
  size_t member_offset = 0;  // bytes
  size_t member_bytes = 0;   // of one element, 4 or 8
  int member_elements = 0;   // in C++
  bool present() const { return elements > 0 && bits > 0; }
};

// A vector of `bits` bits is stored in words of 32, least significant first, unused bits 0: the
// representation of wide ports in Verilated models.
class PacketLayout {
 public:
  const std::string& name() const { return name_; }
  int bits() const { return bits_; }
  size_t words() const { return (static_cast<size_t>(bits_) + 31) / 32; }
  const std::vector<FieldPlace>& fields() const { return fields_; }  // absent ones included
  const FieldPlace* find(const std::string& name) const;             // nullptr where unknown

  // `packet` points to the C++ struct, `words` to words() words. A value over its field's width is
  // an error that names packet, field and width.
  void pack(const void* packet, uint32_t* words) const;
  void unpack(const uint32_t* words, void* packet) const;

  uint64_t get(const void* packet, const FieldPlace& field, int element) const;
  void set(void* packet, const FieldPlace& field, int element, uint64_t value) const;
  // The value in a packed word.
  uint64_t extract(const uint32_t* words, const FieldPlace& field, int element) const;

  // Builds the layout of packet type P with this plan.
  template <class P>
  static PacketLayout of(const Plan& plan) {
    static_assert(std::is_standard_layout_v<P> && std::is_trivially_copyable_v<P>);
    PacketLayout layout;
    layout.name_ = P::kName;
    static const P origin{};
    P::fields(plan, [&](auto member, const FieldInfo& info) {
      using Member = std::remove_cvref_t<decltype(origin.*member)>;
      FieldPlace place;
      place.name = info.name;
      place.unit = info.unit;
      place.meaning = info.meaning;
      place.elements = info.bits > 0 ? info.elements : 0;
      place.bits = place.elements > 0 ? info.bits : 0;
      place.member_offset = static_cast<size_t>(reinterpret_cast<const char*>(&(origin.*member)) -
                                                reinterpret_cast<const char*>(&origin));
      if constexpr (std::is_integral_v<Member>) {
        place.member_bytes = sizeof(Member);
        place.member_elements = 1;
      } else {
        place.array = true;
        place.member_bytes = sizeof(typename Member::value_type);
        place.member_elements = static_cast<int>(std::tuple_size_v<Member>);
      }
      layout.fields_.push_back(place);
    });
    layout.finish();
    return layout;
  }

 private:
  void finish();  // offsets, first field most significant
  std::string name_;
  int bits_ = 0;
  std::vector<FieldPlace> fields_;
};

// 0x..., as many digits as the width has.
std::string to_hex(const uint32_t* words, int bits);

}  // namespace photonloom
