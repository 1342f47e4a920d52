// SPDX-License-Identifier: Apache-2.0
// An SDRAM chip on the pins sdram_*_o, sdram_dq_i of a model, as on its board at 100 MHz: its clock
// is the controller's, inverted; pins come out of the FPGA 3.5 ns after their edge, the clock too,
// and go in 1 ns before theirs.
#pragma once
#include <cstdint>
#include <functional>
#include <string>

#include "verilator_tb/model.hpp"
#include "verilator_tb/sdram_chip.hpp"

namespace photonloom {

class SdramWires {
 public:
  using PortOf = std::function<const ModelPort&(const std::string& name)>;
  explicit SdramWires(const PortOf& port_of);

  // Around rising edge number `edge` of the controller's clock: sets what the chip drives, then
  // takes what the controller gave. Throws SdramError when a rule of the chip is broken.
  void before(uint64_t edge);
  void after(uint64_t edge);

 private:
  SdramChip chip_;
  uint8_t* data_in_;
  const uint8_t *cke_, *cs_, *ras_, *cas_, *we_, *bank_, *address_, *dqm_, *data_out_, *driven_;
};

}  // namespace photonloom
