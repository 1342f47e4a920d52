// SPDX-License-Identifier: Apache-2.0
// Inner nodes: a ring of three stages through the node memory, so three descents share it at one node a cycle. A
// descent enters at any node, goes to the near child of each inner node and leaves at a leaf; every far child is
// pushed on its query's stack with its offsets and its scaled squared distance. Mirrors the inner-node step of the
// search in golden/unit/photon_gatherer.cpp.
//
//   stage 0  node memory address     1  its output; query and offsets     2  compare, choose, near child back to 0
//   behind it, without stall: |q - split| | squares | sum | (factor E) | stack write
//
// An entry is in the stack 6 cycles after its node's stage 2; its query takes longer to come back from the leaf.
module photon_gatherer_nodes #(
    parameter int unsigned PositionBits = 16,
    parameter int unsigned LineBits = 13,
    parameter int unsigned Contexts = 16,
    parameter int unsigned NodeWords = 8192,
    parameter int unsigned CausticBase = 8192,
    parameter int unsigned EpsilonFactor = 1,
    parameter int unsigned StackBits = 5,      // of a stack pointer
    parameter int unsigned DistanceBits = 34,  // of a scaled squared distance
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned NodeBits = LineBits + 1,
    localparam int unsigned NodeAddressBits = NodeWords > 1 ? $clog2(NodeWords) : 1,
    localparam int unsigned EntryBits = 1 + NodeBits + 3 * PositionBits + DistanceBits
) (
    input  logic                       clk_i,
    input  logic                       rst_i,
    // node memory, written while idle
    input  logic                       node_write_i,
    input  logic [NodeAddressBits-1:0] node_address_i,
    input  logic [   PositionBits+1:0] node_data_i,      // axis, split
    // context state, read by context in stage 1
    output logic [    ContextBits-1:0] context_o,
    input  logic [ 3*PositionBits-1:0] query_i,
    input  logic [ 3*PositionBits-1:0] offsets_i,
    input  logic                       map_i,
    input  logic [         LineBits:0] lines_i,          // of that map
    // a descent enters at an inner node
    input  logic                       in_valid_i,
    output logic                       in_ready_o,
    input  logic [    ContextBits-1:0] in_context_i,
    input  logic                       in_map_i,
    input  logic [       NodeBits-1:0] in_node_i,
    input  logic [      StackBits-1:0] in_stack_i,
    // and leaves at a line
    output logic                       leaf_valid_o,
    output logic [    ContextBits-1:0] leaf_context_o,
    output logic [       LineBits-1:0] leaf_line_o,
    output logic [      StackBits-1:0] leaf_stack_o,
    // one node done
    output logic                       step_o,
    output logic [    ContextBits-1:0] step_context_o,
    // stack
    output logic                       push_o,
    output logic [    ContextBits-1:0] push_context_o,
    output logic [      StackBits-1:0] push_stack_o,
    output logic [      EntryBits-1:0] push_entry_o      // is a leaf, node, offsets, scaled distance
);
  localparam int unsigned P = PositionBits;

  // ---- stage 0 ----
  logic valid_0_q, map_0_q;
  logic [ContextBits-1:0] context_0_q;
  logic [NodeBits-1:0] node_0_q;
  logic [StackBits-1:0] stack_0_q;
  logic [P+1:0] node_data;
  logic loop;

  block_ram #(
      .Width(P + 2),
      .Depth(NodeWords)
  ) nodes (
      .clk_i(clk_i),
      .write_i(node_write_i),
      .write_address_i(node_address_i),
      .write_data_i(node_data_i),
      .read_i(1'b1),
      .read_address_i(NodeAddressBits'(node_0_q) + (map_0_q ? NodeAddressBits'(CausticBase) : '0)),
      .read_data_o(node_data)
  );

  // ---- stage 1 ----
  logic valid_1_q;
  logic [ContextBits-1:0] context_1_q;
  logic [NodeBits-1:0] node_1_q;
  logic [StackBits-1:0] stack_1_q;
  logic signed [NodeBits+1:0] line_1;  // of the left child, were it a leaf

  assign context_o = context_1_q;
  assign line_1 = signed'({1'b0, node_1_q, 1'b0}) - signed'((NodeBits + 2)'(lines_i));

  // ---- stage 2 ----
  logic valid_2_q, map_2_q, left_leaf_2_q, right_leaf_2_q;
  logic [ContextBits-1:0] context_2_q;
  logic [NodeBits-2:0] node_2_q;  // inner nodes are the lower half of the numbers
  logic [StackBits-1:0] stack_2_q;
  logic [LineBits-1:0] line_2_q;
  logic [3*P-1:0] query_2_q, offsets_2_q, offsets;
  logic [P-1:0] split_2_q, coordinate, difference;
  logic [1:0] axis_2_q;
  logic right, near_leaf;

  always_ff @(posedge clk_i) begin
    valid_0_q <= loop || in_valid_i;
    if (loop) begin
      context_0_q <= context_2_q;
      map_0_q <= map_2_q;
      node_0_q <= {node_2_q, right};
      stack_0_q <= stack_2_q + 1'b1;
    end else begin
      context_0_q <= in_context_i;
      map_0_q <= in_map_i;
      node_0_q <= in_node_i;
      stack_0_q <= in_stack_i;
    end

    valid_1_q <= valid_0_q;
    context_1_q <= context_0_q;
    node_1_q <= node_0_q;
    stack_1_q <= stack_0_q;

    valid_2_q <= valid_1_q;
    context_2_q <= context_1_q;
    map_2_q <= map_i;
    node_2_q <= node_1_q[NodeBits-2:0];
    stack_2_q <= stack_1_q;
    query_2_q <= query_i;
    offsets_2_q <= offsets_i;
    {axis_2_q, split_2_q} <= node_data;
    line_2_q <= line_1[LineBits-1:0];
    left_leaf_2_q <= !line_1[NodeBits+1];
    right_leaf_2_q <= !line_1[NodeBits+1] || line_1 == '1;

    if (rst_i) begin
      valid_0_q <= 1'b0;
      valid_1_q <= 1'b0;
      valid_2_q <= 1'b0;
    end
  end

  always_comb begin
    unique case (axis_2_q)
      2'd0: coordinate = query_2_q[0+:P];
      2'd1: coordinate = query_2_q[P+:P];
      default: coordinate = query_2_q[2*P+:P];
    endcase
    right = coordinate >= split_2_q;
    difference = right ? coordinate - split_2_q : split_2_q - coordinate;
    offsets = offsets_2_q;
    unique case (axis_2_q)
      2'd0: offsets[0+:P] = difference;
      2'd1: offsets[P+:P] = difference;
      default: offsets[2*P+:P] = difference;
    endcase
  end

  assign near_leaf = right ? right_leaf_2_q : left_leaf_2_q;
  assign loop = valid_2_q && !near_leaf;
  assign in_ready_o = !loop;
  assign leaf_valid_o = valid_2_q && near_leaf;
  assign leaf_context_o = context_2_q;
  assign leaf_line_o = line_2_q + LineBits'(right);
  assign leaf_stack_o = stack_2_q + 1'b1;
  assign step_o = valid_2_q;
  assign step_context_o = context_2_q;

  // ---- the far child, behind the ring ----
  localparam int unsigned Behind = 4;  // stages from 3 to the scaled distance
  localparam int unsigned SubtreeBits = 1 + NodeBits + 3 * P;
  localparam int unsigned RideBits = ContextBits + StackBits + SubtreeBits;

  logic [Behind-1:0] push_valid_q;
  logic [RideBits-1:0] ride_q[0:Behind-1];
  logic [3*P-1:0] ride_offsets;
  logic [2*P+1:0] distance;
  logic [DistanceBits-1:0] scaled_q;

  assign ride_offsets = ride_q[0][3*P-1:0];

  squared_distance #(
      .Bits(P + 1)
  ) square (
      .clk_i(clk_i),
      .offset_i({1'b0, ride_offsets[2*P+:P], 1'b0, ride_offsets[P+:P], 1'b0, ride_offsets[0+:P]}),
      .sum_o(distance)
  );

  always_ff @(posedge clk_i) begin
    push_valid_q <= {push_valid_q[Behind-2:0], valid_2_q};
    ride_q[0] <= {context_2_q, stack_2_q, right ? left_leaf_2_q : right_leaf_2_q, node_2_q, !right, offsets};
    for (int unsigned i = 1; i < Behind; i++) ride_q[i] <= ride_q[i-1];
    scaled_q <= DistanceBits'(distance) * DistanceBits'(EpsilonFactor);
    if (rst_i) push_valid_q <= '0;
  end

  assign push_o = push_valid_q[Behind-1];
  assign push_context_o = ride_q[Behind-1][SubtreeBits+StackBits+:ContextBits];
  assign push_stack_o = ride_q[Behind-1][SubtreeBits+:StackBits];
  assign push_entry_o = {ride_q[Behind-1][SubtreeBits-1:0], scaled_q};
endmodule
