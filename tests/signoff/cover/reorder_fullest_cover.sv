// SPDX-License-Identifier: Apache-2.0
module reorder_fullest_cover #(
    parameter int unsigned BinBits,
    parameter int unsigned PathBits,
    parameter int unsigned CountBits,
    parameter int unsigned SettleBits
) (
    input logic clk_i,
    input logic rst_i,
    input logic clear_i,
    input logic ready_o,
    input logic insert_i,
    input logic [BinBits-1:0] insert_bin_i,
    input logic take_i,
    input logic take_ready_o,
    input logic update_q,
    input logic making_q,
    input logic [PathBits-1:0] update_bin_q,
    input logic [PathBits-1:0] making_bin_q,
    input logic [PathBits-1:0] root_bin,
    input logic [PathBits-1:0] best_bin_q,
    input logic [CountBits-1:0] root_count,
    input logic [CountBits-1:0] best_count_q,
    input logic [CountBits-1:0] chosen_rest,
    input logic [CountBits-1:0] left_q,
    input logic [BinBits-1:0] current_q,
    input logic [SettleBits-1:0] settle_q,
    input logic fresh_over_root,
    input logic fresh_over_best,
    input logic choose
);
  logic ran_q = 1'b0;  // the first reset is over
  always_ff @(posedge clk_i) if (!rst_i) ran_q <= 1'b1;

  // The newest length, of two cycles ago, wins: it is in no memory yet.
  newest_wins: cover property (@(posedge clk_i) disable iff (rst_i) choose && fresh_over_root && fresh_over_best);
  // What has grown since the last choice wins over the root.
  grown_wins: cover property (@(posedge clk_i) disable iff (rst_i) choose && !fresh_over_best && best_count_q > root_count);
  // A bin that nothing has joined of late wins: the root's.
  root_wins: cover property (@(posedge clk_i) disable iff (rst_i) choose && !fresh_over_best && root_count > best_count_q);
  // Two bins are equally full: the lower number wins.
  tie: cover property (@(posedge clk_i) disable iff (rst_i) choose && root_count == best_count_q && root_bin != best_bin_q && root_count != '0);
  // The fullest bin holds one packet.
  bin_of_one: cover property (@(posedge clk_i) disable iff (rst_i) choose && chosen_rest == '0);
  // A bin grows while it is being emptied: its length is fixed, the new packet stays behind.
  grows_while_emptied: cover property (@(posedge clk_i) disable iff (rst_i) insert_i && left_q != '0 && insert_bin_i == current_q);
  // A packet enters in the cycle in which another leaves.
  exchange: cover property (@(posedge clk_i) disable iff (rst_i) insert_i && take_i && take_ready_o);
  // A packet enters as the bin's last one leaves: a choice must not come before it is counted.
  enters_as_last_leaves: cover property (@(posedge clk_i) disable iff (rst_i) insert_i && take_i && left_q == CountBits'(1));
  // A choice waits for a length that is being counted.
  waits_for_count: cover property (@(posedge clk_i) disable iff (rst_i) take_i && left_q == '0 && (update_q || making_q));
  // A choice waits until the tournament knows of the last one.
  waits_for_root: cover property (@(posedge clk_i) disable iff (rst_i) take_i && left_q == '0 && settle_q != '0 && !update_q && !making_q);
  // One bin grows in two cycles running: its count is taken from where it is being made.
  same_bin_twice: cover property (@(posedge clk_i) disable iff (rst_i) update_q && making_q && update_bin_q == making_bin_q);
  // Two bins of one match grow in two cycles running: their word is taken from where it is being made.
  same_match_twice: cover property (@(posedge clk_i) disable iff (rst_i) update_q && making_q && update_bin_q != making_bin_q &&
      update_bin_q >> 2 == making_bin_q >> 2);
  // A flush has emptied everything.
  cleared: cover property (@(posedge clk_i) disable iff (rst_i) clear_i);
  // A reset in the middle of a bin.
  reset_in_bin: cover property (@(posedge clk_i) rst_i && ran_q && left_q != '0);
  // A reset while the memories are still being cleared after the one before, or in the middle of that.
  clearing_starts_again: cover property (@(posedge clk_i) rst_i && ran_q && ready_o);
endmodule
