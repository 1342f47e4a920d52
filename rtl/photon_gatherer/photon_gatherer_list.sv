// SPDX-License-Identifier: Apache-2.0
// The lists of all contexts: per context the K smallest candidates in (d2, index). One candidate a cycle, whatever the
// context. A candidate keeps the place that it got when it entered; its key stands there in LUT RAM, and only the order
// of the places moves: K short numbers, sorted by key. A new one takes the next place while the list is not full,
// afterwards the place of the last in order; so places 0 .. n-1 are always the list's, in some order.
//
//   stage a   read all keys of the context, compare with the new one and with the two tokens ahead
//   stage b   rank = how many go before it
//   stage c   it enters iff rank < K: order, key, count and the copy of d2 are written
//   stage d   d2 of the entry that is now the last (block RAM), or its own; its load arrives
//   stage e   the new bound is written
//
// A token in b or c is not in the keys yet. It need not be known whether it enters: the list holds the K smallest of
// what came before, so rank = min(K, smaller ones in the list + smaller ones of the same context in b and c).
//
// A start is a token of its own. It empties the list and sets the bound. Behind the list is the slot store: what is kept
// of each entry, by its place.
//
// Bounds: r2_max of the query's map from its start, the K-th d2 once the list is full; written in the fourth cycle after the
// token, to be read from the fifth.
module photon_gatherer_list #(
    parameter int unsigned K = 16,
    parameter int unsigned R2Bits = 34,
    parameter int unsigned IndexBits = 16,
    parameter int unsigned Contexts = 16,
    parameter int unsigned LoadBits = 48,
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned PlaceBits = K > 1 ? $clog2(K) : 1,
    localparam int unsigned CountBits = $clog2(K + 1),
    localparam int unsigned StoreBits = LoadBits + R2Bits + IndexBits
) (
    input  logic                           clk_i,
    input  logic                           rst_i,
    // tokens
    input  logic                           in_valid_i,
    input  logic [        ContextBits-1:0] in_context_i,
    input  logic                           in_candidate_i,
    input  logic                           in_start_i,
    input  logic                           in_snapshot_i,
    input  logic [          IndexBits-1:0] in_index_i,
    input  logic [             R2Bits-1:0] in_d2_i,
    input  logic [           LoadBits-1:0] load_i,           // three cycles after its token
    // a start is done: four cycles after its token, with r2_max of its map, given from the token until then
    output logic                           started_o,
    input  logic [             R2Bits-1:0] r2_max_i,
    // a bound is written: who reads bounds keeps them by context
    output logic                           bound_write_o,
    output logic [        ContextBits-1:0] bound_context_o,
    output logic [             R2Bits-1:0] bound_o,
    // count and insertions of a context
    input  logic [        ContextBits-1:0] read_context_i,
    output logic [          CountBits-1:0] count_o,
    output logic [            IndexBits:0] insertions_o,
    // slot store: a word a cycle after its address
    input  logic                           store_read_i,
    input  logic [        ContextBits-1:0] store_context_i,
    input  logic [          PlaceBits-1:0] store_place_i,
    output logic [          StoreBits-1:0] store_word_o,     // load, d2, index
    // snapshot: places in list order, the first lowest
    output logic                           snapshot_o,
    output logic [          CountBits-1:0] snapshot_count_o,
    output logic [        K*PlaceBits-1:0] snapshot_places_o,
    // counted event
    output logic                           insert_o
);
  localparam int unsigned KeyBits = R2Bits + IndexBits;
  localparam int unsigned RankBits = $clog2(K + 3);
  localparam int unsigned StateBits = IndexBits + 2;  // full, insertions

  // ---- stage a ----
  logic [KeyBits-1:0] a_key, b_key_q, c_key_q;
  logic [K-1:0] smaller_b_q;  // a valid entry is smaller than the token
  logic less_b, less_c, ahead_b, ahead_c, ahead_b_q, ahead_c_q;
  logic b_candidate_q, c_enters_q, b_start_q, c_start_q, b_snapshot_q, c_snapshot_q;
  logic [ContextBits-1:0] b_context_q, c_context_q;
  logic [StateBits-1:0] a_state, c_state, c_state_next, read_state;
  logic [CountBits-1:0] a_count, c_count;

  // ---- stage c, where everything is written ----
  logic [RankBits-1:0] rank, c_rank_q;
  logic [K*PlaceBits-1:0] order;
  logic [PlaceBits-1:0] place;
  logic c_full;

  assign a_key = {in_d2_i, in_index_i};
  assign a_count = count_of(a_state);
  less_than #(
      .Width(KeyBits)
  ) compare_b (
      .a_i(b_key_q),
      .b_i(a_key),
      .less_o(less_b)
  );
  less_than #(
      .Width(KeyBits)
  ) compare_c (
      .a_i(c_key_q),
      .b_i(a_key),
      .less_o(less_c)
  );
  assign ahead_b = b_candidate_q && b_context_q == in_context_i && less_b;
  assign ahead_c = c_candidate_q && c_context_q == in_context_i && less_c;

  function automatic logic [CountBits-1:0] count_of(input logic [StateBits-1:0] state);
    count_of = state[StateBits-1] ? CountBits'(K) : CountBits'(state[StateBits-2:0]);
  endfunction

  for (genvar j = 0; j < K; j++) begin : gen_place
    logic [KeyBits-1:0] word;
    logic smaller;
    lut_ram #(
        .Width(KeyBits),
        .Depth(Contexts)
    ) key (
        .clk_i(clk_i),
        .write_i(c_enters_q && place == PlaceBits'(j)),
        .write_address_i(c_context_q),
        .write_data_i(c_key_q),
        .read_address_i(in_context_i),
        .read_data_o(word)
    );
    less_than #(
        .Width(KeyBits)
    ) compare (
        .a_i(word),
        .b_i(a_key),
        .less_o(smaller)
    );
    always_ff @(posedge clk_i) smaller_b_q[j] <= smaller && a_count > CountBits'(j);
  end

  // ---- stage b ----
  logic c_candidate_q;

  always_comb begin
    rank = RankBits'(ahead_b_q) + RankBits'(ahead_c_q);
    for (int unsigned j = 0; j < K; j++) rank = rank + RankBits'(smaller_b_q[j]);
  end

  always_ff @(posedge clk_i) begin
    b_candidate_q <= in_valid_i && in_candidate_i;
    b_start_q <= in_valid_i && in_start_i;
    b_snapshot_q <= in_valid_i && in_snapshot_i;
    b_context_q <= in_context_i;
    b_key_q <= a_key;
    ahead_b_q <= ahead_b;
    ahead_c_q <= ahead_c;

    c_candidate_q <= b_candidate_q;
    c_start_q <= b_start_q;
    c_snapshot_q <= b_snapshot_q;
    c_context_q <= b_context_q;
    c_key_q <= b_key_q;
    c_rank_q <= rank;
    c_enters_q <= b_candidate_q && rank < RankBits'(K);
    if (rst_i) begin
      b_candidate_q <= 1'b0;
      b_start_q <= 1'b0;
      b_snapshot_q <= 1'b0;
      c_candidate_q <= 1'b0;
      c_start_q <= 1'b0;
      c_snapshot_q <= 1'b0;
      c_enters_q <= 1'b0;
    end
  end

  // ---- stage c: order ----
  assign c_full = c_state[StateBits-1];
  assign c_count = count_of(c_state);
  assign place = c_full ? order[PlaceBits*(K-1)+:PlaceBits] : PlaceBits'(c_state[IndexBits:0]);

  for (genvar j = 0; j < K; j++) begin : gen_order
    logic [PlaceBits-1:0] left;
    if (j == 0) begin : gen_first
      assign left = place;
    end else begin : gen_other
      assign left = c_rank_q < RankBits'(j) ? order[PlaceBits*(j-1)+:PlaceBits] : place;
    end
    lut_ram #(
        .Width(PlaceBits),
        .Depth(Contexts)
    ) entry (
        .clk_i(clk_i),
        .write_i(c_enters_q && c_rank_q <= RankBits'(j)),
        .write_address_i(c_context_q),
        .write_data_i(left),
        .read_address_i(c_context_q),
        .read_data_o(order[PlaceBits*j+:PlaceBits])
    );
  end

  // ---- counts; a start clears them ----
  logic [StateBits-1:0] state_data;

  assign c_state_next[IndexBits:0] = c_state[IndexBits:0] + 1'b1;
  assign c_state_next[StateBits-1] = c_full || CountBits'(c_state[IndexBits:0]) == CountBits'(K - 1);
  assign state_data = c_start_q ? '0 : c_state_next;

  for (genvar r = 0; r < 3; r++) begin : gen_state
    logic [ContextBits-1:0] address;
    logic [StateBits-1:0] data;
    lut_ram #(
        .Width(StateBits),
        .Depth(Contexts)
    ) state (
        .clk_i(clk_i),
        .write_i(c_enters_q || c_start_q),
        .write_address_i(c_context_q),
        .write_data_i(state_data),
        .read_address_i(address),
        .read_data_o(data)
    );
  end
  assign gen_state[0].address = in_context_i;
  assign gen_state[1].address = c_context_q;
  assign gen_state[2].address = read_context_i;
  assign a_state = gen_state[0].data;
  assign c_state = gen_state[1].data;
  assign read_state = gen_state[2].data;
  assign count_o = count_of(read_state);
  assign insertions_o = read_state[IndexBits:0];
  assign insert_o = c_enters_q;
  assign snapshot_o = c_snapshot_q;
  assign snapshot_count_o = c_count;
  assign snapshot_places_o = order;

  // ---- bounds ----
  // The new last is the entry before the last, unless the token itself is.
  logic d_bound_q, d_start_q, d_own_q, e_bound_q, e_start_q;
  logic [ContextBits-1:0] d_context_q, e_context_q;
  logic [R2Bits-1:0] d_d2, d_own_d2_q, e_d2_q;  // own: of the token, not of the list
  logic [PlaceBits-1:0] before_last;

  if (K == 1) begin : gen_one
    assign before_last = '0;
  end else begin : gen_many
    assign before_last = order[PlaceBits*(K-2)+:PlaceBits];
  end

  block_ram #(
      .Width(R2Bits),
      .Depth(1 << (ContextBits + PlaceBits))
  ) d2_by_place (
      .clk_i(clk_i),
      .write_i(c_enters_q),
      .write_address_i({c_context_q, place}),
      .write_data_i(c_key_q[KeyBits-1:IndexBits]),
      .read_i(1'b1),
      .read_address_i({c_context_q, before_last}),
      .read_data_o(d_d2)
  );

  always_ff @(posedge clk_i) begin
    d_bound_q <= c_start_q || (c_enters_q && c_state_next[StateBits-1]);
    d_start_q <= c_start_q;
    d_own_q <= c_start_q || c_rank_q == RankBits'(K - 1);
    d_context_q <= c_context_q;
    d_own_d2_q <= c_start_q ? r2_max_i : c_key_q[KeyBits-1:IndexBits];

    e_bound_q <= d_bound_q;
    e_context_q <= d_context_q;
    e_start_q <= d_start_q;
    e_d2_q <= d_own_q ? d_own_d2_q : d_d2;
    if (rst_i) begin
      d_bound_q <= 1'b0;
      d_start_q <= 1'b0;
      e_bound_q <= 1'b0;
      e_start_q <= 1'b0;
    end
  end

  assign started_o = e_start_q;

  assign bound_write_o = e_bound_q;
  assign bound_context_o = e_context_q;
  assign bound_o = e_d2_q;

  // ---- slot store: load and key by place ----
  logic store_q;
  logic [ContextBits-1:0] store_context_q;
  logic [PlaceBits-1:0] store_place_q;
  logic [KeyBits-1:0] d_key_q;

  always_ff @(posedge clk_i) begin
    store_q <= c_enters_q;
    store_context_q <= c_context_q;
    store_place_q <= place;
    d_key_q <= c_key_q;
    if (rst_i) store_q <= 1'b0;
  end

  block_ram #(
      .Width(StoreBits),
      .Depth(1 << (ContextBits + PlaceBits))
  ) slot_store (
      .clk_i(clk_i),
      .write_i(store_q),
      .write_address_i({store_context_q, store_place_q}),
      .write_data_i({load_i, d_key_q}),
      .read_i(store_read_i),
      .read_address_i({store_context_i, store_place_i}),
      .read_data_o(store_word_o)
  );
endmodule
