// SPDX-License-Identifier: Apache-2.0
// sources: rtl/common/lut_ram.sv rtl/common/block_ram.sv rtl/common/less_than.sv
// sources: rtl/photon_gatherer/photon_gatherer_key_code.sv rtl/photon_gatherer/photon_gatherer_coded_list.sv
// photon_gatherer_coded_list: what k_list proves of photon_gatherer_list, with codes of so few bits that most keys have the code of another,
// while its owner keeps loads and itself where the list is not ready. The list is sorted and holds the K smallest of what came since its start. One candidate, any, of one
// context, any, is followed: it stands at place n of a snapshot iff n candidates of that context were smaller and n < K,
// with its own load, and nowhere else; the count is that of the candidates, at most K; the bound is r2_max until the list
// is full, then the distance of the K-th. Keys of one list differ, since a photon's index is in them. As its owner does, a
// candidate waits until the start before it is done, and after a snapshot nothing comes for that context while it is read.
module k_coded_list #(
    parameter int unsigned K = 2,
    parameter int unsigned R2Bits = 1,
    parameter int unsigned IndexBits = 2,
    parameter int unsigned CodeBits = 2,
    parameter int unsigned ExponentBits = 1,
    parameter bit CountAhead = 1'b0,
    parameter bit WriteLater = 1'b0,
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

  logic ready, waits_q, mine, candidate, start, snapshot;
  assign mine = in_valid_i && ready && in_context_i == context_w;
  assign candidate = mine && in_kind_i == 2'd0;
  assign start = mine && in_kind_i == 2'd1;
  assign snapshot = mine && in_kind_i == 2'd2;

  logic [3:0] load_q;
  logic started, bound_write, bound_context, snapshot_there;
  logic [R2Bits-1:0] bound;
  logic [CountBits-1:0] count, snapshot_count;
  logic [K*PlaceBits-1:0] snapshot_places;
  logic [PlaceBits-1:0] store_place_q;
  logic [KeyBits:0] word;

  photon_gatherer_coded_list #(
      .K(K),
      .R2Bits(R2Bits),
      .IndexBits(IndexBits),
      .Contexts(2),
      .LoadBits(1),
      .CodeBits(CodeBits),
      .ExponentBits(ExponentBits),
      .CountAhead(CountAhead),
      .WriteLater(WriteLater)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .ready_o(ready),
      .in_valid_i(in_valid_i),
      .in_context_i(in_context_i),
      .in_candidate_i(in_kind_i == 2'd0),
      .in_start_i(in_kind_i == 2'd1),
      .in_snapshot_i(in_kind_i == 2'd2),
      .in_index_i(in_key_i[IndexBits-1:0]),
      .in_d2_i(in_key_i[KeyBits-1:IndexBits]),
      .load_i(load_q[3]),
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
  // Where a start, any token of the list and a snapshot are: stages a, b, c, which stay while not ready, d, e and one more.
  logic [5:0] start_age_q, token_age_q, reading_q;
  logic [KeyBits+3:0] in_q;
  logic [R2Bits-1:0] bound_q;

  always_ff @(posedge clk_i) begin
    waits_q <= !ready;
    in_q <= {in_valid_i, in_context_i, in_kind_i, in_key_i};
    if (!waits_q) load_q <= {load_q[2:0], in_key_i == key_w};
    start_age_q <= {start_age_q[4:3], ready && start_age_q[2], ready ? {start_age_q[1:0], start} : start_age_q[2:0]};
    token_age_q <= {token_age_q[4:3], ready && token_age_q[2], ready ? {token_age_q[1:0], mine} : token_age_q[2:0]};
    reading_q <= {reading_q[4:3], ready && reading_q[2], ready ? {reading_q[1:0], snapshot} : reading_q[2:0]};
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
    // Of a snapshot in stage c an entry is read, once the last one is written.
    if (reading_q[2]) store_place_q <= snapshot_places[PlaceBits*looked_at+:PlaceBits];
    if (bound_write && bound_context == context_w) bound_q <= bound;
    if (rst_i) begin
      on_q <= 1'b0;
      waits_q <= 1'b0;
      start_age_q <= '0;
      token_age_q <= '0;
      reading_q <= '0;
    end
  end

  // The owner of the list.
  always_comb begin
    assume (in_kind_i != 2'd3 && looked_at < K);
    if (waits_q) assume (in_q == {in_valid_i, in_context_i, in_kind_i, in_key_i});
    if (mine) assume (reading_q[4:0] == '0);
    if (candidate || snapshot) assume (on_q && start_age_q == '0);
    if (candidate && came_q) assume (in_key_i != key_w);
    if (start) assume (token_age_q == '0);
  end

  always_comb begin
    if (!rst_i) begin
      if (reading_q[2]) assert (snapshot_there && snapshot_count == all_q);
      if (reading_q[4] && CountBits'(looked_at) < all_q) begin
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
