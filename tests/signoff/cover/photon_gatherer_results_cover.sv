// SPDX-License-Identifier: Apache-2.0
module photon_gatherer_results_cover #(
    parameter int unsigned Slots,
    parameter int unsigned SlotBits
) (
    input logic clk_i,
    input logic rst_i,
    input logic start_i,
    input logic start_flush_i,
    input logic finish_i,
    input logic [SlotBits:0] finish_slot_i,
    input logic take_ready_o,
    input logic [SlotBits:0] head_q,
    input logic [SlotBits:0] tail_q,
    input logic done,
    input logic flush_start,
    input logic flush_now,
    input logic occupied_q,
    input logic settled_q,
    input logic complete,
    input logic [1:0] state_q
);
  logic [SlotBits:0] used;
  assign used = tail_q - head_q;

  // A query finishes before an older one: its result waits.
  out_of_order: cover property (@(posedge clk_i) disable iff (rst_i) finish_i && finish_slot_i != head_q);
  // The oldest is not done while younger ones wait behind it.
  head_not_done: cover property (@(posedge clk_i) disable iff (rst_i) state_q == 2'd1 && occupied_q && settled_q && !complete && used > (SlotBits + 1)'(1));
  // All slots are in use.
  slots_full: cover property (@(posedge clk_i) disable iff (rst_i) used == (SlotBits + 1)'(Slots));
  // The slots have gone round: their laps tell old from new.
  second_lap: cover property (@(posedge clk_i) disable iff (rst_i) start_i && tail_q[SlotBits]);
  // The head's slot is written in the cycle in which it would be read.
  head_written: cover property (@(posedge clk_i) disable iff (rst_i) occupied_q && !settled_q);
  // No place is left for a reciprocal: a sum waits.
  no_reciprocal: cover property (@(posedge clk_i) disable iff (rst_i) !take_ready_o);
  // One query finishes as another one's reciprocal does.
  both_written: cover property (@(posedge clk_i) disable iff (rst_i) finish_i && done);
  // A flush starts as a query finishes.
  flush_as_one_finishes: cover property (@(posedge clk_i) disable iff (rst_i) start_i && start_flush_i && finish_i);
  // Of several sums: the word of a flush waits, for another slot is written.
  flush_word_waits: cover property (@(posedge clk_i) disable iff (rst_i) flush_start && flush_now && done);
endmodule
