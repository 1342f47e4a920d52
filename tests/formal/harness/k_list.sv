// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/lut_ram.sv rtl/common/block_ram.sv rtl/common/less_than.sv
// sources: rtl/photon_gatherer/photon_gatherer_list.sv
// photon_gatherer_list: the list is sorted and holds the K smallest of what came since its start. One candidate, any, of one
// context, any, is followed: it stands at place n of a snapshot iff n candidates of that context were smaller and n < K,
// with its own load, and nowhere else; the count is that of the candidates, at most K; the bound is r2_max until the list
// is full, then the distance of the K-th. Keys of one list differ, since a photon's index is in them. As its owner does, a
// candidate waits until the start before it is done, and after a snapshot nothing comes for that context while it is read.
module k_list #(
    parameter int unsigned K = 2,
    parameter int unsigned R2Bits = 1,
    parameter int unsigned IndexBits = 2,
    localparam int unsigned KeyBits = R2Bits + IndexBits,
    localparam int unsigned PlaceBits = K > 1 ? $clog2(K) : 1,
    localparam int unsigned CountBits = $clog2(K + 1)
) (
    input logic clk_i,
    input logic rst_i,
    input logic in_valid_i,
    input logic in_context_i,
    input logic [1:0] in_kind_i,  // 0 candidate, 1 start, 2 snapshot
    input logic [KeyBits-1:0] in_key_i
);
  (* anyconst *) logic context_w;
  (* anyconst *) logic [KeyBits-1:0] key_w;
  (* anyconst *) logic [R2Bits-1:0] r2_max;
  (* anyconst *) logic [PlaceBits-1:0] looked_at;  // this entry of a snapshot

  logic mine, candidate, start, snapshot;
  assign mine = in_valid_i && in_context_i == context_w;
  assign candidate = mine && in_kind_i == 2'd0;
  assign start = mine && in_kind_i == 2'd1;
  assign snapshot = mine && in_kind_i == 2'd2;

  logic [2:0] load_q;
  logic started, bound_write, bound_context, snapshot_there;
  logic [R2Bits-1:0] bound;
  logic [CountBits-1:0] count, snapshot_count;
  logic [K*PlaceBits-1:0] snapshot_places;
  logic [PlaceBits-1:0] store_place_q;
  logic [KeyBits:0] word;

  photon_gatherer_list #(
      .K(K),
      .R2Bits(R2Bits),
      .IndexBits(IndexBits),
      .Contexts(2),
      .LoadBits(1)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i),
      .in_context_i(in_context_i),
      .in_candidate_i(in_kind_i == 2'd0),
      .in_start_i(in_kind_i == 2'd1),
      .in_snapshot_i(in_kind_i == 2'd2),
      .in_index_i(in_key_i[IndexBits-1:0]),
      .in_d2_i(in_key_i[KeyBits-1:IndexBits]),
      .load_i(load_q[2]),
      .started_o(started),
      .r2_max_i(r2_max),
      .bound_write_o(bound_write),
      .bound_context_o(bound_context),
      .bound_o(bound),
      .read_context_i(context_w),
      .count_o(count),
      .insertions_o(),
      .store_read_i(1'b1),
      .store_context_i(context_w),
      .store_place_i(store_place_q),
      .store_word_o(word),
      .snapshot_o(snapshot_there),
      .snapshot_count_o(snapshot_count),
      .snapshot_places_o(snapshot_places),
      .insert_o()
  );

  logic started_q = 1'b0;
  always_ff @(posedge clk_i) started_q <= 1'b1;
  always_comb assume (rst_i == !started_q);

  // Since the start of the watched list: it is on, the watched candidate came, so many smaller ones came, so many came.
  logic on_q, came_q;
  logic [CountBits-1:0] smaller_q, all_q;
  // Cycles since a start and since any token of the list, as bits; where a snapshot is.
  logic [4:0] start_age_q, token_age_q, reading_q;
  logic [R2Bits-1:0] bound_q;

  always_ff @(posedge clk_i) begin
    load_q <= {load_q[1:0], in_key_i == key_w};
    start_age_q <= {start_age_q[3:0], start};
    token_age_q <= {token_age_q[3:0], mine};
    reading_q <= {reading_q[3:0], snapshot};
    if (start) begin
      on_q <= 1'b1;
      came_q <= 1'b0;
      smaller_q <= '0;
      all_q <= '0;
    end
    if (candidate) begin
      if (in_key_i == key_w) came_q <= 1'b1;
      if (in_key_i < key_w && smaller_q != CountBits'(K)) smaller_q <= smaller_q + 1'b1;
      if (all_q != CountBits'(K)) all_q <= all_q + 1'b1;
    end
    // The token of a snapshot is in stage c two cycles later; then its entry is read, once the last one is written.
    if (reading_q[1]) store_place_q <= snapshot_places[PlaceBits*looked_at+:PlaceBits];
    if (bound_write && bound_context == context_w) bound_q <= bound;
    if (rst_i) begin
      on_q <= 1'b0;
      start_age_q <= '0;
      token_age_q <= '0;
      reading_q <= '0;
    end
  end

  // The owner of the list.
  always_comb begin
    assume (in_kind_i != 2'd3 && looked_at < K);
    if (mine) assume (reading_q[3:0] == '0);
    if (candidate || snapshot) assume (on_q && start_age_q == '0);
    if (candidate && came_q) assume (in_key_i != key_w);
    if (start) assume (token_age_q == '0);
  end

  always_comb begin
    if (!rst_i) begin
      if (reading_q[1]) assert (snapshot_there && snapshot_count == all_q);
      if (reading_q[3] && CountBits'(looked_at) < all_q) begin
        assert ((word[KeyBits-1:0] == key_w) == (came_q && smaller_q == CountBits'(looked_at)));
        assert (word[KeyBits] == (word[KeyBits-1:0] == key_w));
      end
      if (on_q && token_age_q == '0) begin
        assert (count == all_q);
        if (all_q < CountBits'(K)) assert (bound_q == r2_max);
        if (came_q && smaller_q == CountBits'(K - 1) && all_q == CountBits'(K)) assert (bound_q == key_w[KeyBits-1:IndexBits]);
      end
    end
  end
endmodule
