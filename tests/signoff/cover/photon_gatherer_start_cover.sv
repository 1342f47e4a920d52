// SPDX-License-Identifier: Apache-2.0
module photon_gatherer_start_cover (
    input logic clk_i,
    input logic rst_i,
    input logic query_valid_q,
    input photonloom_pkg::gather_query_t query_q,
    input logic slot_ready_i,
    input logic flush_ready_i,
    input logic hold_i,
    input logic free,
    input logic empty,
    input logic [1:0] token_q,
    input logic tree_done_i,
    input logic search_o,
    input logic search_leaf_o,
    input logic start_o
);
  logic flushed_q;  // what started last was a flush
  logic started_q;  // something has started since reset: the slots are no longer being cleared
  always_ff @(posedge clk_i) begin
    if (start_o) begin
      flushed_q <= query_q.flush;
      started_q <= 1'b1;
    end
    if (rst_i) {flushed_q, started_q} <= '0;
  end

  // All contexts are in use.
  no_context: cover property (@(posedge clk_i) disable iff (rst_i) query_valid_q && !query_q.flush && slot_ready_i && !free);
  // All result slots are taken, by results that wait for an older one.
  no_slot: cover property (@(posedge clk_i) disable iff (rst_i) started_q && query_valid_q && !slot_ready_i && free);
  // A query waits because its tree goes on with another one.
  held_by_tree: cover property (@(posedge clk_i) disable iff (rst_i) query_valid_q && !query_q.flush && slot_ready_i && free && token_q == 2'd0 && hold_i);
  // The list of the query before is still being emptied.
  waits_for_token: cover property (@(posedge clk_i) disable iff (rst_i) query_valid_q && !query_q.flush && slot_ready_i && free && token_q != 2'd0);
  // A flush waits as another slot is written in its cycle.
  flush_waits: cover property (@(posedge clk_i) disable iff (rst_i) query_valid_q && query_q.flush && slot_ready_i && !flush_ready_i);
  // A flush passes while all contexts are in use.
  flush_without_context: cover property (@(posedge clk_i) disable iff (rst_i) start_o && query_q.flush && !free);
  // A flush behind a flush.
  two_flushes: cover property (@(posedge clk_i) disable iff (rst_i) start_o && query_q.flush && flushed_q);
  // A query of a map without photons ends where it starts.
  empty_map: cover property (@(posedge clk_i) disable iff (rst_i) search_o && empty);
  // It ends in a cycle in which its tree ends another one, which goes first.
  empty_end_waits: cover property (@(posedge clk_i) disable iff (rst_i) token_q == 2'd3 && tree_done_i);
  // A map of one line: the root is a leaf.
  root_is_leaf: cover property (@(posedge clk_i) disable iff (rst_i) search_leaf_o);
endmodule
