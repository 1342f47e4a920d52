// SPDX-License-Identifier: Apache-2.0
module reorder_sweep_scan_cover (
    input logic clk_i,
    input logic rst_i,
    input logic row_full_i,
    input logic overflow_q,
    input logic last_valid_q,
    input logic found_valid_q,
    input logic next_none_q,
    input logic may_precede,
    input logic fills_i,
    input logic in_word,
    input logic before_word,
    input logic behind_word
);
  // The bin that was found waits: an insertion of this cycle may go before it.
  found_waits: cover property (@(posedge clk_i) disable iff (rst_i) found_valid_q && !row_full_i && may_precede);
  // A bin fell out of the row: the scan goes back to behind the row's last.
  back_to_row: cover property (@(posedge clk_i) disable iff (rst_i) overflow_q && last_valid_q);
  // A new bin lies in a word that the scan has passed: it goes back.
  back_to_word: cover property (@(posedge clk_i) disable iff (rst_i) fills_i && before_word && !overflow_q);
  // A new bin lies in the word in hand: what was found in that is looked at again.
  found_put_back: cover property (@(posedge clk_i) disable iff (rst_i) fills_i && in_word && found_valid_q);
  // A new bin where nothing was left to find.
  found_after_end: cover property (@(posedge clk_i) disable iff (rst_i) fills_i && behind_word && next_none_q);
endmodule
