// SPDX-License-Identifier: Apache-2.0
module photon_gatherer_stack_cover #(
    parameter int unsigned LineBits,
    parameter int unsigned StackBits
) (
    input logic clk_i,
    input logic rst_i,
    input logic push_i,
    input logic [StackBits-1:0] push_stack_i,
    input logic in_valid_i,
    input logic in_ready_o,
    input logic valid_2_q,
    input logic stop_2_q,
    input logic [StackBits-1:0] stack_2_q,
    input logic two,
    input logic far_top,
    input logic far_second,
    input logic loop
);
  // The stack is as deep as it can be.
  deepest: cover property (@(posedge clk_i) disable iff (rst_i) push_i && push_stack_i == StackBits'(LineBits - 1));
  // Two subtrees are dropped and there are more.
  drops_two: cover property (@(posedge clk_i) disable iff (rst_i) loop);
  // A leaf that is done waits as the ring goes on with another query.
  in_waits: cover property (@(posedge clk_i) disable iff (rst_i) in_valid_i && !in_ready_o);
  // The top is dropped, the one below it visited.
  second_taken: cover property (@(posedge clk_i) disable iff (rst_i) valid_2_q && !stop_2_q && far_top && two && !far_second);
  // The last entry is dropped: the query is done.
  last_dropped: cover property (@(posedge clk_i) disable iff (rst_i) valid_2_q && !stop_2_q && far_top && !two);
  // The query ends with entries left, at its leaf limit.
  stopped_with_entries: cover property (@(posedge clk_i) disable iff (rst_i) valid_2_q && stop_2_q && stack_2_q != '0);
  // An entry is written as another query's are judged.
  pushed_while_judged: cover property (@(posedge clk_i) disable iff (rst_i) push_i && valid_2_q);
endmodule
