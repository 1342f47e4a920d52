// SPDX-License-Identifier: Apache-2.0
module reorder_lists_cover #(
    parameter int unsigned Packets,
    parameter int unsigned BinBits
) (
    input logic clk_i,
    input logic rst_i,
    input logic ready_o,
    input logic insert_i,
    input logic [BinBits-1:0] insert_bin_i,
    input logic remove_i,
    input logic [BinBits-1:0] remove_bin_i,
    input logic out_valid_o,
    input logic first5,
    input logic first_known7_q,
    input logic head_known7_q
);
  logic ran_q = 1'b0;  // the first reset is over
  logic [31:0] held_q;
  always_ff @(posedge clk_i) begin
    if (!rst_i) ran_q <= 1'b1;
    held_q <= held_q + 32'(insert_i) - 32'(remove_i);
    if (rst_i) held_q <= '0;
  end

  // As many packets are linked as the pool is for.
  pool_full: cover property (@(posedge clk_i) disable iff (rst_i) held_q == Packets);
  // The pool is full and takes a packet as it gives one.
  exchange_when_full: cover property (@(posedge clk_i) disable iff (rst_i) held_q == Packets && insert_i && remove_i);
  // The last packet leaves: all lists are empty.
  empties: cover property (@(posedge clk_i) disable iff (rst_i) held_q == 32'd1 && remove_i && !insert_i);
  // A packet enters an empty pool and leaves in the same cycle, as a flush does.
  through_empty_pool: cover property (@(posedge clk_i) disable iff (rst_i) held_q == '0 && insert_i && remove_i);
  // One bin is filled and emptied in a cycle.
  same_bin: cover property (@(posedge clk_i) disable iff (rst_i) insert_i && remove_i && insert_bin_i == remove_bin_i);
  // The first packet of an empty list.
  first_of_list: cover property (@(posedge clk_i) disable iff (rst_i) ready_o && first5);
  // The first of a list is taken as it is being written: it is forwarded.
  first_forwarded: cover property (@(posedge clk_i) disable iff (rst_i) first_known7_q);
  // A list's head is read as it is being written: it is forwarded.
  head_forwarded: cover property (@(posedge clk_i) disable iff (rst_i) head_known7_q);
  // A reset with packets linked, whose lists have to be forgotten.
  reset_with_packets: cover property (@(posedge clk_i) rst_i && ran_q && held_q != '0);
  // A reset with a packet on its way out of the pool.
  reset_as_packet_leaves: cover property (@(posedge clk_i) rst_i && ran_q && out_valid_o);
endmodule
