// SPDX-License-Identifier: Apache-2.0
module photon_gatherer_beat_queue_cover (
    input logic clk_i,
    input logic rst_i,
    input logic ready_o,
    input logic in_keep_i,
    input logic drop,
    input logic pop
);
  // No room for a line: the lanes are held back.
  full: cover property (@(posedge clk_i) disable iff (rst_i) !ready_o);
  // A beat comes and one goes in a cycle.
  both_move: cover property (@(posedge clk_i) disable iff (rst_i) in_keep_i && pop);
  // A beat is taken and another one dropped: two places come free.
  two_places: cover property (@(posedge clk_i) disable iff (rst_i) drop && pop);
endmodule
