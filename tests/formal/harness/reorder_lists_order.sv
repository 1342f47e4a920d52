// SPDX-License-Identifier: Apache-2.0
// sources: tests/formal/harness/stubs/block_ram.sv tests/formal/harness/stubs/reorder_counts.sv
// sources: tests/formal/harness/stubs/free_list.sv rtl/common/lut_ram.sv rtl/reorder_buffer/pool_ram.sv
// sources: rtl/reorder_buffer/reorder_lists.sv
// reorder_lists: a removal from a bin gives, nine cycles later, the packet that was inserted into that bin longest ago, each
// once, unchanged. Any list is watched, and in it any two packets that were inserted one after the other, Q and P, or P alone as
// the first ever: the removal whose turn P is reads P's node (H), gives out its packet (D) and gives its node back (G), and an
// insertion that links P links it to Q's node (L). One bit of the packet is followed. The lists are ready 4 * Bins cycles after
// reset.
//
// H of Q and L of all packets but P are assumed of the cycles before: Q and P are any two, so this is induction over time. Of
// what other lists do nothing else is assumed: their turns, nodes and links are anything, but that L makes them link to a node
// that is out, which is not Q's while that is out.
//
// In place of reorder_counts and free_list stand stubs that do what is proved of them. Each memory keeps the one word that the
// two packets are about. The environment is the reorder buffer: nothing before ready, a removal only from a bin that holds
// something, at most Packets in a bin.
module reorder_lists_order #(
    parameter int unsigned Packets = 9,
    parameter int unsigned Bins = 2
) (
    input logic clk_i,
    input logic rst_i,
    input logic insert_i,
    input logic insert_bin_i,
    input logic insert_packet_i,
    input logic remove_i,
    input logic remove_bin_i,
    input logic follow_i  // the packet that is inserted is Q, if none is yet
);
  localparam int unsigned NodeBits = $clog2(Packets + 16);
  localparam int unsigned HeldBits = $clog2(Packets + 2);

  logic ready, out_valid, out;
  reorder_lists #(
      .Width(1),
      .Packets(Packets),
      .Bins(Bins),
      .BinBits(1)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .ready_o(ready),
      .insert_i(insert_i),
      .insert_bin_i(insert_bin_i),
      .insert_packet_i(insert_packet_i),
      .remove_i(remove_i),
      .remove_bin_i(remove_bin_i),
      .out_valid_o(out_valid),
      .out_o(out)
  );

  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_comb assume (rst_i == !started_q);

  // What is watched: a list, the node of Q, the node of P. Words of other lists and nodes are free.
  (* anyconst *) logic watched_bin;
  (* anyconst *) logic [1:0] watched_turn;
  (* anyconst *) logic [NodeBits-1:0] q_node, p_node;
  (* anyconst *) logic alone;  // there is no Q: P is the first packet of the list since reset
  // Probes: which word each memory keeps, and the word.
  logic counts_watched;
  logic [2:0] tails_watched, firsts_watched, heads_watched;
  logic [NodeBits-1:0] links_watched, pool_watched, tail, first, link;
  logic [NodeBits:0] head;  // {a packet is linked behind the last one that was removed, which}
  logic pool;
  always_comb begin
    assume (counts_watched == watched_bin);
    assume (tails_watched == {watched_bin, watched_turn});
    assume (firsts_watched == {watched_bin, watched_turn});
    assume (heads_watched == {watched_bin, watched_turn});
    assume (links_watched == q_node && pool_watched == p_node);
  end

  // Probes of the counts' stub and of the lists.
  logic [1:0] inserts, removes;
  logic [HeldBits-1:0] held;
  logic [3:0] walk;
  logic [4:0] insert_stages;  // bit n is cycle n + 1
  logic [8:0] remove_stages;
  logic first5, given;
  logic [NodeBits-1:0] node2, tail5, head7, given_node;

  logic inserted, removed;
  assign inserted = insert_i && insert_bin_i == watched_bin;
  assign removed  = remove_i && remove_bin_i == watched_bin;
  always_comb begin
    if (!rst_i && !ready) assume (!insert_i && !remove_i);
    if (removed) assume (held != '0 || inserted);
    if (inserted) assume (held < HeldBits'(Packets) || removed);
  end

  // The age of an operation: cycles since, 0 before it, Old for that many and more.
  localparam logic [3:0] Old = 4'd14;
  function automatic logic [3:0] older(input logic [3:0] age, input logic now);
    older = now ? 4'd1 : age == '0 || age == Old ? age : age + 4'd1;
  endfunction
  logic [3:0] q_in_q, q_out_q, p_in_q, p_out_q;
  logic [HeldBits-1:0] q_ahead_q, p_ahead_q;  // packets of the bin that leave it before
  logic p_first_q, p_packet_q;
  logic [8:0] removes_due_q;
  logic [3:0] cycles_q;  // since reset, up to 4 * Bins
  logic q_in, q_out, p_in, p_out;
  assign p_in = inserted && inserts == watched_turn && p_in_q == '0 && (alone || q_in_q != '0);
  assign q_in = inserted && inserts == watched_turn && q_in_q == '0 && !alone && follow_i;
  assign q_out = removed && q_out_q == '0 && (q_in ? held == '0 : q_in_q != '0 && q_ahead_q == '0);
  assign p_out = removed && p_out_q == '0 && (p_in ? held == '0 : p_in_q != '0 && p_ahead_q == '0);

  // A node is out from the cycle after it was handed out to the one in which it is given back.
  logic q_owned, p_owned;
  assign q_owned = q_in_q >= 4'd3 && q_out_q <= 4'd8;
  assign p_owned = p_in_q >= 4'd3 && p_out_q <= 4'd8;
  always_comb begin
    if (q_in_q == 4'd2) assume (node2 == q_node);
    if (p_in_q == 4'd2) assume (node2 == p_node);
    if (insert_stages[1] && q_owned) assume (node2 != q_node);
    if (insert_stages[1] && p_owned) assume (node2 != p_node);
  end

  logic other_breaks_q;  // what is assumed of the cycle before
  always_ff @(posedge clk_i) begin
    q_in_q <= older(q_in_q, q_in);
    q_out_q <= older(q_out_q, q_out);
    p_in_q <= older(p_in_q, p_in);
    p_out_q <= older(p_out_q, p_out);
    q_ahead_q <= (q_in ? held : q_ahead_q) - HeldBits'(removed);
    p_ahead_q <= (p_in ? held : p_ahead_q) - HeldBits'(removed);
    if (p_in) begin
      p_first_q  <= held < HeldBits'(4);
      p_packet_q <= insert_packet_i;
    end
    removes_due_q <= {removes_due_q[7:0], remove_i};
    other_breaks_q <= (q_out_q == 4'd7 && head7 != q_node) ||
        (insert_stages[4] && !first5 && p_in_q != 4'd5 && q_owned && tail5 == q_node);
    if (cycles_q != 4'd8) cycles_q <= cycles_q + 1'b1;
    if (rst_i) begin
      cycles_q <= '0;
      q_in_q <= '0;
      q_out_q <= '0;
      p_in_q <= '0;
      p_out_q <= '0;
      removes_due_q <= '0;
      other_breaks_q <= 1'b0;
    end
  end
  always_comb assume (!other_breaks_q);

  // What is to be shown.
  always_comb begin
    if (!rst_i && started_q) begin
      if (p_in_q == 4'd5) assert (insert_stages[4] && first5 == p_first_q);
      if (p_in_q == 4'd5 && !p_first_q) assert (tail5 == q_node && q_owned);  // L
      if (p_out_q == 4'd7) assert (head7 == p_node && p_owned);  // H
      if (p_out_q == 4'd8) assert (given && given_node == p_node && p_owned);  // G
      if (p_out_q == 4'd9) assert (out == p_packet_q);  // D
      assert (out_valid == removes_due_q[8]);
      if (cycles_q == 4'd8) assert (ready);
    end
  end

  // Lemmas. The ages: Q before P, in before out, the operations of a list four of the bin apart.
  function automatic logic before(input logic [3:0] a, input logic [3:0] b, input logic [3:0] by);
    before = b == '0 || (a != '0 && (a == Old || a >= b + by));
  endfunction
  always_comb begin
    if (!rst_i && started_q) begin
      assert (q_in_q <= Old && q_out_q <= Old && p_in_q <= Old && p_out_q <= Old);
      assert (before(q_in_q, q_out_q, 4'd0) && before(p_in_q, p_out_q, 4'd0));
      if (alone) assert (q_in_q == '0);
      else assert (before(q_in_q, p_in_q, 4'd4) && before(q_out_q, p_out_q, 4'd4));
      if (!ready) assert (q_in_q == '0 && p_in_q == '0 && held == '0 && inserts == '0 && removes == '0);
      if (!ready) assert (insert_stages == '0 && remove_stages == '0);
      assert (walk <= 4'd8 && walk == cycles_q);
    end
  end

  // The bin: whose turn it is follows from how many are ahead.
  logic [1:0] behind_q;  // packets of the bin inserted after Q, as long as P is not
  assign behind_q = inserts - watched_turn - 2'd1;
  logic q_held, p_held;  // inserted and not removed
  assign q_held = q_in_q != '0 && q_out_q == '0;
  assign p_held = p_in_q != '0 && p_out_q == '0;
  always_comb begin
    if (!rst_i && started_q) begin
      assert (held <= HeldBits'(Packets) && 2'(inserts - removes) == held[1:0]);
      if (q_held) assert (q_ahead_q < held && 2'(removes + q_ahead_q[1:0]) == watched_turn);
      if (p_held) assert (p_ahead_q < held && 2'(removes + p_ahead_q[1:0]) == watched_turn);
      if (q_held && p_held) assert (p_ahead_q == q_ahead_q + HeldBits'(4));
      if (q_held && p_in_q == '0) assert (held == q_ahead_q + HeldBits'(1) + HeldBits'(behind_q));
      if (q_out_q != '0 && p_in_q == '0) assert (held <= HeldBits'(behind_q));
      if (alone && p_in_q == '0) assert (inserts <= watched_turn && HeldBits'(inserts) == held + HeldBits'(removes));
      if (p_held && (alone || q_out_q != '0)) assert (p_ahead_q < HeldBits'(4));
      // P is first iff Q was removed before.
      if (p_in_q != '0 && alone) assert (p_first_q);
      if (p_in_q != '0 && !alone && p_first_q) assert (before(q_out_q, p_in_q, 4'd1));
      if (p_in_q != '0 && !p_first_q) assert (!alone && (q_out_q == '0 || q_out_q == Old || q_out_q <= p_in_q));
    end
  end

  // The memories, once an operation has written them.
  always_comb begin
    if (!rst_i && started_q) begin
      if (q_in_q >= 4'd6 && p_in_q <= 4'd5) assert (tail == q_node);
      if (p_in_q >= 4'd6 && !p_first_q && q_out_q <= 4'd8) assert (link == p_node);
      if (p_in_q >= 4'd6 && p_first_q && p_out_q <= 4'd5) assert (first == p_node);
      if (q_out_q >= 4'd10 && p_out_q <= 4'd9) assert (head[NodeBits] == (p_in_q != '0 && !p_first_q));
      if (q_out_q >= 4'd10 && p_out_q <= 4'd9 && head[NodeBits]) assert (head[NodeBits-1:0] == p_node);
      if (alone && p_out_q <= 4'd9 && walk > {1'b0, watched_bin, watched_turn}) assert (!head[NodeBits]);
      if (p_in_q >= 4'd3 && p_out_q <= 4'd8) assert (pool == p_packet_q);
    end
  end
endmodule
