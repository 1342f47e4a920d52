// SPDX-License-Identifier: Apache-2.0
// A Nexys Video around board_core, photons in block RAM. The core's clock is made of the board's 100 MHz; the centre button resets
// it. The link is the board's USB serial port. The LEDs are the core's. Frequencies and the PLL's dividers: board_pkg,
// which is generated. VCO = 100 MHz / PllReference * PllFeedback.
module nexys_video_top #(
    parameter int unsigned ClocksPerBit = board_pkg::ClocksPerBit
) (
    input  logic       clk_100mhz,
    input  logic       btn_i,
    input  logic       uart_rx_i,   // from the host
    output logic       uart_tx_o,   // to the host
    output logic [7:0] led_o
);
  logic clk, clk_made, feedback, locked;
  PLLE2_BASE #(
      .CLKIN1_PERIOD(10.0),
      .CLKFBOUT_MULT(board_pkg::PllFeedback),
      .DIVCLK_DIVIDE(board_pkg::PllReference),
      .CLKOUT0_DIVIDE(board_pkg::PllOutput)
  ) pll (
      .CLKIN1(clk_100mhz),
      .CLKFBIN(feedback),
      .CLKFBOUT(feedback),
      .CLKOUT0(clk_made),
      .RST(1'b0),
      .PWRDWN(1'b0),
      .LOCKED(locked)
  );
  BUFG clock_buffer (
      .I(clk_made),
      .O(clk)
  );

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
      .uart_rx_i(uart_rx_i),
      .uart_tx_o(uart_tx_o),
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
