// SPDX-License-Identifier: Apache-2.0
#include "golden/unit/photon_gatherer_image.hpp"

#include <fmt/core.h>

#include <stdexcept>

namespace photonloom {

namespace {

constexpr uint32_t kRegisters = 1u << 23;  // above node memory; 2 per map, then cache control

// Puts the low `bits` of `value` at bit `at` of `bytes`, little endian; advances `at`.
void put(uint8_t* bytes, size_t& at, uint64_t value, int bits) {
  for (int i = 0; i < bits; ++i, ++at)
    if (value >> i & 1) bytes[at / 8] = static_cast<uint8_t>(bytes[at / 8] | 1u << (at % 8));
}

std::vector<uint8_t> line_bytes(const Plan& plan, const PhotonMap& map) {
  const size_t stride = static_cast<size_t>(plan.photon_bytes);
  std::vector<uint8_t> bytes(map.slots.size() * stride, 0);
  for (size_t i = 0; i < map.slots.size(); ++i) {
    const PackedPhoton& photon = map.slots[i];
    uint8_t* to = bytes.data() + i * stride;
    size_t at = 0;
    for (const uint32_t x : photon.position) put(to, at, x, plan.position_bits);
    put(to, at, photon.direction.u, plan.direction_bits);
    put(to, at, photon.direction.v, plan.direction_bits);
    for (int c = 0; c < plan.channels; ++c)
      put(to, at, photon.power.mantissa[static_cast<size_t>(c)], plan.mantissa_bits);
    put(to, at, photon.power.exponent, plan.exponent_bits);
  }
  return bytes;
}

}  // namespace

PhotonGathererImage photon_gatherer_image(const Plan& plan, const PhotonMap& global,
                                          const PhotonMap& caustic) {
  PhotonGathererImage image;
  for (const bool is_caustic : {false, true}) {
    const PhotonMap& map = is_caustic ? caustic : global;
    if (map.lines > plan.lines(plan.map(is_caustic)))
      throw std::runtime_error(fmt::format("{} map: has {} lines, the plan has room for {}",
                                           is_caustic ? "caustic" : "global", map.lines,
                                           plan.lines(plan.map(is_caustic))));
    const uint32_t base = is_caustic ? static_cast<uint32_t>(plan.lines(plan.global)) : 0;
    for (uint32_t node = 1; node < map.lines; ++node)
      image.cfg.push_back({base + node, uint64_t{map.nodes[node].axis} << plan.position_bits |
                                            map.nodes[node].split});
    const uint32_t registers = kRegisters + (is_caustic ? 2 : 0);
    image.cfg.push_back({registers, map.lines});
    image.cfg.push_back({registers + 1, plan.map(is_caustic).r2_max});
    image.lines[is_caustic ? 1 : 0] = line_bytes(plan, map);
  }
  return image;
}

}  // namespace photonloom
