// SPDX-License-Identifier: Apache-2.0
// From a query to the leaves that it visits: the registers that say where its map is, its start in a context, and the
// trees that it descends. Wires, as photon_gatherer.sv is. Leaves come by one by one; for each that is done its tree goes
// on, with the context's bound as it is then, until the query is done.
//
// Latency 1 from the query to its start; then that of photon_gatherer_trees.
module photon_gatherer_descent #(
    parameter int unsigned Contexts = 16,
    parameter int unsigned Levels = 1,  // of a descent at once: 2 of one tree
    parameter int unsigned Trees = 1,  // number n of N trees, lists and sums has the contexts c with c % N = n, as c / N
    parameter int unsigned Lists = 1,
    parameter int unsigned Sums = 1,
    parameter int unsigned Sets = 64,  // of the cache
    parameter bit Wide = 1'b0,  // of several trees and lists
    parameter bit OwnNodes = 1'b1,  // a node memory of its own
    parameter bit EarlyReplies = 1'b1,  // sooner than 4 cycles after a line was asked for, 3 with two trees, 5 of two levels at once
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned TreeContexts = (Contexts + Trees - 1) / Trees,
    localparam int unsigned TreeContextBits = TreeContexts > 1 ? $clog2(TreeContexts) : 1,
    localparam int unsigned ListContexts = (Contexts + Lists - 1) / Lists,
    localparam int unsigned ListContextBits = ListContexts > 1 ? $clog2(ListContexts) : 1,
    localparam int unsigned SumContexts = (Contexts + Sums - 1) / Sums,
    localparam int unsigned SumContextBits = SumContexts > 1 ? $clog2(SumContexts) : 1,
    localparam int unsigned NormalBits = photonloom_pkg::NormalBits,
    localparam int unsigned R2Bits = photonloom_pkg::R2Bits,
    localparam int unsigned LineBits = photonloom_pkg::LineBits,
    localparam int unsigned StackBits = $clog2(LineBits + 1),
    localparam int unsigned SetBits = Sets > 1 ? $clog2(Sets) : 1,
    localparam int unsigned NodeAddressBits = $clog2(photonloom_pkg::NodeWords),
    localparam int unsigned NodeDataBits = photonloom_pkg::PositionBits + 2 + photonloom_pkg::Parity,
    localparam int unsigned StepBits = $clog2(2 * Trees + 1)
) (
    input  logic                             clk_i,
    input  logic                             rst_i,
    // node memory and registers, written while idle
    input  logic                             cfg_valid_i,
    input  logic [                     23:0] cfg_addr_i,
    input  logic [                     63:0] cfg_data_i,
    // a node memory elsewhere, where it has none
    output logic [      NodeAddressBits-1:0] shared_node_address_o,
    input  logic [         NodeDataBits-1:0] shared_node_data_i,
    // of the cache
    output logic                             forget_o,
    output logic [              SetBits-1:0] set_mask_o,
    output logic                             bypass_o,
    // queries
    input  logic                             in_valid_i,
    output logic                             in_ready_o,
    input  photonloom_pkg::gather_query_t    in_i,
    // what a start waits for
    input  logic                             slot_ready_i,
    input  logic                             flush_ready_i,
    // a query or a flush starts; a query does, in a context
    output logic                             start_o,
    output logic                             search_o,
    output logic [          ContextBits-1:0] context_o,
    output photonloom_pkg::gather_query_t    query_o,
    output logic [     3*(NormalBits+2)-1:0] normal_o,          // decoded, z negated
    // the token that empties its list
    output logic                             token_o,
    input  logic                             token_taken_i,
    output logic [          ContextBits-1:0] token_context_o,
    input  logic                             token_done_i,
    output logic [               R2Bits-1:0] token_r2_max_o,
    // a leaf is reached
    output logic                             leaf_valid_o,
    output logic [          ContextBits-1:0] leaf_context_o,
    output logic                             leaf_map_o,
    output logic                             leaf_first_o,      // of its query
    output logic [             LineBits-1:0] leaf_line_o,
    output logic [            StackBits-1:0] leaf_stack_o,      // entries left
    output logic [            StackBits-1:0] leaf_steps_o,      // inner nodes on the way to it
    // and done, of each tree
    input  logic [                Trees-1:0] finish_valid_i,
    output logic [                Trees-1:0] finish_ready_o,
    input  logic [Trees*TreeContextBits-1:0] finish_context_i,  // of the tree
    input  logic [      Trees*StackBits-1:0] finish_stack_i,
    input  logic [                Trees-1:0] finish_stop_i,
    // a bound is written, by each list for its contexts
    input  logic [                Lists-1:0] bound_write_i,
    input  logic [Lists*ListContextBits-1:0] bound_context_i,
    input  logic [         Lists*R2Bits-1:0] bound_i,
    // a query is done: in a tree, or else in an empty map, that of the token
    output logic [                Trees-1:0] done_o,
    output logic [Trees*TreeContextBits-1:0] done_context_o,    // of the tree
    output logic                             empty_done_o,
    // contexts that are given back
    input  logic [                 Sums-1:0] sum_free_i,
    input  logic [  Sums*SumContextBits-1:0] sum_free_context_i,
    input  logic                             photons_free_i,
    input  logic [          ContextBits-1:0] photons_free_context_i,
    // a query is in flight
    output logic                             busy_o,
    // a node's word was not right, of each tree
    output logic [                Trees-1:0] wrong_o,
    output logic [Trees*TreeContextBits-1:0] wrong_context_o,
    // counted events, how many
    output logic [             StepBits-1:0] nodes_o,
    output logic [             StepBits-1:0] dropped_o
);
  localparam int unsigned PositionBits = photonloom_pkg::PositionBits;
  localparam int unsigned NodeBits = LineBits + 1;
  localparam int unsigned Bucket = photonloom_pkg::Bucket;
  localparam int unsigned GlobalLines = photonloom_pkg::GlobalPresent == 0 ? 0 :
      (photonloom_pkg::GlobalPhotons + Bucket - 1) / Bucket;
  localparam int unsigned CausticLines = photonloom_pkg::CausticPresent == 0 ? 0 :
      (photonloom_pkg::CausticPhotons + Bucket - 1) / Bucket;

  logic node_write, search_inner, search_leaf, hold;
  logic [NodeAddressBits-1:0] node_address;
  logic [PositionBits+1:0] node_data;
  logic [2*NodeBits-1:0] lines;
  logic [2*R2Bits-1:0] r2_max;

  photon_gatherer_registers #(
      .Sets(Sets),
      .NodeAddressBits(NodeAddressBits)
  ) registers (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .cfg_valid_i(cfg_valid_i),
      .cfg_addr_i(cfg_addr_i),
      .cfg_data_i(cfg_data_i),
      .node_write_o(node_write),
      .node_address_o(node_address),
      .node_data_o(node_data),
      .lines_o(lines),
      .r2_max_o(r2_max),
      .forget_o(forget_o),
      .set_mask_o(set_mask_o),
      .bypass_o(bypass_o)
  );

  photon_gatherer_start #(
      .Contexts(Contexts),
      .Trees(Trees),
      .Sums(Sums),
      .TokenFirst(photonloom_pkg::ListCodeBits != 0 || (EarlyReplies && Sets == 0)),
      .Wide(Wide)
  ) starts (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i),
      .in_ready_o(in_ready_o),
      .in_i(in_i),
      .lines_i(lines),
      .r2_max_i(r2_max),
      .hold_i(hold),
      .slot_ready_i(slot_ready_i),
      .flush_ready_i(flush_ready_i),
      .start_o(start_o),
      .search_o(search_o),
      .search_inner_o(search_inner),
      .search_leaf_o(search_leaf),
      .context_o(context_o),
      .query_o(query_o),
      .normal_o(normal_o),
      .token_o(token_o),
      .token_taken_i(token_taken_i),
      .token_context_o(token_context_o),
      .token_done_i(token_done_i),
      .token_r2_max_o(token_r2_max_o),
      .empty_done_o(empty_done_o),
      .tree_done_i(done_o[32'(token_context_o)&(Trees-1)]),
      .sum_free_i(sum_free_i),
      .sum_free_context_i(sum_free_context_i),
      .photons_free_i(photons_free_i),
      .photons_free_context_i(photons_free_context_i),
      .busy_o(busy_o)
  );

  photon_gatherer_trees #(
      .Contexts(Contexts),
      .Wide(Wide),
      .OwnNodes(OwnNodes),
      .Trees(Trees),
      .Lists(Lists),
      .GlobalLines(GlobalLines),
      .CausticLines(CausticLines),
      .NodeWords(photonloom_pkg::NodeWords),
      .Levels(Levels)
  ) trees (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .node_write_i(node_write),
      .node_address_i(node_address),
      .node_data_i(node_data),
      .lines_i(lines),
      .shared_node_address_o(shared_node_address_o),
      .shared_node_data_i(shared_node_data_i),
      .hold_o(hold),
      .start_i(search_o),
      .start_inner_i(search_inner),
      .start_leaf_i(search_leaf),
      .start_context_i(context_o),
      .start_map_i(query_o.map),
      .start_position_i(query_o.position),
      .leaf_valid_o(leaf_valid_o),
      .leaf_context_o(leaf_context_o),
      .leaf_map_o(leaf_map_o),
      .leaf_first_o(leaf_first_o),
      .leaf_line_o(leaf_line_o),
      .leaf_stack_o(leaf_stack_o),
      .leaf_steps_o(leaf_steps_o),
      .finish_valid_i(finish_valid_i),
      .finish_ready_o(finish_ready_o),
      .finish_context_i(finish_context_i),
      .finish_stack_i(finish_stack_i),
      .finish_stop_i(finish_stop_i),
      .bound_write_i(bound_write_i),
      .bound_context_i(bound_context_i),
      .bound_i(bound_i),
      .done_o(done_o),
      .done_context_o(done_context_o),
      .wrong_o(wrong_o),
      .wrong_context_o(wrong_context_o),
      .nodes_o(nodes_o),
      .dropped_o(dropped_o)
  );
endmodule
