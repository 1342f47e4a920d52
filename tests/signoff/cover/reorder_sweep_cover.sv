// SPDX-License-Identifier: Apache-2.0
module reorder_sweep_cover #(
    parameter int unsigned BinBits,
    parameter int unsigned CountBits,
    parameter int unsigned Row
) (
    input logic clk_i,
    input logic rst_i,
    input logic clear_i,
    input logic insert_i,
    input logic [BinBits-1:0] insert_bin_i,
    input logic full_i,
    input logic take_i,
    input logic take_ready_o,
    input logic start_q,
    input logic [BinBits-1:0] current_q,
    input logic [CountBits-1:0] left_q,
    input logic left_any_q,
    input logic [Row-1:0] valid_q,
    input logic [Row-1:0] same,
    input logic append,
    input logic known1_q,
    input logic pop,
    input logic move,
    input logic hit,
    input logic ahead,
    input logic in_row,
    input logic beyond,
    input logic exhausted,
    input logic write_q,
    input logic fills_q,
    input logic wrap
);
  logic ran_q = 1'b0;  // the first reset is over
  always_ff @(posedge clk_i) if (!rst_i) ran_q <= 1'b1;

  // The pool is full: a packet enters in the cycle in which another leaves.
  exchange_when_full: cover property (@(posedge clk_i) disable iff (rst_i) insert_i && full_i && take_i && take_ready_o);
  // A packet joins the bin that is being emptied, and leaves in the same pass.
  joins_current: cover property (@(posedge clk_i) disable iff (rst_i) hit && !pop);
  // It comes as the last one of the bin leaves: the bin stays.
  joins_as_last_leaves: cover property (@(posedge clk_i) disable iff (rst_i) hit && take_i && left_any_q && left_q == CountBits'(1));
  // It joins the bin that the sweep turns to in this very cycle.
  joins_next: cover property (@(posedge clk_i) disable iff (rst_i) insert_i && pop && same[0]);
  // A bin behind the sweep: its packet waits for the next pass.
  left_for_next_pass: cover property (@(posedge clk_i) disable iff (rst_i) insert_i && !start_q && insert_bin_i < current_q && !hit);
  // A new bin between those of the row, which has to make place.
  enters_row: cover property (@(posedge clk_i) disable iff (rst_i) in_row);
  // The row is full and the new bin pushes its last one out, which the scan has to find again.
  pushes_out_of_row: cover property (@(posedge clk_i) disable iff (rst_i) in_row && !move && valid_q[Row-1]);
  // A new bin behind the row while the scan brings another one.
  beyond_while_appended: cover property (@(posedge clk_i) disable iff (rst_i) beyond && append);
  // The row moves up as a new bin enters it.
  enters_while_moving: cover property (@(posedge clk_i) disable iff (rst_i) in_row && move && valid_q[1]);
  // The row's first is taken while the second's number is still being read.
  second_not_known: cover property (@(posedge clk_i) disable iff (rst_i) pop && !known1_q);
  // Packets are held and none can leave: the next bin is being looked for.
  no_bin_yet: cover property (@(posedge clk_i) disable iff (rst_i) take_i && !take_ready_o && !exhausted);
  // From the last bin to the first.
  next_pass: cover property (@(posedge clk_i) disable iff (rst_i) wrap);
  // The pass would be over but for a packet that has just come.
  pass_held_open: cover property (@(posedge clk_i) disable iff (rst_i) take_i && !left_any_q && exhausted && (write_q || fills_q));
  // A packet comes as the pass begins: it belongs to it, wherever its bin lies.
  comes_with_new_pass: cover property (@(posedge clk_i) disable iff (rst_i) insert_i && start_q && ahead);
  // A flush has emptied everything.
  cleared: cover property (@(posedge clk_i) disable iff (rst_i) clear_i);
  // A reset in the middle of a bin.
  reset_in_bin: cover property (@(posedge clk_i) rst_i && ran_q && left_any_q);
endmodule
