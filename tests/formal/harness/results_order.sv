// SPDX-License-Identifier: Apache-2.0
// package: tests/formal/harness/gatherer_pkg.sv
// sources: tests/formal/harness/stubs/block_ram.sv tests/formal/harness/stubs/block_ram_halves.sv rtl/common/lut_ram.sv tests/formal/harness/stubs/fifo.sv
// sources: tests/formal/harness/stubs/reciprocal.sv rtl/photon_gatherer/photon_gatherer_results.sv
// photon_gatherer_results, a unit of reciprocals for each sum, or Units of them, that takes any time: one slot, any, is followed, through all queries and
// flushes that take it. Its result is offered in its turn, once that query has finished and its reciprocal is done, or where it is a
// flush; it holds the query's head, what the query finished with and the reciprocal of its own r2; and it is offered within 5
// cycles of its turn and of that, of gatherers that lie far from their block RAM within 7, in halves 8, of two sums within 9, since a flush waits
// there for the others' words. Slots are numbered in turn. Queries finish in any order.
//
// Of each block RAM the word of the slot is kept; what other slots hold, and when they are done, is any. At most four
// queries wait for a unit, which is as many as there are slots. In halves queries finish at least two cycles apart.
//
// StartLater: what starts comes to the module a cycle after it did. A query may have seen in the cycle before that a slot is free,
// as photon_gatherer_start does; still none ever takes a slot that another one has. A result may come two cycles later.
module results_order #(
    parameter  int unsigned Sums   = 2,
    parameter  int unsigned Units  = Sums,
    parameter  bit          Far    = 1'b0,
    parameter  bit          Halves = 1'b0,
    parameter  bit          StartLater = 1'b0,
    localparam int unsigned Limit  = (Sums > 1 ? 9 : Halves ? 8 : Far ? 7 : 5) + (StartLater ? 2 : 0)
) (
    input logic clk_i,
    input logic rst_i,
    input logic start_i,
    input logic start_flush_i,
    input logic start_map_i,
    input logic start_tag_i,
    input logic finish_i,
    input logic [2:0] finish_slot_i,
    input logic finish_count_i,
    input logic [1:0] finish_r2_i,
    input logic result_ready_i
);
  (* anyconst *) logic [1:0] slot;
  logic start_ready, flush_ready, result_valid;
  logic [2:0] start_slot;
  photonloom_pkg::gather_result_t result;

  // What starts, as the module is told of it.
  logic start, start_flush, start_map, start_tag, later_q, later_flush_q, later_map_q, later_tag_q, ready_before_q;
  always_ff @(posedge clk_i) begin
    later_q <= start_i && !rst_i;
    {later_flush_q, later_map_q, later_tag_q} <= {start_flush_i, start_map_i, start_tag_i};
    ready_before_q <= start_ready && StartLater && !rst_i;
  end
  assign {start, start_flush, start_map, start_tag} = StartLater ? {later_q, later_flush_q, later_map_q, later_tag_q} :
      {start_i, start_flush_i, start_map_i, start_tag_i};

  photon_gatherer_results #(
      .Slots(4),
      .Sums(Sums),
      .Units(Units),
      .Far(Far),
      .Halves(Halves),
      .StartLater(StartLater)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .start_ready_o(start_ready),
      .flush_ready_o(flush_ready),
      .start_i(start),
      .start_flush_i(start_flush),
      .start_map_i(start_map),
      .start_tag_i(start_tag),
      .start_sample_i(1'b0),
      .start_pixel_i(1'b0),
      .start_slot_o(start_slot),
      .take_ready_o(),
      .take_i(Sums'(0)),
      .take_slot_i((2 * Sums)'(0)),
      .take_faulty_i(Sums'(0)),
      .finish_i(finish_i),
      .finish_slot_i(finish_slot_i),
      .finish_count_i({1'b0, finish_count_i}),
      .finish_r2_i({4'd0, finish_r2_i}),
      .finish_flux_i(6'd0),
      .finish_nodes_i(2'd0),
      .finish_leaves_i(2'd0),
      .finish_insertions_i(3'd0),
      .result_valid_o(result_valid),
      .result_ready_i(result_ready_i),
      .result_o(result)
  );

  logic [1:0] heads_watched, bodies_watched, reciprocals_watched;  // probes
  (* keep *) logic wait_ready, done, done_lap;  // probes
  (* keep *) logic [1:0] done_slot;  // probe

  logic started_q = 1'b0;
  logic [2:0] starts_q, results_q;  // modulo twice the slots
  logic rested_q;  // no start in the cycle before
  logic finished_q;
  // The query of the slot: it is there, runs, waits for its reciprocal.
  logic there_q, runs_q, waits_q, flush_q, map_q, tag_q, count_q, lap_q;
  logic [1:0] r2_q;
  logic starts, finishes, mine, turn;
  logic [3:0] late_q;
  assign starts = start && starts_q[1:0] == slot;
  assign finishes = finish_i && finish_slot_i[1:0] == slot;
  assign turn = results_q[1:0] == slot && starts_q != results_q;
  assign mine = result_valid && turn;
  always_ff @(posedge clk_i) begin
    started_q <= 1'b1;
    rested_q <= !start_i;
    finished_q <= finish_i && !rst_i;
    starts_q <= starts_q + 3'(start);
    results_q <= results_q + 3'(result_valid && result_ready_i);
    if (starts) begin
      there_q <= 1'b1;
      runs_q <= !start_flush;
      flush_q <= start_flush;
      map_q <= start_map;
      tag_q <= start_tag;
      lap_q <= starts_q[2];
    end
    if (finishes) begin
      runs_q <= 1'b0;
      waits_q <= 1'b1;
      count_q <= finish_count_i;
      r2_q <= finish_r2_i;
    end
    if (done && done_slot == slot) waits_q <= 1'b0;
    if (mine && result_ready_i) there_q <= 1'b0;
    late_q <= turn && !runs_q && !waits_q && !result_valid ? late_q + 1'b1 : '0;
    if (rst_i) begin
      starts_q <= '0;
      results_q <= '0;
      rested_q <= 1'b1;
      there_q <= 1'b0;
      runs_q <= 1'b0;
      waits_q <= 1'b0;
      late_q <= '0;
    end
  end

  always_comb begin
    assume (rst_i == !started_q);
    assume (heads_watched == slot && bodies_watched == slot && reciprocals_watched == slot);
    if (!rst_i) begin
      if (start_i) assume (rested_q && (start_flush_i ? flush_ready : start_ready || ready_before_q));
      if (finish_i) assume (wait_ready && (!Halves || !finished_q));
      if (finishes) assume (runs_q && finish_slot_i[2] == lap_q);
      if (start) assert (start_slot == starts_q);
    end
  end

  always_comb begin
    if (!rst_i) begin
      if (done && done_slot == slot) assert (waits_q && done_lap == lap_q);
      if (starts) assert (!there_q);
      if (result_valid) assert (starts_q != results_q);
      if (mine) begin
        assert (there_q && !runs_q && !waits_q);
        assert (result.tag == tag_q && result.flush == flush_q && result.map == (map_q && !flush_q));
        if (flush_q) assert (result.count == '0 && result.r2 == '0 && result.reciprocal == '0);
        if (!flush_q) assert (result.count == {1'b0, count_q} && result.r2 == {4'd0, r2_q});
        if (!flush_q) assert (result.reciprocal == (r2_q == 2'd0 ? 2'd1 : r2_q));
      end
      assert (late_q <= 4'(Limit));
    end
  end
endmodule
