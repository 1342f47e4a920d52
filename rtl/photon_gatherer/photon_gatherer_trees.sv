// SPDX-License-Identifier: Apache-2.0
// The walks of all contexts, on Trees trees: context c is at tree c % Trees, where it is number c / Trees. All trees
// read one node memory, each on a port of its own. Their leaves become one stream: those of tree 0 go first, those of
// the others wait in a queue each, past which a leaf goes that has nothing to wait for. The stream has a register behind that
// choice; Wide, each tree's leaves have one before it.
//
// A start enters its tree while that goes on with no other query. Of several trees it waits for that here, at least a
// cycle: the ways on, to the queues and to the cache, are long and begin at a register.
//
// Trees inner nodes, one leaf and 2 * Trees stack entries a cycle; latencies are those of photon_gatherer_tree, of several
// trees one more from a start and one more to a leaf.
module photon_gatherer_trees #(
    parameter int unsigned Contexts = 16,
    parameter int unsigned Trees = 1,
    parameter int unsigned Lists = 1,
    parameter int unsigned GlobalLines = 4096,  // of the plan's maps
    parameter int unsigned CausticLines = 0,
    parameter int unsigned NodeWords = 4096,
    parameter int unsigned Levels = 1,  // of a descent at once: 2 of one tree
    parameter bit Wide = 1'b0,  // leaves have a register before the trees' are one stream
    parameter bit OwnNodes = 1'b1,  // a node memory of its own; else one tree of one level reads another
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned TreeContexts = (Contexts + Trees - 1) / Trees,
    localparam int unsigned TreeContextBits = TreeContexts > 1 ? $clog2(TreeContexts) : 1,
    localparam int unsigned ListContexts = (Contexts + Lists - 1) / Lists,
    localparam int unsigned ListContextBits = ListContexts > 1 ? $clog2(ListContexts) : 1,
    localparam int unsigned PositionBits = photonloom_pkg::PositionBits,
    localparam int unsigned R2Bits = photonloom_pkg::R2Bits,
    localparam int unsigned LineBits = photonloom_pkg::LineBits,
    localparam int unsigned NodeBits = LineBits + 1,
    localparam int unsigned NodeAddressBits = $clog2(NodeWords),
    localparam int unsigned StackBits = $clog2(LineBits + 1),
    localparam int unsigned CountBits = $clog2(2 * Trees + 1),
    localparam int unsigned Parity = photonloom_pkg::Parity,
    localparam int unsigned NodeDataBits = PositionBits + 2 + Parity
) (
    input  logic                             clk_i,
    input  logic                             rst_i,
    // node memory and lines of the caustic, the global map; written while idle
    input  logic                             node_write_i,
    input  logic [      NodeAddressBits-1:0] node_address_i,
    input  logic [         PositionBits+1:0] node_data_i,       // axis, split
    input  logic [           2*NodeBits-1:0] lines_i,
    // a node memory elsewhere, which is read where there is none here: a word comes in the cycle after its address
    output logic [      NodeAddressBits-1:0] shared_node_address_o,
    input  logic [         NodeDataBits-1:0] shared_node_data_i,
    // a query starts, not while held: at an inner node or a leaf of its map, or, in an empty one, at neither
    output logic                             hold_o,            // of the context that would start; of several trees any
    input  logic                             start_i,
    input  logic                             start_inner_i,
    input  logic                             start_leaf_i,
    input  logic [          ContextBits-1:0] start_context_i,
    input  logic                             start_map_i,
    input  logic [       3*PositionBits-1:0] start_position_i,  // of several trees it and its map stay while held
    // a leaf is reached
    output logic                             leaf_valid_o,
    output logic [          ContextBits-1:0] leaf_context_o,
    output logic                             leaf_map_o,
    output logic                             leaf_first_o,      // of its query
    output logic [             LineBits-1:0] leaf_line_o,
    output logic [            StackBits-1:0] leaf_stack_o,      // entries left
    output logic [            StackBits-1:0] leaf_steps_o,      // inner nodes on the way to it
    // a leaf is done, of each tree
    input  logic [                Trees-1:0] finish_valid_i,
    output logic [                Trees-1:0] finish_ready_o,
    input  logic [Trees*TreeContextBits-1:0] finish_context_i,  // of the tree
    input  logic [      Trees*StackBits-1:0] finish_stack_i,
    input  logic [                Trees-1:0] finish_stop_i,
    // a bound is written, by each list for its contexts
    input  logic [                Lists-1:0] bound_write_i,
    input  logic [Lists*ListContextBits-1:0] bound_context_i,
    input  logic [         Lists*R2Bits-1:0] bound_i,
    // a query is done, of each tree
    output logic [                Trees-1:0] done_o,
    output logic [Trees*TreeContextBits-1:0] done_context_o,    // of the tree
    // a node's word was not right, of each tree
    output logic [                Trees-1:0] wrong_o,
    output logic [Trees*TreeContextBits-1:0] wrong_context_o,
    // counted events, how many
    output logic [            CountBits-1:0] nodes_o,
    output logic [            CountBits-1:0] dropped_o
);
  localparam int unsigned LeafBits = ContextBits + 2 + LineBits + 2 * StackBits;

  // Words of two levels: of half as many numbers as the lowest inner level needs.
  localparam int unsigned GlobalLevels = GlobalLines > 1 ? $clog2(GlobalLines) : 0;
  localparam int unsigned CausticLevels = CausticLines > 1 ? $clog2(CausticLines) : 0;
  localparam int unsigned GlobalWords = GlobalLevels > 0 ? 1 << (GlobalLevels - 1) : 0;
  localparam int unsigned CausticWords = CausticLevels > 0 ? 1 << (CausticLevels - 1) : 0;
  localparam int unsigned PairWords = GlobalWords + CausticWords > 2 ? GlobalWords + CausticWords : 2;
  localparam int unsigned ReadAddressBits = Levels == 1 ? NodeAddressBits : $clog2(PairWords);
  localparam int EventBits = Levels == 1 ? 2 : 3;  // how many entries a tree drops, and whether it has done a second node
  localparam int unsigned ReadDataBits = Levels == 1 ? NodeDataBits : 3 * NodeDataBits;

  logic root, root_inner, root_leaf, held, any_leaf;
  logic [ContextBits-1:0] root_context;
  logic [Trees-1:0] hold, leaf_valid, node_step;
  logic [EventBits*Trees-1:0] dropped;
  logic [Trees*LeafBits-1:0] leaves;
  logic [Trees*ReadAddressBits-1:0] node_address;
  logic [Trees*ReadDataBits-1:0] node_data;
  logic [NodeDataBits-1:0] node_word;

  if (!OwnNodes && (Trees != 1 || Levels != 1)) begin : gen_bad_shared
    a_shared_node_memory_is_read_by_one_tree_of_one_level bad_shared ();
  end

  if (Parity != 0) begin : gen_parity
    assign node_word = {^node_data_i, node_data_i};
  end else begin : gen_no_parity
    assign node_word = node_data_i;
  end

  /* verilator lint_off UNUSEDSIGNAL */
  logic unused;
  /* verilator lint_on UNUSEDSIGNAL */
  if (OwnNodes) begin : gen_own
    assign shared_node_address_o = '0;
    assign unused = &{1'b0, shared_node_data_i};
  end else begin : gen_shared
    assign shared_node_address_o = node_address;
    assign node_data = shared_node_data_i;
    assign unused = &{1'b0, node_write_i, node_address_i, node_word};
  end

  if (OwnNodes && Levels == 1) begin : gen_level
    photon_gatherer_node_memory #(
        .Trees(Trees),
        .Width(NodeDataBits),
        .Depth(NodeWords)
    ) node_memory (
        .clk_i(clk_i),
        .write_i(node_write_i),
        .write_address_i(node_address_i),
        .write_data_i(node_word),
        .read_address_i(node_address),
        .read_data_o(node_data)
    );
  end else if (OwnNodes) begin : gen_pairs
    if (Trees != 1) begin : gen_bad_levels
      two_levels_are_of_one_tree bad_levels ();
    end
    photon_gatherer_pair_memory #(
        .Width(NodeDataBits),
        .GlobalLines(GlobalLines),
        .CausticLines(CausticLines),
        .NodeAddressBits(NodeAddressBits),
        .GlobalWords(PairWords - CausticWords),
        .CausticWords(CausticWords),
        .GlobalUpper(GlobalLevels % 2),
        .CausticUpper(CausticLevels % 2)
    ) node_memory (
        .clk_i(clk_i),
        .write_i(node_write_i),
        .write_address_i(node_address_i),
        .write_data_i(node_word),
        .read_address_i(node_address),
        .read_data_o(node_data)
    );
  end

  // ---- a start enters its tree ----
  if (Trees > 1) begin : gen_waiting
    logic waiting_q, inner_q, leaf_q;
    logic [ContextBits-1:0] context_q;
    always_ff @(posedge clk_i) begin
      if (!waiting_q) begin
        waiting_q <= start_i;
        inner_q <= start_inner_i;
        leaf_q <= start_leaf_i;
        context_q <= start_context_i;
      end else if (!held) begin
        waiting_q <= 1'b0;
      end
      if (rst_i) waiting_q <= 1'b0;
    end
    assign hold_o = waiting_q;
    assign root = waiting_q && !held;
    assign root_inner = root && inner_q;
    assign root_leaf = root && leaf_q;
    assign root_context = context_q;
  end else begin : gen_at_once
    assign hold_o = held;
    assign root = start_i;
    assign root_inner = start_inner_i;
    assign root_leaf = start_leaf_i;
    assign root_context = start_context_i;
  end

  for (genvar tree = 0; tree < Trees; tree++) begin : gen_tree
    logic here, valid, valid_now, map, first;
    logic [TreeContextBits-1:0] context_here;
    logic [LineBits-1:0] line;
    logic [StackBits-1:0] stack, steps;
    logic [LeafBits-1:0] leaf, leaf_now;

    assign here = (32'(root_context) & (Trees - 1)) == tree;
    assign leaf_now = {ContextBits'(32'(context_here) * Trees + tree), map, first, line, stack, steps};

    photon_gatherer_tree #(
        .UnitContexts(Contexts),
        .Trees(Trees),
        .Tree(tree),
        .Lists(Lists),
        .GlobalLines(GlobalLines),
        .CausticLines(CausticLines),
        .NodeWords(NodeWords),
        .Levels(Levels),
        .GlobalWords(PairWords - CausticWords),
        .GlobalUpper(GlobalLevels % 2),
        .CausticUpper(CausticLevels % 2),
        .NodeAddressBits(ReadAddressBits)
    ) walk (
        .clk_i(clk_i),
        .rst_i(rst_i),
        .node_address_o(node_address[ReadAddressBits*tree+:ReadAddressBits]),
        .node_data_i(node_data[ReadDataBits*tree+:ReadDataBits]),
        .lines_i(lines_i),
        .hold_o(hold[tree]),
        .start_i(root && here),
        .start_inner_i(root_inner && here),
        .start_leaf_i(root_leaf && here),
        .start_context_i(TreeContextBits'(root_context >> $clog2(Trees))),
        .start_map_i(start_map_i),
        .start_position_i(start_position_i),
        .leaf_valid_o(valid_now),
        .leaf_context_o(context_here),
        .leaf_map_o(map),
        .leaf_first_o(first),
        .leaf_line_o(line),
        .leaf_stack_o(stack),
        .leaf_steps_o(steps),
        .finish_valid_i(finish_valid_i[tree]),
        .finish_ready_o(finish_ready_o[tree]),
        .finish_context_i(finish_context_i[TreeContextBits*tree+:TreeContextBits]),
        .finish_stack_i(finish_stack_i[StackBits*tree+:StackBits]),
        .finish_stop_i(finish_stop_i[tree]),
        .bound_write_i(bound_write_i),
        .bound_context_i(bound_context_i),
        .bound_i(bound_i),
        .done_o(done_o[tree]),
        .done_context_o(done_context_o[TreeContextBits*tree+:TreeContextBits]),
        .wrong_o(wrong_o[tree]),
        .wrong_context_o(wrong_context_o[TreeContextBits*tree+:TreeContextBits]),
        .nodes_o(node_step[tree]),
        .dropped_o(dropped[EventBits*tree+:EventBits])
    );

    if (Wide) begin : gen_later
      logic valid_q;
      logic [LeafBits-1:0] leaf_q;
      always_ff @(posedge clk_i) begin
        valid_q <= valid_now && !rst_i;
        leaf_q <= leaf_now;
      end
      assign valid = valid_q;
      assign leaf = leaf_q;
    end else begin : gen_now
      assign valid = valid_now;
      assign leaf = leaf_now;
    end

    if (tree == 0) begin : gen_first
      assign leaf_valid[tree] = valid;
      assign leaves[LeafBits*tree+:LeafBits] = leaf;
    end else begin : gen_other
      localparam int unsigned Depth = TreeContexts > 2 ? (1 << $clog2(TreeContexts)) : 2;
      logic waiting, goes;
      logic [LeafBits-1:0] oldest;
      /* verilator lint_off UNUSEDSIGNAL */  // the queue holds every context
      logic ready;
      /* verilator lint_on UNUSEDSIGNAL */
      assign goes = leaf_valid[tree-1:0] == '0;
      assign leaf_valid[tree] = waiting || valid;
      assign leaves[LeafBits*tree+:LeafBits] = waiting ? oldest : leaf;
      fifo #(
          .Width(LeafBits),
          .Depth(Depth),
          .ValidAhead(Wide)
      ) queue (
          .clk_i(clk_i),
          .rst_i(rst_i),
          .in_valid_i(valid && (waiting || !goes)),
          .in_ready_o(ready),
          .in_i(leaf),
          .out_valid_o(waiting),
          .out_ready_i(goes),
          .out_o(oldest)
      );
    end
  end

  always_comb begin
    held = 1'b0;
    nodes_o = '0;
    dropped_o = '0;
    for (int unsigned t = 0; t < Trees; t++) begin
      if ((32'(root_context) & (Trees - 1)) == t) held = hold[t];
      nodes_o = nodes_o + (Levels == 1 ? CountBits'(node_step[t]) :
                 CountBits'(node_step[t]) + CountBits'(dropped[EventBits*t+Levels]));
      dropped_o = dropped_o + CountBits'(dropped[EventBits*t+:2]);
    end
  end

  assign any_leaf = leaf_valid != '0;
  if (Trees == 1) begin : gen_one
    assign leaf_valid_o = any_leaf;
    assign {leaf_context_o, leaf_map_o, leaf_first_o, leaf_line_o, leaf_stack_o, leaf_steps_o} = leaves;
  end else begin : gen_choice
    logic leaf_valid_q;
    logic [LeafBits-1:0] leaf, leaf_q;
    always_comb begin
      leaf = leaves[0+:LeafBits];
      for (int unsigned t = Trees; t > 0; t--) if (leaf_valid[t-1]) leaf = leaves[LeafBits*(t-1)+:LeafBits];
    end
    always_ff @(posedge clk_i) begin
      leaf_valid_q <= any_leaf && !rst_i;
      leaf_q <= leaf;
    end
    assign leaf_valid_o = Wide ? any_leaf : leaf_valid_q;
    assign {leaf_context_o, leaf_map_o, leaf_first_o, leaf_line_o, leaf_stack_o, leaf_steps_o} = Wide ? leaf : leaf_q;
  end
endmodule
