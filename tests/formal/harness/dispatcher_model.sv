// SPDX-License-Identifier: Apache-2.0
// A photon gatherer as gather_dispatcher sees it, at most two queries at a time: results, and the photons of those that
// want and have some, come in the order of its queries whenever it likes, either first. A result carries a query's first
// tag bit and whether there are photons, which the query says; two photons of a query carry its second.
module dispatcher_model (
    input  logic       clk_i,
    input  logic       rst_i,
    input  logic [2:0] idle_i,          // no query, no result, no photon now
    input  logic       query_valid_i,
    output logic       query_ready_o,
    input  logic [1:0] query_tag_i,
    input  logic       query_wants_i,
    input  logic       query_has_i,
    output logic       result_valid_o,
    input  logic       result_ready_i,
    output logic [1:0] result_o,
    output logic       photon_valid_o,
    input  logic       photon_ready_i,
    output logic [1:0] photon_o
);
  logic results_ready, photons_ready, result_there, photon_there, photon_tag, take, second_q;
  logic result_offered_q, photon_offered_q;

  assign query_ready_o = !idle_i[0] && results_ready && photons_ready;
  assign take = query_valid_i && query_ready_o;
  // Once offered it stays.
  assign result_valid_o = result_there && (!idle_i[1] || result_offered_q);
  assign photon_valid_o = photon_there && (!idle_i[2] || photon_offered_q);
  assign photon_o = {photon_tag, second_q};

  fifo #(
      .Width(2),
      .Depth(2)
  ) results (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(take),
      .in_ready_o(results_ready),
      .in_i({query_tag_i[0], query_has_i}),
      .out_valid_o(result_there),
      .out_ready_i(result_valid_o && result_ready_i),
      .out_o(result_o)
  );
  fifo #(
      .Width(1),
      .Depth(2)
  ) photons (
      .clk_i(clk_i),
      .rst_i(rst_i),
      .in_valid_i(take && query_wants_i && query_has_i),
      .in_ready_o(photons_ready),
      .in_i(query_tag_i[1]),
      .out_valid_o(photon_there),
      .out_ready_i(photon_valid_o && photon_ready_i && second_q),
      .out_o(photon_tag)
  );

  always_ff @(posedge clk_i) begin
    result_offered_q <= result_valid_o && !result_ready_i;
    photon_offered_q <= photon_valid_o && !photon_ready_i;
    if (photon_valid_o && photon_ready_i) second_q <= !second_q;
    if (rst_i) begin
      result_offered_q <= 1'b0;
      photon_offered_q <= 1'b0;
      second_q <= 1'b0;
    end
  end
endmodule
