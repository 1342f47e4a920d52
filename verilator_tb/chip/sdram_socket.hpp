// SPDX-License-Identifier: Apache-2.0
// The SDRAM chip on a model's pins, at the plan's clock on its board.
#pragma once
#include <cstdint>
#include <functional>
#include <string>

#include "verilator_tb/chip/sdram_chip.hpp"

namespace photonloom {

class SdramSocket {
 public:
  // `pin`: the storage of a port of the model, which has all of sdram_*. `khz`: the clock, by which
  // the chip tells whether its times are kept.
  SdramSocket(const std::function<uint8_t*(const std::string& port)>& pin, int khz);

  // Just before edge number `edge` of the controller's clock: the pins, both ways.
  void before_edge(uint64_t edge);
  SdramChip& chip() { return chip_; }
  const SdramChip& chip() const { return chip_; }

 private:
  SdramChip chip_;
  int64_t period_;  // picoseconds
  uint8_t* data_in_;
  const uint8_t *data_out_, *driven_, *address_, *bank_, *dqm_;
  const uint8_t *cke_, *cs_, *ras_, *cas_, *we_;
};

}  // namespace photonloom
