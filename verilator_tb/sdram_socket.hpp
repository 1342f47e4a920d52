// SPDX-License-Identifier: Apache-2.0
// The chip on a model's SDRAM pins, as on a board: its clock is half a period behind the
// controller's, and both directions take time.
#pragma once
#include "verilator_tb/model.hpp"
#include "verilator_tb/sdram_chip.hpp"

namespace photonloom {

class SdramSocket {
 public:
  // The model has the ports sdram_*; the controller's clock has a period of 10 ns.
  explicit SdramSocket(const Model& model);

  // Around the controller's rising edge number `edge`: its data inputs before, its outputs after.
  void before(uint64_t edge);
  void after(uint64_t edge);
  const SdramChip& chip() const { return chip_; }

 private:
  SdramChip chip_;
  uint8_t* data_in_;
  const uint8_t *data_out_, *driven_, *address_, *bank_, *dqm_;
  const uint8_t *cke_, *cs_, *ras_, *cas_, *we_;
};

}  // namespace photonloom
