// SPDX-License-Identifier: Apache-2.0
#include "verilator_tb/chip/sdram_socket.hpp"

#include <cstring>

namespace photonloom {

namespace {
// Picoseconds. The chip's clock is a quarter ahead of the controller's; pins come out of the FPGA
// some time after their edge, the clock too, and go in some time before theirs.
constexpr int64_t kPinOut = 3'500, kPinIn = 1'000;
}  // namespace

SdramSocket::SdramSocket(const std::function<uint8_t*(const std::string& port)>& pin, int khz)
    : period_(1'000'000'000 / khz),
      data_in_(pin("sdram_dq_i")),
      data_out_(pin("sdram_dq_o")),
      driven_(pin("sdram_dq_oe_o")),
      address_(pin("sdram_a_o")),
      bank_(pin("sdram_ba_o")),
      dqm_(pin("sdram_dqm_o")),
      cke_(pin("sdram_cke_o")),
      cs_(pin("sdram_cs_no")),
      ras_(pin("sdram_ras_no")),
      cas_(pin("sdram_cas_no")),
      we_(pin("sdram_we_no")) {}

void SdramSocket::before_edge(uint64_t edge) {
  const int64_t time = static_cast<int64_t>(edge) * period_;
  const uint16_t data = chip_.data(time - kPinIn);
  std::memcpy(data_in_, &data, 2);
  // The chip's next edge comes after this one of the controller, but sees the pins before they
  // change.
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
  chip_.edge(time - period_ / 4 + kPinOut, pins);
}

}  // namespace photonloom
