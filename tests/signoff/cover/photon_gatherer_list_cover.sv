// SPDX-License-Identifier: Apache-2.0
module photon_gatherer_list_cover #(
    parameter int unsigned K,
    parameter int unsigned R2Bits,
    parameter int unsigned IndexBits,
    parameter int unsigned ContextBits,
    parameter int unsigned KeyBits,
    parameter int unsigned RankBits,
    parameter int unsigned CountBits
) (
    input logic clk_i,
    input logic rst_i,
    input logic in_valid_i,
    input logic in_candidate_i,
    input logic in_start_i,
    input logic in_snapshot_i,
    input logic [ContextBits-1:0] in_context_i,
    input logic [R2Bits-1:0] in_d2_i,
    input logic [KeyBits-1:0] b_key_q,
    input logic [ContextBits-1:0] b_context_q,
    input logic b_candidate_q,
    input logic c_candidate_q,
    input logic [ContextBits-1:0] c_context_q,
    input logic c_enters_q,
    input logic c_full,
    input logic [CountBits-1:0] c_count,
    input logic [RankBits-1:0] c_rank_q,
    input logic c_start_q,
    input logic c_snapshot_q,
    input logic ahead_b_q,
    input logic ahead_c_q
);
  // A candidate enters a full list in place of the last.
  replaces_last: cover property (@(posedge clk_i) disable iff (rst_i) c_enters_q && c_full);
  // A full list turns a candidate down.
  turned_down: cover property (@(posedge clk_i) disable iff (rst_i) c_candidate_q && !c_enters_q);
  // The list becomes full: from now on the k-th distance is the bound.
  becomes_full: cover property (@(posedge clk_i) disable iff (rst_i) c_enters_q && c_count == CountBits'(K - 1));
  // A candidate enters an empty list.
  first_entry: cover property (@(posedge clk_i) disable iff (rst_i) c_enters_q && c_count == '0);
  // It becomes the nearest of a full list: all places move.
  nearest_of_full: cover property (@(posedge clk_i) disable iff (rst_i) c_enters_q && c_full && c_rank_q == '0);
  // It becomes the last of a full list: the bound is its own distance, not one of the list's.
  last_of_full: cover property (@(posedge clk_i) disable iff (rst_i) c_enters_q && c_full && c_rank_q == RankBits'(K - 1));
  // Two candidates running at one distance: the index decides.
  tie: cover property (@(posedge clk_i) disable iff (rst_i) in_valid_i && in_candidate_i && b_candidate_q && b_context_q == in_context_i &&
      b_key_q[KeyBits-1:IndexBits] == in_d2_i);
  // Both tokens ahead are of the same list and nearer, and in no memory yet.
  both_ahead_nearer: cover property (@(posedge clk_i) disable iff (rst_i) b_candidate_q && ahead_b_q && ahead_c_q);
  // Three lists take turns, a candidate each.
  three_lists: cover property (@(posedge clk_i) disable iff (rst_i) in_valid_i && in_candidate_i && b_candidate_q && c_candidate_q &&
      in_context_i != b_context_q && b_context_q != c_context_q && in_context_i != c_context_q);
  // A list is emptied as a candidate of another one enters.
  emptied_behind_candidate: cover property (@(posedge clk_i) disable iff (rst_i) in_valid_i && in_start_i && b_candidate_q);
  // A snapshot follows a candidate of another list.
  snapshot_behind_candidate: cover property (@(posedge clk_i) disable iff (rst_i) in_valid_i && in_snapshot_i && b_candidate_q);
  // A snapshot of a list that is full.
  snapshot_of_full: cover property (@(posedge clk_i) disable iff (rst_i) c_snapshot_q && c_full);
  // A snapshot of a list in which nothing is.
  snapshot_of_empty: cover property (@(posedge clk_i) disable iff (rst_i) c_snapshot_q && c_count == '0);
  // What was in a full list is forgotten at the start of the next query.
  full_list_emptied: cover property (@(posedge clk_i) disable iff (rst_i) c_start_q && c_full);
endmodule
