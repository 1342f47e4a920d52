// SPDX-License-Identifier: Apache-2.0
// Golden's packets and another backend's side by side: equal or not, packet by packet, nothing
// between.
#pragma once
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>

#include "golden/packet/layout.hpp"
#include "golden/unit/backend.hpp"
#include "verilator_tb/rig/timeline.hpp"

namespace photonloom {

struct RunOptions;

// The first wrong packet; what() is the whole report.
struct Divergence : std::runtime_error {
  Divergence(const std::string& report, uint64_t at_cycle)
      : std::runtime_error(report), cycle(at_cycle) {}
  uint64_t cycle;  // in which it came; the greatest where that is not known
};

// Where a comparison stands, for its report.
struct CompareContext {
  std::string unit;
  std::string backend = "rtl";
  // Extension of the waveforms that the backend writes; empty: it writes none, and has no cycles
  // and no seed.
  std::string waveform = "fst";
  uint64_t seed = 1;
  std::string plan;     // name or hash
  std::string rerun;    // command line that repeats the run, without waveform options
  std::string written;  // file of the waveform that this run writes; empty: none
  uint64_t written_from = 0, written_to = 0;  // its cycles
  void writes(const RunOptions& options);     // sets these
  bool keep_going = false;
  Timeline* timeline = nullptr;  // filled where there is one
};

// The end of a report: the command that repeats the run, with a waveform where the backend writes
// one, of the cycles around `cycle` where that is known, and the one that shows it; the latter
// alone where the run wrote it. Empty where the context has no command.
std::string again_text(const CompareContext& context, std::optional<uint64_t> cycle);

// Compares one output stream. Packets are handed over as arrays of C++ structs.
class StreamComparer {
 public:
  StreamComparer(const PacketLayout& layout, std::string stream, const CompareContext& context);

  // `cycles` may be empty; input(i) is the text of the input that decided packet i of this call.
  // Throws Divergence at the first difference unless the context says to keep going.
  template <class P>
  void compare(std::span<const P> golden, std::span<const P> other,
               std::span<const uint64_t> cycles, const std::function<std::string(size_t)>& input) {
    const size_t n = std::min(golden.size(), other.size());
    for (size_t i = 0; i < n; ++i) {
      if (golden[i] == other[i])
        ++matched_;
      else
        differ(&golden[i], &other[i], i < cycles.size() ? cycles[i] : 0, input(i));
      ++compared_;
    }
    if (golden.size() != other.size()) count_differs(golden.size(), other.size());
  }

  uint64_t compared() const { return compared_; }
  uint64_t differences() const { return differences_; }
  const std::string& first_report() const { return first_report_; }
  // The cycle of the first difference, as Divergence has it; the greatest where there is none.
  uint64_t first_cycle() const { return first_cycle_; }

 private:
  static constexpr uint64_t kNoCycle = std::numeric_limits<uint64_t>::max();
  void differ(const void* golden, const void* other, uint64_t cycle, const std::string& input);
  void count_differs(size_t golden, size_t other);
  void report(const std::string& text, uint64_t cycle);
  PacketLayout layout_;
  std::string stream_;
  CompareContext context_;
  uint64_t compared_ = 0, matched_ = 0, differences_ = 0;
  std::string first_report_;
  uint64_t first_cycle_ = kNoCycle;
};

// What golden counts, but for a few that golden alone has, and what the rig sees at its ports, the
// hardware has counted too; a RigError names the counter. A kernel (docs/hls.md) may have none. To
// be called once nothing is under way.
void check_counters(const std::string& unit, const Counters& golden, const Counters& hardware,
                    uint64_t cycles);

}  // namespace photonloom
