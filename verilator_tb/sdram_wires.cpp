// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/sdram_wires.hpp"

#include <cstring>

namespace photonloom {

namespace {

constexpr int64_t kPeriod = 10'000, kPinOut = 3'500, kPinIn = 1'000;  // picoseconds

}  // namespace

SdramWires::SdramWires(const PortOf& port_of)
    : data_in_(port_of("sdram_dq_i").data),
      cke_(port_of("sdram_cke_o").data),
      cs_(port_of("sdram_cs_no").data),
      ras_(port_of("sdram_ras_no").data),
      cas_(port_of("sdram_cas_no").data),
      we_(port_of("sdram_we_no").data),
      bank_(port_of("sdram_ba_o").data),
      address_(port_of("sdram_a_o").data),
      dqm_(port_of("sdram_dqm_o").data),
      data_out_(port_of("sdram_dq_o").data),
      driven_(port_of("sdram_dq_oe_o").data) {}

void SdramWires::before(uint64_t edge) {
  const uint16_t data = chip_.data(static_cast<int64_t>(edge) * kPeriod - kPinIn);
  std::memcpy(data_in_, &data, 2);
}

void SdramWires::after(uint64_t edge) {
  SdramPins pins;
  pins.cke = *cke_ != 0;
  pins.cs_n = *cs_ != 0;
  pins.ras_n = *ras_ != 0;
  pins.cas_n = *cas_ != 0;
  pins.we_n = *we_ != 0;
  pins.bank = *bank_;
  uint16_t address = 0;
  std::memcpy(&address, address_, 2);
  pins.address = address;
  pins.dqm = *dqm_;
  pins.driven = *driven_ != 0;
  std::memcpy(&pins.data, data_out_, 2);
  chip_.edge(static_cast<int64_t>(edge) * kPeriod + kPeriod / 2 + kPinOut, pins);
}

}  // namespace photonloom
