// SPDX-License-Identifier: Apache-2.0
#include <cstring>

#include "golden/unit/photon_gatherer_image.hpp"
#include "verilator_tb/backends.hpp"
#include "verilator_tb/clocked_unit.hpp"
#include "verilator_tb/sdram_socket.hpp"

namespace photonloom {

namespace {

class RtlGatherEngine final : public ClockedPhotonGatherer {
 public:
  RtlGatherEngine(const Plan& plan, const RunOptions& options, bool reordered, bool back_door)
      : plan_(plan),
        back_door_(back_door && plan.photon_memory == PhotonMemory::kSdram),
        rig_(plan, "gather_engine", options),
        in_(rig_, plan, "in"),
        results_(rig_, plan, "result"),
        photons_(rig_, plan, "photon") {
    if (reordered) order_ = make_golden_reorder_buffer(plan);
    rig_.set("reorder_i", reordered);
    if (plan.photon_memory == PhotonMemory::kSdram) {
      sdram_ = std::make_unique<SdramSocket>(
          [this](const std::string& port) { return rig_.port(port).data; });
      rig_.add_clock("clk_sdram_i", options.sdram_period,
                     [this](uint64_t edge) { sdram_->before_edge(edge); });
    }
    rig_.reset();
  }

  void load(const PhotonMap& global, const PhotonMap& caustic) override {
    while (!rig_.get("memory_ready_o")) rig_.cycle();
    const PhotonGathererImage image = photon_gatherer_image(plan_, global, caustic);
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
        rig_.set("write_valid_i", 1);
        rig_.set("write_address_i",
                 (first_line * static_cast<uint64_t>(plan_.line_bytes()) + at) / 4);
        rig_.set("write_data_i", word);
        bool taken = false;
        while (!taken) {
          taken = rig_.get("write_ready_o") != 0;
          rig_.cycle();
        }
        rig_.set("write_valid_i", 0);
      }
      first_line = plan_.lines(plan_.global);
    }
    for (const CfgWrite& w : image.cfg) {
      rig_.set("cfg_valid_i", 1);
      rig_.set("cfg_addr_i", w.address);
      rig_.set("cfg_data_i", w.data);
      rig_.cycle();
    }
    rig_.set("cfg_valid_i", 0);
    // The last word is on its way into the memory for a while.
    for (int i = 0; i < 100; ++i) rig_.cycle();
    load_cycles_ = rig_.cycles();
  }

  void process(std::span<const GatherQuery> in, std::vector<GatherResult>& results,
               std::vector<GatherPhoton>& photons) override {
    result_cycles_.clear();
    photon_cycles_.clear();
    std::vector<GatherQuery> due;
    if (order_)
      order_->process(in, due);
    else
      due.assign(in.begin(), in.end());
    for (const GatherQuery& q : in) in_.push(q);
    size_t got = 0;
    int64_t photons_owed = 0;  // negative while photons are ahead of their result
    rig_.run_until([&] {
      while (results_.waiting()) {
        const GatherResult r = results_.pop(result_cycles_);
        if (got < due.size() && due[got].want_photons && !due[got].flush) photons_owed += r.count;
        ++got;
        results.push_back(r);
      }
      while (photons_.waiting()) {
        photons.push_back(photons_.pop(photon_cycles_));
        --photons_owed;
      }
      return in_.stream().empty() && got >= due.size() && photons_owed <= 0;
    });
    in_cycles_ = in_.stream().take_cycles();
  }

  Counters counters() const override {
    Counters c{{"packets in", in_.stream().accepted()},
               {"cycles", rig_.cycles() - load_cycles_},
               {"stalls in", in_.stream().stalled()},
               {"stalls out", results_.stream().stalled() + photons_.stream().stalled()}};
    add_port_counters(rig_, c);
    return c;
  }
  uint64_t cycles() const override { return rig_.cycles(); }
  std::span<const uint64_t> in_cycles() const override { return in_cycles_; }
  std::span<const uint64_t> out_cycles(int stream) const override {
    return stream == 0 ? result_cycles_ : photon_cycles_;
  }
  void finish() override {
    expect_silence(rig_, "gather_engine", results_.stream(), 60);
    expect_silence(rig_, "gather_engine", photons_.stream(), 60);
    if (rig_.get("busy_o"))
      throw RigError("gather_engine", ", port busy_o: is 1 although every packet has come out");
  }

 private:
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

  Plan plan_;
  bool back_door_;
  uint64_t load_cycles_ = 0;
  std::unique_ptr<SdramSocket> sdram_;
  Rig rig_;
  PacketSource<GatherQuery> in_;
  PacketTaker<GatherResult> results_;
  PacketTaker<GatherPhoton> photons_;
  std::unique_ptr<ReorderBuffer> order_;
  std::vector<uint64_t> in_cycles_, result_cycles_, photon_cycles_;
};

}  // namespace

std::unique_ptr<ClockedPhotonGatherer> make_rtl_gather_engine(const Plan& plan,
                                                              const RunOptions& options,
                                                              bool reordered, bool back_door) {
  return std::make_unique<RtlGatherEngine>(plan, options, reordered, back_door);
}

}  // namespace photonloom
