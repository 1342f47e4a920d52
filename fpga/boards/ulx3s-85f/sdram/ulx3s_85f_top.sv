// SPDX-License-Identifier: Apache-2.0
// A ULX3S around board_core, photons in SDRAM. The core's clock is made of the board's 25 MHz; button FIRE1 resets it. The
// link is the USB serial port US1. Frequencies and the PLL's dividers: board_pkg, which is generated; the rest of the PLL
// is as `ecppll` writes it (docs/data.md). The PLL's own output is its feedback: VCO = core clock * PllOutput.
//
// clk_sdram is the clock of the SDRAM's controller. The chip's own, clk_chip, is three quarters of a period later, a quarter
// ahead of the next edge: the commands are stable when the chip looks, its data when the controller takes them.
module ulx3s_85f_top #(
    parameter int unsigned ClocksPerBit = board_pkg::ClocksPerBit
) (
    input  logic        clk_25mhz,
    input  logic        btn_i,
    input  logic        ftdi_txd_i,     // from the host
    output logic        ftdi_rxd_o,     // to the host
    output logic [ 7:0] led_o,
    output logic        sdram_clk_o,
    output logic        sdram_cke_o,
    output logic        sdram_csn_o,
    output logic        sdram_rasn_o,
    output logic        sdram_casn_o,
    output logic        sdram_wen_o,
    output logic [ 1:0] sdram_ba_o,
    output logic [12:0] sdram_a_o,
    output logic [ 1:0] sdram_dqm_o,
    inout  wire  [15:0] sdram_dq_io
);
  localparam int Phase = board_pkg::PllOutput / 2;  // the first phase; counts VCO cycles
  localparam int SdramDivider = board_pkg::VcoKHz / board_pkg::SdramKHz;
  localparam int ChipEighths = 6 * SdramDivider;  // three quarters of a period in eighths of a VCO cycle

  logic clk, clk_sdram, clk_chip, locked;
  (* FREQUENCY_PIN_CLKI = "25", ICP_CURRENT = "12", LPF_RESISTOR = "8", MFG_ENABLE_FILTEROPAMP = "1", MFG_GMCREF_SEL = "2" *)
  EHXPLLL #(
      .PLLRST_ENA("DISABLED"),
      .INTFB_WAKE("DISABLED"),
      .STDBY_ENABLE("DISABLED"),
      .DPHASE_SOURCE("DISABLED"),
      .OUTDIVIDER_MUXA("DIVA"),
      .OUTDIVIDER_MUXB("DIVB"),
      .OUTDIVIDER_MUXC("DIVC"),
      .OUTDIVIDER_MUXD("DIVD"),
      .CLKI_DIV(board_pkg::PllReference),
      .CLKFB_DIV(board_pkg::PllFeedback),
      .FEEDBK_PATH("CLKOP"),
      .CLKOP_ENABLE("ENABLED"),
      .CLKOP_DIV(board_pkg::PllOutput),
      .CLKOP_CPHASE(Phase),
      .CLKOP_FPHASE(0),
      .CLKOS_ENABLE("ENABLED"),
      .CLKOS_DIV(SdramDivider),
      .CLKOS_CPHASE(Phase),
      .CLKOS_FPHASE(0),
      .CLKOS2_ENABLE("ENABLED"),
      .CLKOS2_DIV(SdramDivider),
      .CLKOS2_CPHASE(Phase + ChipEighths / 8),
      .CLKOS2_FPHASE(ChipEighths % 8)
  ) pll (
      .RST(1'b0),
      .STDBY(1'b0),
      .CLKI(clk_25mhz),
      .CLKFB(clk),
      .CLKOP(clk),
      .CLKOS(clk_sdram),
      .CLKOS2(clk_chip),
      .PHASESEL0(1'b0),
      .PHASESEL1(1'b0),
      .PHASEDIR(1'b1),
      .PHASESTEP(1'b1),
      .PHASELOADREG(1'b1),
      .PLLWAKESYNC(1'b0),
      .ENCLKOP(1'b0),
      .LOCK(locked)
  );

  // Reset while the PLL is not locked and while the button is held, released in step with the clock.
  logic [3:0] reset_q;
  logic rst_q;
  always_ff @(posedge clk) begin
    reset_q <= {reset_q[2:0], btn_i || !locked};
    rst_q   <= reset_q[3];
  end

  logic [15:0] dq_in, dq_out;
  logic dq_enable;
  for (genvar i = 0; i < 16; i++) begin : gen_dq
    BB pad (
        .I(dq_out[i]),
        .T(!dq_enable),
        .O(dq_in[i]),
        .B(sdram_dq_io[i])
    );
  end
  ODDRX1F clock_pad (
      .SCLK(clk_chip),
      .RST(1'b0),
      .D0(1'b1),
      .D1(1'b0),
      .Q(sdram_clk_o)
  );

  board_core #(
      .ClocksPerBit(ClocksPerBit),
      .ClockKHz(board_pkg::CoreKHz)
  ) core (
      .clk_i(clk),
      .rst_i(rst_q),
      .uart_rx_i(ftdi_txd_i),
      .uart_tx_o(ftdi_rxd_o),
      .led_o(led_o),
      .clk_sdram_i(clk_sdram),
      .sdram_cke_o(sdram_cke_o),
      .sdram_cs_no(sdram_csn_o),
      .sdram_ras_no(sdram_rasn_o),
      .sdram_cas_no(sdram_casn_o),
      .sdram_we_no(sdram_wen_o),
      .sdram_ba_o(sdram_ba_o),
      .sdram_a_o(sdram_a_o),
      .sdram_dqm_o(sdram_dqm_o),
      .sdram_dq_i(dq_in),
      .sdram_dq_o(dq_out),
      .sdram_dq_oe_o(dq_enable)
  );
endmodule
