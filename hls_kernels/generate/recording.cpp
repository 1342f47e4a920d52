// SPDX-License-Identifier: Apache-2.0
#include "hls_kernels/generate/recording.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <span>

#include "golden/numeric/random.hpp"
#include "golden/packet/layout.hpp"
#include "golden/plan/plan_file.hpp"
#include "golden/unit/photon_gatherer_image.hpp"
#include "golden/unit/photon_lines.hpp"

namespace photonloom {

namespace {

// Numbers one after the other; each use has a stream of its own.
class Draw {
 public:
  explicit Draw(uint64_t stream) : stream_(stream) {}
  uint64_t bits(int n) { return hash_bits(1, next_++, 0, stream_) & low(n); }
  uint64_t below(uint64_t n) { return hash_bits(1, next_++, 0, stream_) % n; }

 private:
  static uint64_t low(int n) { return n >= 64 ? ~0ull : (uint64_t{1} << n) - 1; }
  uint64_t stream_, next_ = 0;
};

// Every field random.
template <class P>
P any(const PacketLayout& layout, Draw& draw) {
  P packet{};
  for (const FieldPlace& f : layout.fields())
    for (int i = 0; i < f.elements; ++i) layout.set(&packet, f, i, draw.bits(f.bits));
  return packet;
}

GatherQuery query(const PacketLayout& layout, Draw& draw) {
  GatherQuery q = any<GatherQuery>(layout, draw);
  q.flush = 0;
  return q;
}

GatherQuery flush(const Plan& plan, Draw& draw) {
  GatherQuery q{};
  q.pixel = static_cast<uint32_t>(draw.bits(plan.pixel_bits()));
  q.flush = 1;
  return q;
}

// The largest mantissa of a photon has its top bit where the exponent is not 0. Exponents are the
// highest 2^exponent_bits.
void set_power(const Plan& plan, Draw& draw, Channels32& mantissa, uint32_t& exponent,
               int exponent_bits) {
  exponent = static_cast<uint32_t>(ones(plan.exponent_bits) - ones(exponent_bits) +
                                   draw.bits(exponent_bits));
  for (int c = 0; c < plan.channels; ++c)
    mantissa[static_cast<size_t>(c)] = static_cast<uint32_t>(draw.bits(plan.mantissa_bits));
  if (exponent) mantissa[0] |= 1u << (plan.mantissa_bits - 1);
}

// Photons in a cube whose edge is twice the largest radius, or the whole range, and of all
// exponents; by `narrower` bits less of each.
std::vector<PackedPhoton> drawn_photons(const Plan& plan, const MapPlan& map, int narrower,
                                        Draw& draw) {
  int edge = 2;
  while (edge < plan.position_bits && uint64_t{1} << (2 * edge - 2) <= map.r2_max) ++edge;
  edge = std::max(0, std::min(edge, plan.position_bits) - narrower);
  std::vector<PackedPhoton> photons(std::min<uint64_t>(map.photons, 512));
  for (PackedPhoton& p : photons) {
    for (uint32_t& x : p.position) x = static_cast<uint32_t>(draw.bits(edge));
    set_power(plan, draw, p.power.mantissa, p.power.exponent,
              std::max(0, plan.exponent_bits - narrower));
    p.direction = {static_cast<uint32_t>(draw.bits(plan.direction_bits)),
                   static_cast<uint32_t>(draw.bits(plan.direction_bits))};
  }
  return photons;
}

bool lines_fit(const Plan& plan, const std::vector<PackedPhoton>& photons, bool is_caustic) {
  Plan roomy = plan;
  roomy.further_percent = 100 * plan.bucket;
  return photon_lines(roomy, build_photon_map(photons, plan), is_caustic).size() <=
         plan.memory_lines(plan.map(is_caustic)) * static_cast<uint64_t>(plan.line_bytes());
}

std::vector<std::vector<PackedPhoton>> photon_lists(const Plan& plan) {
  Draw draw(2);
  std::vector<std::vector<PackedPhoton>> lists(2);
  for (const bool is_caustic : {false, true}) {
    const MapPlan& map = plan.map(is_caustic);
    if (!map.present) continue;
    // Compressed leaves of photons that have little in common take more lines than the plan has
    // room for, which is for a scene's.
    for (int narrower = 0; narrower <= plan.position_bits; ++narrower) {
      lists[is_caustic] = drawn_photons(plan, map, narrower, draw);
      if (!plan.compressed() || lines_fit(plan, lists[is_caustic], is_caustic)) break;
    }
  }
  return lists;
}

std::string words_text(const std::string& name, std::span<const uint32_t> words) {
  std::string text = fmt::format("constexpr uint32_t {}[] = {{", name);
  for (size_t i = 0; i < words.size(); ++i)
    text += fmt::format("{}0x{:x}u,", i % 8 == 0 ? "\n    " : " ", words[i]);
  if (words.empty()) text += "0";  // C++ has no array of nothing
  return text + "};\n";
}

template <class P>
std::string packets_text(const std::string& name, const Plan& plan, const std::vector<P>& packets) {
  const PacketLayout layout = PacketLayout::of<P>(plan);
  std::vector<uint32_t> words(packets.size() * layout.words());
  for (size_t i = 0; i < packets.size(); ++i)
    layout.pack(&packets[i], words.data() + i * layout.words());
  return fmt::format("\n// {}, {} words each\nconstexpr unsigned {}_packets = {};\n", P::kName,
                     layout.words(), name, packets.size()) +
         words_text(name, words);
}

std::string file_text(const std::string& body) {
  return "// SPDX-License-Identifier: Apache-2.0\n"
         "// Generated: packets that went in, and what the golden model gave.\n"
         "#pragma once\n#include <cstdint>\n\nnamespace recorded {\n" +
         body + "\n}  // namespace recorded\n";
}

template <class Unit>
std::string stream_recording(std::type_identity<Unit> unit, const Plan& plan) {
  const auto in = drawn_packets(unit, plan);
  std::vector<typename Unit::FirstOut> out;
  make_golden(unit, plan)->process(in, out);
  return file_text(packets_text("in", plan, in) + packets_text(Unit::kOutputs[0], plan, out));
}

}  // namespace

std::vector<GatherQuery> drawn_packets(std::type_identity<ReorderBuffer>, const Plan& plan) {
  Draw draw(1);
  const PacketLayout layout = PacketLayout::of<GatherQuery>(plan);
  std::vector<GatherQuery> in;
  const int n = std::min(2 * plan.reorder_packets, 2000) + 40;
  for (int i = 0; i < n; ++i) in.push_back(query(layout, draw));
  in.push_back(flush(plan, draw));
  for (int i = 0; i < 20; ++i) in.push_back(query(layout, draw));
  in.push_back(flush(plan, draw));
  return in;
}

std::vector<PhotonMap> drawn_maps(const Plan& plan) {
  std::vector<PhotonMap> maps;
  for (const std::vector<PackedPhoton>& list : photon_lists(plan))
    maps.push_back(build_photon_map(list, plan));
  return maps;
}

std::vector<GatherQuery> drawn_packets(std::type_identity<PhotonGatherer>, const Plan& plan) {
  Draw draw(3);
  const PacketLayout layout = PacketLayout::of<GatherQuery>(plan);
  const std::vector<std::vector<PackedPhoton>> lists = photon_lists(plan);
  std::vector<GatherQuery> in;
  for (int i = 0; i < 240; ++i) {
    GatherQuery q = query(layout, draw);
    q.want_photons = draw.below(4) == 0;
    const std::vector<PackedPhoton>& photons = lists[q.map];
    if (!photons.empty()) {
      q.position = photons[draw.below(photons.size())].position;
      for (uint32_t& x : q.position) x ^= static_cast<uint32_t>(draw.below(2));
    }
    in.push_back(q);
    if (i == 100) in.push_back(flush(plan, draw));
  }
  return in;
}

std::vector<SamplerInput> drawn_packets(std::type_identity<CdfSampler>, const Plan& plan) {
  Draw draw(4);
  const PacketLayout layout = PacketLayout::of<SamplerInput>(plan);
  std::vector<SamplerInput> in;
  for (int table = 0; table < 6; ++table) {
    const SamplerInput random = any<SamplerInput>(layout, draw);
    SamplerInput header{};
    header.pixel = random.pixel;
    header.sample = random.sample;
    header.normal = random.normal;
    in.push_back(header);
    const int photons = table == 1 ? 0 : plan.k - table % 3;
    for (int i = 0; i < photons; ++i) {
      SamplerInput p{};
      p.kind = 1;
      set_power(plan, draw, p.mantissa, p.exponent, plan.exponent_bits);
      for (uint32_t& d : p.direction) d = static_cast<uint32_t>(draw.bits(plan.direction_bits));
      in.push_back(p);
    }
    for (int i = 0; i < (table == 3 ? 0 : 12); ++i) {
      const SamplerInput drawn = any<SamplerInput>(layout, draw);
      SamplerInput request{};
      request.kind = 2;
      request.tag = drawn.tag;
      request.u = drawn.u;
      request.v = drawn.v;
      in.push_back(request);
    }
  }
  return in;
}

std::vector<CacheLookup> drawn_packets(std::type_identity<IrradianceCache>, const Plan& plan) {
  Draw draw(5);
  const PacketLayout layout = PacketLayout::of<CacheLookup>(plan);
  const int w = plan.cache_falloff_bits();
  std::vector<CacheLookup> in;
  for (int tile = 0; tile < 4; ++tile) {
    // Points of a cube of 2^size units, records that reach a fraction of it.
    const int size = std::min(plan.position_bits, 6 + 2 * tile);
    for (int i = 0; i < std::min(2 * plan.cache_records, 300) + 20; ++i) {
      CacheLookup lookup = any<CacheLookup>(layout, draw);
      lookup.clear = i == 0;
      lookup.insert = draw.below(4) != 0;
      for (uint32_t& x : lookup.position) x &= (1u << size) - 1;
      const auto common = static_cast<uint32_t>(draw.below(3));
      const auto top = static_cast<uint32_t>(ones(plan.normal_bits));
      for (uint32_t& x : lookup.normal)
        x = std::min(top, (x & 3) + (common << (plan.normal_bits - 2)));
      lookup.falloff =
          (1u << (w - 1)) + static_cast<uint32_t>(draw.below((uint64_t{1} << (w - 1)) + 1));
      lookup.falloff_exponent = static_cast<uint32_t>(draw.below(2 * static_cast<uint64_t>(size)));
      in.push_back(lookup);
    }
  }
  return in;
}

std::string write_recording(std::type_identity<IrradianceCache> unit, const Plan& plan) {
  return stream_recording(unit, plan);
}

std::string write_recording(std::type_identity<ReorderBuffer> unit, const Plan& plan) {
  return stream_recording(unit, plan);
}

std::string write_recording(std::type_identity<CdfSampler> unit, const Plan& plan) {
  return stream_recording(unit, plan);
}

std::string write_recording(std::type_identity<PhotonGatherer> unit, const Plan& plan) {
  const std::vector<PhotonMap> maps = drawn_maps(plan);
  const std::vector<GatherQuery> in = drawn_packets(unit, plan);
  const auto golden = make_golden(unit, plan);
  golden->load(maps[0], maps[1]);
  std::vector<GatherResult> results;
  std::vector<GatherPhoton> photons;
  golden->process(in, results, photons);

  // Configuration as docs/photon_gatherer.md has it: nodes, then registers.
  const PhotonGathererImage image = photon_gatherer_image(plan, maps[0], maps[1]);
  std::string nodes;
  size_t words = 0;
  uint64_t registers[4] = {};
  for (const CfgWrite& w : image.cfg) {
    if (w.address >= kNodeAddresses) {
      if (w.address < kNodeAddresses + 4) registers[w.address - kNodeAddresses] = w.data;
      continue;
    }
    nodes +=
        fmt::format("{}{{{}, 0x{:x}ull}},", words++ % 4 == 0 ? "\n    " : " ", w.address, w.data);
  }
  if (words == 0) nodes = "{0, 0}";
  std::string text = fmt::format(
      "\n// By map: leaf lines, 0 for no map; squared maximum radius\n"
      "constexpr unsigned map_lines[2] = {{{}, {}}};\n"
      "constexpr unsigned long long map_r2_max[2] = {{0x{:x}ull, 0x{:x}ull}};\n\n"
      "struct NodeWord {{\n  unsigned address;\n  unsigned long long data;\n}};\n"
      "constexpr unsigned nodes_words = {};\nconstexpr NodeWord nodes[] = {{{}}};\n",
      registers[0], registers[2], registers[1], registers[3], words, nodes);
  for (const size_t map : {size_t{0}, size_t{1}}) {
    // A beat begins a word, as a packet does.
    const std::vector<uint8_t>& bytes = image.lines[map];
    const size_t beat_bytes = static_cast<size_t>(plan.beat_bits) / 8,
                 beats = bytes.size() / beat_bytes, words_of_beat = (beat_bytes + 3) / 4;
    std::vector<uint32_t> line_words(beats * words_of_beat);
    for (size_t beat = 0; beat < beats; ++beat)
      for (size_t i = 0; i < beat_bytes; ++i)
        line_words[beat * words_of_beat + i / 4] |=
            static_cast<uint32_t>(bytes[beat * beat_bytes + i]) << (8 * (i % 4));
    const std::string name = map == 0 ? "global" : "caustic";
    text +=
        fmt::format("\n// Line memory, a beat after the other\nconstexpr unsigned {}_beats = {};\n",
                    name, beats) +
        words_text(name, line_words);
  }
  return file_text(text + packets_text("in", plan, in) +
                   packets_text(PhotonGatherer::kOutputs[0], plan, results) +
                   packets_text(PhotonGatherer::kOutputs[1], plan, photons));
}

}  // namespace photonloom
