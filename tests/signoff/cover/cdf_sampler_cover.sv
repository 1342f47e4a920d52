// SPDX-License-Identifier: Apache-2.0
module cdf_sampler_cover #(
    parameter int unsigned Combine,
    parameter int unsigned K,
    parameter int unsigned CountBits,
    parameter int unsigned IndexBits,
    parameter int unsigned ProbabilityBits,
    parameter int unsigned PowerTotalBits
) (
    input logic clk_i,
    input logic rst_i,
    input logic in_valid_i,
    input logic in_ready_o,
    input logic out_valid_o,
    input logic out_ready_i,
    input photonloom_pkg::sampler_input_t packet,
    input logic valid,
    input logic ready,
    input logic [1:0] state_q,
    input logic fresh_q,
    input logic open_q,
    input logic table_q,
    input logic [CountBits-1:0] photons_q,
    input logic begin_table,
    input logic add_photon,
    input logic end_photons,
    input logic old_samples_out,
    input logic cosine_last,
    input logic power_ready,
    input logic request_push,
    input logic request_ready,
    input logic [1:0] owing,
    input logic add_q,
    input logic [IndexBits-1:0] photon_cell,
    input logic [IndexBits-1:0] add_cell_q,
    input logic [PowerTotalBits-1:0] power_total,
    input logic weight_valid,
    input logic [ProbabilityBits-1:0] weight,
    input logic last_weight
);
  localparam logic [1:0] Add = 2'd1, Walk = 2'd2;
  localparam logic [1:0] Header = 2'd0, Photon = 2'd1, Request = 2'd2;

  logic ran_q = 1'b0;  // the first reset is over
  // Of the table's weights so far: how many there are above 1, up to 3, and whether all are above 0.
  logic [1:0] large_q;
  logic all_above_0_q;
  always_ff @(posedge clk_i) begin
    if (!rst_i) ran_q <= 1'b1;
    if (weight_valid && weight > ProbabilityBits'(1) && large_q != 2'd3) large_q <= large_q + 2'd1;
    if (weight_valid && weight == '0) all_above_0_q <= 1'b0;
    if (begin_table || rst_i) begin
      large_q <= '0;
      all_above_0_q <= 1'b1;
    end
  end

  // Both words of the input's register wait: the source has to hold its packet.
  in_waits: cover property (@(posedge clk_i) disable iff (rst_i) in_valid_i && !in_ready_o);
  // A sample has to hold while nobody takes it.
  out_waits: cover property (@(posedge clk_i) disable iff (rst_i) out_valid_o && !out_ready_i);
  // Both sides are held back at once, from where the unit has to start again without losing a sample.
  both_wait: cover property (@(posedge clk_i) disable iff (rst_i) in_valid_i && !in_ready_o && out_valid_o && !out_ready_i);
  // A packet comes and a sample goes in one cycle.
  both_move: cover property (@(posedge clk_i) disable iff (rst_i) in_valid_i && in_ready_o && out_valid_o && out_ready_i);
  // A header waits for the table before it, which is still being made.
  header_waits: cover property (@(posedge clk_i) disable iff (rst_i) valid && packet.kind == Header && !fresh_q);
  // A header behind photons ends a table that nobody samples.
  table_without_requests: cover property (@(posedge clk_i) disable iff (rst_i) end_photons && packet.kind == Header);
  // A header behind a header begins the table anew.
  header_again: cover property (@(posedge clk_i) disable iff (rst_i) begin_table && state_q == Add);
  // A third table would overwrite the first while samples are owed from that.
  waits_for_old_samples: cover property (@(posedge clk_i) disable iff (rst_i) valid && packet.kind == Request && state_q == Add &&
      !old_samples_out);
  // Fewer photons than the cosine's total takes cycles: the table waits for that.
  waits_for_cosine: cover property (@(posedge clk_i) disable iff (rst_i) valid && packet.kind == Request && state_q == Add && !cosine_last);
  // A photon beyond the k-th is left out.
  photon_beyond_k: cover property (@(posedge clk_i) disable iff (rst_i) valid && ready && packet.kind == Photon && state_q == Add &&
      photons_q == CountBits'(K));
  // A table of as many photons as there can be.
  table_of_k: cover property (@(posedge clk_i) disable iff (rst_i) end_photons && photons_q == CountBits'(K));
  // A photon before any header is left out.
  photon_before_header: cover property (@(posedge clk_i) disable iff (rst_i) valid && ready && packet.kind == Photon && !open_q);
  // A photon behind a table's first request is left out.
  photon_behind_request: cover property (@(posedge clk_i) disable iff (rst_i) valid && ready && packet.kind == Photon && open_q && state_q != Add);
  // A request before any header is left out.
  request_before_header: cover property (@(posedge clk_i) disable iff (rst_i) valid && ready && packet.kind == Request && !open_q);
  // A table without photons: it is the cosine's alone, or of ones.
  no_photons: cover property (@(posedge clk_i) disable iff (rst_i) end_photons && photons_q == '0);
  // Photons, but none with power: the same without a division by nothing.
  no_power: cover property (@(posedge clk_i) disable iff (rst_i) Combine != 4 && last_weight && photons_q != '0 && power_total == '0);
  // All weight in one cell but for the ones of cells that would vanish.
  one_cell: cover property (@(posedge clk_i) disable iff (rst_i) last_weight && large_q + 2'(weight > ProbabilityBits'(1)) == 2'd1);
  // A cell below the horizon has no weight: nothing is drawn there.
  no_weight: cover property (@(posedge clk_i) disable iff (rst_i) weight_valid && weight == '0);
  // A weight that would vanish is raised to 1.
  weight_raised: cover property (@(posedge clk_i) disable iff (rst_i) weight_valid && weight == ProbabilityBits'(1));
  // Two photons running in one cell: the sum of the first is not in memory yet.
  same_cell_twice: cover property (@(posedge clk_i) disable iff (rst_i) add_photon && add_q && photon_cell == add_cell_q);
  // u = 0: the first cell that has weight.
  u_least: cover property (@(posedge clk_i) disable iff (rst_i) request_push && request_ready && packet.u == '0);
  // u all ones: the last cell that has weight, and none behind it.
  u_greatest: cover property (@(posedge clk_i) disable iff (rst_i) request_push && request_ready && packet.u == '1);
  // The requests of a table fill their FIFO.
  requests_full: cover property (@(posedge clk_i) disable iff (rst_i) request_push && !request_ready);
  // Samples of both tables are under way at once.
  both_tables_owe: cover property (@(posedge clk_i) disable iff (rst_i) owing == 2'b11);
  // A table is made while the other one is sampled.
  made_while_sampled: cover property (@(posedge clk_i) disable iff (rst_i) weight_valid && owing[!table_q]);
  // After reset packets wait until the sums are cleared.
  waits_for_clearing: cover property (@(posedge clk_i) disable iff (rst_i) valid && !power_ready);
  // A reset while photons add up.
  reset_while_adding: cover property (@(posedge clk_i) rst_i && ran_q && state_q == Add);
  // A reset while a table is made, of which some sums are there.
  reset_in_table: cover property (@(posedge clk_i) rst_i && ran_q && (state_q == Walk || weight_valid));
  // A reset with samples owed.
  reset_with_samples_owed: cover property (@(posedge clk_i) rst_i && ran_q && owing != '0);
endmodule
