// SPDX-License-Identifier: Apache-2.0
// package: tests/formal/harness/gatherer_pkg.sv
// sources: rtl/common/oct_decode.sv rtl/photon_gatherer/photon_gatherer_contexts.sv rtl/photon_gatherer/photon_gatherer_start.sv
// photon_gatherer_start beside result slots that tell a cycle late whether one is free, and trees that take a query any time
// after its start: a query or a flush starts only with a free slot; a query only in a context that nothing reads, once the list of
// the query before is empty and that query is in its tree; and until it is there it stays as it was. Of one tree, which says in the
// cycle itself whether it may take one, a query starts where it may; and it does start, and a flush too, in the last of Limit
// cycles at the latest in which nothing is in its way and lists do their part. Slots, contexts and trees become free at any time.
module start_waits #(
    parameter int unsigned Trees = 2,
    parameter bit TokenFirst = 0,
    parameter bit Far = 0,
    localparam int unsigned Contexts = 3,
    localparam int unsigned Slots = 5,
    localparam int unsigned Limit = 4 + 32'(TokenFirst) + 32'(Far)
) (
    input logic clk_i,
    input logic rst_i,
    input logic in_valid_i,
    input photonloom_pkg::gather_query_t in_i,
    input logic [3:0] lines_i,
    input logic flush_ready_i,
    input logic tree_ready_i,
    input logic slot_done_i,
    input logic token_taken_i,
    input logic token_done_i,
    input logic tree_done_i,
    input logic [1:0] sum_free_i,
    input logic sum_free_context0_i,
    input logic sum_free_context1_i,
    input logic photons_free_i,
    input logic [1:0] photons_free_context_i
);
  logic start, search, in_ready, ready_q, waiting_q, hold;
  logic [1:0] context_o;
  photonloom_pkg::gather_query_t query, waiting_query_q;

  photon_gatherer_start #(
      .Contexts(Contexts),
      .Trees(Trees),
      .Sums(2),
      .TokenFirst(TokenFirst),
      .Far(Far)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(in_valid_i),
      .in_ready_o(in_ready),
      .in_i(in_i),
      .lines_i(lines_i),
      .r2_max_i(12'd0),
      .hold_i(hold),
      .slot_ready_i(ready_q),
      .flush_ready_i(ready_q && flush_ready_i),
      .start_o(start),
      .search_o(search),
      .search_inner_o(),
      .search_leaf_o(),
      .context_o(context_o),
      .query_o(query),
      .normal_o(),
      .token_o(),
      .token_taken_i(token_taken_i),
      .token_context_o(),
      .token_done_i(token_done_i),
      .token_r2_max_o(),
      .empty_done_o(),
      .tree_done_i(tree_done_i),
      .sum_free_i(sum_free_i),
      .sum_free_context_i({sum_free_context1_i, sum_free_context0_i}),
      .photons_free_i(photons_free_i),
      .photons_free_context_i(photons_free_context_i),
      .busy_o()
  );
  assign hold = Trees > 1 ? waiting_q : !tree_ready_i;

  (* keep *) logic [1:0] token;  // probe

  logic started_q = 1'b0;
  logic [2:0] used_q;  // slots
  logic emptied_q;  // the list of the query that waits
  logic [Contexts-1:0] summing_q, streaming_q;
  logic clear;  // nothing is in the way of what waits
  logic [2:0] clear_q;  // and has not been for so many cycles
  always_comb begin
    clear = !in_ready && ready_q;
    if (query.flush) begin
      clear = clear && flush_ready_i;
    end else begin
      clear = clear && !hold && (summing_q | streaming_q) != '1;
      unique case (token)
        2'd0: ;
        2'd1: clear = clear && token_taken_i;
        2'd2: clear = clear && (token_done_i || emptied_q);
        default: clear = clear && !tree_done_i;
      endcase
    end
  end
  always_ff @(posedge clk_i) begin
    started_q <= 1'b1;
    ready_q <= used_q != 3'(Slots);
    used_q <= used_q + 3'(start) - 3'(slot_done_i);
    if (!waiting_q) waiting_q <= search && Trees > 1;
    else if (tree_ready_i) waiting_q <= 1'b0;
    if (search) waiting_query_q <= query;
    emptied_q <= (emptied_q || (token == 2'd2 && token_done_i)) && !search;
    for (int unsigned c = 0; c < Contexts; c++) begin
      if (sum_free_i[c%2] && (c % 2 == 0 ? sum_free_context0_i : sum_free_context1_i) == 1'(c / 2)) summing_q[c] <= 1'b0;
      if (photons_free_i && photons_free_context_i == 2'(c)) streaming_q[c] <= 1'b0;
      if (search && context_o == 2'(c)) begin
        summing_q[c] <= 1'b1;
        streaming_q[c] <= query.want_photons;
      end
    end
    clear_q <= clear && !start ? clear_q + 1'b1 : '0;
    if (rst_i) begin
      clear_q <= '0;
      ready_q <= 1'b0;
      used_q <= '0;
      waiting_q <= 1'b0;
      emptied_q <= 1'b0;
      summing_q <= '0;
      streaming_q <= '0;
    end
  end

  always_comb begin
    assume (rst_i == !started_q);
    if (!rst_i) begin
      if (slot_done_i) assume (used_q != '0);
      if (TokenFirst && token_done_i) assume (token == 2'd2 && !emptied_q);
      // What is given back is in use.
      if (sum_free_i[0]) assume (sum_free_context0_i ? summing_q[2] : summing_q[0]);
      if (sum_free_i[1]) assume (!sum_free_context1_i && summing_q[1]);
      if (photons_free_i) assume (photons_free_context_i < 2'(Contexts) && streaming_q[photons_free_context_i]);
      if (start) assert (used_q != 3'(Slots));
      if (search) begin
        assert (context_o < 2'(Contexts) && !summing_q[context_o] && !streaming_q[context_o]);
        assert (TokenFirst ? emptied_q && token == 2'd2 && !hold : token == 2'd0 && !hold);
      end
      if (Trees == 1) assert (clear_q < 3'(Limit));
      if (waiting_q) assert (query == waiting_query_q && !in_ready);
    end
  end
endmodule
