// SPDX-License-Identifier: Apache-2.0
#include "rtl/generate/tables.hpp"

#include <fmt/core.h>

#include <stdexcept>

#include "golden/packet/layout.hpp"
#include "golden/packet/map_photon.hpp"

namespace photonloom {

namespace {

template <class F>
void for_each_table(F&& f) {
  for_each_packet(f);
  f(std::type_identity<MapPhoton>{});
}

}  // namespace

std::vector<std::string> packet_names() {
  std::vector<std::string> names;
  for_each_table([&](auto tag) { names.push_back(decltype(tag)::type::kName); });
  return names;
}

std::string packet_table(const Plan& plan, const std::string& name) {
  std::string text;
  for_each_table([&](auto tag) {
    using P = typename decltype(tag)::type;
    if (name != P::kName) return;
    const PacketLayout layout = PacketLayout::of<P>(plan);
    text = fmt::format(
        "`{}`, {} bits:\n\n| field | bits | at | unit | meaning |\n"
        "|---|---|---|---|---|\n",
        name, layout.bits());
    for (const FieldPlace& f : layout.fields()) {
      if (!f.present()) {
        text += fmt::format("| `{}` | absent | | | {} |\n", f.name, f.meaning);
        continue;
      }
      text += fmt::format(
          "| `{}` | {} | {}:{} | {} | {} |\n", f.name,
          f.elements > 1 ? fmt::format("{} x {}", f.elements, f.bits) : fmt::format("{}", f.bits),
          f.offset + f.elements * f.bits - 1, f.offset, f.unit, f.meaning);
    }
  });
  if (text.empty()) throw std::runtime_error("there is no packet " + name);
  return text;
}

}  // namespace photonloom
