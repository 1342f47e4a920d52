// SPDX-License-Identifier: Apache-2.0
// Count pairs of a node and a slot, nodes First .. First + Count - 1, slots 0 .. Count - 1. One of each is handed out with
// take_i, to be found at node_o and slot_o two cycles later, until it is given back with whatever partner: first in
// ascending order, then in the order of their return. There is no empty signal: its owner never has more than Count - 4
// pairs out, so the pair read came back at least two cycles ago.
module free_list #(
    parameter int unsigned Count = 16,
    parameter int unsigned First = 0,
    localparam int unsigned NodeBits = $clog2(First + Count),
    localparam int unsigned SlotBits = $clog2(Count)
) (
    input  logic                clk_i,
    input  logic                rst_i,
    input  logic                take_i,
    output logic [NodeBits-1:0] node_o,
    output logic [SlotBits-1:0] slot_o,
    input  logic                give_i,
    input  logic [NodeBits-1:0] node_i,
    input  logic [SlotBits-1:0] slot_i
);
  localparam logic [SlotBits-1:0] Last = SlotBits'(Count - 1);

  logic [SlotBits-1:0] head_q, tail_q, fresh_slot_q, fresh_slot2_q, returned_slot;
  logic [NodeBits-1:0] fresh_node_q, fresh_node2_q, returned_node;
  logic first_round_q, fresh_q, fresh2_q;

  pool_ram #(
      .Width(NodeBits + SlotBits),
      .Depth(Count)
  ) ring (
      .clk_i(clk_i),
      .write_i(give_i),
      .write_address_i(tail_q),
      .write_data_i({node_i, slot_i}),
      .read_address_i(head_q),
      .read_data_o({returned_node, returned_slot})
  );

  assign node_o = fresh2_q ? fresh_node2_q : returned_node;
  assign slot_o = fresh2_q ? fresh_slot2_q : returned_slot;

  always_ff @(posedge clk_i) begin
    fresh_node_q <= NodeBits'(First) + NodeBits'(head_q);
    fresh_slot_q <= head_q;
    fresh_q <= first_round_q;
    fresh_node2_q <= fresh_node_q;
    fresh_slot2_q <= fresh_slot_q;
    fresh2_q <= fresh_q;
    if (take_i) begin
      head_q <= head_q == Last ? '0 : head_q + 1'b1;
      if (head_q == Last) first_round_q <= 1'b0;
    end
    if (give_i) tail_q <= tail_q == Last ? '0 : tail_q + 1'b1;
    if (rst_i) begin
      head_q <= '0;
      tail_q <= '0;
      first_round_q <= 1'b1;
    end
  end
endmodule
