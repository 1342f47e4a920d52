// SPDX-License-Identifier: Apache-2.0
// A ULX3S around board_core, photons in block RAM. The core's clock is made of the board's 25 MHz; button FIRE1 resets it. The
// link is the USB serial port US1. Frequencies and the PLL's dividers: board_pkg, which is generated; the rest of the PLL
// is as `ecppll` writes it (docs/data.md). The PLL's own output is its feedback: VCO = core clock * PllOutput.
module ulx3s_85f_top #(
    parameter int unsigned ClocksPerBit = board_pkg::ClocksPerBit
) (
    input  logic        clk_25mhz,
    input  logic        btn_i,
    input  logic        ftdi_txd_i,     // from the host
    output logic        ftdi_rxd_o,     // to the host
    output logic [ 7:0] led_o
);
  localparam int Phase = board_pkg::PllOutput / 2;  // the first phase; counts VCO cycles

  logic clk, locked;
  /* verilator lint_off PINMISSING */  // outputs of the PLL that are not used
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
      .CLKOP_FPHASE(0)
  ) pll (
      .RST(1'b0),
      .STDBY(1'b0),
      .CLKI(clk_25mhz),
      .CLKFB(clk),
      .CLKOP(clk),
      .PHASESEL0(1'b0),
      .PHASESEL1(1'b0),
      .PHASEDIR(1'b1),
      .PHASESTEP(1'b1),
      .PHASELOADREG(1'b1),
      .PLLWAKESYNC(1'b0),
      .ENCLKOP(1'b0),
      .LOCK(locked)
  );
  /* verilator lint_on PINMISSING */

  // Reset while the PLL is not locked and while the button is held, released in step with the clock.
  logic [3:0] reset_q;
  logic rst_q;
  always_ff @(posedge clk) begin
    reset_q <= {reset_q[2:0], btn_i || !locked};
    rst_q   <= reset_q[3];
  end

  /* verilator lint_off UNUSED */  // there is no SDRAM in this plan
  logic cke, cs_n, ras_n, cas_n, we_n, dq_enable;
  logic [1:0] ba, dqm;
  logic [12:0] a;
  logic [15:0] dq_out;
  /* verilator lint_on UNUSED */

  board_core #(
      .ClocksPerBit(ClocksPerBit),
      .ClockKHz(board_pkg::CoreKHz)
  ) core (
      .clk_i(clk),
      .rst_i(rst_q),
      .uart_rx_i(ftdi_txd_i),
      .uart_tx_o(ftdi_rxd_o),
      .led_o(led_o),
      .clk_sdram_i(clk),
      .sdram_cke_o(cke),
      .sdram_cs_no(cs_n),
      .sdram_ras_no(ras_n),
      .sdram_cas_no(cas_n),
      .sdram_we_no(we_n),
      .sdram_ba_o(ba),
      .sdram_a_o(a),
      .sdram_dqm_o(dqm),
      .sdram_dq_i(16'h0),
      .sdram_dq_o(dq_out),
      .sdram_dq_oe_o(dq_enable)
  );
endmodule
