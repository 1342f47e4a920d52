// SPDX-License-Identifier: Apache-2.0
// package: tests/formal/harness/gatherer_pkg.sv
// sources: rtl/common/lut_ram.sv rtl/common/block_ram.sv rtl/common/fifo.sv tests/formal/harness/stubs/reciprocal.sv
// sources: rtl/photon_gatherer/photon_gatherer_results.sv
// photon_gatherer_results, two units of reciprocals that take any time each: a sum begins only where places are promised for
// all, and each finishes once, at any time after. The FIFO of the places has room for each that finishes; as many places are free as are
// not held; a unit that is done waits for the other a cycle at most; and while reciprocals are wanted some unit is at one, but for
// a cycle: so they go on as long as units do. Slots are any.
module results_credits #(
    parameter int unsigned Lemmas = 0,
    localparam int unsigned Sums = 2,
    localparam int unsigned Places = 8
) (
    input logic clk_i,
    input logic rst_i,
    input logic start_i,
    input logic start_flush_i,
    input logic [Sums-1:0] take_i,
    input logic [Sums*2-1:0] take_slot_i,
    input logic finish_i,
    input logic [2:0] finish_slot_i,
    input logic [5:0] finish_r2_i,
    input logic result_ready_i
);
  logic take_ready;

  photon_gatherer_results #(
      .Slots(4),
      .Sums(Sums)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .start_ready_o(),
      .flush_ready_o(),
      .start_i(start_i),
      .start_flush_i(start_flush_i),
      .start_map_i(1'b0),
      .start_tag_i(1'b0),
      .start_sample_i(1'b0),
      .start_pixel_i(1'b0),
      .start_slot_o(),
      .take_ready_o(take_ready),
      .take_i(take_i),
      .take_slot_i(take_slot_i),
      .take_faulty_i(2'd0),
      .finish_i(finish_i),
      .finish_slot_i(finish_slot_i),
      .finish_count_i(2'd0),
      .finish_r2_i(finish_r2_i),
      .finish_flux_i(6'd0),
      .finish_nodes_i(2'd0),
      .finish_leaves_i(2'd0),
      .finish_insertions_i(3'd0),
      .result_valid_o(),
      .result_ready_i(result_ready_i),
      .result_o()
  );

  (* keep *) logic [3:0] places, head, tail;  // probes
  (* keep *) logic [Sums-1:0] unit_done;  // probes
  (* keep *) logic [1:0] state0, state1;  // probes
  (* keep *) logic wait_ready, done;  // probes

  logic started_q = 1'b0;
  logic [3:0] summing_q;  // queries whose sum has begun and is not done
  logic [3:0] finished_q;  // queries whose sum is done, whose reciprocal is not
  logic [1:0] wait_q;  // cycles in which the second unit was done already
  logic [1:0] still_q;  // cycles in which no unit is at one while one is wanted
  always_ff @(posedge clk_i) begin
    started_q <= 1'b1;
    summing_q <= summing_q + 4'(take_i[0]) + 4'(take_i[1]) - 4'(finish_i);
    finished_q <= finished_q + 4'(finish_i) - 4'(done);
    wait_q <= unit_done[1] ? wait_q + 1'b1 : '0;
    still_q <= finished_q == '0 || state0 != 2'd0 || state1 != 2'd0 ? '0 : still_q + 1'b1;
    if (rst_i) begin
      summing_q <= '0;
      finished_q <= '0;
      wait_q <= '0;
      still_q <= '0;
    end
  end

  always_comb begin
    assume (rst_i == !started_q);
    if (!rst_i) begin
      if (take_i != '0) assume (take_ready);
      if (finish_i) assume (summing_q != '0);
      if (finish_i) assert (wait_ready);
      assert (6'(places) + 6'(summing_q) + 6'(finished_q) == 6'(Places));
      assert (wait_q <= 2'd2);
      if (wait_q == 2'd2) assert (!unit_done[1]);
      assert (still_q <= 2'd1);
    end
  end

  if (Lemmas == 1) begin : gen_lemmas
    always_comb begin
      if (!rst_i) begin
        assert (state0 <= 2'd2 && state1 <= 2'd2 && summing_q <= 4'(Places) && finished_q <= 4'(Places));
        assert (finished_q == 4'(tail - head) + 4'(state0 != 2'd0) + 4'(state1 != 2'd0));
        assert (4'(tail - head) <= 4'(Places));
      end
    end
  end
endmodule
