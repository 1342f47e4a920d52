// SPDX-License-Identifier: Apache-2.0
module ulx3s_85f_top #(
    parameter int unsigned ClocksPerBit = 25
) (
  board_core #(
      .ClocksPerBit(ClocksPerBit),
      .ClockKHz(50000)
