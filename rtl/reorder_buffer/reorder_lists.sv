// SPDX-License-Identifier: Apache-2.0
// The pool: packets in block RAM, linked into one FIFO per bin. One insertion and one removal a cycle, of any bins, the
// same included; nothing ever waits. A removal may be asked for in the cycle of the insertion of the very packet that it
// takes. out_valid_o comes 9 cycles after remove_i.
//
// A bin is four lists used in turn, so that a bin's list is touched again four operations later at the earliest: only a
// head can then be read while it is written, and is forwarded. A packet that enters an empty list becomes its first, any
// other is linked to the list's tail; where a removal leaves no packet linked behind its own, the list's next packet will
// be a first again. Both sides know which it is from reorder_counts, in one order of all operations, an insertion before
// the removal of its cycle. So firsts, tails and links are written by insertions alone, heads by removals alone.
//
//   cycle  insertion                    removal
//     0    reorder_counts, take a node  reorder_counts
//     2    write packet                 -
//     3    read tail                    -
//     5    write first or link, tail    read head and first (its own insertion may be writing that)
//     7    -                            read packet, read link
//     8    -                            give node back
//     9    -                            write head; packet at out_o
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
  localparam int unsigned Lists = 4 * Bins;
  localparam int unsigned ListBits = $clog2(Lists);
  localparam int unsigned IndexBits = Bins > 1 ? ListBits - 2 : 1;
  // Nodes come back some cycles after the packet has left the count of packets held.
  localparam int unsigned Slack = 16;
  localparam int unsigned Nodes = Packets + Slack;
  localparam int unsigned NodeBits = $clog2(Nodes);

  // After reset nothing is linked behind what was removed from any list.
  logic [ListBits:0] walk_q;
  logic walking;
  assign walking = !walk_q[ListBits];
  assign ready_o = !walking;

  always_ff @(posedge clk_i) begin
    if (walking) walk_q <= walk_q + 1'b1;
    if (rst_i) walk_q <= '0;
  end

  logic [1:0] insert_turn3, remove_turn3;
  logic [IndexBits-1:0] insert_index3, remove_index3;
  logic [ListBits-1:0] insert_list3, remove_list3;
  logic first5;  // the insertion's list was empty
  logic linked5;  // a packet is linked behind the one that is removed

  reorder_counts #(
      .Packets(Packets),
      .Bins(Bins)
  ) counts (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .clear_i(walking),
      .clear_bin_i(walk_q[IndexBits-1:0]),
      .insert_i(insert_i),
      .insert_bin_i(IndexBits'(insert_bin_i)),
      .remove_i(remove_i),
      .remove_bin_i(IndexBits'(remove_bin_i)),
      .insert_bin_o(insert_index3),
      .insert_turn_o(insert_turn3),
      .first_o(first5),
      .remove_bin_o(remove_index3),
      .remove_turn_o(remove_turn3),
      .linked_o(linked5)
  );
  if (Bins > 1) begin : gen_lists
    assign insert_list3 = {insert_index3, insert_turn3};
    assign remove_list3 = {remove_index3, remove_turn3};
  end else begin : gen_list
    assign insert_list3 = insert_turn3;
    assign remove_list3 = remove_turn3;
    logic unused;
    assign unused = &{1'b0, insert_index3, remove_index3};
  end
  if (BinBits > IndexBits) begin : gen_unused
    logic unused;
    assign unused = &{1'b0, insert_bin_i[BinBits-1:IndexBits], remove_bin_i[BinBits-1:IndexBits]};
  end

  // Insertion.
  logic [4:0] insert_q;  // bit n is cycle n + 1
  logic [Width-1:0] packet1_q, packet2_q;
  logic [ListBits-1:0] insert_list4_q, insert_list5_q;
  logic [NodeBits-1:0] tail_read, tail5_q, node2, node3_q, node4_q, node5_q;

  always_ff @(posedge clk_i) begin
    insert_q <= {insert_q[3:0], insert_i};
    packet1_q <= insert_packet_i;
    packet2_q <= packet1_q;
    node3_q <= node2;
    node4_q <= node3_q;
    node5_q <= node4_q;
    insert_list4_q <= insert_list3;
    insert_list5_q <= insert_list4_q;
    tail5_q <= tail_read;
    if (rst_i) insert_q <= '0;
  end

  block_ram #(
      .Width(NodeBits),
      .Depth(Lists)
  ) tails (
      .clk_i(clk_i),
      .write_i(insert_q[4]),
      .write_address_i(insert_list5_q),
      .write_data_i(node5_q),
      .read_i(1'b1),
      .read_address_i(insert_list3),
      .read_data_o(tail_read)
  );

  // Removal.
  logic [8:0] remove_q;  // bit n is cycle n + 1
  logic [ListBits-1:0] remove_list4_q, remove_list5_q, remove_list6_q, remove_list7_q, remove_list8_q, remove_list9_q;
  logic linked6_q, linked7_q, linked8_q, linked9_q, linked10_q, linked11_q;
  logic [NodeBits-1:0] first_read, first7_q, head_read, head7_q, head7, head8_q, next9, next10_q, next11_q;
  logic is_linked_read, is_linked7_q;
  logic same_list5_q, first_known6_q, first_known7_q;  // the first is the node of the cycle's insertion
  logic head_known6_q, head_known7_q;  // the list is the one whose head was written meanwhile
  logic [NodeBits-1:0] node6_q, node7_q;

  assign head7 = (head_known7_q ? linked11_q : is_linked7_q) ? (head_known7_q ? next11_q : head7_q) :
      (first_known7_q ? node7_q : first7_q);
  assign out_valid_o = remove_q[8];

  always_ff @(posedge clk_i) begin
    remove_q <= {remove_q[7:0], remove_i};
    remove_list4_q <= remove_list3;
    remove_list5_q <= remove_list4_q;
    remove_list6_q <= remove_list5_q;
    remove_list7_q <= remove_list6_q;
    remove_list8_q <= remove_list7_q;
    remove_list9_q <= remove_list8_q;
    linked6_q <= linked5;
    linked7_q <= linked6_q;
    linked8_q <= linked7_q;
    linked9_q <= linked8_q;
    linked10_q <= linked9_q;
    linked11_q <= linked10_q;
    same_list5_q <= insert_q[3] && insert_list4_q == remove_list4_q;
    first_known6_q <= same_list5_q && first5;
    first_known7_q <= first_known6_q;
    node6_q <= node5_q;
    node7_q <= node6_q;
    head_known6_q <= remove_q[8] && remove_list9_q == remove_list5_q;
    head_known7_q <= head_known6_q;
    first7_q <= first_read;
    {is_linked7_q, head7_q} <= {is_linked_read, head_read};
    head8_q <= head7;
    next10_q <= next9;
    next11_q <= next10_q;
    if (rst_i) remove_q <= '0;
  end

  block_ram #(
      .Width(NodeBits),
      .Depth(Lists)
  ) firsts (
      .clk_i(clk_i),
      .write_i(insert_q[4] && first5),
      .write_address_i(insert_list5_q),
      .write_data_i(node5_q),
      .read_i(1'b1),
      .read_address_i(remove_list5_q),
      .read_data_o(first_read)
  );

  block_ram #(
      .Width(1 + NodeBits),
      .Depth(Lists)
  ) heads (
      .clk_i(clk_i),
      .write_i(walking || remove_q[8]),
      .write_address_i(walking ? walk_q[ListBits-1:0] : remove_list9_q),
      .write_data_i({!walking && linked9_q, next9}),
      .read_i(1'b1),
      .read_address_i(remove_list5_q),
      .read_data_o({is_linked_read, head_read})
  );

  pool_ram #(
      .Width(NodeBits),
      .Depth(Nodes)
  ) links (
      .clk_i(clk_i),
      .write_i(insert_q[4] && !first5),
      .write_address_i(tail5_q),
      .write_data_i(node5_q),
      .read_address_i(head7),
      .read_data_o(next9)
  );

  pool_ram #(
      .Width(Width),
      .Depth(Nodes)
  ) pool (
      .clk_i(clk_i),
      .write_i(insert_q[1]),
      .write_address_i(node2),
      .write_data_i(packet2_q),
      .read_address_i(head7),
      .read_data_o(out_o)
  );

  free_list #(
      .Count(Nodes)
  ) free_nodes (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .take_i(insert_i),
      .number_o(node2),
      .give_i(remove_q[7]),
      .number_i(head8_q)
  );
endmodule
