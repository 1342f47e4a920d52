// SPDX-License-Identifier: Apache-2.0
// A Verilated board_core, seen from where a host's cable ends: two wires and eight LEDs; with the
// SDRAM chip on its pins where the plan keeps photons there. Nothing here looks inside the board.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "golden/plan/plan.hpp"
#include "verilator_tb/chip/sdram_socket.hpp"
#include "verilator_tb/chip/uart_wire.hpp"
#include "verilator_tb/model/model.hpp"

namespace photonloom {

struct BoardRun {
  int clocks_per_bit = 4;     // the board's ClocksPerBit
  double wire_clocks = 0;     // a bit of the cable's far end, in clocks; 0: as the board's
  double sdram_period = 0.5;  // clock of the SDRAM, in clocks of the core
  uint64_t initial_seed = 1;  // of the registers' initial values
  std::string module = "board_core";
  std::string rtl_dir = {};              // empty: default_rtl_dir()
  std::string work_dir = "build/cosim";  // where models are kept
  std::string waveform = {};             // FST file; empty: none
  bool open_memories = false;            // block RAM can be written from outside
};

class BoardModel {
 public:
  // Builds or finds the model and resets the board.
  BoardModel(const Plan& plan, const BoardRun& run);
  ~BoardModel() { model_.close_waveform(); }

  UartWire& wire() { return wire_; }
  void cycle();
  uint64_t cycles() const { return cycles_; }
  uint8_t leds() const { return leds_ ? *leds_ : 0; }
  // Another port of the module, up to 64 bits.
  void set(const std::string& port, uint64_t value);
  uint64_t get(const std::string& port) const;
  // Where the run has open memories.
  const std::vector<ModelMemory>& memories() const { return model_.memories(); }

 private:
  Model model_;
  UartWire wire_;
  std::unique_ptr<SdramSocket> sdram_;
  uint8_t* sdram_clock_ = nullptr;
  double sdram_period_;
  uint64_t sdram_edges_ = 0;
  uint8_t *clock_, *reset_, *rx_;
  const uint8_t *tx_, *leds_ = nullptr;
  bool tracing_ = false;
  uint64_t cycles_ = 0;
};

}  // namespace photonloom
