// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/lut_ram.sv rtl/common/async_fifo.sv
// async_fifo: words come out once, unchanged, in order, and stay offered until they are taken, at any ratio and phase of its
// clocks: each step of the proof is an edge of either, of both or of neither, as the environment likes. A register that
// samples the other domain gets the value before the edge; that metastability is over by the next edge is assumed. Words
// are as in stream_checks: two on end are 1.
module async_fifo_stream (
    input logic in_clk_i,
    input logic out_clk_i,
    input logic in_valid_i,
    input logic in_i,
    input logic out_ready_i
);
  logic in_ready, out_valid, out, rst;

  async_fifo #(
      .Width(1),
      .Depth(4)
  ) dut (
      .in_clk_i(in_clk_i),
      .in_rst_i(rst),
      .in_valid_i(in_valid_i),
      .in_ready_o(in_ready),
      .in_i(in_i),
      .out_clk_i(out_clk_i),
      .out_rst_i(rst),
      .out_valid_o(out_valid),
      .out_ready_i(out_ready_i),
      .out_o(out)
  );

  // Reset is over once each side has had an edge in it.
  logic in_started_q = 1'b0, out_started_q = 1'b0;
  always_ff @(posedge in_clk_i) in_started_q <= 1'b1;
  always_ff @(posedge out_clk_i) out_started_q <= 1'b1;
  assign rst = !in_started_q || !out_started_q;

  logic [1:0] sent_q = '0, taken_q = '0;
  logic stalled_q = 1'b0, shown_q;

  always_ff @(posedge in_clk_i) begin
    if (!rst && in_valid_i && in_ready) begin
      if (sent_q == 2'd1) assume (in_i);
      if (sent_q == 2'd2) assume (!in_i);
      if (in_i) sent_q <= sent_q + 1'b1;
    end
  end

  always_ff @(posedge out_clk_i) begin
    stalled_q <= !rst && out_valid && !out_ready_i;
    shown_q   <= out;
    if (!rst) begin
      if (stalled_q) assert (out_valid && out == shown_q);
      if (out_valid && out_ready_i) begin
        if (taken_q == 2'd1) assert (out);
        if (taken_q == 2'd2) assert (!out);
        if (out) taken_q <= taken_q + 1'b1;
      end
    end
  end
endmodule
