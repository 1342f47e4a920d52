// SPDX-License-Identifier: Apache-2.0
module reorder_buffer_cover (
    input logic clk_i,
    input logic rst_i,
    input logic in_valid_i,
    input logic in_ready_o,
    input logic out_valid_o,
    input logic out_ready_i,
    input logic in_taken,
    input logic out_taken,
    input logic in_flush
);
  logic ran_q = 1'b0;  // the first reset is over
  logic flushed_q;  // the last packet taken in was a flush
  logic out_waited_q;
  always_ff @(posedge clk_i) begin
    if (!rst_i) ran_q <= 1'b1;
    if (in_taken) flushed_q <= in_flush;
    out_waited_q <= out_valid_o && !out_ready_i;
    if (rst_i) flushed_q <= 1'b0;
  end

  // The packets that wait for their keys fill their FIFO: the source has to hold what it offers.
  in_waits: cover property (@(posedge clk_i) disable iff (rst_i) in_valid_i && !in_ready_o);
  // A packet has to hold while nobody takes it.
  out_waits: cover property (@(posedge clk_i) disable iff (rst_i) out_valid_o && !out_ready_i);
  // Both sides are held back at once, from where the unit has to start again without losing a packet.
  both_wait: cover property (@(posedge clk_i) disable iff (rst_i) in_valid_i && !in_ready_o && out_valid_o && !out_ready_i);
  // One comes and one goes in a cycle, as it does in every cycle of a frame.
  both_move: cover property (@(posedge clk_i) disable iff (rst_i) in_taken && out_taken);
  // The output is released while the input is held: places come free one by one behind a full pipeline.
  released: cover property (@(posedge clk_i) disable iff (rst_i) out_taken && out_waited_q && in_valid_i && !in_ready_o);
  // A flush is what waits at a full input.
  flush_waits: cover property (@(posedge clk_i) disable iff (rst_i) in_valid_i && !in_ready_o && in_flush);
  // A flush behind a flush finds nothing to empty.
  two_flushes: cover property (@(posedge clk_i) disable iff (rst_i) in_taken && in_flush && flushed_q);
  // The first packet behind a flush: the order starts afresh.
  first_behind_flush: cover property (@(posedge clk_i) disable iff (rst_i) in_taken && !in_flush && flushed_q);
  // A packet comes as another is offered and not taken.
  comes_while_out_waits: cover property (@(posedge clk_i) disable iff (rst_i) in_taken && out_valid_o && !out_ready_i);
  // A reset with a packet at the output.
  reset_before_packet_is_taken: cover property (@(posedge clk_i) rst_i && ran_q && out_valid_o);
  // A reset with the input full.
  reset_with_input_full: cover property (@(posedge clk_i) rst_i && ran_q && !in_ready_o);
endmodule
