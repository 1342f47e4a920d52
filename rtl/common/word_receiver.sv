// SPDX-License-Identifier: Apache-2.0
// Packets from the words of a word_sender. A packet stands until it is taken; the next one's words come after that.
//
// Words and one more cycles a packet; latency 1 from its last word. in_ready_o, out_valid_o and out_o come from registers.
module word_receiver #(
    parameter int unsigned Width = 64,
    parameter int unsigned Words = 8,
    localparam int unsigned WordBits = (Width + Words - 1) / Words
) (
    input  logic                clk_i,
    input  logic                rst_i,
    input  logic                in_valid_i,
    output logic                in_ready_o,
    input  logic [WordBits-1:0] in_i,
    output logic                out_valid_o,
    input  logic                out_ready_i,
    output logic [   Width-1:0] out_o
);
  localparam int unsigned CountBits = Words > 1 ? $clog2(Words) : 1;
  logic [CountBits-1:0] next_q;  // word of the packet
  /* verilator lint_off UNUSEDSIGNAL */  // what fills up the highest word
  logic [Words*WordBits-1:0] packet_q;
  /* verilator lint_on UNUSEDSIGNAL */

  assign in_ready_o = !out_valid_o;
  assign out_o = packet_q[Width-1:0];

  always_ff @(posedge clk_i) begin
    for (int unsigned w = 0; w < Words; w++)
      if (in_valid_i && in_ready_o && next_q == CountBits'(w)) packet_q[WordBits*w+:WordBits] <= in_i;
    if (in_valid_i && in_ready_o) begin
      next_q <= next_q == CountBits'(Words - 1) ? '0 : next_q + 1'b1;
      out_valid_o <= next_q == CountBits'(Words - 1);
    end else if (out_ready_i) begin
      out_valid_o <= 1'b0;
    end
    if (rst_i) begin
      next_q <= '0;
      out_valid_o <= 1'b0;
    end
  end
endmodule
