// SPDX-License-Identifier: Apache-2.0
module photon_gatherer_coded_list_cover #(
    parameter int unsigned K,
    parameter int unsigned IndexBits,
    parameter int unsigned ContextBits,
    parameter int unsigned KeyBits,
    parameter int unsigned RankBits,
    parameter int unsigned CountBits,
    parameter int unsigned Steps
) (
    input logic clk_i, rst_i,
    input logic in_valid_i,
    input logic in_start_i,
    input logic in_snapshot_i,
    input logic [K-1:0] equal_b_q,
    input logic b_candidate_q,
    input logic [ContextBits-1:0] b_context_q,
    input logic c_candidate_q,
    input logic [ContextBits-1:0] c_context_q,
    input logic [KeyBits-1:0] c_key_q,
    input logic [KeyBits-1:0] probe_key_q,
    input logic enters,
    input logic c_full,
    input logic [CountBits-1:0] c_count,
    input logic [RankBits-1:0] c_rank_q,
    input logic c_start_q,
    input logic c_snapshot_q,
    input logic c_doubt_q,
    input logic [Steps-1:0] step_q,
    input logic probe_less,
    input logic ahead_b_q,
    input logic ahead_c_q
);
  // A candidate in doubt turns out to go before the entry that has its code.
  doubt_before: cover property (@(posedge clk_i) disable iff (rst_i) c_doubt_q && step_q[Steps-1] && !probe_less);
  // It goes behind it.
  doubt_behind: cover property (@(posedge clk_i) disable iff (rst_i) c_doubt_q && step_q[Steps-1] && probe_less);
  // It becomes the last of a list that is not full: no further entry to compare with.
  doubt_to_end: cover property (@(posedge clk_i) disable iff (rst_i) c_doubt_q && step_q[0] && c_rank_q == RankBits'(c_count) && !c_full);
  // It goes behind all of a full list, and does not enter.
  doubt_turned_down: cover property (@(posedge clk_i) disable iff (rst_i) c_doubt_q && step_q[0] && c_rank_q >= RankBits'(K));
  // The distances are the same: the index decides.
  doubt_tie: cover property (@(posedge clk_i) disable iff (rst_i) c_doubt_q && step_q[Steps-1] && probe_key_q[KeyBits-1:IndexBits] == c_key_q[KeyBits-1:IndexBits]);
  // Several places have its code.
  several_equal: cover property (@(posedge clk_i) disable iff (rst_i) b_candidate_q && (equal_b_q & (equal_b_q - 1'b1)) != '0);
  // Tokens ahead are nearer, and in no memory yet, as an entry has its code too.
  doubt_and_ahead: cover property (@(posedge clk_i) disable iff (rst_i) b_candidate_q && equal_b_q != '0 && ahead_b_q && ahead_c_q);
  // One in doubt of the same list waits behind one in doubt.
  doubt_behind_doubt: cover property (@(posedge clk_i) disable iff (rst_i) c_doubt_q && b_candidate_q && b_context_q == c_context_q && equal_b_q != '0);
  // A start waits for one in doubt.
  start_waits: cover property (@(posedge clk_i) disable iff (rst_i) c_doubt_q && in_valid_i && in_start_i);
  // A snapshot waits for one in doubt.
  snapshot_waits: cover property (@(posedge clk_i) disable iff (rst_i) c_doubt_q && in_valid_i && in_snapshot_i);
  // A candidate enters a full list in place of the last.
  replaces_last: cover property (@(posedge clk_i) disable iff (rst_i) enters && c_full);
  // A full list turns a candidate down.
  turned_down: cover property (@(posedge clk_i) disable iff (rst_i) c_candidate_q && !enters && !c_doubt_q);
  // The list becomes full: from now on the k-th distance is the bound.
  becomes_full: cover property (@(posedge clk_i) disable iff (rst_i) enters && c_count == CountBits'(K - 1));
  // It becomes the last of a full list: the bound is its own distance, not one of the list's.
  last_of_full: cover property (@(posedge clk_i) disable iff (rst_i) enters && c_full && c_rank_q == RankBits'(K - 1));
  // A snapshot of a list that is full.
  snapshot_of_full: cover property (@(posedge clk_i) disable iff (rst_i) c_snapshot_q && c_full);
  // A snapshot of a list in which nothing is.
  snapshot_of_empty: cover property (@(posedge clk_i) disable iff (rst_i) c_snapshot_q && c_count == '0);
  // What was in a full list is forgotten at the start of the next query.
  full_list_emptied: cover property (@(posedge clk_i) disable iff (rst_i) c_start_q && c_full);
endmodule
