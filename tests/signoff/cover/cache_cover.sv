// SPDX-License-Identifier: Apache-2.0
module cache_cover #(
    parameter int unsigned Ways,
    parameter int unsigned Misses,
    parameter int unsigned WayBits,
    parameter int unsigned TagBits
) (
    input logic clk_i,
    input logic rst_i,
    input logic invalidate_i,
    input logic bypass_i,
    input logic in_valid_i,
    input logic queue_valid,
    input logic ready_i,
    input logic valid_3_q,
    input logic stale_3_q,
    input logic found,
    input logic free_q,
    input logic hits,
    input logic allocate,
    input logic retry,
    input logic [Ways-1:0] held,
    input logic [Ways-1:0] match,
    input logic [Ways-1:0] pending_3_q,
    input logic [Ways*TagBits-1:0] tags_3_q,
    input logic [WayBits-1:0] victim,
    input logic line_req_valid_o,
    input logic hit_valid_q,
    input logic any_filled,
    input logic serve,
    input logic filled,
    input logic reader_valid_q,
    input logic reader_free,
    input logic [Misses-1:0] busy_q,
    input logic sweeping_q
);
  logic ran_q = 1'b0;  // the first reset is over
  logic looks, victim_valid;
  assign looks = valid_3_q && !stale_3_q;
  always_comb begin
    victim_valid = 1'b0;
    for (int unsigned w = 0; w < Ways; w++) if (victim == WayBits'(w)) victim_valid = tags_3_q[TagBits*w+TagBits-1];
  end
  always_ff @(posedge clk_i) if (!rst_i) ran_q <= 1'b1;

  // A line that is there.
  hit: cover property (@(posedge clk_i) disable iff (rst_i) hits);
  // A line that is not, into a way that holds none.
  miss: cover property (@(posedge clk_i) disable iff (rst_i) allocate && !victim_valid);
  // It drives another line out.
  evicts: cover property (@(posedge clk_i) disable iff (rst_i) allocate && victim_valid);
  // The line is on its way for another client: the request comes again.
  line_under_way: cover property (@(posedge clk_i) disable iff (rst_i) looks && (match & pending_3_q) != '0);
  // All entries of the miss table are in use.
  no_entry: cover property (@(posedge clk_i) disable iff (rst_i) looks && !found && !free_q);
  // Every way of the set is held by who still needs it.
  all_ways_held: cover property (@(posedge clk_i) disable iff (rst_i) looks && !found && free_q && held == '1);
  // The request of the miss before has not been taken by memory.
  request_pending: cover property (@(posedge clk_i) disable iff (rst_i) looks && !found && free_q && held != '1 && line_req_valid_o);
  // The tags were written while they were read: the lookup is made again.
  stale: cover property (@(posedge clk_i) disable iff (rst_i) valid_3_q && stale_3_q && !sweeping_q);
  // What is to be looked up again waits behind a new request.
  again_waits: cover property (@(posedge clk_i) disable iff (rst_i) in_valid_i && queue_valid);
  // A request goes to the queue as another one leaves it.
  queue_moves: cover property (@(posedge clk_i) disable iff (rst_i) retry && queue_valid && !in_valid_i);
  // A hit waits for the reader.
  hit_waits: cover property (@(posedge clk_i) disable iff (rst_i) hit_valid_q && !reader_free);
  // A line that has come goes before a hit that waits.
  line_before_hit: cover property (@(posedge clk_i) disable iff (rst_i) serve && hit_valid_q);
  // A line has come and there is no room for its photons.
  line_waits_for_room: cover property (@(posedge clk_i) disable iff (rst_i) any_filled && !ready_i);
  // The last part of a line is written as another line is read.
  written_while_read: cover property (@(posedge clk_i) disable iff (rst_i) filled && reader_valid_q);
  // A way is given to a new line as another one begins to be read.
  taken_as_served: cover property (@(posedge clk_i) disable iff (rst_i) allocate && serve);
  // Every request fetches its line, one that is there too.
  bypassed: cover property (@(posedge clk_i) disable iff (rst_i) allocate && bypass_i);
  // Lines are forgotten while queries are not in flight.
  forgets: cover property (@(posedge clk_i) disable iff (rst_i) invalidate_i);
  // A reset with lines on their way, which must not be taken for those of the queries behind it.
  reset_with_lines_under_way: cover property (@(posedge clk_i) rst_i && ran_q && busy_q != '0);
endmodule
