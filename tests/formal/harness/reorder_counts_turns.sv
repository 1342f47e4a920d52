// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/block_ram.sv rtl/reorder_buffer/reorder_counts.sv
// reorder_counts: of one bin, any, bin and turn come 3 cycles after an operation and say how often modulo 4 such an
// operation was made before; first_o and linked_o come 5 cycles after and say whether fewer than 4 packets were in the bin,
// and whether more than 4 were. The owner removes only what is there and holds at most Packets.
module reorder_counts_turns #(
    parameter int unsigned Packets = 6,
    parameter int unsigned Bins = 2
) (
    input logic clk_i,
    input logic rst_i,
    input logic insert_i,
    input logic insert_bin_i,
    input logic remove_i,
    input logic remove_bin_i
);
  (* anyconst *) logic watched;
  logic insert_bin, remove_bin, first, linked, clear;
  logic [1:0] insert_turn, remove_turn;

  reorder_counts #(
      .Packets(Packets),
      .Bins(Bins)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .clear_i(clear),
      .clear_bin_i(clear_bin),
      .insert_i(insert_i),
      .insert_bin_i(insert_bin_i),
      .remove_i(remove_i),
      .remove_bin_i(remove_bin_i),
      .insert_bin_o(insert_bin),
      .insert_turn_o(insert_turn),
      .first_o(first),
      .remove_bin_o(remove_bin),
      .remove_turn_o(remove_turn),
      .linked_o(linked)
  );

  // After reset each bin is cleared, then operations begin.
  logic started_q = 1'b0;
  logic [1:0] age_q;
  logic clear_bin;
  always_ff @(posedge clk_i) begin
    started_q <= 1'b1;
    if (age_q != 2'd3) age_q <= age_q + 1'b1;
    if (rst_i) age_q <= '0;
  end
  always_comb assume (rst_i == !started_q);
  assign clear = age_q < 2'd2;
  assign clear_bin = age_q[0];

  logic inserted, removed;
  assign inserted = insert_i && insert_bin_i == watched;
  assign removed  = remove_i && remove_bin_i == watched;
  logic [1:0] inserts_q, removes_q;  // modulo 4
  logic [2:0] held_q;
  // What is to come out, and when.
  logic [4:0] insert_due_q, remove_due_q, first_q, linked_q;
  logic [5:0] insert_turn_q, remove_turn_q;
  always_ff @(posedge clk_i) begin
    if (inserted) inserts_q <= inserts_q + 1'b1;
    if (removed) removes_q <= removes_q + 1'b1;
    held_q <= held_q + 3'(inserted) - 3'(removed);
    insert_due_q <= {insert_due_q[3:0], inserted};
    remove_due_q <= {remove_due_q[3:0], removed};
    insert_turn_q <= {insert_turn_q[3:0], inserts_q};
    remove_turn_q <= {remove_turn_q[3:0], removes_q};
    first_q <= {first_q[3:0], held_q < 3'd4};
    linked_q <= {linked_q[3:0], held_q + 3'(inserted) > 3'd4};
    if (rst_i) begin
      inserts_q <= '0;
      removes_q <= '0;
      held_q <= '0;
      insert_due_q <= '0;
      remove_due_q <= '0;
    end
  end

  always_comb begin
    if (age_q != 2'd3 || rst_i) assume (!insert_i && !remove_i);
    if (removed) assume (held_q != '0 || inserted);
    if (inserted) assume (held_q < 3'(Packets) || removed);
  end

  always_comb begin
    if (!rst_i) begin
      if (insert_due_q[2]) assert (insert_bin == watched && insert_turn == insert_turn_q[5:4]);
      if (remove_due_q[2]) assert (remove_bin == watched && remove_turn == remove_turn_q[5:4]);
      if (insert_due_q[4]) assert (first == first_q[4]);
      if (remove_due_q[4]) assert (linked == linked_q[4]);
    end
  end
endmodule
