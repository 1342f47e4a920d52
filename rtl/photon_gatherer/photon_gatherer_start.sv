// SPDX-License-Identifier: Apache-2.0
// Starts queries in the order in which they come. A query begins at the root: an inner node, a leaf, or its end in an
// empty map; search_o tells the other modules, which write their part of the context. A flush takes no context.
//
// Meanwhile the list of the context is emptied by a token, two cycles at most and five stages later: before a lane asks
// for its bound, and before the end of a query in an empty map is noted. A list with codes may keep the token waiting, and a lane asks
// sooner than 8 cycles after the start where a line may come at once: there, with TokenFirst, a query takes its context and starts when the list is empty.
//
// Latency 1 from the query to its start; starts are at least two cycles apart, so what they need is looked up a cycle
// ahead. hold_i: the tree goes on with another query in this cycle; of several trees: the query that started last is not in
// its tree yet. There contexts are many and the ways from a start are long: whether a query may start is known a cycle
// ahead, and the query stays until it is in its tree. Of one tree whose unit is Far from a board's dispatcher it is known
// ahead too, but for hold_i, which comes from a register. Mirrors the beginning of search_gather in
// golden/unit/photon_gatherer.cpp.
module photon_gatherer_start #(
    parameter int unsigned Contexts = 16,
    parameter int unsigned Trees = 1,
    parameter int unsigned Sums = 1,  // sum s has the contexts c with c % Sums = s, as c / Sums
    parameter bit TokenFirst = photonloom_pkg::ListCodeBits != 0,
    parameter bit Far = photonloom_pkg::FarGatherers != 0,  // from where it is known whether a slot is free
    parameter bit Wide = 1'b0,  // of several trees and lists: contexts are taken at least three cycles apart
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned SumContexts = (Contexts + Sums - 1) / Sums,
    localparam int unsigned SumContextBits = SumContexts > 1 ? $clog2(SumContexts) : 1,
    localparam int unsigned R2Bits = photonloom_pkg::R2Bits,
    localparam int unsigned NormalBits = photonloom_pkg::NormalBits,
    localparam int unsigned NodeBits = photonloom_pkg::LineBits + 1
) (
    input  logic                           clk_i,
    input  logic                           rst_i,
    input  logic                           in_valid_i,
    output logic                           in_ready_o,
    input  photonloom_pkg::gather_query_t  in_i,
    // maps: of the caustic, the global one
    input  logic [         2*NodeBits-1:0] lines_i,
    input  logic [           2*R2Bits-1:0] r2_max_i,
    // what a start waits for
    input  logic                           hold_i,
    input  logic                           slot_ready_i,
    input  logic                           flush_ready_i,
    // a query or a flush starts; a query does, in a context
    output logic                           start_o,
    output logic                           search_o,
    output logic                           search_inner_o,          // its root is an inner node
    output logic                           search_leaf_o,           // its root is a leaf
    output logic [        ContextBits-1:0] context_o,
    output photonloom_pkg::gather_query_t  query_o,                 // of several trees held while hold_i is
    output logic [   3*(NormalBits+2)-1:0] normal_o,                // decoded, z negated
    // the token that empties the list
    output logic                           token_o,
    input  logic                           token_taken_i,
    output logic [        ContextBits-1:0] token_context_o,
    input  logic                           token_done_i,
    output logic [             R2Bits-1:0] token_r2_max_o,
    // the end of a query in an empty map, where the tree ends none
    output logic                           empty_done_o,
    input  logic                           tree_done_i,             // the tree of its context ends one
    // contexts that are given back
    input  logic [               Sums-1:0] sum_free_i,
    input  logic [Sums*SumContextBits-1:0] sum_free_context_i,
    input  logic                           photons_free_i,
    input  logic [        ContextBits-1:0] photons_free_context_i,
    // a query is in flight
    output logic                           busy_o
);
  localparam logic [1:0] Idle = 2'd0, Ask = 2'd1, Wait = 2'd2, End = 2'd3;

  logic query_valid_q, free, in_use, empty, leaf, slot_ready, context_ready, held;
  /* verilator lint_off UNDRIVEN */
  /* verilator lint_off UNUSEDSIGNAL */
  logic emptied_q;  // with TokenFirst: the list of the query that waits
  /* verilator lint_on UNUSEDSIGNAL */
  /* verilator lint_on UNDRIVEN */
  logic take;  // a query takes its context, and a token for its list
  logic [ContextBits-1:0] free_context;
  photonloom_pkg::gather_query_t query_q;
  logic [1:0] map_empty_q, map_leaf_q;  // no line, one line
  logic [1:0] token_q, token_busy;
  logic token_empty_q, token_map_q;
  logic [3*(NormalBits+2)-1:0] normal;

  assign empty = map_empty_q[query_q.map];
  assign leaf = map_leaf_q[query_q.map];
  assign take = query_valid_q && !query_q.flush && slot_ready && context_ready && token_busy == Idle && !held;
  assign search_o = TokenFirst ? emptied_q && !held : take;
  assign context_o = TokenFirst ? token_context_o : free_context;
  assign search_inner_o = search_o && !empty && !leaf;
  assign search_leaf_o = search_o && leaf;
  assign start_o = search_o || (query_valid_q && query_q.flush && flush_ready_i);
  assign query_o = query_q;
  assign busy_o = query_valid_q || in_use;

  photon_gatherer_contexts #(
      .Contexts(Contexts),
      .Sums(Sums),
      .GroupsFirst(Wide)
  ) contexts (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .free_o(free),
      .context_o(free_context),
      .take_i(take),
      .take_photons_i(query_q.want_photons),
      .sum_free_i(sum_free_i),
      .sum_free_context_i(sum_free_context_i),
      .photons_free_i(photons_free_i),
      .photons_free_context_i(photons_free_context_i),
      .busy_o(in_use)
  );

  // ---- what a search waits for ----
  if (Trees > 1) begin : gen_ahead
    // It stays until a start takes it, and is known again two cycles after that.
    logic may_q, started_q;
    always_ff @(posedge clk_i) begin
      may_q <= slot_ready_i && free && token_q == Idle && !hold_i && !start_o && !started_q;
      started_q <= start_o;
      if (rst_i) {may_q, started_q} <= '0;
    end
    assign in_ready_o = !query_valid_q && !hold_i;
    assign slot_ready = may_q;
    assign context_ready = 1'b1;
    assign token_busy = TokenFirst ? token_q : Idle;
    assign held = 1'b0;
  end else if (Far) begin : gen_far
    // Whether a result slot is free is known far away. What is free stays so until a start,
    // after which no query is there for a cycle; hold_i comes from a register.
    logic may_q, started_q;
    always_ff @(posedge clk_i) begin
      may_q <= slot_ready_i && free && token_q == Idle && !started_q;
      started_q <= start_o;
      if (rst_i) {may_q, started_q} <= '0;
    end
    assign in_ready_o = !query_valid_q;
    assign slot_ready = may_q;
    assign context_ready = 1'b1;
    assign token_busy = TokenFirst ? token_q : Idle;
    assign held = hold_i;
  end else begin : gen_at_once
    assign in_ready_o = !query_valid_q;
    assign slot_ready = slot_ready_i;
    assign context_ready = free;
    assign token_busy = token_q;
    assign held = hold_i;
  end

  if (TokenFirst) begin : gen_token_first
    always_ff @(posedge clk_i) begin
      emptied_q <= (token_done_i || emptied_q) && !search_o;
      if (rst_i) emptied_q <= 1'b0;
    end
  end

  always_ff @(posedge clk_i) begin
    map_empty_q <= {lines_i[NodeBits+:NodeBits] == '0, lines_i[0+:NodeBits] == '0};
    map_leaf_q <= {lines_i[NodeBits+:NodeBits] == NodeBits'(1), lines_i[0+:NodeBits] == NodeBits'(1)};
    if (in_ready_o) begin
      query_valid_q <= in_valid_i;
      query_q <= in_i;
    end else if (start_o) begin
      query_valid_q <= 1'b0;
    end
    if (rst_i) query_valid_q <= 1'b0;
  end

  // ---- the token ----
  assign token_o = token_q == Ask;
  assign token_r2_max_o = token_map_q ? r2_max_i[R2Bits+:R2Bits] : r2_max_i[0+:R2Bits];
  assign empty_done_o = token_q == End;

  always_ff @(posedge clk_i) begin
    unique case (token_q)
      Idle: begin
        token_context_o <= free_context;
        token_empty_q <= empty;
        token_map_q <= query_q.map;
        if (take) token_q <= Ask;
      end
      Ask: if (token_taken_i) token_q <= Wait;
      Wait: if (TokenFirst ? search_o : token_done_i) token_q <= token_empty_q ? End : Idle;
      default: if (!tree_done_i) token_q <= Idle;
    endcase
    if (rst_i) token_q <= Idle;
  end

  // z is stored negated: what is asked is whether x + y > -z.
  oct_decode #(
      .Bits(NormalBits)
  ) decode_normal (
      .code_i(query_q.normal),
      .direction_o(normal)
  );
  assign normal_o = {-normal[2*(NormalBits+2)+:NormalBits+2], normal[2*(NormalBits+2)-1:0]};
endmodule
