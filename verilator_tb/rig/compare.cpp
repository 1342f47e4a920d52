// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/rig/compare.hpp"

#include <fmt/core.h>

#include <set>

#include "golden/packet/trace.hpp"
#include "verilator_tb/rig/rig.hpp"

namespace photonloom {

void CompareContext::writes(const RunOptions& options) {
  written = options.waveform;
  written_from = options.waveform_from;
  written_to = options.waveform_to;
}

std::string again_text(const CompareContext& context, std::optional<uint64_t> cycle) {
  if (context.rerun.empty()) return "";
  if (context.waveform.empty()) return "  again:\n    " + context.rerun;
  std::string begin = "  again, with a waveform";
  if (!context.written.empty() && cycle) {
    if (context.written_from <= *cycle && *cycle <= context.written_to)
      return "  in the waveform that is written:\n    gtkwave " + context.written;
    // Registers that no reset sets begin with values drawn in the order that a model has them, and
    // one that writes waveforms has more.
    begin = fmt::format(
        "  not in the waveform, which has cycles {} to {}: a model that writes one "
        "begins with other values of what no reset sets; again, with a waveform",
        context.written_from, context.written_to);
  }
  const std::string file = context.unit + "." + context.waveform;
  std::string text =
      fmt::format("{}{}:\n    {} --wave {} --wave-unit {}", begin,
                  cycle ? " of the window around it" : "", context.rerun, file, context.unit);
  if (cycle)
    text += fmt::format(" --wave-cycles {}:{}", *cycle > 1000 ? *cycle - 1000 : 0, *cycle + 50);
  return text + "\n    gtkwave " + file;
}

StreamComparer::StreamComparer(const PacketLayout& layout, std::string stream,
                               const CompareContext& context)
    : layout_(layout), stream_(std::move(stream)), context_(context) {}

void StreamComparer::report(const std::string& text, uint64_t cycle) {
  ++differences_;
  if (first_report_.empty()) {
    first_report_ = text;
    first_cycle_ = cycle;
  }
  if (!context_.keep_going) throw Divergence(text, cycle);
}

void StreamComparer::differ(const void* golden, const void* other, uint64_t cycle,
                            const std::string& input) {
  if (!first_report_.empty()) {
    ++differences_;
    return;
  }
  std::vector<uint32_t> g(layout_.words()), o(layout_.words());
  layout_.pack(golden, g.data());
  layout_.pack(other, o.data());
  const bool simulated = !context_.waveform.empty();
  std::string text = fmt::format(
      "{0}, stream {1}: packet {2} differs from golden ({3} matched before)\n"
      "  {4}plan {5}\n  input  {6}\n  golden {7}\n  {8:6} {9}\n"
      "    {10:<24}{11:>24}{12:>24}  unit\n",
      context_.unit, stream_, compared_, matched_,
      simulated ? fmt::format("cycle {}, seed {}, ", cycle, context_.seed) : "", context_.plan,
      input, to_hex(g.data(), layout_.bits()), context_.backend, to_hex(o.data(), layout_.bits()),
      "field", "golden", context_.backend);
  for (const FieldPlace& f : layout_.fields())
    for (int i = 0; i < f.elements; ++i) {
      const uint64_t a = layout_.get(golden, f, i), b = layout_.get(other, f, i);
      text += fmt::format("  {} {:<24}{:>24}{:>24}{}{}\n", a == b ? ' ' : '*',
                          f.array ? fmt::format("{}[{}]", f.name, i) : f.name, a, b,
                          f.unit.empty() ? "" : "  ", f.unit);
    }
  report(text + again_text(context_, cycle), cycle);
}

void StreamComparer::count_differs(size_t golden, size_t other) {
  report(fmt::format("{}, stream {}: {} packets where golden gives {}, after {} compared; seed {}, "
                     "plan {}{}{}",
                     context_.unit, stream_, other, golden, compared_, context_.seed, context_.plan,
                     context_.rerun.empty() ? "" : "\n  again: ", context_.rerun),
         kNoCycle);
}

void check_counters(const std::string& unit, const Counters& golden, const Counters& hardware,
                    uint64_t cycles) {
  const bool has_ports = hardware.contains("stalls in");  // a kernel has none, and so no counters
  const bool gathers = golden.contains("photons out");
  // What golden alone counts: of results that gatherers gave, and how often a bin was chosen.
  const std::set<std::string> golden_only =
      gathers ? std::set<std::string>{"photons out", "flushes", "clamped", "full"}
              : std::set<std::string>{"choices"};
  const auto expect = [&](const std::string& name, uint64_t due, const char* whose) {
    const auto counted = hardware.find(name);
    if (counted == hardware.end()) {
      if (!has_ports || golden_only.contains(name)) return;
      throw RigError(unit, fmt::format(": has no counter {}, which {} has", name, whose));
    }
    if (counted->second != (due & 0xffffffff))
      throw RigError(unit, fmt::format(": counts {} {}, expected {} as {}", counted->second, name,
                                       due & 0xffffffff, whose));
  };
  for (const auto& [name, count] : golden) expect(name, count, "golden");
  const auto seen = [&](const std::string& name) {
    const auto at = hardware.find(name);
    return at == hardware.end() ? 0 : at->second;
  };
  // Cycles of some kind are some of all cycles.
  for (const auto& [name, count] : hardware)
    if ((name.starts_with("cycles ") || name == "busy" || name == "memory busy" ||
         name == "choice waits" || name.starts_with("stalled ")) &&
        count > cycles)
      throw RigError(unit, fmt::format(": counts {} {}, expected no more than the {} cycles", count,
                                       name, cycles));
  if (seen("cycles waiting") > seen("cycles busy"))
    throw RigError(unit, fmt::format(": waits {} of {} busy cycles", seen("cycles waiting"),
                                     seen("cycles busy")));
  if (!gathers || !has_ports) return;
  // Of a line port the rig counts requests.
  expect("stalled in", seen("stalls in"), "the rig");
  expect("stalled results", seen("stalls results"), "the rig");
  expect("stalled photons", seen("stalls photons"), "the rig");
  if (hardware.contains("line requests")) expect("cache misses", seen("line requests"), "the rig");
}

}  // namespace photonloom
