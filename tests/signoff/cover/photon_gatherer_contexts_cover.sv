// SPDX-License-Identifier: Apache-2.0
module photon_gatherer_contexts_cover #(
    parameter int unsigned Contexts,
    parameter int unsigned Sums
) (
    input logic clk_i,
    input logic rst_i,
    input logic take_i,
    input logic [Sums-1:0] sum_free_i,
    input logic photons_free_i,
    input logic [Contexts-1:0] summing_q,
    input logic [Contexts-1:0] streaming_q
);
  // Every context is in use.
  all_busy: cover property (@(posedge clk_i) disable iff (rst_i) (summing_q | streaming_q) == '1);
  // A context is taken as another one comes free.
  taken_as_freed: cover property (@(posedge clk_i) disable iff (rst_i) take_i && (sum_free_i != '0 || photons_free_i));
  // A context waits for its photons alone: its sum is done.
  streams_alone: cover property (@(posedge clk_i) disable iff (rst_i) (streaming_q & ~summing_q) != '0);
  // Sum and photons give contexts back in one cycle.
  both_freed: cover property (@(posedge clk_i) disable iff (rst_i) sum_free_i != '0 && photons_free_i);
endmodule
