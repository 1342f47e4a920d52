// SPDX-License-Identifier: Apache-2.0
// The sorted lists of all contexts: per context the K smallest candidates in (d2, index), each with the place of its
// load in the slot store. One candidate a cycle, whatever the context: entry j of the addressed context keeps its word,
// or is written with its left neighbour's or the new one. Entries stand in LUT RAM addressed by context, so a shift is
// a write enable and a two-way choice. A new entry takes the next place while the list is not full, afterwards the
// place of the entry that falls out; so places 0 .. n-1 are always the list's, in some order.
//
// A candidate is counted and stored iff it enters. What is left of the query before counts as empty from the start of
// the next, and the first candidate that enters writes all entries; empty ones hold the largest key, which no candidate
// has, since d2 < 2^R2Bits - 1.
//
// Bounds: r2_max of the query's map from its start, the K-th d2 once the list is full. Everything is done in the
// token's cycle; store_* comes a cycle later, and so does the new bound.
module photon_gatherer_list #(
    parameter int unsigned K = 16,
    parameter int unsigned R2Bits = 34,
    parameter int unsigned IndexBits = 16,
    parameter int unsigned Contexts = 16,
    parameter int unsigned LoadBits = 48,
    parameter int unsigned Readers = 4,  // of bounds
    localparam int unsigned ContextBits = Contexts > 1 ? $clog2(Contexts) : 1,
    localparam int unsigned PlaceBits = K > 1 ? $clog2(K) : 1,
    localparam int unsigned CountBits = $clog2(K + 1),
    localparam int unsigned StoreBits = LoadBits + R2Bits + IndexBits
) (
    input  logic                           clk_i,
    input  logic                           rst_i,
    // a new query; not while bound_busy_o
    output logic                           bound_busy_o,
    input  logic                           start_i,
    input  logic [        ContextBits-1:0] start_context_i,
    input  logic [             R2Bits-1:0] start_r2_max_i,
    // tokens
    input  logic                           in_valid_i,
    input  logic [        ContextBits-1:0] in_context_i,
    input  logic                           in_candidate_i,
    input  logic                           in_snapshot_i,
    input  logic [          IndexBits-1:0] in_index_i,
    input  logic [             R2Bits-1:0] in_d2_i,
    input  logic [           LoadBits-1:0] in_load_i,
    // bounds
    input  logic [Readers*ContextBits-1:0] bound_context_i,
    output logic [     Readers*R2Bits-1:0] bound_o,
    // count and insertions of a context
    input  logic [        ContextBits-1:0] read_context_i,
    output logic [          CountBits-1:0] count_o,
    input  logic [        ContextBits-1:0] read_insertions_context_i,
    output logic [            IndexBits:0] insertions_o,
    // slot store
    output logic                           store_o,
    output logic [        ContextBits-1:0] store_context_o,
    output logic [          PlaceBits-1:0] store_place_o,
    output logic [          StoreBits-1:0] store_data_o,    // load, d2, index
    // snapshot: places in list order, the first lowest
    output logic                           snapshot_o,
    output logic [          CountBits-1:0] snapshot_count_o,
    output logic [        K*PlaceBits-1:0] snapshot_places_o,
    // counted event
    output logic                           insert_o
);
  localparam int unsigned KeyBits = R2Bits + IndexBits;
  localparam int unsigned WordBits = KeyBits + PlaceBits;

  logic [K*WordBits-1:0] words;
  logic [K-1:0] less;  // the new one goes before entry j
  logic [KeyBits-1:0] key;
  logic [WordBits-1:0] word;
  logic [CountBits-1:0] count;
  logic [PlaceBits-1:0] place;
  logic [IndexBits:0] insertions;
  logic enters, is_full, fresh;
  logic [Contexts-1:0] fresh_q;  // nothing has entered since the query's start

  assign key = {in_d2_i, in_index_i};
  assign is_full = count == CountBits'(K);
  assign place = is_full ? words[WordBits*(K-1)+:PlaceBits] : PlaceBits'(count);
  assign word = {key, place};
  assign enters = in_valid_i && in_candidate_i && less[K-1];
  assign fresh = fresh_q[in_context_i];
  assign insert_o = enters;

  for (genvar j = 0; j < K; j++) begin : gen_entry
    logic [WordBits-1:0] left;
    if (j == 0) begin : gen_first
      assign left = word;
    end else begin : gen_other
      assign left = less[j-1] ? words[WordBits*(j-1)+:WordBits] : word;
    end

    lut_ram #(
        .Width(WordBits),
        .Depth(Contexts)
    ) entry (
        .clk_i(clk_i),
        .write_i(enters && less[j]),
        .write_address_i(in_context_i),
        .write_data_i(fresh && j > 0 ? '1 : left),
        .read_address_i(in_context_i),
        .read_data_o(words[WordBits*j+:WordBits])
    );

    assign less[j] = fresh || key < words[WordBits*j+PlaceBits+:KeyBits];
    assign snapshot_places_o[PlaceBits*j+:PlaceBits] = words[WordBits*j+:PlaceBits];
  end

  // ---- count and insertions ----
  logic [CountBits-1:0] count_next, count_stored, count_read;
  assign count = fresh ? '0 : count_stored;
  assign count_o = fresh_q[read_context_i] ? '0 : count_read;
  assign count_next = is_full ? count : count + 1'b1;

  always_ff @(posedge clk_i) begin
    for (int unsigned c = 0; c < Contexts; c++) begin
      if (enters && in_context_i == ContextBits'(c)) fresh_q[c] <= 1'b0;
      if (start_i && start_context_i == ContextBits'(c)) fresh_q[c] <= 1'b1;
    end
  end

  lut_ram #(
      .Width(CountBits),
      .Depth(Contexts)
  ) count_for_list (
      .clk_i(clk_i),
      .write_i(enters),
      .write_address_i(in_context_i),
      .write_data_i(count_next),
      .read_address_i(in_context_i),
      .read_data_o(count_stored)
  );
  lut_ram #(
      .Width(CountBits),
      .Depth(Contexts)
  ) count_to_read (
      .clk_i(clk_i),
      .write_i(enters),
      .write_address_i(in_context_i),
      .write_data_i(count_next),
      .read_address_i(read_context_i),
      .read_data_o(count_read)
  );
  photon_gatherer_tally #(
      .Width(IndexBits + 1),
      .Contexts(Contexts)
  ) insertion_counts (
      .clk_i(clk_i),
      .clear_i(start_i),
      .clear_context_i(start_context_i),
      .step_i(enters),
      .step_context_i(in_context_i),
      .step_value_o(insertions),
      .step_next_i(insertions + 1'b1),
      .read_context_i(read_insertions_context_i),
      .read_value_o(insertions_o)
  );

  // ---- bounds ----
  logic bound_q;
  logic [ContextBits-1:0] bound_context_q;
  logic [R2Bits-1:0] last_d2, bound_d2_q;

  assign bound_busy_o = bound_q;
  if (K == 1) begin : gen_one
    assign last_d2 = in_d2_i;
  end else begin : gen_many
    assign last_d2 = less[K-2] ? words[WordBits*(K-2)+PlaceBits+IndexBits+:R2Bits] : in_d2_i;
  end

  for (genvar r = 0; r < Readers; r++) begin : gen_bound
    lut_ram #(
        .Width(R2Bits),
        .Depth(Contexts)
    ) bound (
        .clk_i(clk_i),
        .write_i(bound_q || start_i),
        .write_address_i(bound_q ? bound_context_q : start_context_i),
        .write_data_i(bound_q ? bound_d2_q : start_r2_max_i),
        .read_address_i(bound_context_i[ContextBits*r+:ContextBits]),
        .read_data_o(bound_o[R2Bits*r+:R2Bits])
    );
  end

  assign snapshot_o = in_valid_i && in_snapshot_i;
  assign snapshot_count_o = count;

  always_ff @(posedge clk_i) begin
    bound_q <= enters && (is_full || count == CountBits'(K - 1));
    bound_context_q <= in_context_i;
    bound_d2_q <= last_d2;

    store_o <= enters;
    store_context_o <= in_context_i;
    store_place_o <= place;
    store_data_o <= {in_load_i, key};
    if (rst_i) begin
      bound_q <= 1'b0;
      store_o <= 1'b0;
    end
  end
endmodule
