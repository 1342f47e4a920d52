// SPDX-License-Identifier: Apache-2.0
// Inner nodes: a ring of three stages through a port of the node memory, so three descents share it at one node a cycle. A
// descent enters at any inner node, goes to the near child of each and leaves at a leaf; every far child is pushed on
// its query's stack with its offsets and its scaled squared distance. Mirrors the inner-node step of the search in
// golden/unit/photon_gatherer.cpp; offsets are signed here, which their squares do not show.
//
//   stage 0  node memory address     1  its output; query and offsets     2  compare, choose, near child back to 0
//   behind it, without stall: offsets | squares | two sums | (factor E) | stack write; what leaves is registered
//
// An entry is in the stack 6 cycles after its node's stage 2; its query takes longer to come back from the leaf. With Parity
// a word of the node memory has a parity bit, the highest; one that is not right is told a cycle after stage 2.
module photon_gatherer_nodes #(
    parameter int unsigned PositionBits = 16,
    parameter int unsigned LineBits = 13,
    parameter int unsigned Contexts = 16,
    parameter int unsigned NodeWords = 8192,
    parameter int unsigned CausticBase = 8192,
    parameter int unsigned EpsilonFactor = 1,
    parameter int unsigned StackBits = 5,      // of a stack pointer
    parameter int unsigned DistanceBits = 34,  // of a scaled squared distance
    parameter int unsigned Parity = 0,
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned NodeBits = LineBits + 1,
    localparam int unsigned NodeAddressBits = NodeWords > 1 ? $clog2(NodeWords) : 1,
    localparam int unsigned OffsetBits = PositionBits + 1,
    localparam int unsigned EntryBits = 1 + NodeBits + 3 * OffsetBits + DistanceBits
) (
    input  logic                       clk_i,
    input  logic                       rst_i,
    // node memory: the word is there in the cycle after its address
    output logic [NodeAddressBits-1:0] node_address_o,
    input  logic [PositionBits+1+Parity:0] node_data_i,  // axis, split
    // context state, read by context in stage 1
    output logic [    ContextBits-1:0] context_o,
    input  logic [ 3*PositionBits-1:0] query_i,
    input  logic [   3*OffsetBits-1:0] offsets_i,        // not used for a first descent
    output logic                       map_o,
    input  logic [         LineBits:0] lines_i,          // of that map
    // a descent enters at an inner node
    input  logic                       in_valid_i,
    output logic                       in_ready_o,
    input  logic [    ContextBits-1:0] in_context_i,
    input  logic                       in_map_i,
    input  logic                       in_first_i,       // its query's first, at the root
    input  logic [       NodeBits-1:0] in_node_i,
    input  logic [      StackBits-1:0] in_stack_i,
    // and leaves at a line
    output logic                       leaf_valid_o,
    output logic [    ContextBits-1:0] leaf_context_o,
    output logic                       leaf_map_o,
    output logic                       leaf_first_o,
    output logic [       LineBits-1:0] leaf_line_o,
    output logic [      StackBits-1:0] leaf_stack_o,
    output logic [      StackBits-1:0] leaf_steps_o,     // inner nodes of the descent
    // one node done
    output logic                       step_o,
    // its word was not right
    output logic                       wrong_o,
    output logic [    ContextBits-1:0] wrong_context_o,
    // stack
    output logic                       push_o,
    output logic [    ContextBits-1:0] push_context_o,
    output logic [      StackBits-1:0] push_stack_o,
    output logic [      EntryBits-1:0] push_entry_o      // is a leaf, node, offsets, scaled distance
);
  localparam int unsigned P = PositionBits;
  localparam int unsigned F = OffsetBits;

  // ---- stage 0 ----
  logic valid_0_q, map_0_q, first_0_q;
  logic [ContextBits-1:0] context_0_q;
  logic [NodeBits-1:0] node_0_q;
  logic [StackBits-1:0] stack_0_q, start_0_q;
  logic loop;

  assign node_address_o = NodeAddressBits'(node_0_q) + (map_0_q ? NodeAddressBits'(CausticBase) : '0);

  // ---- stage 1 ----
  logic valid_1_q, map_1_q, first_1_q;
  logic [ContextBits-1:0] context_1_q;
  logic [NodeBits-1:0] node_1_q;
  logic [StackBits-1:0] stack_1_q, start_1_q;
  logic signed [NodeBits+1:0] line_1;  // of the left child, were it a leaf

  assign context_o = context_1_q;
  assign map_o = map_1_q;
  assign line_1 = signed'({1'b0, node_1_q, 1'b0}) - signed'((NodeBits + 2)'(lines_i));

  // ---- stage 2 ----
  logic valid_2_q, map_2_q, first_2_q, left_leaf_2_q, right_leaf_2_q;
  logic [ContextBits-1:0] context_2_q;
  logic [NodeBits-2:0] node_2_q;  // inner nodes are the lower half of the numbers
  logic [StackBits-1:0] stack_2_q, start_2_q;
  logic [LineBits-1:0] line_2_q;
  logic [3*P-1:0] query_2_q;
  logic [3*F-1:0] offsets_2_q, difference, offsets;
  logic [P-1:0] split_2_q;
  logic [1:0] axis_2_q;
  logic right, near_leaf;

  always_ff @(posedge clk_i) begin
    valid_0_q <= loop || in_valid_i;
    if (loop) begin
      context_0_q <= context_2_q;
      map_0_q <= map_2_q;
      first_0_q <= first_2_q;
      node_0_q <= {node_2_q, right};
      stack_0_q <= stack_2_q + 1'b1;
      start_0_q <= start_2_q;
    end else begin
      context_0_q <= in_context_i;
      map_0_q <= in_map_i;
      first_0_q <= in_first_i;
      node_0_q <= in_node_i;
      stack_0_q <= in_stack_i;
      start_0_q <= in_stack_i;
    end

    valid_1_q <= valid_0_q;
    context_1_q <= context_0_q;
    map_1_q <= map_0_q;
    first_1_q <= first_0_q;
    node_1_q <= node_0_q;
    stack_1_q <= stack_0_q;
    start_1_q <= start_0_q;

    valid_2_q <= valid_1_q;
    context_2_q <= context_1_q;
    map_2_q <= map_1_q;
    first_2_q <= first_1_q;
    node_2_q <= node_1_q[NodeBits-2:0];
    stack_2_q <= stack_1_q;
    start_2_q <= start_1_q;
    query_2_q <= query_i;
    offsets_2_q <= first_1_q ? '0 : offsets_i;
    {axis_2_q, split_2_q} <= node_data_i[PositionBits+1:0];
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
    for (int unsigned a = 0; a < 3; a++)
      difference[F*a+:F] = {1'b0, query_2_q[P*a+:P]} - {1'b0, split_2_q};
    unique case (axis_2_q)
      2'd0: right = !difference[P];
      2'd1: right = !difference[F+P];
      default: right = !difference[2*F+P];
    endcase
    offsets = offsets_2_q;
    unique case (axis_2_q)
      2'd0: offsets[0+:F] = difference[0+:F];
      2'd1: offsets[F+:F] = difference[F+:F];
      default: offsets[2*F+:F] = difference[2*F+:F];
    endcase
  end

  assign near_leaf = right ? right_leaf_2_q : left_leaf_2_q;
  assign loop = valid_2_q && !near_leaf;
  assign in_ready_o = !loop;

  always_ff @(posedge clk_i) begin
    leaf_valid_o <= valid_2_q && near_leaf;
    leaf_context_o <= context_2_q;
    leaf_map_o <= map_2_q;
    leaf_first_o <= first_2_q;
    leaf_line_o <= line_2_q + LineBits'(right);
    leaf_stack_o <= stack_2_q + 1'b1;
    leaf_steps_o <= stack_2_q + 1'b1 - start_2_q;
    step_o <= valid_2_q;
    if (rst_i) begin
      leaf_valid_o <= 1'b0;
      step_o <= 1'b0;
    end
  end

  if (Parity != 0) begin : gen_parity
    logic parity_2_q;
    always_ff @(posedge clk_i) begin
      parity_2_q <= node_data_i[PositionBits+1+Parity];
      wrong_o <= valid_2_q && ^{parity_2_q, axis_2_q, split_2_q};
      wrong_context_o <= context_2_q;
      if (rst_i) wrong_o <= 1'b0;
    end
  end else begin : gen_no_parity
    assign wrong_o = 1'b0;
    assign wrong_context_o = '0;
  end

  // ---- the far child, behind the ring ----
  localparam int unsigned Behind = 5;  // stages from 3 to the scaled distance
  localparam int unsigned SubtreeBits = 1 + NodeBits + 3 * F;
  localparam int unsigned RideBits = ContextBits + StackBits + SubtreeBits;

  logic [Behind-1:0] push_valid_q;
  logic [RideBits-1:0] ride_q[0:Behind-1];
  logic [2*F-1:0] distance;
  logic [DistanceBits-1:0] scaled_q;

  squared_distance #(
      .Bits(F),
      .Stages(3)
  ) square (
      .clk_i(clk_i),
      .offset_i(ride_q[0][3*F-1:0]),
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
