// SPDX-License-Identifier: Apache-2.0
// libFuzzer target: a line of a trace is a packet that packs, unpacks and is written as it was, or
// one error. The first byte says which packet.
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "golden/packet/map_photon.hpp"
#include "golden/packet/trace.hpp"

using namespace photonloom;

namespace {

template <class P>
void try_line(const std::string& line) {
  static const Plan plan = [] {
    Plan p;
    p.cache_present = true;
    p.global.photons = 1000;
    return p;
  }();
  static const PacketLayout layout = PacketLayout::of<P>(plan);
  P packet{};
  try {
    packet_from_json(layout, line, "line 1", &packet);
  } catch (const std::runtime_error& error) {
    if (std::string(error.what()).rfind("line 1: ", 0) != 0) std::abort();
    return;
  }
  std::vector<uint32_t> words(layout.words());
  layout.pack(&packet, words.data());
  P unpacked{}, read{};
  layout.unpack(words.data(), &unpacked);
  packet_from_json(layout, packet_to_json(layout, &packet), "written", &read);
  if (!(unpacked == packet) || !(read == packet)) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return -1;
  const std::string line(reinterpret_cast<const char*>(data) + 1, size - 1);
  int kind = '0';
  for_each_packet([&](auto tag) {
    if (data[0] == kind++) try_line<typename decltype(tag)::type>(line);
  });
  if (data[0] == kind) try_line<MapPhoton>(line);
  return 0;
}
