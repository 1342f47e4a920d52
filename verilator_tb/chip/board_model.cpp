// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/chip/board_model.hpp"

#include <fmt/core.h>

#include <cstring>

namespace photonloom {

BoardModel::BoardModel(const Plan& plan, const BoardRun& run)
    : model_(build_model(plan, {.unit = run.module,
                                .rtl_dir = run.rtl_dir,
                                .work_dir = run.work_dir,
                                .waveform = !run.waveform.empty(),
                                .parameters = {fmt::format("ClocksPerBit={}", run.clocks_per_bit)},
                                .open_memories = run.open_memories}),
             run.initial_seed),
      wire_(run.wire_clocks > 0 ? run.wire_clocks : run.clocks_per_bit),
      sdram_period_(run.sdram_period) {
  for (const ModelPort& p : model_.ports())
    if (!p.output) std::memset(p.data, 0, p.bytes);
  clock_ = model_.port("clk_i").data;
  reset_ = model_.port("rst_i").data;
  rx_ = model_.port("uart_rx_i").data;
  tx_ = model_.port("uart_tx_o").data;
  if (model_.has_port("led_o")) leds_ = model_.port("led_o").data;
  if (plan.photon_memory == PhotonMemory::kSdram && model_.has_port("sdram_dq_i")) {
    sdram_ = std::make_unique<SdramSocket>(
        [&](const std::string& port) { return model_.port(port).data; }, plan.sdram_khz);
    sdram_clock_ = model_.port("clk_sdram_i").data;
  }
  if (!run.waveform.empty()) {
    model_.open_waveform(run.waveform);
    tracing_ = true;
  }
  *rx_ = 1;
  *reset_ = 1;
  for (int i = 0; i < 8; ++i) cycle();
  *reset_ = 0;
}

void BoardModel::cycle() {
  *rx_ = wire_.drive() ? 1 : 0;
  *clock_ = 0;
  model_.eval();
  wire_.sample((*tx_ & 1) != 0);
  if (tracing_) model_.dump(2 * cycles_);
  for (; sdram_ &&
         static_cast<double>(sdram_edges_) * sdram_period_ < static_cast<double>(cycles_ + 1);
       ++sdram_edges_) {
    sdram_->before_edge(sdram_edges_);
    *sdram_clock_ = 1;
    model_.eval();
    *sdram_clock_ = 0;
    model_.eval();
  }
  *clock_ = 1;
  model_.eval();
  if (tracing_) model_.dump(2 * cycles_ + 1);
  ++cycles_;
}

void BoardModel::set(const std::string& port, uint64_t value) {
  const ModelPort& p = model_.port(port);
  std::memset(p.data, 0, p.bytes);
  std::memcpy(p.data, &value, std::min<size_t>(p.bytes, 8));
}

uint64_t BoardModel::get(const std::string& port) const {
  const ModelPort& p = model_.port(port);
  uint64_t value = 0;
  std::memcpy(&value, p.data, std::min<size_t>(p.bytes, 8));
  return value;
}

}  // namespace photonloom
