// SPDX-License-Identifier: Apache-2.0
// In place of reorder_counts: exact for one bin, any, as the property reorder_counts says; anything for the other bins.
module reorder_counts #(
    parameter int unsigned Packets = 2048,
    parameter int unsigned Bins = 512,
    localparam int unsigned BinBits = Bins > 1 ? $clog2(Bins) : 1
) (
    input  logic               clk_i,
    input  logic               rst_i,
    input  logic               clear_i,
    input  logic [BinBits-1:0] clear_bin_i,
    input  logic               insert_i,
    input  logic [BinBits-1:0] insert_bin_i,
    input  logic               remove_i,
    input  logic [BinBits-1:0] remove_bin_i,
    output logic [BinBits-1:0] insert_bin_o,
    output logic [        1:0] insert_turn_o,
    output logic               first_o,
    output logic [BinBits-1:0] remove_bin_o,
    output logic [        1:0] remove_turn_o,
    output logic               linked_o
);
  localparam int unsigned Bits = $clog2(Packets + 2);
  (* anyconst *) logic [BinBits-1:0] watched;
  (* anyseq *) logic [1:0] insert_turn, remove_turn;
  (* anyseq *) logic first, linked;
  logic inserted, removed;
  assign inserted = insert_i && insert_bin_i == watched;
  assign removed  = remove_i && remove_bin_i == watched;

  logic [1:0] inserts_q, removes_q;  // of the watched bin, modulo 4
  logic [Bits-1:0] held_q;
  logic [3*BinBits-1:0] insert_bins_q, remove_bins_q;  // the newest lowest
  logic [5:0] insert_turns_q, remove_turns_q;
  logic [4:0] firsts_q, linkeds_q;
  always_ff @(posedge clk_i) begin
    if (inserted) inserts_q <= inserts_q + 1'b1;
    if (removed) removes_q <= removes_q + 1'b1;
    held_q <= held_q + Bits'(inserted) - Bits'(removed);
    insert_bins_q <= (3 * BinBits)'({insert_bins_q, insert_bin_i});
    remove_bins_q <= (3 * BinBits)'({remove_bins_q, remove_bin_i});
    insert_turns_q <= {insert_turns_q[3:0], inserted ? inserts_q : insert_turn};
    remove_turns_q <= {remove_turns_q[3:0], removed ? removes_q : remove_turn};
    firsts_q <= {firsts_q[3:0], inserted ? held_q < Bits'(4) : first};
    linkeds_q <= {linkeds_q[3:0], removed ? held_q + Bits'(inserted) > Bits'(4) : linked};
    if (rst_i) begin
      inserts_q <= '0;
      removes_q <= '0;
      held_q <= '0;
    end
  end
  assign insert_bin_o = insert_bins_q[2*BinBits+:BinBits];
  assign remove_bin_o = remove_bins_q[2*BinBits+:BinBits];
  assign insert_turn_o = insert_turns_q[5:4];
  assign remove_turn_o = remove_turns_q[5:4];
  assign first_o = firsts_q[4];
  assign linked_o = linkeds_q[4];
endmodule
