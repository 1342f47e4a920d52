// SPDX-License-Identifier: Apache-2.0
// Inner nodes, two levels of a descent at once: photon_gatherer_nodes with words of three nodes, one and its two children
// (photon_gatherer_pair_memory). Where a descent is at the upper one of a word, the near child is chosen and, unless that is a leaf,
// its near child too; where it is at one of the lower two, which only where it enters, one level. So nodes take little more than
// half of the steps, and of the cycles that a descent takes. Order, entries of the stack and counts are those of
// photon_gatherer_nodes. Mirrors two inner-node steps of the search in golden/unit/photon_gatherer.cpp.
//
//   stage 0  level and address of the word     1  its output; the query's coordinates on its axes; which descendants are leaves
//   stage 2  three comparisons, two choices, the near descendant back to 0
//   behind it, without stall: offsets | squares | two sums | (factor E) | stack write, for each bank of the stack; what leaves is
//   registered
//
// Entries are in the stack 6 cycles after their nodes' stage 2. With Parity each node of a word has a parity bit, the highest; one
// that was used and is not right is told a cycle after stage 2.
module photon_gatherer_node_pairs #(
    parameter int unsigned PositionBits = 16,
    parameter int unsigned LineBits = 13,
    parameter int unsigned Contexts = 16,
    parameter int unsigned AddressBits = 12,
    parameter int unsigned CausticBase = 4096,  // of its words
    parameter int unsigned GlobalUpper = 1,     // levels of a map's upper nodes: 0 even, 1 odd
    parameter int unsigned CausticUpper = 1,
    parameter int unsigned EpsilonFactor = 1,
    parameter int unsigned StackBits = 5,      // of a stack pointer
    parameter int unsigned DistanceBits = 34,  // of a scaled squared distance
    parameter int unsigned Parity = 0,
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned NodeBits = LineBits + 1,
    localparam int unsigned OffsetBits = PositionBits + 1,
    localparam int unsigned WordBits = PositionBits + 2 + Parity,
    localparam int unsigned EntryBits = 1 + NodeBits + 3 * OffsetBits + DistanceBits
) (
    input  logic                   clk_i,
    input  logic                   rst_i,
    // node memory: the word is there in the cycle after its address
    output logic [AddressBits-1:0] node_address_o,
    input  logic [ 3*WordBits-1:0] node_data_i,    // of the upper, the left, the right one: axis, split
    // context state, read by context in stage 1
    output logic [ContextBits-1:0] context_o,
    input  logic [3*PositionBits-1:0] query_i,
    input  logic [ 3*OffsetBits-1:0] offsets_i,    // not used for a first descent
    output logic                   map_o,
    input  logic [     LineBits:0] lines_i,        // of that map
    // a descent enters at an inner node
    input  logic                   in_valid_i,
    output logic                   in_ready_o,
    input  logic [ContextBits-1:0] in_context_i,
    input  logic                   in_map_i,
    input  logic                   in_first_i,     // its query's first, at the root
    input  logic [   NodeBits-1:0] in_node_i,
    input  logic [  StackBits-1:0] in_stack_i,
    // and leaves at a line
    output logic                   leaf_valid_o,
    output logic [ContextBits-1:0] leaf_context_o,
    output logic                   leaf_map_o,
    output logic                   leaf_first_o,
    output logic [   LineBits-1:0] leaf_line_o,
    output logic [  StackBits-1:0] leaf_stack_o,
    output logic [  StackBits-1:0] leaf_steps_o,   // inner nodes of the descent
    // one node done, a second one
    output logic                   step_o,
    output logic                   step_second_o,
    // a word was not right
    output logic                   wrong_o,
    output logic [ContextBits-1:0] wrong_context_o,
    // stack
    output logic                   push_o,
    output logic [ContextBits-1:0] push_context_o,
    output logic [  StackBits-1:0] push_stack_o,   // of the first one
    output logic [  2*EntryBits:0] push_entry_o    // whether there are two, one for each bank: is a leaf, node, offsets, scaled distance
);
  localparam int unsigned P = PositionBits;
  localparam int unsigned F = OffsetBits;

  // ---- stage 0 ----
  logic valid_0_q, map_0_q, first_0_q, odd_0, upper_0;
  logic [ContextBits-1:0] context_0_q;
  logic [NodeBits-1:0] node_0_q;
  logic [StackBits-1:0] stack_0_q, start_0_q;
  logic loop;

  // A node's level is the number of its highest bit.
  always_comb begin
    odd_0 = 1'b0;
    for (int unsigned i = 0; i < NodeBits; i++) if (node_0_q[i]) odd_0 = i % 2 == 1;
  end
  assign upper_0 = odd_0 == (map_0_q ? CausticUpper != 0 : GlobalUpper != 0);
  assign node_address_o = AddressBits'(upper_0 ? node_0_q : node_0_q >> 1) + (map_0_q ? AddressBits'(CausticBase) : '0);

  // ---- stage 1 ----
  logic valid_1_q, map_1_q, first_1_q, upper_1_q;
  logic [ContextBits-1:0] context_1_q;
  logic [NodeBits-1:0] node_1_q;
  logic [StackBits-1:0] stack_1_q, start_1_q;
  logic signed [NodeBits+2:0] child_1, grandchild_1;  // lines of the first ones, were they leaves
  logic [WordBits-1:0] upper_word, left_word, right_word, node_word;
  logic [1:0] axis_1[0:2];
  logic [P-1:0] coordinate_1[0:2];

  assign context_o = context_1_q;
  assign map_o = map_1_q;
  assign child_1 = signed'({2'b00, node_1_q, 1'b0}) - signed'((NodeBits + 3)'(lines_i));
  assign grandchild_1 = signed'({1'b0, node_1_q, 2'b00}) - signed'((NodeBits + 3)'(lines_i));
  assign {right_word, left_word, upper_word} = node_data_i;
  assign node_word = upper_1_q ? upper_word : node_1_q[0] ? right_word : left_word;
  assign axis_1[0] = node_word[P+:2];
  assign axis_1[1] = left_word[P+:2];
  assign axis_1[2] = right_word[P+:2];
  for (genvar w = 0; w < 3; w++) begin : gen_coordinate
    assign coordinate_1[w] = axis_1[w] == 2'd0 ? query_i[0+:P] : axis_1[w] == 2'd1 ? query_i[P+:P] : query_i[2*P+:P];
  end

  // ---- stage 2 ----
  logic valid_2_q, map_2_q, first_2_q, upper_2_q;
  logic [1:0] child_leaf_2_q;
  logic [3:0] grandchild_leaf_2_q;
  logic [ContextBits-1:0] context_2_q;
  logic [NodeBits-2:0] node_2_q;  // inner nodes are the lower half of the numbers
  logic [StackBits-1:0] stack_2_q, start_2_q, next_stack;
  logic [LineBits-1:0] child_2_q, grandchild_2_q;
  logic [P-1:0] coordinate_2_q[0:2];
  logic [3*F-1:0] offsets_2_q;
  logic [P-1:0] split_2_q[0:2];  // of the node, of its left, its right child
  logic [1:0] axis_2_q[0:2];
  logic [F-1:0] difference[0:2];
  logic [2:0] right;
  logic second, right_2, child_leaf, grandchild_leaf;

  always_ff @(posedge clk_i) begin
    valid_0_q <= loop || in_valid_i;
    if (loop) begin
      context_0_q <= context_2_q;
      map_0_q <= map_2_q;
      first_0_q <= first_2_q;
      node_0_q <= second ? NodeBits'({node_2_q, right[0], right_2}) : {node_2_q, right[0]};
      stack_0_q <= next_stack;
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
    upper_1_q <= upper_0;
    stack_1_q <= stack_0_q;
    start_1_q <= start_0_q;

    valid_2_q <= valid_1_q;
    context_2_q <= context_1_q;
    map_2_q <= map_1_q;
    first_2_q <= first_1_q;
    node_2_q <= node_1_q[NodeBits-2:0];
    upper_2_q <= upper_1_q;
    stack_2_q <= stack_1_q;
    start_2_q <= start_1_q;
    for (int unsigned w = 0; w < 3; w++) coordinate_2_q[w] <= coordinate_1[w];
    offsets_2_q <= first_1_q ? '0 : offsets_i;
    {axis_2_q[0], split_2_q[0]} <= node_word[P+1:0];
    {axis_2_q[1], split_2_q[1]} <= left_word[P+1:0];
    {axis_2_q[2], split_2_q[2]} <= right_word[P+1:0];
    child_2_q <= child_1[LineBits-1:0];
    grandchild_2_q <= grandchild_1[LineBits-1:0];
    for (int unsigned i = 0; i < 2; i++) child_leaf_2_q[i] <= child_1 >= -signed'((NodeBits + 3)'(i));
    for (int unsigned i = 0; i < 4; i++) grandchild_leaf_2_q[i] <= grandchild_1 >= -signed'((NodeBits + 3)'(i));

    if (rst_i) begin
      valid_0_q <= 1'b0;
      valid_1_q <= 1'b0;
      valid_2_q <= 1'b0;
    end
  end

  for (genvar w = 0; w < 3; w++) begin : gen_compare
    assign difference[w] = {1'b0, coordinate_2_q[w]} - {1'b0, split_2_q[w]};
    assign right[w] = !difference[w][P];
  end

  // The near child's own near child, where that is in the word too and the child is no leaf.
  assign child_leaf = child_leaf_2_q[right[0]];
  assign second = upper_2_q && !child_leaf;
  assign right_2 = right[0] ? right[2] : right[1];
  assign grandchild_leaf = grandchild_leaf_2_q[{right[0], right_2}];
  assign next_stack = stack_2_q + (second ? StackBits'(2) : StackBits'(1));
  assign loop = valid_2_q && !child_leaf && !(upper_2_q && grandchild_leaf);
  assign in_ready_o = !loop;

  always_ff @(posedge clk_i) begin
    leaf_valid_o <= valid_2_q && !loop;
    leaf_context_o <= context_2_q;
    leaf_map_o <= map_2_q;
    leaf_first_o <= first_2_q;
    leaf_line_o <= second ? grandchild_2_q + LineBits'({right[0], right_2}) : child_2_q + LineBits'(right[0]);
    leaf_stack_o <= next_stack;
    leaf_steps_o <= next_stack - start_2_q;
    step_o <= valid_2_q;
    step_second_o <= valid_2_q && second;
    if (rst_i) begin
      leaf_valid_o <= 1'b0;
      step_o <= 1'b0;
      step_second_o <= 1'b0;
    end
  end

  if (Parity != 0) begin : gen_parity
    logic [2:0] parity_2_q, bad;
    for (genvar w = 0; w < 3; w++) begin : gen_bad
      assign bad[w] = ^{parity_2_q[w], axis_2_q[w], split_2_q[w]};
    end
    always_ff @(posedge clk_i) begin
      parity_2_q <= {right_word[WordBits-1], left_word[WordBits-1], node_word[WordBits-1]};
      wrong_o <= valid_2_q && (bad[0] || (second && (right[0] ? bad[2] : bad[1])));
      wrong_context_o <= context_2_q;
      if (rst_i) wrong_o <= 1'b0;
    end
  end else begin : gen_no_parity
    assign wrong_o = 1'b0;
    assign wrong_context_o = '0;
  end

  // ---- the far children, behind the ring: of two levels one for each bank of the stack ----
  localparam int unsigned Behind = 5;  // stages from 3 to the scaled distance
  localparam int unsigned SubtreeBits = 1 + NodeBits + 3 * F;

  logic [1:0] axis_second;
  logic [F-1:0] difference_second;
  logic [3*F-1:0] offsets_first, offsets_second;
  logic [SubtreeBits-1:0] first_far, second_far;
  logic [Behind-1:0] push_valid_q, push_second_q;
  logic [ContextBits-1:0] push_context_q[0:Behind-1];
  logic [StackBits-1:0] push_stack_q[0:Behind-1];

  assign axis_second = right[0] ? axis_2_q[2] : axis_2_q[1];
  assign difference_second = right[0] ? difference[2] : difference[1];
  always_comb begin
    for (int unsigned a = 0; a < 3; a++) begin
      offsets_first[F*a+:F] = (a == 2 ? axis_2_q[0] >= 2'd2 : axis_2_q[0] == 2'(a)) ? difference[0] : offsets_2_q[F*a+:F];
      offsets_second[F*a+:F] = (a == 2 ? axis_second >= 2'd2 : axis_second == 2'(a)) ? difference_second : offsets_2_q[F*a+:F];
    end
  end
  assign first_far = {child_leaf_2_q[!right[0]], node_2_q, !right[0], offsets_first};
  assign second_far = {
    grandchild_leaf_2_q[{right[0], !right_2}], NodeBits'({node_2_q, right[0], !right_2}), offsets_second
  };

  always_ff @(posedge clk_i) begin
    push_valid_q <= {push_valid_q[Behind-2:0], valid_2_q};
    push_second_q <= {push_second_q[Behind-2:0], second};
    push_context_q[0] <= context_2_q;
    push_stack_q[0] <= stack_2_q;
    for (int unsigned i = 1; i < Behind; i++) begin
      push_context_q[i] <= push_context_q[i-1];
      push_stack_q[i] <= push_stack_q[i-1];
    end
    if (rst_i) push_valid_q <= '0;
  end

  for (genvar bank = 0; bank < 2; bank++) begin : gen_bank
    logic [SubtreeBits-1:0] ride_q[0:Behind-1];
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
      ride_q[0] <= stack_2_q[0] == (bank == 1) ? first_far : second_far;
      for (int unsigned i = 1; i < Behind; i++) ride_q[i] <= ride_q[i-1];
      scaled_q <= DistanceBits'(distance) * DistanceBits'(EpsilonFactor);
    end
    assign push_entry_o[EntryBits*bank+:EntryBits] = {ride_q[Behind-1], scaled_q};
  end
  assign push_entry_o[2*EntryBits] = push_second_q[Behind-1];
  assign push_o = push_valid_q[Behind-1];
  assign push_context_o = push_context_q[Behind-1];
  assign push_stack_o = push_stack_q[Behind-1];
endmodule
