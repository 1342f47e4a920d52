// SPDX-License-Identifier: Apache-2.0
#include "golden/unit/self_test.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <span>

#include "golden/numeric/random.hpp"
#include "golden/packet/layout.hpp"
#include "golden/packet/signature.hpp"
#include "golden/unit/backend.hpp"
#include "golden/unit/photon_gatherer_image.hpp"
#include "golden/unit/photon_lines.hpp"

namespace photonloom {
namespace {

constexpr uint64_t kPhotons = 48;  // of a map at most
constexpr size_t kQueries = 24;    // at most; the flush is one more
constexpr uint64_t kSeed = 0x5e1f7e57;

// Of docs/host-link.md.
constexpr uint32_t kConfigurationSpace = 1u << 28, kLineSpace = 2u << 28, kQuerySpace = 3u << 28;
constexpr uint32_t kControlRegister = 16, kQueriesRegister = 17;
constexpr uint32_t kReorderedAndCold = 3;  // of the replayer's mode

uint32_t random_bits(uint64_t item, uint64_t dimension, int width) {
  return width == 0 ? 0u
                    : static_cast<uint32_t>(hash_bits(kSeed, item, 0, dimension) >> (64 - width));
}

// In a cube of 2^spread position units in the middle.
UVec3 position(const Plan& plan, uint64_t item, int spread) {
  UVec3 p{};
  const uint32_t corner = ((1u << plan.position_bits) - (1u << spread)) / 2;
  for (size_t c = 0; c < 3; ++c) p[c] = corner + random_bits(item, c, spread);
  return p;
}

std::vector<PackedPhoton> photons(const Plan& plan, const MapPlan& map, uint64_t first,
                                  int spread) {
  std::vector<PackedPhoton> list(map.present ? std::min(map.photons, kPhotons) : 0);
  for (size_t i = 0; i < list.size(); ++i) {
    const uint64_t item = first + i;
    list[i].position = position(plan, item, spread);
    list[i].direction = {random_bits(item, 3, plan.direction_bits),
                         random_bits(item, 4, plan.direction_bits)};
    for (int c = 0; c < plan.channels; ++c)
      list[i].power.mantissa[static_cast<size_t>(c)] =
          random_bits(item, 5 + static_cast<uint64_t>(c), plan.mantissa_bits);
    list[i].power.mantissa[0] |= 1u << (plan.mantissa_bits - 1);  // as encode_power normalises
    list[i].power.exponent = random_bits(
        item, 8, plan.compressed() ? std::min(1, plan.exponent_bits) : plan.exponent_bits);
  }
  return list;
}

std::vector<GatherQuery> queries(const Plan& plan) {
  const size_t room = static_cast<size_t>(plan.replay_queries) - 1;
  std::vector<GatherQuery> list(std::min(kQueries, room));
  for (size_t i = 0; i < list.size(); ++i) {
    const uint64_t item = 1000 + i;
    GatherQuery q{};
    q.pixel = random_bits(item, 3, plan.pixel_bits());
    q.sample = random_bits(item, 4, plan.sample_bits());
    q.tag = random_bits(item, 5, plan.tag_bits());
    const bool both = plan.global.present && plan.caustic.present;
    q.map = both ? static_cast<uint32_t>(i % 2) : plan.caustic.present ? 1 : 0;
    q.position = position(plan, item, plan.position_bits);
    for (size_t c = 0; c < 2; ++c) q.normal[c] = random_bits(item, 6 + c, plan.normal_bits);
    list[i] = q;
  }
  GatherQuery flush{};
  flush.flush = 1;
  list.push_back(flush);
  return list;
}

void append(std::vector<uint32_t>& script, uint32_t address, std::span<const uint32_t> words) {
  if (words.empty()) return;
  script.push_back(address);
  script.push_back(static_cast<uint32_t>(words.size()));
  script.insert(script.end(), words.begin(), words.end());
}

void append_lines(std::vector<uint32_t>& script, const Plan& plan,
                  const PhotonGathererImage& image) {
  uint64_t base = 0;
  for (const std::vector<uint8_t>& bytes : image.lines) {
    std::vector<uint32_t> words((bytes.size() + 3) / 4);
    for (size_t i = 0; i < bytes.size(); ++i) words[i / 4] |= uint32_t{bytes[i]} << (8 * (i % 4));
    append(script, kLineSpace + static_cast<uint32_t>(base), words);
    base = plan.memory_lines(plan.global) * static_cast<uint64_t>(plan.line_bytes()) / 4;
  }
}

// Runs of neighbouring addresses in one WRITE.
void append_configuration(std::vector<uint32_t>& script, const std::vector<CfgWrite>& cfg) {
  for (size_t i = 0; i < cfg.size();) {
    std::vector<uint32_t> words;
    const uint32_t first = cfg[i].address;
    while (i < cfg.size() && cfg[i].address == first + words.size() / 2) {
      words.push_back(static_cast<uint32_t>(cfg[i].data));
      words.push_back(static_cast<uint32_t>(cfg[i].data >> 32));
      ++i;
    }
    append(script, kConfigurationSpace + 2 * first, words);
  }
}

// Without a radius, so that every query finds photons.
Plan without_radius(Plan plan) {
  for (MapPlan* m : {&plan.global, &plan.caustic}) m->r2_max = plan.r2_limit();
  return plan;
}

}  // namespace

SelfTest make_self_test(const Plan& own) {
  const Plan plan = without_radius(own);
  // Room for any further lines, to see whether there are some.
  Plan roomy = plan;
  roomy.further_percent = 100 * plan.bucket;
  PhotonMap global, caustic;
  for (int spread = plan.position_bits; spread >= 0; --spread) {
    global = build_photon_map(photons(plan, plan.global, 0, spread), plan);
    caustic = build_photon_map(photons(plan, plan.caustic, 500, spread), plan);
    const auto one_line_each = [&](const PhotonMap& map, bool is_caustic) {
      return photon_lines(roomy, map, is_caustic).size() ==
             map.lines * static_cast<size_t>(plan.line_bytes());
    };
    if (one_line_each(global, false) && one_line_each(caustic, true)) break;
  }
  const PhotonGathererImage image = photon_gatherer_image(plan, global, caustic);

  SelfTest test;
  append_lines(test.words, plan, image);
  append_configuration(test.words, image.cfg);
  const std::vector<GatherQuery> asked = queries(plan);
  const PacketLayout layout = PacketLayout::of<GatherQuery>(plan);
  const size_t stride = std::bit_ceil(layout.words());
  std::vector<uint32_t> packed(asked.size() * stride, 0);
  for (size_t i = 0; i < asked.size(); ++i) layout.pack(&asked[i], &packed[i * stride]);
  append(test.words, kQuerySpace, packed);
  const std::array<uint32_t, 3> replay{static_cast<uint32_t>(asked.size()), 1, kReorderedAndCold};
  append(test.words, kQueriesRegister, replay);
  for (const uint32_t control : {1u, 0u}) append(test.words, kControlRegister, {&control, 1});

  std::vector<GatherQuery> ordered;
  make_golden_reorder_buffer(plan)->process(asked, ordered);
  std::vector<GatherResult> results;
  std::vector<GatherPhoton> none;
  const auto gatherer = make_golden_photon_gatherer(plan);
  gatherer->load(global, caustic);
  gatherer->process(ordered, results, none);
  ResultSignature signature(plan);
  for (const GatherResult& r : results) signature.add(r);
  test.results = static_cast<uint32_t>(results.size());
  test.signature = signature.value();
  return test;
}

}  // namespace photonloom
