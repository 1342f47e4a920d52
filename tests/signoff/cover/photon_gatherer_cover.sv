// SPDX-License-Identifier: Apache-2.0
module photon_gatherer_cover #(
    parameter int unsigned TagBits
) (
    input logic clk_i,
    input logic rst_i,
    input logic in_valid_i,
    input logic in_ready_o,
    input logic result_valid_o,
    input logic result_ready_i,
    input photonloom_pkg::gather_result_t result_o,
    input logic photon_valid_o,
    input logic photon_ready_i,
    input logic line_req_valid_o,
    input logic line_req_ready_i,
    input logic [TagBits-1:0] line_req_tag_o,
    input logic line_rsp_valid_i,
    input logic [TagBits-1:0] line_rsp_tag_i,
    input logic cfg_valid_i,
    input logic search,
    input logic busy,
    input logic bypass
);
  logic ran_q = 1'b0;  // the first reset is over
  logic searched_q, asked_q;  // a query has come, a line was asked for, since reset
  logic [TagBits-1:0] last_tag_q;  // of the last line asked for
  always_ff @(posedge clk_i) begin
    if (!rst_i) ran_q <= 1'b1;
    if (search) searched_q <= 1'b1;
    if (line_req_valid_o && line_req_ready_i) begin
      asked_q <= 1'b1;
      last_tag_q <= line_req_tag_o;
    end
    if (rst_i) {searched_q, asked_q} <= '0;
  end

  // A query has to hold while none can start.
  in_waits: cover property (@(posedge clk_i) disable iff (rst_i) in_valid_i && !in_ready_o);
  // A result has to hold while nobody takes it.
  result_waits: cover property (@(posedge clk_i) disable iff (rst_i) result_valid_o && !result_ready_i);
  // A photon has to hold while nobody takes it.
  photon_waits: cover property (@(posedge clk_i) disable iff (rst_i) photon_valid_o && !photon_ready_i);
  // A line request has to hold while memory does not take it.
  line_request_waits: cover property (@(posedge clk_i) disable iff (rst_i) line_req_valid_o && !line_req_ready_i);
  // Photons are held back and results go on: neither stream waits for the other.
  results_pass_photons: cover property (@(posedge clk_i) disable iff (rst_i) photon_valid_o && !photon_ready_i && result_valid_o && result_ready_i);
  // Results are held back and photons go on.
  photons_pass_results: cover property (@(posedge clk_i) disable iff (rst_i) result_valid_o && !result_ready_i && photon_valid_o && photon_ready_i);
  // Everything is held back at once, from where the unit has to start again without losing a packet.
  all_wait: cover property (@(posedge clk_i) disable iff (rst_i) in_valid_i && !in_ready_o && result_valid_o && !result_ready_i && photon_valid_o &&
      !photon_ready_i);
  // A query comes and a result goes in one cycle.
  both_move: cover property (@(posedge clk_i) disable iff (rst_i) in_valid_i && in_ready_o && result_valid_o && result_ready_i);
  // A line is asked for while a beat of another one comes.
  asked_while_answered: cover property (@(posedge clk_i) disable iff (rst_i) line_req_valid_o && line_req_ready_i && line_rsp_valid_i);
  // A line comes that is not the one asked for last: answers by tag.
  another_line_comes: cover property (@(posedge clk_i) disable iff (rst_i) line_rsp_valid_i && asked_q && line_rsp_tag_i != last_tag_q);
  // Maps or registers change between queries: nothing of the old ones may be left, in the cache neither.
  changed_between_queries: cover property (@(posedge clk_i) disable iff (rst_i) cfg_valid_i && searched_q && !busy);
  // Queries with the cache turned off.
  without_cache: cover property (@(posedge clk_i) disable iff (rst_i) search && bypass);
  // Nothing was found: no flux, the radius is r2_max.
  nothing_found: cover property (@(posedge clk_i) disable iff (rst_i) result_valid_o && !result_o.flush && result_o.count == '0 && result_o.nodes != '0);
  // All k photons were found.
  full_result: cover property (@(posedge clk_i) disable iff (rst_i) result_valid_o && result_o.full);
  // The k photons lie nearer than r2_floor, whose reciprocal is given.
  clamped: cover property (@(posedge clk_i) disable iff (rst_i) result_valid_o && result_o.clamped);
  // The leaf limit ended a query that had more to visit.
  leaf_limit: cover property (@(posedge clk_i) disable iff (rst_i) photonloom_pkg::LeafLimit != 0 && result_valid_o &&
      32'(result_o.leaves) == photonloom_pkg::LeafLimit);
  // A reset with queries in flight.
  reset_in_query: cover property (@(posedge clk_i) rst_i && ran_q && busy);
  // A reset with a result that nobody has taken.
  reset_before_result_is_taken: cover property (@(posedge clk_i) rst_i && ran_q && result_valid_o);
  // A reset with a photon that nobody has taken.
  reset_before_photon_is_taken: cover property (@(posedge clk_i) rst_i && ran_q && photon_valid_o);
  // A reset with a line request that memory has not taken.
  reset_before_line_is_asked: cover property (@(posedge clk_i) rst_i && ran_q && line_req_valid_o);
endmodule
