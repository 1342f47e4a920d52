// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/block_ram.sv rtl/reorder_buffer/reorder_counts.sv
// reorder_counts: of one bin, any, bin and turn come 3 cycles after an operation and say how often modulo 4 such an
// operation was made before; first_o and linked_o come 5 cycles after and say whether fewer than 4 packets were in the bin,
// and whether more than 4 were. The owner removes only what is there and holds at most Packets.
module reorder_counts_turns #(
    parameter int unsigned Lemmas = 1,
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

  // Operation 0 is the insertion, 1 the removal. Of the watched bin the numbers of operations modulo 2**Bits before this
  // cycle, and before each of the last cycles: at Bits * k, k cycles ago. *_due_q[k]: one was made k + 1 cycles ago.
  localparam int unsigned Bits = Packets > 6 ? $clog2(Packets + 2) : 3;
  localparam int unsigned Ago = 6;
  logic inserted, removed;
  assign inserted = insert_i && insert_bin_i == watched;
  assign removed  = remove_i && remove_bin_i == watched;
  logic [Ago*Bits-1:0] inserts_q, removes_q;
  logic [Ago-2:0] insert_due_q, remove_due_q;
  logic [Bits-1:0] held_q;
  always_ff @(posedge clk_i) begin
    inserts_q <= {inserts_q[0+:(Ago-1)*Bits], inserts_q[0+:Bits] + Bits'(inserted)};
    removes_q <= {removes_q[0+:(Ago-1)*Bits], removes_q[0+:Bits] + Bits'(removed)};
    insert_due_q <= {insert_due_q[Ago-3:0], inserted};
    remove_due_q <= {remove_due_q[Ago-3:0], removed};
    held_q <= held_q + Bits'(inserted) - Bits'(removed);
    if (rst_i) begin
      inserts_q <= '0;
      removes_q <= '0;
      insert_due_q <= '0;
      remove_due_q <= '0;
      held_q <= '0;
    end
  end

  always_comb begin
    if (!rst_i && age_q != 2'd3) assume (!insert_i && !remove_i);
    if (!rst_i && removed) assume (held_q != '0 || inserted);
    if (!rst_i && inserted) assume (held_q < Bits'(Packets) || removed);
  end

  // What comes out.
  logic [Bits-1:0] held5;  // before the operations of 5 cycles ago
  assign held5 = inserts_q[5*Bits+:Bits] - removes_q[5*Bits+:Bits];
  always_comb begin
    if (!rst_i) begin
      if (insert_due_q[2]) assert (insert_bin == watched && insert_turn == inserts_q[3*Bits+:2]);
      if (remove_due_q[2]) assert (remove_bin == watched && remove_turn == removes_q[3*Bits+:2]);
      if (insert_due_q[4]) assert (first == (held5 < Bits'(4)));
      if (remove_due_q[4]) assert (linked == (held5 + Bits'(insert_due_q[4]) > Bits'(4)));
    end
  end

  // What the module holds of the watched bin, so that the above follows from one cycle to the next. Probes are kept where no
  // lemma reads them.
  (* keep *) logic [1:0] ask1, ask2, bin1, bin2, bin3;  // probe
  (* keep *) logic [2*Bits-1:0] new3, new4, held4;  // probe
  (* keep *) logic [4*Bits-1:0] count3;  // probe
  (* keep *) logic same1, same2, same3, same4;  // probe
  if (Lemmas == 1) begin : gen_lemmas
    always_comb begin
      if (!rst_i) begin
        assert (held_q == inserts_q[0+:Bits] - removes_q[0+:Bits] && held_q <= Bits'(Packets));
        if (remove_due_q[0]) assert (same1 == insert_due_q[0]);
        if (remove_due_q[1]) assert (same2 == insert_due_q[1]);
        if (remove_due_q[2]) assert (same3 == insert_due_q[2]);
        if (remove_due_q[3]) assert (same4 == insert_due_q[3]);
      end
    end
    for (genvar o = 0; o < 2; o++) begin : gen_operation
      logic [Ago*Bits-1:0] made;
      logic [Ago-2:0] due;
      assign made = o == 0 ? inserts_q : removes_q;
      assign due  = o == 0 ? insert_due_q : remove_due_q;
      always_comb begin
        if (!rst_i) begin
          for (int unsigned k = 0; k + 1 < Ago; k++) begin
            assert (made[Bits*k+:Bits] == made[Bits*(k+1)+:Bits] + Bits'(due[k]));
          end
          if (age_q != 2'd3) assert (made == '0 && due == '0);
          assert (due[0] == (ask1[o] && bin1[o] == watched));
          assert (due[1] == (ask2[o] && bin2[o] == watched));
          if (due[2]) begin
            assert (bin3[o] == watched && new3[Bits*o+:Bits] == made[2*Bits+:Bits]);
            assert (count3[Bits*2*o+:Bits] == inserts_q[3*Bits+:Bits]);
            assert (count3[Bits*(2*o+1)+:Bits] == removes_q[3*Bits+:Bits]);
          end
          if (due[3]) begin
            assert (new4[Bits*o+:Bits] == made[3*Bits+:Bits]);
            assert (held4[Bits*o+:Bits] == inserts_q[4*Bits+:Bits] - removes_q[4*Bits+:Bits]);
          end
        end
      end
    end
  end
endmodule
