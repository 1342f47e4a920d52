// SPDX-License-Identifier: Apache-2.0
module photon_gatherer_candidates_cover (
    input logic clk_i,
    input logic rst_i,
    input logic start_i,
    input logic snapshot_i,
    input logic hand_free,
    input logic hand_two,
    input logic hand_q,
    input logic gone,
    input logic wait_valid_q,
    input logic [1:0] wait_mask_q,
    input logic [1:0] wait_near,
    input logic wait_alone,
    input logic wait_merge,
    input logic wait_end
);
  // The bound that shrank while a pair waited leaves nothing of it.
  gone_while_waiting: cover property (@(posedge clk_i) disable iff (rst_i) gone);
  // It leaves one of two.
  half_gone: cover property (@(posedge clk_i) disable iff (rst_i) wait_valid_q && wait_mask_q == 2'b11 && (wait_near == 2'b01 || wait_near == 2'b10));
  // Nothing is left of a leaf's last pair: its end joins the pair in hand.
  end_joins_hand: cover property (@(posedge clk_i) disable iff (rst_i) wait_merge);
  // The pair in hand has two candidates to go when it becomes the leaf's last.
  end_joins_two: cover property (@(posedge clk_i) disable iff (rst_i) wait_merge && hand_two);
  // Such an end goes beside the hand.
  end_alone: cover property (@(posedge clk_i) disable iff (rst_i) wait_end);
  // Such an end waits because the hand ends a leaf too.
  end_waits: cover property (@(posedge clk_i) disable iff (rst_i) wait_alone && !wait_merge && !wait_end);
  // A list is to be emptied while a pair is in hand.
  start_waits: cover property (@(posedge clk_i) disable iff (rst_i) start_i && hand_q && !hand_free);
  // Photons are asked for as a list is to be emptied, which goes first.
  snapshot_waits_for_start: cover property (@(posedge clk_i) disable iff (rst_i) start_i && snapshot_i);
endmodule
