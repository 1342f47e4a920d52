// SPDX-License-Identifier: Apache-2.0
// In place of ram_fifo where its words do not matter: any words, each offered until it is taken. That the real one does so
// is proved by itself.
module ram_fifo #(
    parameter int unsigned Width = 8,
    parameter int unsigned Depth = 512,
    localparam int unsigned AddressBits = $clog2(Depth)
) (
    input  logic                 clk_i,
    input  logic                 rst_i,
    input  logic                 clear_i,
    input  logic                 in_valid_i,
    output logic                 in_ready_o,
    input  logic [    Width-1:0] in_i,
    output logic                 out_valid_o,
    input  logic                 out_ready_i,
    output logic [    Width-1:0] out_o,
    output logic [AddressBits:0] room_o,
    output logic                 empty_o
);
  (* anyseq *) logic valid, ready;
  (* anyseq *) logic [Width-1:0] word;
  logic held_q;
  logic [Width-1:0] word_q;
  assign out_valid_o = !rst_i && (held_q || valid);
  assign out_o = held_q ? word_q : word;
  assign in_ready_o = ready;
  assign room_o = '0;
  assign empty_o = !out_valid_o;
  always_ff @(posedge clk_i) begin
    held_q <= out_valid_o && !out_ready_i;
    word_q <= out_o;
    if (rst_i || clear_i) held_q <= 1'b0;
  end
endmodule
