// SPDX-License-Identifier: Apache-2.0
module photon_gatherer_photons_cover #(
    parameter int unsigned CountBits
) (
    input logic clk_i,
    input logic rst_i,
    input logic start_i,
    input logic head_valid,
    input logic [1:0] state_q,
    input logic [CountBits-1:0] left_q,
    input logic snapshot_valid_o,
    input logic snapshot_ready_i,
    input logic read_valid_o,
    input logic read_ready_i,
    input logic full_q,
    input logic free_o
);
  localparam logic [1:0] Idle = 2'd0, Stream = 2'd3;

  logic ran_q = 1'b0;  // the first reset is over
  always_ff @(posedge clk_i) if (!rst_i) ran_q <= 1'b1;

  // A query that wants its photons has none: no packet, and its context is free.
  none: cover property (@(posedge clk_i) disable iff (rst_i) state_q == Stream && free_o && left_q == '0);
  // The sum has the store's port: a photon waits for it.
  read_waits_for_sum: cover property (@(posedge clk_i) disable iff (rst_i) read_valid_o && !read_ready_i);
  // The photon before it has not been taken.
  read_waits_for_output: cover property (@(posedge clk_i) disable iff (rst_i) state_q == Stream && left_q != '0 && full_q);
  // The snapshot waits for candidates.
  snapshot_waits: cover property (@(posedge clk_i) disable iff (rst_i) snapshot_valid_o && !snapshot_ready_i);
  // The oldest query that wants photons is not done yet.
  waits_for_oldest: cover property (@(posedge clk_i) disable iff (rst_i) state_q == Idle && head_valid);
  // Another query that wants photons starts as one gives its context back.
  starts_as_freed: cover property (@(posedge clk_i) disable iff (rst_i) start_i && free_o);
  // A reset in the middle of a query's photons.
  reset_in_stream: cover property (@(posedge clk_i) rst_i && ran_q && state_q == Stream && left_q != '0);
endmodule
