// SPDX-License-Identifier: Apache-2.0
// Where a query goes next: to an inner node or to a leaf. A query comes from its start, at the root, or with the next
// subtree that its stack gives; never both in a cycle. Inner nodes wait in one queue, subtrees that are leaves in
// another, so that these do not wait for those. One goes past an empty queue: latency 0, one query in and one step to
// either side a cycle. Leaves at which a descent ends go before the queue of leaves.
module photon_gatherer_next #(
    parameter int unsigned Contexts = 16,
    parameter bit HasBoth = 1'b0,  // maps
    parameter bit OnlyCaustic = 1'b0,
    parameter int unsigned StackBits = 5,
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned LineBits = photonloom_pkg::LineBits,
    localparam int unsigned NodeBits = LineBits + 1
) (
    input  logic                   clk_i,
    input  logic                   rst_i,
    input  logic [ 2*NodeBits-1:0] lines_i,            // of the caustic, the global map
    // a query starts, in this map; it is at an inner node or at a leaf, or not at all in the tree
    input  logic                   start_i,
    input  logic                   start_inner_i,
    input  logic                   start_leaf_i,
    input  logic [ContextBits-1:0] start_context_i,
    input  logic                   start_map_i,
    // the next subtree
    input  logic                   subtree_i,
    input  logic                   subtree_leaf_i,
    input  logic [ContextBits-1:0] subtree_context_i,
    input  logic [   NodeBits-1:0] subtree_node_i,
    input  logic [  StackBits-1:0] subtree_stack_i,
    // to an inner node
    output logic                   node_valid_o,
    input  logic                   node_ready_i,
    output logic [ContextBits-1:0] node_context_o,
    output logic                   node_map_o,
    output logic                   node_first_o,       // the root
    output logic [   NodeBits-1:0] node_node_o,
    output logic [  StackBits-1:0] node_stack_o,
    // the end of a descent
    input  logic                   descent_valid_i,
    input  logic [ContextBits-1:0] descent_context_i,
    input  logic                   descent_map_i,
    input  logic                   descent_first_i,
    input  logic [   LineBits-1:0] descent_line_i,
    input  logic [  StackBits-1:0] descent_stack_i,
    input  logic [  StackBits-1:0] descent_steps_i,
    // a leaf is reached
    output logic                   leaf_valid_o,
    output logic [ContextBits-1:0] leaf_context_o,
    output logic                   leaf_map_o,
    output logic                   leaf_first_o,
    output logic [   LineBits-1:0] leaf_line_o,
    output logic [  StackBits-1:0] leaf_stack_o,
    output logic [  StackBits-1:0] leaf_steps_o        // inner nodes on the way to it
);
  localparam int unsigned Depth = Contexts > 2 ? (1 << $clog2(Contexts)) : 2;
  localparam int unsigned WordBits = ContextBits + 2 + NodeBits + StackBits;

  logic [WordBits-1:0] word, oldest_node, oldest_leaf;
  logic subtree_map, node_push, node_waiting, node_map, leaf_push, leaf_waiting, leaf_map, leaf_first;
  logic [ContextBits-1:0] leaf_context;
  logic [NodeBits-1:0] leaf_node;
  logic [StackBits-1:0] leaf_stack;
  logic [LineBits:0] lines;
  /* verilator lint_off UNUSEDSIGNAL */  // queues hold every context
  logic nodes_ready, leaves_ready;
  /* verilator lint_on UNUSEDSIGNAL */

  if (HasBoth) begin : gen_maps
    lut_ram #(
        .Width(1),
        .Depth(Contexts)
    ) maps (
        .clk_i(clk_i),
        .write_i(start_i),
        .write_address_i(start_context_i),
        .write_data_i(start_map_i),
        .read_address_i(subtree_context_i),
        .read_data_o(subtree_map)
    );
  end else begin : gen_map
    logic unused;
    assign unused = &{1'b0, start_i};
    assign subtree_map = OnlyCaustic;
  end

  assign word = subtree_i ? {subtree_context_i, subtree_map, 1'b0, subtree_node_i, subtree_stack_i} :
                            {start_context_i, start_map_i, 1'b1, NodeBits'(1), StackBits'(0)};

  // ---- inner nodes ----
  fifo #(
      .Width(WordBits),
      .Depth(Depth)
  ) nodes (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(node_push && (node_waiting || !node_ready_i)),
      .in_ready_o(nodes_ready),
      .in_i(word),
      .out_valid_o(node_waiting),
      .out_ready_i(node_ready_i),
      .out_o(oldest_node)
  );
  assign node_push = (subtree_i && !subtree_leaf_i) || start_inner_i;
  assign node_valid_o = node_waiting || node_push;
  assign {node_context_o, node_map, node_first_o, node_node_o, node_stack_o} = node_waiting ? oldest_node : word;
  assign node_map_o = HasBoth ? node_map : OnlyCaustic;

  // ---- leaves ----
  fifo #(
      .Width(WordBits),
      .Depth(Depth)
  ) leaves (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(leaf_push && (leaf_waiting || descent_valid_i)),
      .in_ready_o(leaves_ready),
      .in_i(word),
      .out_valid_o(leaf_waiting),
      .out_ready_i(!descent_valid_i),
      .out_o(oldest_leaf)
  );
  assign leaf_push = (subtree_i && subtree_leaf_i) || start_leaf_i;
  assign {leaf_context, leaf_map, leaf_first, leaf_node, leaf_stack} = leaf_waiting ? oldest_leaf : word;
  assign lines = (HasBoth ? leaf_map : OnlyCaustic) ? lines_i[NodeBits+:NodeBits] : lines_i[0+:NodeBits];

  assign leaf_valid_o = descent_valid_i || leaf_waiting || leaf_push;
  assign leaf_context_o = descent_valid_i ? descent_context_i : leaf_context;
  assign leaf_map_o = descent_valid_i ? descent_map_i : HasBoth ? leaf_map : OnlyCaustic;
  assign leaf_first_o = descent_valid_i ? descent_first_i : leaf_first;
  assign leaf_line_o = descent_valid_i ? descent_line_i : LineBits'(leaf_node - NodeBits'(lines));
  assign leaf_stack_o = descent_valid_i ? descent_stack_i : leaf_stack;
  assign leaf_steps_o = descent_valid_i ? descent_steps_i : '0;
endmodule
