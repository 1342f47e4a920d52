// SPDX-License-Identifier: Apache-2.0
// sources: rtl/photon_gatherer/photon_gatherer_contexts.sv
// photon_gatherer_contexts: a query that starts takes a context that no other one has. Takes are as far apart as photon_gatherer_start of
// several trees and lists has them; what is given back, and when, is any.
module contexts_free #(
    parameter bit GroupsFirst = 1'b0,
    parameter int unsigned Contexts = 6
) (
    input logic clk_i,
    input logic rst_i,
    input logic take_i,
    input logic take_photons_i,
    input logic sum_free_i,
    input logic [2:0] sum_free_context_i,
    input logic photons_free_i,
    input logic [2:0] photons_free_context_i
);
  logic free;
  logic [2:0] context_taken;

  photon_gatherer_contexts #(
      .Contexts(Contexts),
      .GroupsFirst(GroupsFirst)
  ) dut (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .free_o(free),
      .context_o(context_taken),
      .take_i(take_i),
      .take_photons_i(take_photons_i),
      .sum_free_i(sum_free_i),
      .sum_free_context_i(sum_free_context_i),
      .photons_free_i(photons_free_i),
      .photons_free_context_i(photons_free_context_i),
      .busy_o()
  );

  // A context is in use from its take until both are done with it.
  logic [Contexts-1:0] summing_q = '0, streaming_q = '0;
  logic started_q = 1'b0, may_q = 1'b0, took_q = 1'b0;
  always_ff @(posedge clk_i) begin
    started_q <= 1'b1;
    may_q <= !rst_i && free && !take_i && !took_q;
    took_q <= !rst_i && take_i;
    for (int unsigned c = 0; c < Contexts; c++) begin
      if (take_i && context_taken == 3'(c)) begin
        summing_q[c]   <= 1'b1;
        streaming_q[c] <= take_photons_i;
      end
      if (sum_free_i && sum_free_context_i == 3'(c)) summing_q[c] <= 1'b0;
      if (photons_free_i && photons_free_context_i == 3'(c)) streaming_q[c] <= 1'b0;
    end
  end
  always_comb begin
    assume (rst_i == !started_q);
    assume (!rst_i || (!take_i && !sum_free_i && !photons_free_i));
    assume (!take_i || may_q);
    if (take_i) assert (context_taken < 3'(Contexts) && !summing_q[context_taken] && !streaming_q[context_taken]);
  end
endmodule
