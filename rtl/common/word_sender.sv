// SPDX-License-Identifier: Apache-2.0
// A packet in Words words, the lowest bits first, to a word_receiver: what lies far away takes few wires so. The packet is held by
// its giver until in_ready_o; the highest word is filled up with zeros.
//
// A word a cycle; latency 1 to the first; out_valid_o and out_o come from registers.
module word_sender #(
    parameter int unsigned Width = 64,
    parameter int unsigned Words = 8,
    localparam int unsigned WordBits = (Width + Words - 1) / Words
) (
    input  logic                clk_i,
    input  logic                rst_i,
    input  logic                in_valid_i,
    output logic                in_ready_o,
    input  logic [   Width-1:0] in_i,
    output logic                out_valid_o,
    input  logic                out_ready_i,
    output logic [WordBits-1:0] out_o
);
  localparam int unsigned CountBits = Words > 1 ? $clog2(Words) : 1;
  logic [CountBits-1:0] next_q;  // word of the packet
  logic [Words*WordBits-1:0] padded;
  logic move;

  assign padded = (Words * WordBits)'(in_i);
  assign move = in_valid_i && (out_ready_i || !out_valid_o);
  assign in_ready_o = (out_ready_i || !out_valid_o) && next_q == CountBits'(Words - 1);

  always_ff @(posedge clk_i) begin
    if (out_ready_i || !out_valid_o) begin
      out_valid_o <= in_valid_i;
      out_o <= padded[WordBits*next_q+:WordBits];
    end
    if (move) next_q <= next_q == CountBits'(Words - 1) ? '0 : next_q + 1'b1;
    if (rst_i) begin
      out_valid_o <= 1'b0;
      next_q <= '0;
    end
  end
endmodule
