// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cstring>

#include "verilator_tb/chip/sdram_socket.hpp"
#include "verilator_tb/unit/gatherer_unit.hpp"

namespace photonloom {

namespace {

class RtlGatherEngine final : public GathererUnit {
 public:
  RtlGatherEngine(const Plan& plan, const RunOptions& options, bool reordered, bool back_door)
      : GathererUnit(plan, "gather_engine", options, 60),
        back_door_(back_door && plan.photon_memory == PhotonMemory::kSdram) {
    if (reordered) order_ = make_golden_reorder_buffer(plan);
    rig_.set("reorder_i", reordered);
    if (plan.photon_memory == PhotonMemory::kSdram) {
      power_up();
      rig_.add_clock("clk_sdram_i", options.sdram_period,
                     [this](uint64_t edge) { sdram_->before_edge(edge); });
    }
    rig_.reset();
  }

  void finish() override {
    GathererUnit::finish();
    if (rig_.get("busy_o"))
      throw RigError("gather_engine", ", port busy_o: is 1 although every packet has come out");
    if (!sdram_) return;
    const uint64_t lines = rig_.get("count_memory_lines_o");
    const uint64_t bursts = static_cast<uint64_t>(plan_.line_bytes()) / 16;
    if (lines * bursts != sdram_->chip().reads())
      throw RigError("gather_engine",
                     fmt::format(": counts {} memory lines of {} bursts, expected the {} that the "
                                 "SDRAM has read",
                                 lines, bursts, sdram_->chip().reads()));
  }

 private:
  void load_lines(PhotonGathererImage image) override {
    while (!rig_.get("memory_ready_o")) rig_.cycle();
    uint64_t first_line = 0;
    for (const bool is_caustic : {false, true}) {
      const std::vector<uint8_t>& bytes = image.lines[is_caustic];
      for (size_t at = 0; at < bytes.size(); at += 4) {
        uint32_t word = 0;
        std::memcpy(&word, bytes.data() + at, 4);
        if (back_door_) {
          poke(first_line, at, word);
          continue;
        }
        write_word((first_line * static_cast<uint64_t>(plan_.line_bytes()) + at) / 4, word);
      }
      first_line = plan_.memory_lines(plan_.global);
    }
    if (plan_.photon_memory == PhotonMemory::kBlockRam) write_behind_the_lines();
    // What is taken is in the memory when it would take another.
    while (!rig_.get("write_ready_o")) rig_.cycle();
    configure(image.cfg);
    loaded_ = std::move(image);
  }

  // Block RAM keeps its lines. An SDRAM is not refreshed while it is made ready anew, so it gets
  // them again (docs/gather_cluster.md, "Reset"): here on another chip.
  void configure_again() override {
    if (!sdram_) return configure(loaded_.cfg);
    // Until the reset has reached the SDRAM's clock.
    for (int i = 0; i < 20; ++i) rig_.cycle();
    power_up();
    load_lines(std::move(loaded_));
  }

  void power_up() {
    sdram_ = std::make_unique<SdramSocket>(
        [this](const std::string& port) { return rig_.port(port).data; }, plan_.sdram_khz);
  }

  void write_word(uint64_t address, uint32_t word) {
    rig_.set("write_valid_i", 1);
    rig_.set("write_address_i", address);
    rig_.set("write_data_i", word);
    bool taken = false;
    while (!taken) {
      taken = rig_.get("write_ready_o") != 0;
      rig_.cycle();
    }
    rig_.set("write_valid_i", 0);
  }

  // Words that are to be dropped: the one whose address is that of the memory's first word in the
  // bits that the memory looks at, right behind one that was not, and the first behind the last
  // line.
  void write_behind_the_lines() {
    const uint64_t lines =
        std::max<uint64_t>(1, plan_.memory_lines(plan_.global) + plan_.memory_lines(plan_.caustic));
    const auto line_bytes = static_cast<uint64_t>(plan_.line_bytes());
    const auto beat_bytes = static_cast<uint64_t>(plan_.beat_bits) / 8;
    const uint64_t beats = lines * (line_bytes / beat_bytes);
    write_word((uint64_t{1} << clog2(beats)) * beat_bytes / 4, ~uint32_t{0});
    write_word(lines * line_bytes / 4, ~uint32_t{0});
  }

  std::vector<GatherQuery> take_due(std::span<const GatherQuery> in) override {
    if (!order_) return GathererUnit::take_due(in);
    std::vector<GatherQuery> due;
    order_->process(in, due);
    return due;
  }

  void add_own_counters(Counters& counters) const override {
    if (sdram_) counters["memory row changes"] = sdram_->chip().row_changes();
  }

  // Byte `at` of the lines from `first_line` on, where docs/photon_memory.md puts it.
  void poke(uint64_t first_line, size_t at, uint32_t word) {
    const size_t line_bytes = static_cast<size_t>(plan_.line_bytes());
    const int bits = clog2(line_bytes / 2);
    const uint64_t place = (first_line + at / line_bytes) << bits | at % line_bytes / 2;
    for (unsigned half = 0; half < 2; ++half) {
      const uint64_t low = (place + half) & ones(bits), above = place >> (bits + 2);
      sdram_->chip().poke(static_cast<unsigned>(place >> bits & 3),
                          static_cast<unsigned>(above >> (9 - bits)),
                          static_cast<unsigned>((above & ones(9 - bits)) << bits | low),
                          static_cast<uint16_t>(word >> (16 * half)));
    }
  }

  bool back_door_;
  PhotonGathererImage loaded_;
  std::unique_ptr<SdramSocket> sdram_;  // on the pins of rig_
  std::unique_ptr<ReorderBuffer> order_;
};

}  // namespace

std::unique_ptr<ClockedPhotonGatherer> make_rtl_gather_engine(const Plan& plan,
                                                              const RunOptions& options,
                                                              bool reordered, bool back_door) {
  return std::make_unique<RtlGatherEngine>(plan, options, reordered, back_door);
}

}  // namespace photonloom
