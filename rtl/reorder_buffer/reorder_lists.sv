// SPDX-License-Identifier: Apache-2.0
// The pool: packets in block RAM, linked into one FIFO per bin. One insertion and one removal a cycle, of any bins, the
// same included; nothing ever waits. A removal may be asked for in the cycle of the insertion of the very packet that it
// takes. out_valid_o comes 8 cycles after remove_i.
//
// A bin is four lists used in turn, so that a bin's list is touched again four operations later at the earliest: only a
// head can then be read while it is written, and is forwarded. A list always ends in an empty node that waits for its next
// packet: an insertion fills it and links a new one, so it never looks at the head, a removal never at the tail, and
// neither asks whether a list is empty (who removes knows that there is a packet).
//
//   cycle  insertion                    removal
//     0    which of the four lists      which of the four lists
//     1    read tail, write whose turn  write whose turn
//     2    -                            read head
//     3    write link, packet, tail     -
//     4                                 read link of head (the packet's own insertion wrote it in cycle 3)
//     6                                 write head, read packet, give node and slot back
//     8                                 packet at out_o
module reorder_lists #(
    parameter int unsigned Width = 64,
    parameter int unsigned Packets = 2048,
    parameter int unsigned Bins = 512,
    parameter int unsigned BinBits = 9  // at least log2(Bins)
) (
    input  logic               clk_i,
    input  logic               rst_i,
    output logic               ready_o,        // 0 for 4 * Bins cycles after reset
    input  logic               insert_i,
    input  logic [BinBits-1:0] insert_bin_i,
    input  logic [  Width-1:0] insert_packet_i,
    input  logic               remove_i,
    input  logic [BinBits-1:0] remove_bin_i,
    output logic               out_valid_o,
    output logic [  Width-1:0] out_o
);
  localparam int unsigned Lists = 4;
  localparam int unsigned ListBits = $clog2(Bins) + 2;
  // Numbers come back some cycles after the packet has left the count of packets held.
  localparam int unsigned Slack = 16;
  localparam int unsigned Slots = Packets + Slack;
  localparam int unsigned SlotBits = $clog2(Slots);
  localparam int unsigned Nodes = Lists * Bins + Packets + Slack;
  localparam int unsigned NodeBits = $clog2(Nodes);
  localparam int unsigned IndexBits = ListBits - 2 > 0 ? ListBits - 2 : 1;

  // After reset list l holds the empty node l alone.
  logic [ListBits:0] walk_q;
  logic walking;
  assign walking = !walk_q[ListBits];
  assign ready_o = !walking;

  always_ff @(posedge clk_i) begin
    if (walking) walk_q <= walk_q + 1'b1;
    if (rst_i) walk_q <= '0;
  end

  // Turns: which of its lists a bin fills and empties next; written a cycle after they were read.
  logic [1:0] insert_stored, remove_stored, insert_turn, remove_turn, insert_next, remove_next;
  logic [IndexBits-1:0] insert_index, remove_index, insert_index1, remove_index1;
  logic [ListBits-1:0] insert_list, remove_list;
  logic insert1_q, insert2_q, insert3_q;
  logic [ListBits-1:0] insert_list1_q, insert_list2_q, insert_list3_q;
  logic [6:0] remove_q;  // bit n is cycle n + 1
  logic [ListBits-1:0] remove_list1_q, remove_list2_q, remove_list3_q, remove_list4_q, remove_list5_q, remove_list6_q;

  assign insert_index = IndexBits'(insert_bin_i);
  assign remove_index = IndexBits'(remove_bin_i);
  assign insert_index1 = IndexBits'(insert_list1_q >> 2);
  assign remove_index1 = IndexBits'(remove_list1_q >> 2);
  assign insert_next = insert_list1_q[1:0] + 2'd1;
  assign remove_next = remove_list1_q[1:0] + 2'd1;
  assign insert_turn = insert1_q && insert_index1 == insert_index ? insert_next : insert_stored;
  assign remove_turn = remove_q[0] && remove_index1 == remove_index ? remove_next : remove_stored;
  if (Bins > 1) begin : gen_lists
    assign insert_list = {insert_index, insert_turn};
    assign remove_list = {remove_index, remove_turn};
  end else begin : gen_list
    assign insert_list = insert_turn;
    assign remove_list = remove_turn;
  end
  if (BinBits > IndexBits) begin : gen_unused
    logic unused;
    assign unused = &{1'b0, insert_bin_i[BinBits-1:IndexBits], remove_bin_i[BinBits-1:IndexBits]};
  end

  lut_ram #(
      .Width(2),
      .Depth(Bins)
  ) insert_turns (
      .clk_i(clk_i),
      .write_i(walking || insert1_q),
      .write_address_i(walking ? walk_q[IndexBits-1:0] : insert_index1),
      .write_data_i(walking ? 2'd0 : insert_next),
      .read_address_i(insert_index),
      .read_data_o(insert_stored)
  );
  lut_ram #(
      .Width(2),
      .Depth(Bins)
  ) remove_turns (
      .clk_i(clk_i),
      .write_i(walking || remove_q[0]),
      .write_address_i(walking ? walk_q[IndexBits-1:0] : remove_index1),
      .write_data_i(walking ? 2'd0 : remove_next),
      .read_address_i(remove_index),
      .read_data_o(remove_stored)
  );

  // Insertion.
  logic [Width-1:0] packet1_q, packet2_q, packet3_q;
  logic [NodeBits-1:0] tail_read, tail_q, new_node;
  logic [SlotBits-1:0] new_slot;

  always_ff @(posedge clk_i) begin
    insert1_q <= insert_i;
    insert2_q <= insert1_q;
    insert3_q <= insert2_q;
    insert_list1_q <= insert_list;
    insert_list2_q <= insert_list1_q;
    insert_list3_q <= insert_list2_q;
    packet1_q <= insert_packet_i;
    packet2_q <= packet1_q;
    packet3_q <= packet2_q;
    tail_q <= tail_read;
    if (rst_i) begin
      insert1_q <= 1'b0;
      insert2_q <= 1'b0;
      insert3_q <= 1'b0;
    end
  end

  block_ram #(
      .Width(NodeBits),
      .Depth(Lists * Bins)
  ) tails (
      .clk_i(clk_i),
      .write_i(walking || insert3_q),
      .write_address_i(walking ? walk_q[ListBits-1:0] : insert_list3_q),
      .write_data_i(walking ? NodeBits'(walk_q) : new_node),
      .read_i(1'b1),
      .read_address_i(insert_list1_q),
      .read_data_o(tail_read)
  );

  // Removal.
  logic [NodeBits-1:0] head_read, head4_q, head5_q, head6_q, next6, next7_q;
  logic head_known_q;  // the list is the one whose head was written meanwhile
  logic [SlotBits-1:0] slot6;

  always_ff @(posedge clk_i) begin
    remove_q <= {remove_q[5:0], remove_i};
    remove_list1_q <= remove_list;
    remove_list2_q <= remove_list1_q;
    remove_list3_q <= remove_list2_q;
    remove_list4_q <= remove_list3_q;
    remove_list5_q <= remove_list4_q;
    remove_list6_q <= remove_list5_q;
    head_known_q <= remove_q[5] && remove_list6_q == remove_list2_q;
    head4_q <= head_known_q ? next7_q : head_read;
    head5_q <= head4_q;
    head6_q <= head5_q;
    next7_q <= next6;
    out_valid_o <= remove_q[6];
    if (rst_i) begin
      remove_q <= '0;
      out_valid_o <= 1'b0;
    end
  end

  block_ram #(
      .Width(NodeBits),
      .Depth(Lists * Bins)
  ) heads (
      .clk_i(clk_i),
      .write_i(walking || remove_q[5]),
      .write_address_i(walking ? walk_q[ListBits-1:0] : remove_list6_q),
      .write_data_i(walking ? NodeBits'(walk_q) : next6),
      .read_i(1'b1),
      .read_address_i(remove_list2_q),
      .read_data_o(head_read)
  );

  pool_ram #(
      .Width(SlotBits + NodeBits),
      .Depth(Nodes)
  ) links (
      .clk_i(clk_i),
      .write_i(insert3_q),
      .write_address_i(tail_q),
      .write_data_i({new_slot, new_node}),
      .read_address_i(head4_q),
      .read_data_o({slot6, next6})
  );

  pool_ram #(
      .Width(Width),
      .Depth(Slots)
  ) pool (
      .clk_i(clk_i),
      .write_i(insert3_q),
      .write_address_i(new_slot),
      .write_data_i(packet3_q),
      .read_address_i(slot6),
      .read_data_o(out_o)
  );

  free_list #(
      .Count(Slots),
      .First(Lists * Bins)
  ) free_pairs (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .take_i(insert1_q),
      .node_o(new_node),
      .slot_o(new_slot),
      .give_i(remove_q[5]),
      .node_i(head6_q),
      .slot_i(slot6)
  );
endmodule
