// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/sdram_socket.hpp"

#include <cstring>

namespace photonloom {

namespace {
constexpr int64_t kPeriod = 10'000, kPinOut = 3'500, kPinIn = 1'000;  // picoseconds
}

SdramSocket::SdramSocket(const Model& model)
    : data_in_(model.port("sdram_dq_i").data),
      data_out_(model.port("sdram_dq_o").data),
      driven_(model.port("sdram_dq_oe_o").data),
      address_(model.port("sdram_a_o").data),
      bank_(model.port("sdram_ba_o").data),
      dqm_(model.port("sdram_dqm_o").data),
      cke_(model.port("sdram_cke_o").data),
      cs_(model.port("sdram_cs_no").data),
      ras_(model.port("sdram_ras_no").data),
      cas_(model.port("sdram_cas_no").data),
      we_(model.port("sdram_we_no").data) {}

void SdramSocket::before(uint64_t edge) {
  const uint16_t data = chip_.data(static_cast<int64_t>(edge) * kPeriod - kPinIn);
  std::memcpy(data_in_, &data, 2);
}

void SdramSocket::after(uint64_t edge) {
  SdramPins pins;
  pins.cke = *cke_ != 0;
  pins.cs_n = *cs_ != 0;
  pins.ras_n = *ras_ != 0;
  pins.cas_n = *cas_ != 0;
  pins.we_n = *we_ != 0;
  pins.bank = *bank_;
  uint16_t word = 0;
  std::memcpy(&word, address_, 2);
  pins.address = word;
  pins.dqm = *dqm_;
  pins.driven = *driven_ != 0;
  std::memcpy(&pins.data, data_out_, 2);
  chip_.edge(static_cast<int64_t>(edge) * kPeriod + kPeriod / 2 + kPinOut, pins);
}

}  // namespace photonloom
