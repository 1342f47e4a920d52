// SPDX-License-Identifier: Apache-2.0
// The walk through the tree, of number Tree of Trees: that of the unit's contexts c with c % Trees = Tree, here c / Trees.
// From a query's start to its first leaf, and from a leaf that is done to the next one, or to the query's end. Wires three
// modules: photon_gatherer_next chooses the step, photon_gatherer_nodes descends through inner nodes,
// photon_gatherer_stack drops subtrees that are too far; and what they read of a context: its position, the offsets of the
// subtree that it is in, its bound. Mirrors the order of search_gather in golden/unit/photon_gatherer.cpp.
//
// Of two Levels photon_gatherer_node_pairs descends instead, two inner nodes at once.
//
// One inner node, one leaf and two stack entries a cycle. A query is at a leaf 3 cycles for each inner node, or for each two, and 1 after
// its start or its next subtree, at once where that is a leaf; the next subtree comes 4 cycles after the end of a leaf,
// and 3 more for each two entries that are dropped before it.
module photon_gatherer_tree #(
    parameter int unsigned UnitContexts = 16,
    parameter int unsigned Trees = 1,
    parameter int unsigned Tree = 0,
    parameter int unsigned Lists = 1,
    parameter int unsigned GlobalLines = 4096,  // of the plan's maps
    parameter int unsigned CausticLines = 0,
    parameter int unsigned NodeWords = 4096,
    parameter int unsigned Levels = 1,  // of a descent at once
    parameter int unsigned GlobalWords = 2048,  // where 2: of photon_gatherer_pair_memory
    parameter int unsigned GlobalUpper = 1,
    parameter int unsigned CausticUpper = 1,
    parameter int unsigned NodeAddressBits = $clog2(NodeWords),
    localparam int unsigned Contexts = (UnitContexts + Trees - 1) / Trees,
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned ListContexts = (UnitContexts + Lists - 1) / Lists,
    localparam int unsigned ListContextBits = ListContexts > 1 ? $clog2(ListContexts) : 1,
    localparam int unsigned PositionBits = photonloom_pkg::PositionBits,
    localparam int unsigned R2Bits = photonloom_pkg::R2Bits,
    localparam int unsigned LineBits = photonloom_pkg::LineBits,
    localparam int unsigned NodeBits = LineBits + 1,
    localparam int unsigned StackBits = $clog2(LineBits + 1),
    localparam int unsigned Parity = photonloom_pkg::Parity,
    localparam int unsigned WordNodes = Levels == 1 ? 1 : 3
) (
    input  logic                             clk_i,
    input  logic                             rst_i,
    // node memory: the word is there in the cycle after its address
    output logic [      NodeAddressBits-1:0] node_address_o,
    input  logic [WordNodes*(PositionBits+2+Parity)-1:0] node_data_i,  // parity where there is, axis, split; of two levels of three nodes
    // lines of the caustic, the global map
    input  logic [           2*NodeBits-1:0] lines_i,
    // a query starts, not while held: at an inner node or a leaf of its map, or, in an empty one, at neither
    output logic                             hold_o,
    input  logic                             start_i,
    input  logic                             start_inner_i,
    input  logic                             start_leaf_i,
    input  logic [          ContextBits-1:0] start_context_i,
    input  logic                             start_map_i,
    input  logic [       3*PositionBits-1:0] start_position_i,
    // a leaf is reached
    output logic                             leaf_valid_o,
    output logic [          ContextBits-1:0] leaf_context_o,
    output logic                             leaf_map_o,
    output logic                             leaf_first_o,      // of its query
    output logic [             LineBits-1:0] leaf_line_o,
    output logic [            StackBits-1:0] leaf_stack_o,      // entries left
    output logic [            StackBits-1:0] leaf_steps_o,      // inner nodes on the way to it
    // a leaf is done
    input  logic                             finish_valid_i,
    output logic                             finish_ready_o,
    input  logic [          ContextBits-1:0] finish_context_i,
    input  logic [            StackBits-1:0] finish_stack_i,
    input  logic                             finish_stop_i,
    // a bound is written, by each list for its contexts
    input  logic [                Lists-1:0] bound_write_i,
    input  logic [Lists*ListContextBits-1:0] bound_context_i,
    input  logic [         Lists*R2Bits-1:0] bound_i,
    // a query is done
    output logic                             done_o,
    output logic [          ContextBits-1:0] done_context_o,
    // a node's word was not right
    output logic                             wrong_o,
    output logic [          ContextBits-1:0] wrong_context_o,
    // counted events, how many
    output logic                             nodes_o,
    output logic [                 Levels:0] dropped_o          // of two levels, above the number dropped: a second node
);
  localparam bit HasBoth = GlobalLines != 0 && CausticLines != 0;
  localparam bit OnlyCaustic = GlobalLines == 0 && CausticLines != 0;
  localparam int unsigned OffsetsBits = 3 * (PositionBits + 1);  // signed
  // E * distance^2 <= E * 2^R2Bits.
  localparam int unsigned DistanceBits = R2Bits + $clog2(photonloom_pkg::EpsilonFactor);

  logic subtree, subtree_leaf;
  logic [ContextBits-1:0] subtree_context;
  logic [NodeBits-1:0] subtree_node;
  logic [StackBits-1:0] subtree_stack;
  logic [OffsetsBits-1:0] subtree_offsets;

  logic go_valid, go_ready, go_map, go_first;
  logic [ContextBits-1:0] go_context;
  logic [NodeBits-1:0] go_node;
  logic [StackBits-1:0] go_stack;

  logic descent_valid, descent_map, descent_first;
  logic [ContextBits-1:0] descent_context;
  logic [LineBits-1:0] descent_line;
  logic [StackBits-1:0] descent_stack, descent_steps;

  assign hold_o = subtree;

  photon_gatherer_next #(
      .Contexts(Contexts),
      .HasBoth(HasBoth),
      .OnlyCaustic(OnlyCaustic),
      .StackBits(StackBits)
  ) next (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .lines_i(lines_i),
      .start_i(start_i),
      .start_inner_i(start_inner_i),
      .start_leaf_i(start_leaf_i),
      .start_context_i(start_context_i),
      .start_map_i(start_map_i),
      .subtree_i(subtree),
      .subtree_leaf_i(subtree_leaf),
      .subtree_context_i(subtree_context),
      .subtree_node_i(subtree_node),
      .subtree_stack_i(subtree_stack),
      .node_valid_o(go_valid),
      .node_ready_i(go_ready),
      .node_context_o(go_context),
      .node_map_o(go_map),
      .node_first_o(go_first),
      .node_node_o(go_node),
      .node_stack_o(go_stack),
      .descent_valid_i(descent_valid),
      .descent_context_i(descent_context),
      .descent_map_i(descent_map),
      .descent_first_i(descent_first),
      .descent_line_i(descent_line),
      .descent_stack_i(descent_stack),
      .descent_steps_i(descent_steps),
      .leaf_valid_o(leaf_valid_o),
      .leaf_context_o(leaf_context_o),
      .leaf_map_o(leaf_map_o),
      .leaf_first_o(leaf_first_o),
      .leaf_line_o(leaf_line_o),
      .leaf_stack_o(leaf_stack_o),
      .leaf_steps_o(leaf_steps_o)
  );

  // ---- with what nodes and stack read of a context ----
  localparam int unsigned EntryBits = 1 + NodeBits + OffsetsBits + DistanceBits;
  localparam int unsigned PushBits = Levels == 1 ? EntryBits : 1 + 2 * EntryBits;
  logic node_map, push;
  logic [ContextBits-1:0] node_context, push_context, stack_bound_context;
  logic [3*PositionBits-1:0] node_position;
  logic [OffsetsBits-1:0] node_offsets;
  logic [StackBits-1:0] push_stack;
  logic [R2Bits-1:0] stack_bound;
  logic [PushBits-1:0] push_entry;

  lut_ram #(
      .Width(3 * PositionBits),
      .Depth(Contexts)
  ) positions (
      .clk_i(clk_i),
      .write_i(start_i),
      .write_address_i(start_context_i),
      .write_data_i(start_position_i),
      .read_address_i(node_context),
      .read_data_o(node_position)
  );
  lut_ram #(
      .Width(OffsetsBits),
      .Depth(Contexts)
  ) offsets (
      .clk_i(clk_i),
      .write_i(subtree),
      .write_address_i(subtree_context),
      .write_data_i(subtree_offsets),
      .read_address_i(node_context),
      .read_data_o(node_offsets)
  );

  if (Levels == 1) begin : gen_level
    photon_gatherer_nodes #(
        .PositionBits(PositionBits),
        .LineBits(LineBits),
        .Contexts(Contexts),
        .NodeWords(NodeWords),
        .CausticBase(GlobalLines),
        .EpsilonFactor(photonloom_pkg::EpsilonFactor),
        .StackBits(StackBits),
        .DistanceBits(DistanceBits),
        .Parity(Parity)
    ) nodes (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .node_address_o(node_address_o),
        .node_data_i(node_data_i),
        .context_o(node_context),
        .query_i(node_position),
        .offsets_i(node_offsets),
        .map_o(node_map),
        .lines_i((HasBoth ? node_map : OnlyCaustic) ? lines_i[NodeBits+:NodeBits] : lines_i[0+:NodeBits]),
        .in_valid_i(go_valid),
        .in_ready_o(go_ready),
        .in_context_i(go_context),
        .in_map_i(go_map),
        .in_first_i(go_first),
        .in_node_i(go_node),
        .in_stack_i(go_stack),
        .leaf_valid_o(descent_valid),
        .leaf_context_o(descent_context),
        .leaf_map_o(descent_map),
        .leaf_first_o(descent_first),
        .leaf_line_o(descent_line),
        .leaf_stack_o(descent_stack),
        .leaf_steps_o(descent_steps),
        .step_o(nodes_o),
        .wrong_o(wrong_o),
        .wrong_context_o(wrong_context_o),
        .push_o(push),
        .push_context_o(push_context),
        .push_stack_o(push_stack),
        .push_entry_o(push_entry)
    );
  end else begin : gen_pairs
    photon_gatherer_node_pairs #(
        .PositionBits(PositionBits),
        .LineBits(LineBits),
        .Contexts(Contexts),
        .AddressBits(NodeAddressBits),
        .CausticBase(GlobalWords),
        .GlobalUpper(GlobalUpper),
        .CausticUpper(CausticUpper),
        .EpsilonFactor(photonloom_pkg::EpsilonFactor),
        .StackBits(StackBits),
        .DistanceBits(DistanceBits),
        .Parity(Parity)
    ) nodes (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .node_address_o(node_address_o),
        .node_data_i(node_data_i),
        .context_o(node_context),
        .query_i(node_position),
        .offsets_i(node_offsets),
        .map_o(node_map),
        .lines_i((HasBoth ? node_map : OnlyCaustic) ? lines_i[NodeBits+:NodeBits] : lines_i[0+:NodeBits]),
        .in_valid_i(go_valid),
        .in_ready_o(go_ready),
        .in_context_i(go_context),
        .in_map_i(go_map),
        .in_first_i(go_first),
        .in_node_i(go_node),
        .in_stack_i(go_stack),
        .leaf_valid_o(descent_valid),
        .leaf_context_o(descent_context),
        .leaf_map_o(descent_map),
        .leaf_first_o(descent_first),
        .leaf_line_o(descent_line),
        .leaf_stack_o(descent_stack),
        .leaf_steps_o(descent_steps),
        .step_o(nodes_o),
        .step_second_o(dropped_o[Levels]),
        .wrong_o(wrong_o),
        .wrong_context_o(wrong_context_o),
        .push_o(push),
        .push_context_o(push_context),
        .push_stack_o(push_stack),
        .push_entry_o(push_entry)
    );
  end

  photon_gatherer_bounds #(
      .Contexts(UnitContexts),
      .Lists(Lists),
      .Copies(Trees),
      .Copy(Tree),
      .R2Bits(R2Bits)
  ) bounds (
      .clk_i(clk_i),
      .write_i(bound_write_i),
      .write_context_i(bound_context_i),
      .write_bound_i(bound_i),
      .read_context_i(stack_bound_context),
      .read_bound_o(stack_bound)
  );

  photon_gatherer_stack #(
      .OffsetsBits(OffsetsBits),
      .R2Bits(R2Bits),
      .LineBits(LineBits),
      .Contexts(Contexts),
      .EpsilonShift(photonloom_pkg::EpsilonShift),
      .StackBits(StackBits),
      .DistanceBits(DistanceBits),
      .Pushes(Levels)
  ) stack (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .push_i(push),
      .push_context_i(push_context),
      .push_stack_i(push_stack),
      .push_entry_i(push_entry),
      .in_valid_i(finish_valid_i),
      .in_ready_o(finish_ready_o),
      .in_context_i(finish_context_i),
      .in_stack_i(finish_stack_i),
      .in_stop_i(finish_stop_i),
      .bound_context_o(stack_bound_context),
      .bound_i(stack_bound),
      .next_valid_o(subtree),
      .next_context_o(subtree_context),
      .next_leaf_o(subtree_leaf),
      .next_node_o(subtree_node),
      .next_stack_o(subtree_stack),
      .next_offsets_o(subtree_offsets),
      .done_valid_o(done_o),
      .done_context_o(done_context_o),
      .drop_o(dropped_o[1:0])
  );
endmodule
