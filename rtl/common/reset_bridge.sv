// SPDX-License-Identifier: Apache-2.0
// One reset for two clock domains: rst_i, of any length, holds both outputs until each domain has seen at least one edge in
// reset; the other domain leaves reset first, this one some cycles later. Works at any ratio of the clocks. Both are in
// reset from the start, before any edge: with the command of sdram_controller these are the only registers whose initial value counts.
module reset_bridge (
    input  logic clk_i,
    input  logic rst_i,
    output logic rst_o,        // in the domain of clk_i
    input  logic other_clk_i,
    output logic other_rst_o   // in the domain of other_clk_i
);
  logic hold_q;
  logic [1:0] other_q, seen_q;

  initial begin
    hold_q  = 1'b1;
    other_q = '1;
  end

  always_ff @(posedge clk_i) begin
    seen_q <= {seen_q[0], other_q[1]};
    if (rst_i) hold_q <= 1'b1;
    else if (seen_q[1]) hold_q <= 1'b0;
  end
  always_ff @(posedge other_clk_i) other_q <= {other_q[0], hold_q};

  assign rst_o = rst_i || hold_q || seen_q != '0;
  assign other_rst_o = other_q[1];
endmodule
