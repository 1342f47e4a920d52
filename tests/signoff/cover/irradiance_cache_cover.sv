// SPDX-License-Identifier: Apache-2.0
module irradiance_cache_cover #(
    parameter int unsigned Records,
    parameter int unsigned Hits,
    parameter int unsigned HitBits,
    parameter int unsigned CountBits,
    parameter int unsigned WeightBits
) (
    input logic clk_i,
    input logic rst_i,
    input logic in_valid_i,
    input logic in_ready_o,
    input logic out_valid_o,
    input logic out_ready_i,
    input photonloom_pkg::cache_lookup_t packet,
    input photonloom_pkg::cache_lookup_t scan_q,
    input photonloom_pkg::cache_lookup_t drain_q,
    input logic valid,
    input logic ready,
    input logic scan_valid_q,
    input logic drain_valid_q,
    input logic [CountBits-1:0] records_q,
    input logic [CountBits-1:0] next_q,
    input logic read,
    input logic at_end,
    input logic end_scan,
    input logic decide_q,
    input logic room,
    input logic out_ready,
    input logic wanted,
    input logic insert,
    input logic [HitBits-1:0] count,
    input logic [Hits*(WeightBits+1)-1:0] weights
);
  logic ran_q = 1'b0;  // the first reset is over
  always_ff @(posedge clk_i) if (!rst_i) ran_q <= 1'b1;

  // Both words of the input's register wait: the source has to hold its lookup.
  in_waits: cover property (@(posedge clk_i) disable iff (rst_i) in_valid_i && !in_ready_o);
  // The answer has to hold while nobody takes it.
  out_waits: cover property (@(posedge clk_i) disable iff (rst_i) out_valid_o && !out_ready_i);
  // Both sides are held back at once, from where the unit has to start again without losing a lookup.
  both_wait: cover property (@(posedge clk_i) disable iff (rst_i) in_valid_i && !in_ready_o && out_valid_o && !out_ready_i);
  // A lookup comes and an answer goes in one cycle.
  both_move: cover property (@(posedge clk_i) disable iff (rst_i) in_valid_i && in_ready_o && out_valid_o && out_ready_i);
  // The answers' FIFO is full, which holds a lookup back that has gone through its records.
  answers_full: cover property (@(posedge clk_i) disable iff (rst_i) scan_valid_q && at_end && !drain_valid_q && !out_ready);
  // A lookup is done with its records and waits for the one before, whose record it may have to see.
  waits_for_decision: cover property (@(posedge clk_i) disable iff (rst_i) scan_valid_q && at_end && drain_valid_q);
  // The record of the lookup before comes in when this one has read all others: it must still be read.
  record_comes_at_end: cover property (@(posedge clk_i) disable iff (rst_i) insert && scan_valid_q && at_end);
  // A record is written while another one is read, in one memory.
  written_while_read: cover property (@(posedge clk_i) disable iff (rst_i) insert && read);
  // A tile without records: the lookup compares nothing, and what the list held before must not show.
  no_records: cover property (@(posedge clk_i) disable iff (rst_i) end_scan && records_q == '0);
  // The last free record is taken.
  last_place: cover property (@(posedge clk_i) disable iff (rst_i) insert && records_q == CountBits'(Records - 1));
  // A point asks to become a record of a full tile, and is told so.
  refused: cover property (@(posedge clk_i) disable iff (rst_i) wanted && !room);
  // A full tile still answers the points that it covers.
  hit_in_full_tile: cover property (@(posedge clk_i) disable iff (rst_i) decide_q && count != '0 && !room);
  // A point that asks for it is covered already: it makes no record.
  covered_makes_none: cover property (@(posedge clk_i) disable iff (rst_i) decide_q && count != '0 && drain_q.insert);
  // A point that is not covered and asks for nothing.
  only_looks: cover property (@(posedge clk_i) disable iff (rst_i) decide_q && count == '0 && !drain_q.insert);
  // A new tile has to wait for the lookups of the one before.
  clear_waits: cover property (@(posedge clk_i) disable iff (rst_i) valid && packet.clear && (scan_valid_q || drain_valid_q));
  // All records are forgotten at once.
  clears_full_tile: cover property (@(posedge clk_i) disable iff (rst_i) valid && ready && packet.clear && !room);
  // A tile of a single lookup is followed by another tile.
  clears_twice: cover property (@(posedge clk_i) disable iff (rst_i) valid && ready && packet.clear && drain_q.clear && records_q != '0);
  // All places of an answer are in use.
  answer_full: cover property (@(posedge clk_i) disable iff (rst_i) decide_q && count == HitBits'(Hits));
  // The largest weight there is: a point on its record, with the record's normal.
  weight_one: cover property (@(posedge clk_i) disable iff (rst_i) decide_q && weights[WeightBits]);
  // A reset with a lookup half way through its records.
  reset_while_reading: cover property (@(posedge clk_i) rst_i && ran_q && read);
  // A reset with an answer that nobody has taken.
  reset_before_answer_is_taken: cover property (@(posedge clk_i) rst_i && ran_q && out_valid_o);
endmodule
