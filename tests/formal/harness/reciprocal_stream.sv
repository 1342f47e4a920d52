// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/reciprocal.sv
// reciprocal: a result stays, mantissa and exponent, until it is taken; one bit of them, any, is followed.
module reciprocal_stream (
    input logic clk_i,
    input logic rst_i,
    input logic in_valid_i,
    input logic [11:0] in_i,
    input logic out_ready_i,
    output logic in_ready,
    output logic out_valid
);
  (* anyconst *) logic [3:0] followed;
  logic [8:0] mantissa;
  logic [3:0] exponent;
  logic [12:0] result;
  assign result = {exponent, mantissa};

  reciprocal #(
      .XBits(12),
      .W(8)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i),
      .in_ready_o(in_ready),
      .in_i(in_i),
      .out_valid_o(out_valid),
      .out_ready_i(out_ready_i),
      .mantissa_o(mantissa),
      .exponent_o(exponent)
  );

  logic started_q = 1'b0, stalled_q, shown_q;
  always_ff @(posedge clk_i) begin
    started_q <= 1'b1;
    stalled_q <= !rst_i && out_valid && !out_ready_i;
    shown_q   <= result[followed];
  end
  always_comb begin
    assume (rst_i == !started_q);
    assume (followed < 4'd13);
    if (!rst_i && stalled_q) assert (out_valid && result[followed] == shown_q);
  end
endmodule
